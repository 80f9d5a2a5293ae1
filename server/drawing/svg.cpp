// SPDX-License-Identifier: Apache-2.0
#include "drawing/svg.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

namespace posespace {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

// The program limits its own processor time; this is for one that waits.
constexpr milliseconds kPatience{20'000};
constexpr std::size_t kMaxAnswer = std::size_t{8} << 20;  // 4 bytes a texel, and some words

Error Internal(const std::string& what) {
  return {ErrorCode::kInternal, "posespace-svg " + what, {}};
}

std::string ProgramPath() {
  std::error_code failed;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", failed);
  return (self.parent_path() / "posespace-svg").string();
}

// A running posespace-svg with a socket as its input and output.  It ends with this object.
class SvgProgram {
 public:
  static Result<SvgProgram> Start() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
      return Internal("got no socket: " + std::string(std::strerror(errno)));
    }
    SvgProgram program(ends[0]);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    std::string path = ProgramPath(), locale = "LC_ALL=C.UTF-8";
    char* const arguments[] = {path.data(), nullptr};
    char* const environment[] = {locale.data(), nullptr};
    const int failed =
        posix_spawn(&program.pid_, path.c_str(), &files, &attributes, arguments, environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    close(ends[1]);
    if (failed != 0) {
      program.pid_ = -1;
      return Internal("did not start at " + path + ": " + std::strerror(failed));
    }
    return program;
  }

  SvgProgram(SvgProgram&& other) noexcept
      : pid_(std::exchange(other.pid_, -1)), socket_(std::exchange(other.socket_, -1)) {}
  SvgProgram(const SvgProgram&) = delete;
  SvgProgram& operator=(const SvgProgram&) = delete;
  ~SvgProgram() {
    if (socket_ >= 0) close(socket_);
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    Wait();
  }

  // What the program writes for the document until it ends; less when it is killed.
  std::string Ask(std::span<const std::uint8_t> document) {
    const auto deadline = Clock::now() + kPatience;
    std::string answer;
    std::array<char, 1 << 16> buffer;
    std::size_t sent = 0;
    if (document.empty()) shutdown(socket_, SHUT_WR);
    while (answer.size() < kMaxAnswer) {
      const bool sending = sent < document.size();
      pollfd ready{socket_, static_cast<short>(sending ? POLLIN | POLLOUT : POLLIN), 0};
      const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now()).count();
      const int found = poll(&ready, 1, static_cast<int>(std::max<std::int64_t>(0, left)));
      if (found < 0 && errno == EINTR) continue;
      if (found <= 0) break;
      if (sending && (ready.revents & POLLOUT) != 0) {
        const auto wrote = send(socket_, document.data() + sent, document.size() - sent,
                                MSG_NOSIGNAL | MSG_DONTWAIT);
        if (wrote < 0 && errno != EAGAIN && errno != EINTR) break;
        if (wrote > 0) sent += static_cast<std::size_t>(wrote);
        if (sent == document.size()) shutdown(socket_, SHUT_WR);
      }
      if ((ready.revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
        const auto got = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
        if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) break;
        if (got > 0) answer.append(buffer.data(), static_cast<std::size_t>(got));
      }
    }
    return answer;
  }

  // How the program ended; kills it when it has not.
  int End() {
    kill(pid_, SIGKILL);
    const int status = Wait();
    pid_ = -1;
    return status;
  }

 private:
  explicit SvgProgram(int socket) : socket_(socket) {}

  int Wait() const {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

  pid_t pid_ = -1;
  int socket_;
};

Error Refusal(const std::string& line) {
  const auto kind_end = line.find(' ');
  const std::string kind = line.substr(0, kind_end);
  const ErrorCode code = kind == "empty"       ? ErrorCode::kOutlineEmpty
                         : kind == "too_large" ? ErrorCode::kImageTooLarge
                                               : ErrorCode::kImageUndecodable;
  return {code, "the SVG document was refused: " + line.substr(kind_end + 1), {}};
}

// Reads what posespace-svg says (svg_program.cpp); nothing when it did not come to an end.
std::optional<Result<DrawnSvg>> Parse(const std::string& answer) {
  const std::string refused = "refused ";
  auto at = answer.find('\n');
  if (at == std::string::npos) return std::nullopt;
  const std::string line = answer.substr(0, at);
  if (line.starts_with(refused)) return Refusal(line.substr(refused.size()));
  DrawnSvg drawn;
  Texture& texture = drawn.texture;
  int warnings = 0;
  if (std::sscanf(line.c_str(), "drawn %d %d %lf %lf %lf %lf %lf %d", &texture.image.width,
                  &texture.image.height, &texture.origin.x(), &texture.origin.y(), &texture.scale,
                  &drawn.width, &drawn.height, &warnings) != 8) {
    return std::nullopt;
  }
  for (; warnings > 0; --warnings) {
    const auto end = answer.find('\n', at + 1);
    if (end == std::string::npos) return std::nullopt;
    drawn.warnings.push_back(answer.substr(at + 1, end - at - 1));
    at = end;
  }
  const std::size_t pixels = static_cast<std::size_t>(texture.image.width) * texture.image.height;
  if (answer.size() - at - 1 != 4 * pixels) return std::nullopt;
  texture.image.rgba.assign(answer.begin() + static_cast<std::ptrdiff_t>(at) + 1, answer.end());
  return drawn;
}

}  // namespace

Result<DrawnSvg> DrawSvg(std::span<const std::uint8_t> document) {
  SvgProgram program = TRY(SvgProgram::Start());
  const std::string answer = program.Ask(document);
  const int status = program.End();
  if (auto result = Parse(answer)) return std::move(*result);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == 0) return Internal("ended with status " + std::to_string(WEXITSTATUS(status)));
  const bool out_of_time = signal == SIGXCPU || signal == SIGKILL;
  return Error{
      ErrorCode::kImageTooLarge,
      std::string("the SVG document takes more ") +
          (out_of_time ? "than 5 seconds" : "memory than 1 GiB, or is too deeply nested,") +
          " to draw",
      {}};
}

}  // namespace posespace
