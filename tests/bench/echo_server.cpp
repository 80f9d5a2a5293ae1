// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/echo_server.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <charconv>
#include <chrono>

#include "rpc/transport_options.h"

namespace posespace {
namespace {

using Clock = std::chrono::steady_clock;

// The number at the end of a method's name.
std::chrono::nanoseconds BusyTimeOf(const std::string& method) {
  long count = 0;
  std::from_chars(method.data() + method.rfind('/') + 1, method.data() + method.size(), count);
  return std::chrono::nanoseconds(count);
}

void KeepBusyUntil(Clock::time_point instant) {
  while (Clock::now() < instant) {
  }
}

// Deletes itself when the call is done.
class EchoReactor final : public grpc::ServerGenericBidiReactor {
 public:
  explicit EchoReactor(std::chrono::nanoseconds busy) : busy_(busy) { StartRead(&incoming_); }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::OK);
    if (answer_.size() == 0) {
      incoming_.DumpToSingleSlice(&answer_);
      return StartRead(&incoming_);
    }
    if (busy_.count() > 0) KeepBusyUntil(Clock::now() + busy_);
    const grpc::Slice copy(answer_.begin(), answer_.size());
    outgoing_ = grpc::ByteBuffer(&copy, 1);
    StartWrite(&outgoing_);
  }
  void OnWriteDone(bool ok) override {
    if (ok) StartRead(&incoming_);
  }
  void OnDone() override { delete this; }

  const std::chrono::nanoseconds busy_;
  grpc::ByteBuffer incoming_, outgoing_;
  grpc::Slice answer_;
};

}  // namespace

class EchoServer::Service final : public grpc::CallbackGenericService {
 private:
  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override {
    return new EchoReactor(BusyTimeOf(context->method()));
  }
};

EchoServer::EchoServer() : service_(std::make_unique<Service>()) {
  grpc::ServerBuilder builder;
  SetTransportOptions(builder, Limits());
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterCallbackGenericService(service_.get());
  server_ = builder.BuildAndStart();
  address_ = "127.0.0.1:" + std::to_string(port);
}

EchoServer::~EchoServer() = default;

}  // namespace posespace
