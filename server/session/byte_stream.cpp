// SPDX-License-Identifier: Apache-2.0
#include "session/byte_stream.h"

#include <bit>

#include "session/digest.h"

namespace posespace {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

constexpr std::string_view kMagic = "PSPC";
constexpr std::size_t kKindBytes = 4;
constexpr std::size_t kChecksumBytes = 64;  // hexadecimal digits
constexpr std::size_t kHeaderBytes = 4 + kKindBytes + 4 + 8 + kChecksumBytes;

std::string Checksum(std::string_view kind, std::uint32_t version,
                     std::span<const std::uint8_t> payload) {
  return Digest("posespace-sealed/1")
      .Add(kind)
      .Add(static_cast<std::int64_t>(version))
      .Add(payload)
      .Hex();
}

Error Corrupt(std::string_view kind, std::string_view reason) {
  return Error{ErrorCode::kSnapshotCorrupt,
               "stored bytes (" + std::string(kind) + ") " + std::string(reason),
               {}};
}

}  // namespace

ByteWriter& ByteWriter::Append(const void* data, std::size_t size) {
  const auto* const first = static_cast<const std::uint8_t*>(data);
  bytes_.insert(bytes_.end(), first, first + size);
  return *this;
}

ByteWriter& ByteWriter::Add(std::string_view text) {
  Add(static_cast<std::int64_t>(text.size()));
  return Append(text.data(), text.size());
}

ByteWriter& ByteWriter::Add(std::span<const std::uint8_t> bytes) {
  Add(static_cast<std::int64_t>(bytes.size()));
  return Append(bytes.data(), bytes.size());
}

Bytes Seal(std::string_view kind, int version, std::span<const std::uint8_t> payload) {
  const auto number = static_cast<std::uint32_t>(version);
  const auto length = static_cast<std::uint64_t>(payload.size());
  const std::string checksum = Checksum(kind, number, payload);
  ByteWriter sealed;
  sealed.bytes_.reserve(kHeaderBytes + payload.size());
  sealed.Append(kMagic.data(), kMagic.size())
      .Append(kind.data(), kind.size())
      .Append(&number, sizeof number)
      .Append(&length, sizeof length)
      .Append(checksum.data(), checksum.size())
      .Append(payload.data(), payload.size());
  return std::move(sealed.bytes_);
}

Result<ByteReader> ByteReader::Unseal(std::span<const std::uint8_t> sealed, std::string_view kind,
                                      int newest) {
  if (sealed.size() < kHeaderBytes) return Corrupt(kind, "are cut short");
  const auto text = [&sealed](std::size_t offset, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(sealed.data()) + offset, size);
  };
  if (text(0, kMagic.size()) != kMagic || text(kMagic.size(), kKindBytes) != kind) {
    return Corrupt(kind, "do not begin as they should");
  }
  std::uint32_t version = 0;
  std::uint64_t length = 0;
  std::memcpy(&version, sealed.data() + 8, sizeof version);
  std::memcpy(&length, sealed.data() + 12, sizeof length);
  const auto payload = sealed.subspan(kHeaderBytes);
  if (length != payload.size()) return Corrupt(kind, "are cut short");
  if (Checksum(kind, version, payload) != text(kHeaderBytes - kChecksumBytes, kChecksumBytes)) {
    return Corrupt(kind, "fail their checksum");
  }
  if (version < 1 || version > static_cast<std::uint32_t>(newest)) {
    return Corrupt(kind, "have version " + std::to_string(version) + "; known here: 1 to " +
                             std::to_string(newest));
  }
  return ByteReader(payload, kind, static_cast<int>(version));
}

std::span<const std::uint8_t> ByteReader::Take(std::size_t size) {
  if (failed_ || size > left_.size()) {
    Fail();
    return {};
  }
  const auto taken = left_.first(size);
  left_ = left_.subspan(size);
  return taken;
}

std::int64_t ByteReader::Integer() {
  std::int64_t value = 0;
  if (const auto block = Take(sizeof value); !block.empty()) {
    std::memcpy(&value, block.data(), sizeof value);
  }
  return value;
}

double ByteReader::Real() { return std::bit_cast<double>(Integer()); }

std::int64_t ByteReader::Count() {
  const std::int64_t count = Integer();
  if (count < 0 || count > Left(1)) Fail();
  return failed_ ? 0 : count;
}

std::span<const std::uint8_t> ByteReader::Block() {
  return Take(static_cast<std::size_t>(Count()));
}

std::string ByteReader::Text() {
  const auto block = Block();
  return {block.begin(), block.end()};
}

Result<void> ByteReader::Finish() const {
  if (failed_) return Corrupt(kind_, "make no sense");
  if (!left_.empty()) return Corrupt(kind_, "go on after their end");
  return {};
}

}  // namespace posespace
