// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_POINTS_H_
#define POSESPACE_TESTS_SUPPORT_POINTS_H_

#include <sstream>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Points from text: PointsOf("0 0, 4 0, 4 3").
inline Points PointsOf(const std::string& text) {
  std::vector<double> values;
  std::string token;
  std::istringstream in(text);
  while (in >> token) {
    if (token.back() == ',') token.pop_back();
    values.push_back(std::stod(token));
  }
  return Eigen::Map<const Points>(values.data(), static_cast<Eigen::Index>(values.size() / 2), 2);
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_POINTS_H_
