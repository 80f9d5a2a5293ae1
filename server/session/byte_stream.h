// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_BYTE_STREAM_H_
#define POSESPACE_SESSION_BYTE_STREAM_H_

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "geometry/result.h"
#include "store/store.h"

namespace posespace {

// A payload after its kind (4 letters), format version, length and SHA-256: 84 bytes more.
Bytes Seal(std::string_view kind, int version, std::span<const std::uint8_t> payload);

// Values as bytes, one after another: fixed width, little-endian, what varies in length after its
// length.  One per record.
class ByteWriter {
 public:
  ByteWriter& Add(std::int64_t value) { return Append(&value, sizeof value); }
  ByteWriter& Add(double value) { return Append(&value, sizeof value); }
  ByteWriter& Add(std::string_view text);
  ByteWriter& Add(std::span<const std::uint8_t> bytes);

  // Rows, columns, numbers row by row.
  template <typename Scalar, int kColumns>
  ByteWriter& Add(const Eigen::Matrix<Scalar, Eigen::Dynamic, kColumns, Eigen::RowMajor>& matrix) {
    Add(std::int64_t{matrix.rows()}).Add(std::int64_t{matrix.cols()});
    return Append(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }

  // The elements of a container after their number, each written by `write(element)`.
  template <typename Container, typename Write>
  ByteWriter& AddEach(const Container& elements, Write write) {
    Add(static_cast<std::int64_t>(elements.size()));
    for (const auto& element : elements) write(element);
    return *this;
  }

  // What was added, sealed.
  Bytes Sealed(std::string_view kind, int version) const { return Seal(kind, version, bytes_); }

 private:
  friend Bytes Seal(std::string_view kind, int version, std::span<const std::uint8_t> payload);
  ByteWriter& Append(const void* data, std::size_t size);

  Bytes bytes_;
};

// Reads what ByteWriter wrote, from bytes that may be anything: no length is believed before it is
// checked against the bytes that are left.  After a first failure every value is zero or empty, so
// that readers check once, by Finish.
class ByteReader {
 public:
  // Checks kind, version (1 .. `newest`), length and checksum.  Fails with kSnapshotCorrupt.
  static Result<ByteReader> Unseal(std::span<const std::uint8_t> sealed, std::string_view kind,
                                   int newest);

  int version() const { return version_; }

  std::int64_t Integer();
  double Real();
  std::string Text();
  std::span<const std::uint8_t> Block();

  template <typename Matrix>
  Matrix Read() {
    using Scalar = typename Matrix::Scalar;
    static_assert(Matrix::IsRowMajor && std::is_trivially_copyable_v<Scalar>);
    constexpr int kColumns = Matrix::ColsAtCompileTime;
    Matrix matrix(0, kColumns == Eigen::Dynamic ? 0 : kColumns);
    const std::int64_t rows = Integer(), columns = Integer();
    const bool fits = rows >= 0 && rows <= Left(sizeof(Scalar)) && columns >= 0 &&
                      (kColumns == Eigen::Dynamic || columns == kColumns) &&
                      (columns == 0 || rows <= Left(sizeof(Scalar)) / columns);
    if (!fits) Fail();
    if (failed_) return matrix;
    matrix.resize(rows, columns);
    const auto block = Take(static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
    if (!block.empty()) std::memcpy(matrix.data(), block.data(), block.size());
    return matrix;
  }

  // Calls `read()` as many times as were written; each takes at least one byte.
  template <typename Read>
  void ReadEach(Read read) {
    for (std::int64_t count = Count(); count > 0 && !failed_; --count) read();
  }

  // Says that a value makes no sense.
  void Fail() { failed_ = true; }

  // Fails with kSnapshotCorrupt when anything failed, or bytes are left.
  Result<void> Finish() const;

 private:
  ByteReader(std::span<const std::uint8_t> bytes, std::string_view kind, int version)
      : left_(bytes), kind_(kind), version_(version) {}

  std::span<const std::uint8_t> Take(std::size_t size);
  std::int64_t Count();

  // How many elements of a size the bytes that are left can hold.
  std::int64_t Left(std::size_t each) const {
    return static_cast<std::int64_t>(left_.size() / each);
  }

  std::span<const std::uint8_t> left_;
  std::string kind_;
  int version_;
  bool failed_ = false;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_BYTE_STREAM_H_
