// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RESULTS_H_
#define POSESPACE_RESULTS_H_

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "posespace/options.h"

namespace posespace {

// What calls answer: values, not handles.  Drawing coordinates are pixels, x right, y down;
// vertices are x0 y0 x1 y1 ....

// Where a drawing's pixels lie: texel = (point - origin) * scale, texel (i, j) covering
// [i, i+1] x [j, j+1].
struct TexturePlacement {
  Point origin;
  double scale = 1.0;
  int width = 0;
  int height = 0;
};

// A drawing as the service understood it.
struct Shape {
  std::string id;
  double width = 0.0;  // drawing pixels
  double height = 0.0;
  std::vector<Ring> outline;          // outer ring first, holes after it
  int holes_filled = 0;               // covered by the mesh; transparency keeps them see-through
  std::vector<std::string> warnings;  // what was done to the drawing, in words
  TexturePlacement texture;
  bool flipped = false;  // kept as its mirror image
};

// How much detail a mix of drawings in equal parts loses, 0 to 1: where an eye lies on a cheek,
// both are pale ghosts.
struct GhostLoss {
  double before = 0.0;  // the insides of the drawings were aligned
  double after = 0.0;
};

// How a build went.
struct BuildReport {
  std::string revision;  // the built pose space
  int vertices = 0;
  int triangles = 0;
  int outline_vertices = 0;  // before refinement
  int steiner_vertices = 0;  // before refinement
  double min_angle = 0.0;    // smallest over all triangles and drawings, radians
  // How many parts of the drawings each level of the triangulation dealt with, and how many of the
  // Steiner vertices come from it: "zero_steiner" triangulates a part as it is, "straight_cut",
  // "one_point_cut" and "link_path_cut" cut one in two, "overlay" triangulates any.
  std::map<std::string, int> levels;
  std::map<std::string, int> steiner_by_level;
  std::map<std::string, double> seconds;     // by stage
  std::map<std::string, double> confidence;  // by drawing: how clear its matching was, in (0, 1]
  std::vector<std::string> warnings;         // what a person should know
  // Of all drawings mixed; none when alignment was switched off or had nothing to do.
  std::optional<GhostLoss> ghost_loss;
  std::map<std::string, GhostLoss> ghost_losses;  // by drawing: what the mix loses of its detail
};

// What automatic matching would do with the drawings and marks as they were.
struct Suggestion {
  std::map<std::string, double> confidence;  // by drawing, in (0, 1]; below 0.5 look at it
  std::vector<std::string> flips;            // would fit the others better seen in a mirror
  // How much better with all of them: the cost of matching as they are over that with the flips, at
  // least 1.05; 1 when there are none.
  double flip_gain = 1.0;
  // By drawing: places around its outline, drawing pixels; place k of every drawing is the same.
  // The first is where all outlines turn most, a tip or a notch.
  std::map<std::string, std::vector<Point>> arcs;
  std::string etag;  // of the session that was looked at
};

enum class BuildState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };

// Where a build stands.
struct BuildStatus {
  std::string id;
  BuildState state = BuildState::kQueued;
  std::string stage;  // "matching", "simplification", "triangulation", "improvement", "weights"
  double fraction = 0.0;
  std::optional<BuildReport> report;  // when it succeeded
};

// A session as it stood when it was asked.
struct SessionState {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::vector<std::string> shape_ids;  // in the order of upload
  std::vector<std::map<std::string, Point>> correspondences;
  std::map<std::string, Point> placements;
  bool placements_are_default = true;  // one drawing lies at (0, 0), several on the unit circle
  std::string etag;                    // changes with every change of the session
  std::chrono::system_clock::time_point create_time;
  std::chrono::system_clock::time_point update_time;
  std::string revision;              // the pose space that blends use; empty before the first build
  std::optional<BuildStatus> build;  // the latest
};

// One drawing's part in a mesh.
struct PoseMesh {
  std::string shape_id;
  std::vector<double> vertices;  // drawing pixels; also the vertices' texture coordinates
  std::vector<Ring> outlines;    // as extracted, outer first
  int turns = 0;                 // whole turns added to its mean rotation
  TexturePlacement texture;
};

// One triangle list that is valid in every drawing.
struct Mesh {
  std::string revision;
  std::vector<std::int32_t> triangles;  // a0 b0 c0 a1 b1 c1 ...: positive in every drawing
  std::vector<PoseMesh> poses;          // in the order of weights
  std::vector<std::vector<std::int32_t>> boundary;  // loops of vertices, outer first
  std::vector<std::int32_t> landmarks;              // the vertex of each correspondence
  BuildReport report;

  // The place of the mesh that a pixel of a drawing is in.  Cost linear in the triangles.
  // Throws kNotFound for an unknown drawing, kInvalidArgument for a point outside its mesh.
  MeshPoint At(const std::string& shape_id, Point point) const;
};

// A drawing at a place of pose space.
struct Frame {
  std::vector<float> vertices;
  std::map<std::string, double> weights;          // by drawing; they sum to 1
  std::map<std::string, double> texture_weights;  // by drawing; in [0, 1], they sum to 1
  int folds = 0;                                  // triangles that are not positive
  int mended = 0;                                 // triangles that repair made positive
  std::string revision;
};

// The vertices at many points of pose space, all of one revision.
struct FrameBatch {
  std::string revision;
  std::size_t vertex_count = 0;
  std::vector<float> vertices;  // frame after frame

  std::size_t size() const { return vertex_count == 0 ? 0 : vertices.size() / (2 * vertex_count); }
  std::span<const float> operator[](std::size_t frame) const {
    return std::span(vertices).subspan(2 * vertex_count * frame, 2 * vertex_count);
  }
};

// The weights at many points of pose space.
struct WeightTable {
  std::vector<std::string> shape_ids;  // of the columns
  std::vector<double> values;          // row after row; each sums to 1

  std::size_t size() const { return shape_ids.empty() ? 0 : values.size() / shape_ids.size(); }
  std::span<const double> operator[](std::size_t row) const {
    return std::span(values).subspan(shape_ids.size() * row, shape_ids.size());
  }
};

// Rows from the top, RGBA, straight alpha, sRGB.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

// A frame of an animation.
struct TimedFrame {
  int index = 0;
  double time = 0.0;  // seconds from the start
  Point at;
  Frame frame;
};

}  // namespace posespace

#endif  // POSESPACE_RESULTS_H_
