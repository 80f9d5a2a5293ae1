// SPDX-License-Identifier: Apache-2.0
#include "session/digest.h"

#include <openssl/evp.h>

#include <array>
#include <stdexcept>

namespace posespace {
namespace {

// Refusals of OpenSSL's digest are faults of the machine, never of what a client sent.
void Require(bool done) {
  if (!done) throw std::runtime_error("SHA-256 is not available");
}

}  // namespace

struct Digest::Context {
  Context() { Require(state != nullptr && EVP_DigestInit_ex(state, EVP_sha256(), nullptr) == 1); }
  ~Context() { EVP_MD_CTX_free(state); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  EVP_MD_CTX* const state = EVP_MD_CTX_new();
};

Digest::Digest(std::string_view purpose) : context_(std::make_unique<Context>()) { Add(purpose); }

Digest::~Digest() = default;

void Digest::Write(const void* bytes, std::size_t size) {
  Require(EVP_DigestUpdate(context_->state, bytes, size) == 1);
}

Digest& Digest::Add(std::string_view text) {
  Add(static_cast<std::int64_t>(text.size()));
  Write(text.data(), text.size());
  return *this;
}

Digest& Digest::Add(std::span<const std::uint8_t> bytes) {
  Add(static_cast<std::int64_t>(bytes.size()));
  Write(bytes.data(), bytes.size());
  return *this;
}

Digest& Digest::Add(std::int64_t value) {
  Write(&value, sizeof value);
  return *this;
}

Digest& Digest::Add(double value) {
  Write(&value, sizeof value);
  return *this;
}

Digest& Digest::Add(const Points& points) {
  Add(static_cast<std::int64_t>(points.rows()));
  Write(points.data(), static_cast<std::size_t>(points.size()) * sizeof(double));
  return *this;
}

std::string Digest::Hex() {
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> bytes;
  unsigned int size = 0;
  Require(EVP_DigestFinal_ex(context_->state, bytes.data(), &size) == 1);
  return ToHex(std::span(bytes).first(size));
}

std::string ToHex(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace posespace
