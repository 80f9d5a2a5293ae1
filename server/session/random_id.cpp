// SPDX-License-Identifier: Apache-2.0
#include "session/random_id.h"

#include <openssl/rand.h>

#include <array>
#include <cstdint>
#include <stdexcept>

#include "session/digest.h"

namespace posespace {

std::string RandomId() {
  std::array<std::uint8_t, 16> bytes;
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw std::runtime_error("the machine's source of randomness is not available");
  }
  return ToHex(bytes);
}

}  // namespace posespace
