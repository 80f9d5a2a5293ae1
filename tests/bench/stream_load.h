// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_BENCH_STREAM_LOAD_H_
#define POSESPACE_TESTS_BENCH_STREAM_LOAD_H_

#include <grpcpp/support/byte_buffer.h>
#include <sys/types.h>

#include <string>
#include <vector>

namespace posespace {

// A streaming method to put under load.  Messages are bytes made beforehand, so that the client
// costs the same whatever they mean.
struct LoadTarget {
  std::string address;
  std::string method;
  pid_t process;                        // whose CPU time is taken
  std::vector<grpc::ByteBuffer> first;  // said once on each stream
  int first_answers;                    // how many messages answer that
  std::vector<grpc::ByteBuffer> ticks;  // said in turn; each is answered by one message
};

struct LoadPlan {
  int streams = 1;
  double hertz = 0.0;  // of each stream; 0: each tick follows the answer to the one before
  double seconds = 1.0;
};

struct LoadResult {
  double p50 = 0.0, p99 = 0.0;  // seconds from a tick's instant to its answer
  double messages_per_second = 0.0;
  double server_seconds = 0.0;  // CPU time of the server a message
  long messages = 0;
  long dropped = 0;  // not answered before the next tick's instant; only at a given rate
};

// Opens the streams, eight a connection, waits for the first answers and a while of ticks, and
// measures.  With a rate, streams tick evenly one after another, from a thread that keeps to
// instants fixed beforehand, and an answer's time counts from its instant, whatever held up the
// sending.  Throws std::runtime_error when a stream ends by itself.
LoadResult Load(const LoadTarget& target, const LoadPlan& plan);

// Medians over `tries` of the time that a message takes after `idle` seconds without any.
double FirstAfterIdle(const LoadTarget& target, double idle, int tries);

}  // namespace posespace

#endif  // POSESPACE_TESTS_BENCH_STREAM_LOAD_H_
