// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_BENCH_ECHO_SERVER_H_
#define POSESPACE_TESTS_BENCH_ECHO_SERVER_H_

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/server.h>

#include <memory>
#include <string>

namespace posespace {

// What Play is measured against: a server with Play's transport settings, whose bidirectional
// methods answer each message by a copy of the stream's first one.  So they carry the same bytes in
// both directions, and neither understand nor compute any.  The first message of a stream is not
// answered.  A method whose name ends in "/N" keeps its thread busy for N nanoseconds before each
// answer, touching no memory: as long as Play blends.
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
