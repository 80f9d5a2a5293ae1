// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SESSION_STATE_H_
#define POSESPACE_SESSION_SESSION_STATE_H_

#include <atomic>
#include <cstdint>
#include <mutex>

#include "session/session.h"

namespace posespace {

// What a Session holds; private to session.cpp and session_build.cpp.
//
// Three locks, taken in this order:
//   editing   an edit from its check to its commit, fits of weight fields included: long
//   mutex     what an edit changes: long enough for a copy
//   reading   the pointers that blends and watchers follow: long enough to copy a pointer
// Locks of a BuildPool or a BuildJob may be taken while holding any of them; jobs call Publish with
// none of theirs held.
struct Session::State {
  State(std::string session_id, std::string name, std::map<std::string, std::string> notes);

  const std::string id;
  const std::string display_name;
  const std::map<std::string, std::string> labels;
  const std::string nonce;  // keeps etags of a session of the same id, made later, apart
  const std::chrono::system_clock::time_point created;
  const std::shared_ptr<ChangeCounter> build_changes = std::make_shared<ChangeCounter>(0);

  std::mutex editing;
  std::int64_t builds = 0;  // guarded by editing; numbers builds

  mutable std::mutex mutex;
  // Guarded by mutex:
  std::vector<std::shared_ptr<const Drawing>> drawings;
  std::vector<Correspondence> correspondences;
  Placements placements;                // as set; empty: the default
  std::int64_t placements_version = 0;  // grows when placements are set
  std::int64_t version = 0;             // grows with every change
  std::chrono::system_clock::time_point updated;

  std::atomic<bool> closed{false};  // set under mutex, so that no edit comes after it

  mutable std::mutex reading;
  // Guarded by reading:
  std::shared_ptr<BuildJob> latest;
  std::shared_ptr<const PoseSpace> built;

  std::shared_ptr<BuildJob> Latest() const;
  std::shared_ptr<const PoseSpace> BuiltOrNull() const;

  // Takes what a job built as the session's, at today's placements, if the job is still the latest.
  // `placed` is the placements_version of the job's inputs.
  void Publish(const BuildStatus& status, std::int64_t placed);

  // The rest requires `mutex`.

  std::string Etag() const;
  void Touch();

  // Fails  kSessionNotFound (closed), kEtagMismatch.
  Result<void> AcceptEdit(const std::string& etag) const;

  std::vector<std::string> ShapeIds() const;

  // The position of a drawing in `drawings`, or -1.
  std::ptrdiff_t Find(const std::string& shape_id) const;
};

// Where the drawings `ids` lie when `placements` are set, or by default when they are empty.
Placements PlacementsOrDefault(const Placements& placements, std::span<const std::string> ids);

// The places of the drawings of a pose space, row by row, when each has one.
std::optional<Points> PlacesOf(const PoseSpace& pose_space, const Placements& placements);

// Correspondences as the mapping has them: entry i of each is the mark in drawings[i].
std::vector<Landmark> LandmarksOf(const std::vector<Correspondence>& tuples,
                                  std::span<const std::shared_ptr<const Drawing>> drawings);

}  // namespace posespace

#endif  // POSESPACE_SESSION_SESSION_STATE_H_
