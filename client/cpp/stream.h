// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_STREAM_H_
#define POSESPACE_CLIENT_CPP_STREAM_H_

#include <google/protobuf/io/zero_copy_stream.h>
#include <google/protobuf/message_lite.h>

#include <chrono>
#include <memory>
#include <optional>

#include "posespace/error.h"

namespace posespace::internal {

// A streaming call, driven by the thread that asks it for its next event: no thread is woken in
// between, and none of gRPC's callback threads, which fall asleep for 100 ms after an idle second,
// is involved.  One thread at a time, except for Cancel.
class Stream {
 public:
  enum class Event { kNothing, kMessage, kEnded };

  virtual ~Stream() = default;

  // Sends a message once those before it are sent; the message is free at once.
  virtual void Write(const google::protobuf::MessageLite& message) = 0;

  // There is nothing more to be written.
  virtual void WritesDone() = 0;

  // Messages that wait to be sent.
  virtual bool writing() const = 0;

  // What happens until `deadline`; one in the past takes what is there.
  virtual Event Next(std::chrono::steady_clock::time_point deadline) = 0;

  // After kMessage: its bytes, from the beginning each time.
  virtual std::unique_ptr<google::protobuf::io::ZeroCopyInputStream> message() = 0;

  // After kEnded: why, or none when the service has said all.
  virtual const std::optional<Error>& error() const = 0;

  // From any thread: ends the call as kCancelled.
  virtual void Cancel() = 0;
};

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_STREAM_H_
