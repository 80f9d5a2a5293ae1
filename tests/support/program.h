// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_PROGRAM_H_
#define POSESPACE_TESTS_SUPPORT_PROGRAM_H_

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <vector>

extern char** environ;

namespace posespace {

// posespaced with the given arguments; its output is kept in files of a directory of its own.
class Program {
 public:
  // `log`, if given, is the descriptor that gets stderr.
  explicit Program(std::vector<std::string> arguments, std::vector<std::string> environment = {},
                   int log = -1) {
    static int count = 0;
    directory_ = std::filesystem::temp_directory_path() /
                 ("posespaced-" + std::to_string(getpid()) + "-" + std::to_string(++count));
    std::filesystem::create_directories(directory_);
    arguments.insert(arguments.begin(), POSESPACED);
    environment.emplace_back("POSESPACED_STORE=memory");  // unless told otherwise before
    for (char** each = environ; *each != nullptr; ++each) environment.emplace_back(*each);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const auto& [descriptor, name] : {std::pair(1, "out"), std::pair(2, "err")}) {
      posix_spawn_file_actions_addopen(&actions, descriptor, (directory_ / name).c_str(),
                                       O_WRONLY | O_CREAT | O_APPEND, 0600);
    }
    if (log >= 0) posix_spawn_file_actions_adddup2(&actions, log, 2);
    const int failure = posix_spawn(&process_, POSESPACED, &actions, nullptr,
                                    Pointers(arguments).data(), Pointers(environment).data());
    EXPECT_EQ(failure, 0);
    posix_spawn_file_actions_destroy(&actions);
  }

  ~Program() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    std::filesystem::remove_all(directory_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  std::string out() const { return Contents("out"); }
  std::string err() const { return Contents("err"); }

  // The address of the ready line, once it is there.
  std::string Address() const {
    const std::string begin = "posespace ready grpc=";
    for (int k = 0; k < 6'000; ++k) {
      const std::string line = out();
      if (line.starts_with(begin) && line.ends_with('\n')) {
        return line.substr(begin.size(), line.size() - begin.size() - 1);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "never ready: " << err();
    return "";
  }

  void Signal(int signal) const { kill(process_, signal); }

  // Until SIGCONT it does nothing.
  void Stop() const {
    Signal(SIGSTOP);
    EXPECT_EQ(waitpid(process_, nullptr, WUNTRACED), process_);
  }

  // The exit status, once there is one; 128 + n when signal n ended it.
  int Wait() {
    int status = 0;
    EXPECT_EQ(waitpid(process_, &status, 0), process_);
    process_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  static std::vector<char*> Pointers(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
  }

  std::string Contents(const std::string& name) const {
    std::ifstream file(directory_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::filesystem::path directory_;
  pid_t process_ = 0;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_PROGRAM_H_
