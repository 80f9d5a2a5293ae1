// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_DIGEST_H_
#define POSESPACE_SESSION_DIGEST_H_

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "geometry/mesh.h"

namespace posespace {

// SHA-256 of a sequence of values, which tells apart any two sequences: what varies in length is
// written after its length, numbers in fixed width.  Doubles count by their bits.
// One per call; equal sequences give equal digests on every machine of the same byte order.
class Digest {
 public:
  // `purpose` keeps digests of different things apart; a new algorithm gets a new purpose.
  explicit Digest(std::string_view purpose);
  ~Digest();

  Digest& Add(std::string_view text);
  Digest& Add(std::span<const std::uint8_t> bytes);
  Digest& Add(std::int64_t value);
  Digest& Add(double value);
  Digest& Add(const Points& points);

  // 64 lower-case hexadecimal digits; nothing is added afterwards.
  std::string Hex();

 private:
  void Write(const void* bytes, std::size_t size);

  struct Context;
  std::unique_ptr<Context> context_;
};

// Bytes as lower-case hexadecimal digits.
std::string ToHex(std::span<const std::uint8_t> bytes);

}  // namespace posespace

#endif  // POSESPACE_SESSION_DIGEST_H_
