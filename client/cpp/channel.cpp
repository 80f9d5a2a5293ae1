// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/channel.h"

#include <google/protobuf/descriptor.h>
#include <grpc/grpc.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <random>
#include <stdexcept>
#include <utility>

#include "client/cpp/polled_stream.h"
#include "client/cpp/transport_error.h"

namespace posespace::internal {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::Message;
using google::protobuf::MessageLite;

grpc::ChannelArguments Settings() {
  grpc::ChannelArguments settings;
  settings.SetUserAgentPrefix("posespace-cpp/" POSESPACE_VERSION);
  // The service's own values: a dead peer is noticed within 40 s even while nothing is said.
  settings.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 30'000);
  settings.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  settings.SetInt(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  settings.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // A service that comes back is found again at once.
  settings.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  settings.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1'000);
  settings.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2'000);
  // Answers are as large as the pictures and batches that were asked for.
  settings.SetMaxReceiveMessageSize(-1);
  settings.SetMaxSendMessageSize(-1);
  // A connection of one's own, and never by way of a proxy that the environment names for the web.
  settings.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  settings.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return settings;
}

// "/posespace.v1.PoseService/Blend" for BlendRequest.
std::string PathOf(const Descriptor& request) {
  const auto& file = *request.file();
  for (int s = 0; s < file.service_count(); ++s) {
    for (int m = 0; m < file.service(s)->method_count(); ++m) {
      const auto& method = *file.service(s)->method(m);
      if (method.input_type() != &request) continue;
      return "/" + file.service(s)->full_name() + "/" + method.name();
    }
  }
  throw std::logic_error(request.full_name() + " is no request");
}

double SecondsOf(Clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

// The answer of a call, waited for by this thread.
grpc::Status Ask(grpc::GenericStub& stub, const std::string& path, const grpc::ByteBuffer& request,
                 grpc::ByteBuffer* response, Clock::duration timeout) {
  grpc::ClientContext context;
  context.set_deadline(GprTime(Clock::now() + timeout));
  grpc::CompletionQueue queue;
  const auto call = stub.PrepareUnaryCall(&context, path, request, &queue);
  call->StartCall();
  grpc::Status status;
  call->Finish(response, &status, &status);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  return status;
}

}  // namespace

class Channel::Transport {
 public:
  explicit Transport(const std::string& address)
      : stub_(grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), Settings())) {}

  // To begin a call with.
  //
  // gRPC notices that a connection has broken only while somebody polls, and a call over one that
  // broke unseen would fail though the service is there.  Polling any queue of the process takes
  // note of one event of any connection.
  grpc::GenericStub& stub() {
    void* tag = nullptr;
    bool ok = false;
    for (int look = 0; look < kLooks; ++look) looks_.AsyncNext(&tag, &ok, GprTime(Clock::now()));
    return stub_;
  }

 private:
  static constexpr int kLooks = 4;

  grpc::GenericStub stub_;
  grpc::CompletionQueue looks_;
};

Channel::Channel(const std::string& address, const ClientOptions& options)
    : address_(address),
      timeout_(options.timeout),
      transport_(std::make_unique<Transport>(address)) {}

Channel::~Channel() = default;

std::optional<Error> Channel::Try(const Message& request, Message* response,
                                  Clock::duration timeout) const {
  grpc::ByteBuffer answer;
  grpc::Status status =
      Ask(transport_->stub(), PathOf(*request.GetDescriptor()), BytesOf(request), &answer, timeout);
  if (status.ok()) status = grpc::SerializationTraits<MessageLite>::Deserialize(&answer, response);
  if (status.ok()) return std::nullopt;
  return ErrorOfCall(Failed(status), address_, SecondsOf(timeout_), request.ByteSizeLong());
}

void Channel::Call(const Message& request, Message* response, Clock::duration beyond) const {
  const auto give_up = Clock::now() + timeout_ + beyond;
  for (;;) {
    const auto shared = std::max(Clock::duration::zero(), give_up - Clock::now());
    const auto refusal = Try(request, response, shared);
    if (!refusal) return;
    if (!PauseBeforeAnotherTry(*refusal, give_up)) throw *refusal;
  }
}

void Channel::CallPatiently(const Message& request, Message* response, Clock::time_point give_up,
                            const std::stop_token& stop) const {
  for (;;) {
    const auto refusal = Try(request, response, timeout_);
    if (!refusal) return;
    if (!PauseBeforeAnotherTry(*refusal, give_up, stop)) throw *refusal;
  }
}

void Channel::CheckHealth() const {
  constexpr char kServing[] = "\x08\x01";  // HealthCheckResponse{status: SERVING}
  const grpc::Slice nothing;
  grpc::ByteBuffer answer;
  const grpc::Status status = Ask(transport_->stub(), "/grpc.health.v1.Health/Check",
                                  grpc::ByteBuffer(&nothing, 1), &answer, timeout_);
  if (!status.ok()) throw ErrorOfCall(Failed(status), address_, SecondsOf(timeout_));
  grpc::Slice said;
  if (!answer.DumpToSingleSlice(&said).ok() ||
      std::string_view(reinterpret_cast<const char*>(said.begin()), said.size()) != kServing) {
    throw Error(ErrorCode::kUnavailable, "the service at " + address_ + " is not serving");
  }
}

std::unique_ptr<Stream> Channel::Open(const Descriptor& request) const {
  return OpenPolledStream(transport_->stub(), PathOf(request), address_);
}

bool Sleep(Clock::duration duration, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any waiting;
  std::unique_lock lock(mutex);
  waiting.wait_for(lock, stop, duration, [] { return false; });
  return !stop.stop_requested();
}

bool PauseBeforeAnotherTry(const Error& refusal, Clock::time_point give_up,
                           const std::stop_token& stop) {
  const bool may_pass =
      refusal.code() == ErrorCode::kResourceExhausted || refusal.code() == ErrorCode::kUnavailable;
  if (!may_pass || !refusal.retry_after()) return false;
  // Callers that were refused together must not come back together.
  thread_local std::minstd_rand random{std::random_device{}()};
  const auto pause = std::chrono::duration_cast<Clock::duration>(
      *refusal.retry_after() * std::uniform_real_distribution<>(1.0, 2.0)(random));
  if (pause >= give_up - Clock::now()) return false;
  return Sleep(pause, stop);
}

Answers::Answers(std::shared_ptr<Channel> channel, std::unique_ptr<Message> request,
                 std::stop_token stop)
    : channel_(std::move(channel)), request_(std::move(request)), stop_(std::move(stop)) {}

bool Answers::Next(Message* answer, Clock::time_point give_up) {
  for (;;) {
    if (!stream_) {
      stream_ = channel_->Open(*request_->GetDescriptor());
      stream_->Write(*request_);
      stream_->WritesDone();
    }
    const std::stop_callback cancel(stop_, [this] { stream_->Cancel(); });
    switch (stream_->Next(give_up)) {
      case Stream::Event::kMessage:
        begun_ = true;
        if (!answer->ParseFromZeroCopyStream(stream_->message().get())) {
          throw Error(ErrorCode::kInternal, "an answer that is none");
        }
        return true;
      case Stream::Event::kNothing:
        throw NoAnswer(channel_->address(), SecondsOf(channel_->timeout()));
      case Stream::Event::kEnded:
        break;
    }
    if (!stream_->error()) return false;
    const Error refusal = *stream_->error();
    if (begun_ || !PauseBeforeAnotherTry(refusal, give_up, stop_)) throw refusal;
    stream_.reset();
  }
}

}  // namespace posespace::internal
