// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SESSION_VIEW_H_
#define POSESPACE_SESSION_SESSION_VIEW_H_

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "session/build_job.h"
#include "session/placements.h"

namespace posespace {

// One place of the character: shape id -> point, drawing pixels.
using Correspondence = std::map<std::string, Point>;

// What one look at a session shows.  A copy.
struct SessionView {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::vector<std::string> shape_ids;  // in the order of upload
  std::vector<Correspondence> correspondences;
  Placements placements;  // set or default; a drawing uploaded after the setting has none
  bool placements_are_default = true;
  std::string etag;
  std::chrono::system_clock::time_point created;
  std::chrono::system_clock::time_point updated;
  std::string revision;              // empty before the first build
  std::optional<BuildStatus> build;  // the latest
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_SESSION_VIEW_H_
