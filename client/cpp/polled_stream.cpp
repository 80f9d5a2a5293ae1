// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/polled_stream.h"

#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace posespace::internal {
namespace {

using google::protobuf::MessageLite;
using Clock = std::chrono::steady_clock;

// A call through a completion queue that its user polls.
class PolledStream final : public Stream {
 public:
  PolledStream(grpc::GenericStub& stub, const std::string& path, std::string address)
      : address_(std::move(address)), call_(stub.PrepareCall(&context_, path, &queue_)) {
    call_->StartCall(Tag(Step::kStarted));
  }

  ~PolledStream() override {
    context_.TryCancel();
    queue_.Shutdown();
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) {
    }
  }

  void Write(const MessageLite& message) override {
    outgoing_.push_back(BytesOf(message));
    Advance();
  }

  void WritesDone() override {
    all_written_ = true;
    Advance();
  }

  bool writing() const override { return !outgoing_.empty(); }

  Event Next(Clock::time_point deadline) override {
    if (ended_) return Event::kEnded;
    Advance();
    for (;;) {
      void* tag = nullptr;
      bool ok = false;
      const auto event = queue_.AsyncNext(&tag, &ok, GprTime(deadline));
      if (event != grpc::CompletionQueue::GOT_EVENT) return Event::kNothing;
      switch (static_cast<Step>(reinterpret_cast<std::intptr_t>(tag))) {
        case Step::kStarted:
          started_ = true;
          break;
        case Step::kWritten:
          writing_ = false;
          if (!outgoing_.empty()) outgoing_.pop_front();
          broken_ = broken_ || !ok;
          break;
        case Step::kAllWritten:
          writing_ = false;
          break;
        case Step::kRead:
          reading_ = false;
          if (ok) return Event::kMessage;
          finishing_ = true;
          call_->Finish(&status_, Tag(Step::kFinished));
          break;
        case Step::kFinished:
          ended_ = true;
          if (!status_.ok()) error_ = ErrorOfCall(Failed(status_), address_);
          return Event::kEnded;
      }
      Advance();
    }
  }

  std::unique_ptr<google::protobuf::io::ZeroCopyInputStream> message() override {
    return std::make_unique<grpc::ProtoBufferReader>(&incoming_);
  }

  const std::optional<Error>& error() const override { return error_; }

  void Cancel() override { context_.TryCancel(); }

 private:
  enum class Step : std::intptr_t { kStarted = 1, kRead, kWritten, kAllWritten, kFinished };

  static void* Tag(Step step) { return reinterpret_cast<void*>(static_cast<std::intptr_t>(step)); }

  // Starts what can be started: one read and one write at a time, nothing after Finish.
  void Advance() {
    if (!started_ || finishing_) return;
    if (!reading_) {
      reading_ = true;
      call_->Read(&incoming_, Tag(Step::kRead));
    }
    if (writing_ || broken_) return;
    if (!outgoing_.empty()) {
      writing_ = true;
      call_->Write(outgoing_.front(), Tag(Step::kWritten));
    } else if (all_written_ && !said_so_) {
      writing_ = said_so_ = true;
      call_->WritesDone(Tag(Step::kAllWritten));
    }
  }

  const std::string address_;
  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
  grpc::ByteBuffer incoming_;
  std::deque<grpc::ByteBuffer> outgoing_;  // its front is being written while writing_
  grpc::Status status_;
  std::optional<Error> error_;
  bool started_ = false;
  bool reading_ = false;
  bool writing_ = false;
  bool broken_ = false;  // nothing can be written any more; the reads say why
  bool all_written_ = false;
  bool said_so_ = false;
  bool finishing_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Stream> OpenPolledStream(grpc::GenericStub& stub, const std::string& path,
                                         const std::string& address) {
  return std::make_unique<PolledStream>(stub, path, address);
}

grpc::ByteBuffer BytesOf(const MessageLite& message) {
  grpc::ByteBuffer bytes;
  bool own_buffer = false;
  grpc::SerializationTraits<MessageLite>::Serialize(message, &bytes, &own_buffer);
  return bytes;
}

gpr_timespec GprTime(Clock::time_point time) {
  if (time == Clock::time_point::max()) return gpr_inf_future(GPR_CLOCK_MONOTONIC);
  const auto remaining = std::chrono::duration_cast<std::chrono::microseconds>(time - Clock::now());
  // gRPC rounds up to milliseconds, and so would wait for one.
  if (remaining.count() <= 0) return gpr_inf_past(GPR_CLOCK_MONOTONIC);
  return gpr_time_add(gpr_now(GPR_CLOCK_MONOTONIC),
                      gpr_time_from_micros(remaining.count(), GPR_TIMESPAN));
}

FailedCall Failed(const grpc::Status& status) {
  return {status.error_code(), status.error_message(), status.error_details()};
}

}  // namespace posespace::internal
