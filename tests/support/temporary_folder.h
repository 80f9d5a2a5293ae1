// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
#define POSESPACE_TESTS_SUPPORT_TEMPORARY_FOLDER_H_

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>

namespace posespace {

// A folder of one test's own, removed with what is in it.
class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("posespace-test-" + std::to_string(getpid()) + "-" + std::to_string(++Count()))) {
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  static std::atomic<int>& Count() {
    static std::atomic<int> count{0};
    return count;
  }

  const std::filesystem::path path_;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_TEMPORARY_FOLDER_H_
