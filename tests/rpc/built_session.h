// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_RPC_BUILT_SESSION_H_
#define POSESPACE_TESTS_RPC_BUILT_SESSION_H_

#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "session/registry.h"
#include "store/memory_store.h"
#include "tests/rpc/sample_shapes.h"

namespace posespace {

// A registry with one built session, "cell", of two ellipses at (0, 0) and (0, 1).
class BuiltSession {
 public:
  explicit BuiltSession(const Limits& limits = {},
                        std::shared_ptr<Store> store = std::make_shared<MemoryStore>())
      : registry_(Registry::Open(limits, std::move(store)).value()) {
    session_ = *registry_->Create({"cell", "", {}, ""});
    Put("wide", EllipseOf(80, 40));
    Put("tall", EllipseOf(40, 80));
    EXPECT_TRUE(session_->SetPlacements({{"wide", Point(0, 0)}, {"tall", Point(0, 1)}}, ""));
    Build();
  }

  Registry& registry() { return *registry_; }
  Session& session() { return *session_; }

  void Put(const std::string& id, const Points& ring) {
    EXPECT_TRUE(session_->PutShape(id, PolygonSource{ring, {}, {}}, /*replace=*/true));
  }

  void Build() {
    EXPECT_TRUE(session_->StartBuild({}, registry_->build_pool()));
    while (!session_->LatestBuild()->Status().ended())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto error = session_->LatestBuild()->Status().error;
    EXPECT_FALSE(error) << error->message;
  }

 private:
  std::unique_ptr<Registry> registry_;
  std::shared_ptr<Session> session_;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_RPC_BUILT_SESSION_H_
