// SPDX-License-Identifier: Apache-2.0
#include "ops/config.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <string_view>

namespace posespace {
namespace {

constexpr std::string_view kSqlite = "sqlite:";

// POSESPACED_MAX_SESSIONS for --max-sessions.
std::string EnvironmentName(std::string flag) {
  flag.erase(0, 2);
  std::transform(flag.begin(), flag.end(), flag.begin(), [](unsigned char c) {
    return c == '-' ? '_' : static_cast<char>(std::toupper(c));
  });
  return "POSESPACED_" + flag;
}

template <typename T>
CLI::Option* AddOption(CLI::App& app, const std::string& group, const std::string& flag, T& value,
                       const std::string& help) {
  return app.add_option(flag, value, help)
      ->envname(EnvironmentName(flag))
      ->capture_default_str()
      ->group(group);
}

// A limit is at least 1: none means "no limit" by being 0.
template <typename T>
void AddLimit(CLI::App& app, const std::string& group, const std::string& flag, T& value,
              const std::string& help, T most = std::numeric_limits<T>::max()) {
  AddOption(app, group, flag, value, help)->check(CLI::Range(T{1}, most));
}

void AddLimits(CLI::App& app, Limits& limits, int& build_timeout, int& stream_age) {
  const std::string accepted = "Limits on what is accepted";
  AddLimit(app, accepted, "--max-request-bytes", limits.max_request_bytes, "one request",
           std::int64_t{1} << 30);
  AddLimit(app, accepted, "--max-image-pixels", limits.max_image_pixels, "pixels of one picture");
  AddLimit(app, accepted, "--max-session-pixels", limits.max_session_pixels,
           "pixels of all pictures of one session");
  AddLimit(app, accepted, "--max-shapes", limits.max_shapes, "drawings of one session");
  AddLimit(app, accepted, "--max-outline-points", limits.max_outline_points, "points of one ring");
  AddLimit(app, accepted, "--max-landmarks", limits.max_landmarks,
           "correspondences of one session");
  AddLimit(app, accepted, "--max-mesh-vertices", limits.max_mesh_vertices, "vertices of one mesh");
  AddLimit(app, accepted, "--max-queries", limits.max_queries, "queries of one Blend or Render");
  AddLimit(app, accepted, "--max-render-side", limits.max_render_side, "pixels across or down");
  AddLimit(app, accepted, "--max-animation-frames", limits.max_animation_frames,
           "frames of one Animate");
  AddLimit(app, accepted, "--max-render-frames", limits.max_render_frames,
           "pictures of one Render along a path");
  const std::string running = "Limits on how much runs at once";
  AddLimit(app, running, "--max-sessions", limits.max_sessions, "sessions");
  AddLimit(app, running, "--max-memory-bytes", limits.max_memory_bytes,
           "sessions in memory; beyond it those that nobody uses stay in the store");
  AddLimit(app, running, "--max-streams", limits.max_streams, "open streams");
  AddLimit(app, running, "--max-picture-bytes", limits.max_picture_bytes,
           "rendered pictures that wait to be read");
  AddLimit(app, running, "--max-stream-slots", limits.max_stream_slots, "sessions of one stream",
           65'536);
  AddLimit(app, running, "--max-stream-items", limits.max_stream_items, "items of one Play frame");
  AddLimit(app, running, "--max-in-flight", limits.max_in_flight,
           "Play frames of one stream read ahead of being answered", 1'024);
  AddLimit(app, running, "--concurrent-builds", limits.concurrent_builds, "builds at once", 256);
  AddLimit(app, running, "--build-queue", limits.build_queue, "builds waiting");
  AddLimit(app, running, "--build-timeout", build_timeout, "seconds a build may take");
  AddLimit(app, running, "--max-stream-age", stream_age,
           "seconds, give or take a tenth, after which a Play stream is told to begin anew");
}

}  // namespace

std::string DefaultStore() {
  const auto absolute = [](const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr && value[0] == '/' ? std::string(value) : std::string();
  };
  std::string data = absolute("XDG_DATA_HOME");
  if (data.empty()) {
    const std::string home = absolute("HOME");
    if (home.empty()) return "";
    data = home + "/.local/share";
  }
  return std::string(kSqlite) + data + "/posespace/posespaced.sqlite";
}

bool IsLocal(const std::string& listen) {
  if (listen.starts_with("unix:")) return true;
  const std::string host = listen.substr(0, listen.rfind(':'));
  in_addr address{};
  const bool numeric = inet_pton(AF_INET, host.c_str(), &address) == 1;
  const bool loopback = numeric && (ntohl(address.s_addr) >> 24) == IN_LOOPBACKNET;
  return loopback || host == "localhost" || host == "[::1]";
}

Result<void> CheckConfig(const Config& config) {
  const auto refuse = [](std::string message) {
    return Error{ErrorCode::kInvalidOption, std::move(message), {}};
  };
  const bool unix_socket = config.listen.starts_with("unix:");
  if (!unix_socket) {
    const auto colon = config.listen.rfind(':');
    const std::string port = colon == std::string::npos ? "" : config.listen.substr(colon + 1);
    const bool digits =
        !port.empty() && port.size() <= 5 &&
        std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits || std::stoi(port) > 65'535 || colon == 0) {
      return refuse("--listen '" + config.listen + "' is neither ADDR:PORT nor unix:PATH");
    }
  }
  if (!IsLocal(config.listen) && !config.insecure) {
    return refuse("--listen " + config.listen +
                  " reaches beyond this machine in plain text and without authentication; say "
                  "--insecure if the network is trusted");
  }
  if (unix_socket && !config.port_file.empty()) {
    return refuse("--port-file needs a TCP address, not " + config.listen);
  }
  if (config.store.empty()) {
    return refuse(
        "there is no home directory to keep sessions in: say --store sqlite:PATH or memory");
  }
  if (config.store.starts_with("postgres")) {
    return refuse("--store '" + config.store + "' is not in this version: memory, sqlite:PATH are");
  }
  if (config.store != "memory" &&
      (!config.store.starts_with(kSqlite) || config.store.size() == kSqlite.size())) {
    return refuse("--store '" + config.store + "' is neither memory nor sqlite:PATH");
  }
  return {};
}

Config ParseCommandLine(int argc, const char* const* argv, const std::string& version) {
  Config config;
  CLI::App app("posespaced: N-way morphing of 2D drawings as a gRPC service", "posespaced");
  app.set_version_flag("--version", "posespaced " + version);
  const std::string service = "Service";
  AddOption(app, service, "--listen", config.listen, "ADDR:PORT (port 0: any) or unix:PATH");
  AddOption(app, service, "--port-file", config.port_file,
            "file that gets the port once the service answers");
  AddOption(app, service, "--store", config.store,
            "where sessions are kept: sqlite:PATH, a file for one process at a time, or memory");
  AddOption(app, service, "--log-level", config.log_level, "what to log, to stderr")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}));
  app.add_flag("--insecure", config.insecure, "allow plain text beyond this machine")
      ->envname("POSESPACED_INSECURE")
      ->group(service);
  int grace = static_cast<int>(config.drain_grace.count());
  AddOption(app, service, "--drain-grace", grace,
            "milliseconds that open streams may take to end after SIGTERM")
      ->check(CLI::Range(0, 600'000));
  int fade = static_cast<int>(config.limits.placement_fade.count());
  AddOption(app, service, "--placement-fade", fade,
            "milliseconds in which Play's frames come over to new placements; 0: at once")
      ->check(CLI::Range(0, 10'000));
  int build_timeout = static_cast<int>(config.limits.build_timeout.count());
  int stream_age = static_cast<int>(config.limits.max_stream_age.count());
  AddLimits(app, config.limits, build_timeout, stream_age);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& outcome) {
    std::exit(app.exit(outcome) == 0 ? 0 : 2);
  }
  config.drain_grace = std::chrono::milliseconds(grace);
  config.limits.placement_fade = std::chrono::milliseconds(fade);
  config.limits.build_timeout = std::chrono::seconds(build_timeout);
  config.limits.max_stream_age = std::chrono::seconds(stream_age);
  if (const auto checked = CheckConfig(config); !checked) {
    std::cerr << "posespaced: " << checked.error().message << '\n';
    std::exit(2);
  }
  return config;
}

}  // namespace posespace
