// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_BENCH_BENCH_SESSION_H_
#define POSESPACE_TESTS_BENCH_BENCH_SESSION_H_

#include <array>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "geometry/mesh.h"
#include "posespace/v1/session_service.grpc.pb.h"

namespace posespace {

// Where the four drawings of a bench's session lie in pose space.
inline const std::array<Point, 4> kBenchPlaces = {Point(0, 0), Point(1, 0), Point(0, 1),
                                                  Point(1, 1)};

// Makes and builds a session of four stars of `corners` corners.  Returns its mesh.
// Throws std::runtime_error when the service at `address` refuses.
CompatibleMesh BuildStars(const std::string& address, const std::string& session, int corners,
                          double target_edge_length);

// While it lives, the service builds `count` large sessions, each again and again.
class BusyBuilds {
 public:
  BusyBuilds(const std::string& address, int count);
  ~BusyBuilds();

 private:
  std::unique_ptr<v1::SessionService::Stub> stub_;
  std::vector<std::jthread> threads_;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_BENCH_BENCH_SESSION_H_
