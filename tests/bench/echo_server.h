// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_BENCH_ECHO_SERVER_H_
#define POSESPACE_TESTS_BENCH_ECHO_SERVER_H_

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/server.h>

#include <memory>
#include <string>

namespace posespace {

// What Play is measured against: a server with Play's transport settings, whose one bidirectional
// method, of any name, answers each message by a copy of the stream's first one.  So it carries the
// same bytes in both directions, and neither understands nor computes any.  The first message of a
// stream is not answered.
class EchoServer {
 public:
  EchoServer();  // at a port of its own
  ~EchoServer();
  const std::string& address() const { return address_; }

 private:
  class Service;
  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_BENCH_ECHO_SERVER_H_
