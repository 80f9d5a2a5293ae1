// SPDX-License-Identifier: Apache-2.0
#include "rpc/shown_error.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "ops/logging.h"
#include "session/random_id.h"

namespace posespace {
namespace {

// Length of the UTF-8 character that `text` begins with, 0 when it begins with none.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const auto continues = [&](std::size_t k) { return k < text.size() && (byte(k) & 0xc0) == 0x80; };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xc2 && lead <= 0xdf) return continues(1) ? 2 : 0;
  if (lead >= 0xe0 && lead <= 0xef) {
    if (!continues(1) || !continues(2)) return 0;
    const bool overlong = lead == 0xe0 && byte(1) < 0xa0;
    const bool surrogate = lead == 0xed && byte(1) > 0x9f;
    return overlong || surrogate ? 0 : 3;
  }
  if (lead >= 0xf0 && lead <= 0xf4) {
    if (!continues(1) || !continues(2) || !continues(3)) return 0;
    const bool overlong = lead == 0xf0 && byte(1) < 0x90;
    const bool beyond = lead == 0xf4 && byte(1) > 0x8f;
    return overlong || beyond ? 0 : 4;
  }
  return 0;
}

}  // namespace

std::string CleanText(std::string_view text, std::size_t most) {
  std::string clean;
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    if (clean.size() + std::max<std::size_t>(length, 1) > most) break;
    clean += length == 0 ? std::string_view("?") : text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return clean;
}

Error Shown(Error error) {
  if (error.code != ErrorCode::kInternal) return error;
  const std::string id = RandomId();
  spdlog::error("event=internal_error id={} message={}", id, LogValue(error.message));
  return Error{
      ErrorCode::kInternal, "internal error " + id + "; the service's log has the cause", {}};
}

}  // namespace posespace
