// SPDX-License-Identifier: Apache-2.0
#include "ops/port_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace posespace {

Result<void> WritePortFile(const std::string& path, int port) {
  const std::string draft = path + "." + std::to_string(getpid());
  std::error_code failure;
  {
    std::ofstream file(draft);
    file << port << '\n';
    file.close();
    if (!file) failure = std::make_error_code(std::errc::io_error);
  }
  if (!failure) std::filesystem::rename(draft, path, failure);
  if (!failure) return {};
  std::error_code ignored;
  std::filesystem::remove(draft, ignored);
  return Error{ErrorCode::kInvalidOption,
               "cannot write --port-file '" + path + "': " + failure.message(),
               {}};
}

}  // namespace posespace
