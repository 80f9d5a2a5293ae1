// SPDX-License-Identifier: Apache-2.0
#include "rpc/pulse.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/channel_arguments.h>
#include <grpcpp/support/slice.h>

#include <memory>
#include <utility>

namespace posespace {
namespace {

constexpr std::chrono::milliseconds kPeriod{250};

// Asks the server's health service how the server is, and waits for the answer.
class SelfCall {
 public:
  explicit SelfCall(grpc::Server& server)
      : channel_(server.InProcessChannel(grpc::ChannelArguments())), stub_(channel_) {}

  void Make() {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kPeriod);
    const grpc::Slice nothing;
    const grpc::ByteBuffer request(&nothing, 1);
    grpc::ByteBuffer response;
    std::unique_lock lock(mutex_);
    done_ = false;
    stub_.UnaryCall(&context, "/grpc.health.v1.Health/Check", {}, &request, &response,
                    [this](const grpc::Status&) {
                      const std::scoped_lock done_lock(mutex_);
                      done_ = true;
                      answered_.notify_one();
                    });
    answered_.wait(lock, [this] { return done_; });
  }

 private:
  const std::shared_ptr<grpc::Channel> channel_;
  grpc::GenericStub stub_;
  std::mutex mutex_;
  std::condition_variable answered_;
  bool done_ = false;
};

}  // namespace

Pulse::Pulse(grpc::Server& server, Beat beat)
    : beat_(std::move(beat)), thread_([this, &server] { Run(server); }) {}

Pulse::~Pulse() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_one();
  thread_.join();
}

void Pulse::Run(grpc::Server& server) {
  SelfCall self(server);
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, kPeriod, [this] { return stopping_; })) {
    lock.unlock();
    self.Make();
    beat_(std::chrono::steady_clock::now());
    lock.lock();
  }
}

}  // namespace posespace
