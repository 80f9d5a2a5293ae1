// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_CLIENT_CPP_LIVE_SERVICE_H_
#define POSESPACE_TESTS_CLIENT_CPP_LIVE_SERVICE_H_

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "posespace/client.h"
#include "tests/support/program.h"

namespace posespace {

// The service that all tests of this program use and leave alive.
inline const std::string& SharedAddress() {
  static const Program program({"--listen", "127.0.0.1:0", "--log-level", "error"});
  static const std::string address = program.Address();
  return address;
}

// A star of `points` arms about (100, 100).
inline Ring StarRing(int points, double turn = 0.0) {
  Ring ring;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = turn + k * std::numbers::pi / points;
    const double radius = k % 2 == 0 ? 90.0 : 45.0;
    ring.push_back({100.0 + radius * std::sin(angle), 100.0 - radius * std::cos(angle)});
  }
  return ring;
}

inline PolygonSource Star(int points = 5, double turn = 0.0) {
  return {.outer = StarRing(points, turn), .holes = {}, .texture = {}};
}

// Three stars at (0, 0), (1, 0) and (0, 1), built with few vertices.
inline Session MakeStars(const Client& client, const std::string& id = {}) {
  Session session = client.CreateSession(id);
  session.PutShape("up", Star());
  session.PutShape("left", Star(5, -0.2));
  session.PutShape("right", Star(5, 0.3));
  session.SetPlacements({{"up", {0, 0}}, {"left", {1, 0}}, {"right", {0, 1}}});
  session.Build({.target_edge_length = 0.3});
  return session;
}

// EXPECT_THAT([&] { client.Session("nobody"); }, Refuses(ErrorCode::kNotFound,
// "SESSION_NOT_FOUND"));
MATCHER_P2(Refuses, code, reason, "throws " + std::string(Name(code)) + " " + reason) {
  try {
    arg();
  } catch (const Error& error) {
    *result_listener << "throws " << Name(error.code()) << " " << error.reason() << ": "
                     << error.what();
    return error.code() == code && error.reason() == reason;
  }
  *result_listener << "throws nothing";
  return false;
}

// What a call throws.
template <typename Call>
Error ErrorOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::kUnknown, "nothing was thrown");
}

// Largest distance between two lists of coordinates.
template <typename A, typename B>
double Distance(const A& a, const B& b) {
  EXPECT_EQ(a.size(), b.size());
  double distance = 0.0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    distance = std::max(distance, std::abs(static_cast<double>(a[k]) - b[k]));
  }
  return distance;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_CLIENT_CPP_LIVE_SERVICE_H_
