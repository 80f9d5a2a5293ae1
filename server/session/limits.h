// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_LIMITS_H_
#define POSESPACE_SESSION_LIMITS_H_

#include <chrono>
#include <cstdint>

namespace posespace {

// Every limit of the service, with its reason; all can be set by flag.
struct Limits {
  // Affect what is accepted.
  std::int64_t max_request_bytes = 16 << 20;     // one request; a 4k PNG fits
  std::int64_t max_image_pixels = 32'000'000;    // checked from the header, before decoding
  std::int64_t max_session_pixels = 64'000'000;  // of all pictures; 25 bytes each once built
  int max_shapes = 64;                           // of one session; cost grows with each
  int max_outline_points = 20'000;               // of one ring
  int max_landmarks = 256;                       // tuples of one session
  int max_mesh_vertices = 8'000;                 // bounds the cost of every blend
  int max_queries = 256;                         // of one Blend or Render
  int max_render_side = 4'096;                   // pixels
  int max_animation_frames = 100'000;            // of one Animate
  int max_render_frames = 10'000;                // of one Render along a path
  // Affects how Play's frames come over to new placements.
  std::chrono::milliseconds placement_fade{150};  // seen, and no wait
  // Affect how much runs at once.
  std::int64_t max_memory_bytes = std::int64_t{2} << 30;  // of sessions that nobody uses just now
  int max_sessions = 10'000;
  int max_streams = 10'000;
  std::int64_t max_picture_bytes = 512 << 20;  // of all rendered pictures not yet read
  int max_stream_slots = 64;
  int max_stream_items = 256;  // of one Play frame
  int max_in_flight = 4;       // Play frames read ahead
  int concurrent_builds = 2;
  int build_queue = 64;
  std::chrono::seconds build_timeout{120};
  std::chrono::seconds max_stream_age{1'800};  // of a Play stream, give or take a tenth
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_LIMITS_H_
