// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_H_
#define POSESPACE_CLIENT_H_

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "posespace/error.h"
#include "posespace/options.h"
#include "posespace/player.h"
#include "posespace/results.h"
#include "posespace/session.h"

// The C++ client of posespace.  This header is all that a program includes.
namespace posespace {

namespace internal {
class Channel;
}  // namespace internal

struct ClientOptions {
  // How long a call may take, and how long a frame of a stream may be waited for, before
  // kDeadlineExceeded.  Within it, a call that the service refuses for a moment (a full queue) is
  // tried again.  Builds have a timeout of their own.
  std::chrono::milliseconds timeout{5'000};
};

// The connection to a service, and its sessions.
//
//   posespace::Client client("127.0.0.1:7433");
//   posespace::Session session = client.CreateSession("tux");
//
// A value over a shared connection: cheap to copy, used from any number of threads.  The connection
// ends with the last Client, Session, Animation and Player of it.  Do not destroy that last one in
// a program's static destructors, which gRPC does not outlive.
class Client {
 public:
  // `address` is HOST:PORT or unix:PATH.  Nothing is sent until the first call.
  explicit Client(const std::string& address, const ClientOptions& options = {});

  // Returns when the service answers and serves; else throws kUnavailable.
  void Ping() const;

  // A new, empty session.  `session_id` is 1-63 of letters, digits, '_', '.', '-', beginning with a
  // letter or digit; empty: the service chooses one that cannot be guessed.  `labels` are notes of
  // your own, up to 64 of up to 256 bytes.
  // Throws kAlreadyExists, kInvalidArgument (INVALID_ID), kResourceExhausted (SESSION_LIMIT).
  posespace::Session CreateSession(const std::string& session_id = {},
                                   const std::string& display_name = {},
                                   const std::map<std::string, std::string>& labels = {}) const;

  // The session of that id.  Throws kNotFound.
  posespace::Session Session(const std::string& session_id) const;

  // All sessions, by id.
  std::vector<posespace::Session> Sessions() const;

 private:
  std::shared_ptr<internal::Channel> channel_;
};

}  // namespace posespace

#endif  // POSESPACE_CLIENT_H_
