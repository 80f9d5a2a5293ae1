// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_OPS_CONFIG_H_
#define POSESPACE_OPS_CONFIG_H_

#include <chrono>
#include <string>

#include "geometry/result.h"
#include "session/limits.h"

namespace posespace {

// The store of somebody who named none: sqlite:, in XDG_DATA_HOME/posespace, or
// ~/.local/share/posespace; empty where neither XDG_DATA_HOME nor HOME says where that is.
std::string DefaultStore();

// What posespaced was told, by flags or by the environment: --max-sessions is
// POSESPACED_MAX_SESSIONS.
struct Config {
  std::string listen = "127.0.0.1:7433";  // ADDR:PORT, port 0 for any; or unix:PATH
  std::string port_file;                  // where the port is written once the service answers
  std::string store = DefaultStore();     // "memory" or "sqlite:PATH"
  std::string log_level = "info";
  bool insecure = false;                        // allow plain text beyond this machine
  std::chrono::milliseconds drain_grace{5000};  // how long open streams may take to end
  Limits limits;
};

// Refuses what cannot work, in words for the person who typed it: a store that does not exist here,
// an address beyond this machine without --insecure.  Fails with kInvalidOption.
Result<void> CheckConfig(const Config& config);

// The command line and the environment, checked.  For --help, --version and errors it prints what
// there is to say and exits.
Config ParseCommandLine(int argc, const char* const* argv, const std::string& version);

// True for unix:PATH, localhost, 127.0.0.0/8 and [::1].
bool IsLocal(const std::string& listen);

}  // namespace posespace

#endif  // POSESPACE_OPS_CONFIG_H_
