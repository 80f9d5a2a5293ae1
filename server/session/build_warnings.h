// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_BUILD_WARNINGS_H_
#define POSESPACE_SESSION_BUILD_WARNINGS_H_

#include <string>
#include <vector>

#include "mapping/pipeline.h"
#include "session/pose_space.h"

namespace posespace {

// What a person should check in the pictures before trusting the blends, in words that name
// drawings by their ids and correspondences by their numbers.
std::vector<std::string> BuildWarnings(const Mapping& mapping, const BuildInputs& inputs);

}  // namespace posespace

#endif  // POSESPACE_SESSION_BUILD_WARNINGS_H_
