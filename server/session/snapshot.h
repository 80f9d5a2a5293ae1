// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SNAPSHOT_H_
#define POSESPACE_SESSION_SNAPSHOT_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "session/pose_space.h"
#include "session/session_view.h"
#include "store/store.h"

// What a session keeps, as bytes and back: its record, its drawings, its pose space.  Each begins
// with kind, format version and SHA-256 (byte_stream.h); an older version is read for ever, a newer
// one is refused.  Any bytes may be read: they give what was written, or kSnapshotCorrupt.
// All functions are pure.

namespace posespace {

// A drawing by the name that a session gives it.
struct DrawingName {
  std::string id;
  std::string digest;  // Drawing::digest
};

// All of a session but its drawings and pose space, which it names.
struct SessionRecord {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::string nonce;         // of its etags
  std::int64_t version = 0;  // of its etags
  std::chrono::system_clock::time_point created;
  std::chrono::system_clock::time_point updated;
  std::vector<DrawingName> drawings;  // in the order of upload
  std::vector<Correspondence> correspondences;
  Placements placements;                // as set; empty: the default
  std::int64_t builds = 0;              // started so far
  std::string build_id;                 // of the build behind `built`
  std::optional<BuildSummary> built;    // of the built pose space, named by its revision
  std::vector<DrawingName> built_from;  // the drawings of that pose space
};

// What one look at the session shows, without loading it.
SessionView ViewOf(const SessionRecord& record);

Bytes ToBytes(const SessionRecord& record);
Result<SessionRecord> SessionRecordFromBytes(std::span<const std::uint8_t> bytes);

// A packed drawing.  It is the same for every id, so it is kept under its digest.
Bytes ToBytes(const Drawing& drawing);
Result<Drawing> DrawingFromBytes(const DrawingName& name, std::span<const std::uint8_t> bytes);

// `find` gives the drawings that the pose space names; none that it does not know.
using FindDrawing = std::function<std::shared_ptr<const Drawing>(const DrawingName&)>;
Bytes ToBytes(const PoseSpace& pose_space);
Result<std::shared_ptr<const PoseSpace>> PoseSpaceFromBytes(std::span<const std::uint8_t> bytes,
                                                            const FindDrawing& find);

// The keys of a store's blobs.
std::string DrawingKey(const std::string& digest);
std::string PoseSpaceKey(const std::string& revision);

}  // namespace posespace

#endif  // POSESPACE_SESSION_SNAPSHOT_H_
