// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_CHANNEL_H_
#define POSESPACE_CLIENT_CPP_CHANNEL_H_

#include <google/protobuf/message.h>

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "client/cpp/stream.h"
#include "posespace/client.h"
#include "posespace/error.h"

namespace posespace::internal {

using Clock = std::chrono::steady_clock;

// One connection, for any number of threads: its settings, deadlines of calls, tries, and their
// errors.  A call is known by its request, since every rpc has a request message of its own.
class Channel {
 public:
  Channel(const std::string& address, const ClientOptions& options);
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  const std::string& address() const { return address_; }
  std::chrono::milliseconds timeout() const { return timeout_; }

  // Fills the answer of a call, or throws Error.  What the service refuses for now, with a time
  // after which to try again, is tried again until the timeout would pass; a slow call gets some
  // time beyond it.
  void Call(const google::protobuf::Message& request, google::protobuf::Message* response,
            Clock::duration beyond = {}) const;

  // The same, but tried until `give_up` or until `stop` is asked for, each try with the whole
  // timeout.
  void CallPatiently(const google::protobuf::Message& request, google::protobuf::Message* response,
                     Clock::time_point give_up, const std::stop_token& stop) const;

  // Throws kUnavailable unless the service says that it serves.
  void CheckHealth() const;

  // Begins a streaming call whose requests are of this kind; writes nothing.
  std::unique_ptr<Stream> Open(const google::protobuf::Descriptor& request) const;

 private:
  class Transport;

  // The error of one try, or none.
  std::optional<Error> Try(const google::protobuf::Message& request,
                           google::protobuf::Message* response, Clock::duration timeout) const;

  const std::string address_;
  const std::chrono::milliseconds timeout_;
  const std::unique_ptr<Transport> transport_;
};

// Sleeps as long as a refusal asks for; false when it asks for none, there is no time until
// `give_up`, or `stop` was asked for meanwhile.
bool PauseBeforeAnotherTry(const Error& refusal, Clock::time_point give_up,
                           const std::stop_token& stop = {});

// Sleeps; false when `stop` was asked for meanwhile.
bool Sleep(Clock::duration duration, const std::stop_token& stop);

// The answers of a call with one request, one by one.  Only a call that has not begun to answer is
// tried again.  One thread at a time; ended early, the call is cancelled.
class Answers {
 public:
  // `stop` ends a Next that waits, as kCancelled.
  Answers(std::shared_ptr<Channel> channel, std::unique_ptr<google::protobuf::Message> request,
          std::stop_token stop = {});

  // The next answer; false after the last.  Throws Error, and kDeadlineExceeded at `give_up`.
  bool Next(google::protobuf::Message* answer, Clock::time_point give_up);

 private:
  std::shared_ptr<Channel> channel_;
  std::unique_ptr<google::protobuf::Message> request_;
  std::stop_token stop_;
  std::unique_ptr<Stream> stream_;
  bool begun_ = false;
};

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_CHANNEL_H_
