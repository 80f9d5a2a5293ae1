// SPDX-License-Identifier: Apache-2.0
#include "session/ids.h"

#include <algorithm>

namespace posespace {
namespace {

constexpr std::size_t kMaxLength = 63;

bool IsAlphanumeric(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

}  // namespace

Result<void> CheckId(const std::string& what, const std::string& id) {
  const bool valid = !id.empty() && id.size() <= kMaxLength && IsAlphanumeric(id.front()) &&
                     std::all_of(id.begin(), id.end(), [](char c) {
                       return IsAlphanumeric(c) || c == '_' || c == '.' || c == '-';
                     });
  if (valid) return {};
  const std::string message = what + " id " + Quoted(id) +
                              " is not 1 to 63 of letters, digits, '_', '.', '-', beginning with "
                              "a letter or digit";
  return Error{ErrorCode::kInvalidId, message, {{what + "_id", message}}};
}

std::string Quoted(const std::string& id) {
  if (id.size() <= kMaxLength) return "'" + id + "'";
  std::size_t cut = kMaxLength;
  while (cut > 0 && (static_cast<unsigned char>(id[cut]) & 0xC0) == 0x80) --cut;  // whole UTF-8
  return "'" + std::string(id, 0, cut) + "...'";
}

}  // namespace posespace
