// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SESSION_STATE_H_
#define POSESPACE_SESSION_SESSION_STATE_H_

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>

#include "session/session.h"
#include "session/snapshot.h"

namespace posespace {

// What a Session holds; private to session*.cpp.
//
// Three locks, taken in this order:
//   editing   an edit from its check to its commit, fits of weight fields and the store's writes
//             included: long
//   mutex     what an edit changes: long enough for a copy
//   reading   the pointers that blends and watchers follow: long enough to copy a pointer
// Locks of a BuildPool, a BuildJob or a store may be taken while holding `editing`, those of pools
// and jobs while holding any of them; jobs call Publish with none of theirs held.
struct Session::State {
  // What edits change.  An edit copies it, changes the copy and commits that.
  struct Content {
    std::vector<std::shared_ptr<const Drawing>> drawings;
    std::vector<Correspondence> correspondences;
    Placements placements;                // as set; empty: the default
    std::int64_t placements_version = 0;  // grows when placements are set
    std::int64_t version = 0;             // grows with every change
    std::chrono::system_clock::time_point updated;

    std::vector<std::string> ShapeIds() const;

    // The position of a drawing in `drawings`, or -1.
    std::ptrdiff_t Find(const std::string& shape_id) const;
  };

  // The pose space that blends use, and the build behind it.
  struct Product {
    std::shared_ptr<const PoseSpace> pose_space;
    std::string build_id;
  };

  State(std::string session_id, std::string name, std::map<std::string, std::string> notes);

  // As a store has it; without drawings and pose space.
  State(const SessionRecord& record, std::shared_ptr<Store> kept_in);

  const std::string id;
  const std::string display_name;
  const std::map<std::string, std::string> labels;
  const std::string nonce;  // keeps etags of a session of the same id, made later, apart
  const std::chrono::system_clock::time_point created;
  const std::shared_ptr<Store> store;  // null: nothing is kept
  const std::shared_ptr<ChangeCounter> build_changes = std::make_shared<ChangeCounter>(0);

  std::mutex editing;
  // Guarded by editing:
  std::int64_t builds = 0;       // numbers builds
  std::string build_id;          // of the build behind `built`
  std::set<std::string> stored;  // the blobs that the store has for this session

  mutable std::mutex mutex;
  Content content;  // guarded by mutex; changed while holding editing, too

  std::atomic<std::int64_t> drawing_bytes{0};  // of what `content` and `built` show

  std::atomic<bool> closed{false};  // set under mutex, so that no edit comes after it

  mutable std::mutex reading;
  // Guarded by reading:
  std::shared_ptr<BuildJob> latest;
  std::shared_ptr<const PoseSpace> built;  // changed while holding editing, too
  std::optional<Error> lost;               // why the stored pose space could not be had

  // Takes the pose space that the store was asked for, of a session that is being loaded.  Fails
  // with what it could not be had for, damage aside.
  Result<void> TakeBuilt(const SessionRecord& record,
                         Result<std::shared_ptr<const PoseSpace>> fetched);

  std::shared_ptr<BuildJob> Latest() const;
  std::shared_ptr<const PoseSpace> BuiltOrNull() const;
  Content Current() const;

  // Takes what a job built as the session's, at today's placements, if the job is still the latest.
  // `placed` is the placements_version of the job's inputs.  Fails as Commit.
  Result<void> Publish(const BuildStatus& status, std::int64_t placed);

  // The rest but AcceptEdit requires `editing`.

  // What an edit begins with.  Fails as AcceptEdit.
  Result<Content> ContentToEdit(const std::string& etag) const;

  // Makes an edit's copy, with a new version, and its pose space the session's: in the store, then
  // here.  Fails with kStoreUnavailable; then nothing has changed.
  Result<void> Commit(Content next, Product product);

  // Counts drawing_bytes.
  void Weigh(const Content& next, const Product& product);

  // The product as it is.
  Product CurrentProduct() const;

  // Writes all that the store does not have.  Fails with kStoreUnavailable.
  Result<void> Keep(const Content& next, const Product& product, std::int64_t started_builds);

  SessionRecord RecordOf(const Content& next, const Product& product,
                         std::int64_t started_builds) const;

  // Requires `mutex`.
  std::string Etag() const;

  // Requires `mutex`.  Fails  kSessionNotFound (closed), kEtagMismatch.
  Result<void> AcceptEdit(const std::string& etag) const;
};

std::string EtagOf(const std::string& nonce, std::int64_t version);

// How drawings are matched that may be turned so.
MatchingOptions MatchingOptionsOf(Rotation rotation);

// Where the drawings `ids` lie when `placements` are set, or by default when they are empty.
Placements PlacementsOrDefault(const Placements& placements, std::span<const std::string> ids);

// The places of the drawings of a pose space, row by row, when each has one.
std::optional<Points> PlacesOf(const PoseSpace& pose_space, const Placements& placements);

// Correspondences as the mapping has them: entry i of each is the mark in drawings[i].
std::vector<Landmark> LandmarksOf(const std::vector<Correspondence>& tuples,
                                  std::span<const std::shared_ptr<const Drawing>> drawings);

}  // namespace posespace

#endif  // POSESPACE_SESSION_SESSION_STATE_H_
