// SPDX-License-Identifier: Apache-2.0
// posespaced: reads what it is told, serves until it is asked to stop, and stops cleanly.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "ops/config.h"
#include "ops/logging.h"
#include "ops/port_file.h"
#include "ops/termination.h"
#include "rpc/server.h"
#include "store/open_store.h"

namespace {

using std::chrono::milliseconds;

// Open streams may end within the grace; a second signal ends the waiting.
void Drain(posespace::Server& server, const posespace::Termination& termination,
           milliseconds grace) {
  constexpr milliseconds kLook{20};
  server.BeginDrain(grace);
  for (milliseconds waited{0}; waited < grace && server.open_streams() > 0; waited += kLook) {
    if (termination.WaitFor(kLook)) break;
  }
  server.Shutdown(std::min(grace, milliseconds(500)));
}

// Ends the program when stopping takes longer than that, whatever holds it.
void EndAtLatest(milliseconds time) {
  std::thread([time] {
    std::this_thread::sleep_for(time);
    spdlog::error("event=gave_up reason=\"work did not stop in time\"");
    std::_Exit(1);
  }).detach();
}

int Refuse(const posespace::Error& error) {
  std::cerr << "posespaced: " << error.message << '\n';
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const posespace::Config config = posespace::ParseCommandLine(argc, argv, POSESPACE_VERSION);
  const posespace::Termination termination;
  posespace::SetUpLogging(config.log_level);

  auto store = posespace::OpenStore(config.store);
  if (!store) return Refuse(store.error());
  const auto server =
      posespace::Server::Start(config.listen, config.limits, std::move(store).value());
  if (!server) return Refuse(server.error());
  if (!config.port_file.empty()) {
    if (auto written = posespace::WritePortFile(config.port_file, (*server)->port()); !written) {
      return Refuse(written.error());
    }
  }
  std::cout << "posespace ready grpc=" << (*server)->address() << std::endl;
  spdlog::info("event=ready grpc={} store={}", (*server)->address(), config.store);

  termination.Wait();
  EndAtLatest(config.drain_grace + milliseconds(5000));
  spdlog::info("event=draining streams={}", (*server)->open_streams());
  Drain(**server, termination, config.drain_grace);
  spdlog::info("event=stopped");
  return 0;
}
