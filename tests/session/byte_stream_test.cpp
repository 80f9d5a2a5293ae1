// SPDX-License-Identifier: Apache-2.0
#include "session/byte_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "geometry/mesh.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr auto kCorrupt = ErrorCode::kSnapshotCorrupt;

Bytes Sample() {
  ByteWriter out;
  out.Add(std::int64_t{-7}).Add(0.1).Add("text").Add(PointsOf("1 2, 3 4"));
  out.AddEach(std::vector<int>{5, 6}, [&](int value) { out.Add(std::int64_t{value}); });
  return out.Sealed("test", 3);
}

TEST(ByteStream, GivesBackWhatWasWritten) {
  const Bytes bytes = Sample();
  auto in = ByteReader::Unseal(bytes, "test", 3);
  ASSERT_THAT(in, Succeeds());
  EXPECT_EQ(in->version(), 3);
  EXPECT_EQ(in->Integer(), -7);
  EXPECT_EQ(in->Real(), 0.1);
  EXPECT_EQ(in->Text(), "text");
  EXPECT_EQ(in->Read<Points>(), PointsOf("1 2, 3 4"));
  std::vector<std::int64_t> values;
  in->ReadEach([&] { values.push_back(in->Integer()); });
  EXPECT_THAT(values, testing::ElementsAre(5, 6));
  EXPECT_THAT(in->Finish(), Succeeds());
}

TEST(ByteStream, ReadsOlderVersionsAndRefusesNewerOnes) {
  EXPECT_THAT(ByteReader::Unseal(Sample(), "test", 4), Succeeds());
  EXPECT_THAT(ByteReader::Unseal(Sample(), "test", 2), FailsWith(kCorrupt));
}

TEST(ByteStream, RefusesAnotherKind) {
  EXPECT_THAT(ByteReader::Unseal(Sample(), "else", 3), FailsWith(kCorrupt));
}

TEST(ByteStream, RefusesBytesCutAnywhere) {
  const Bytes bytes = Sample();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THAT(ByteReader::Unseal(std::span(bytes).first(size), "test", 3), FailsWith(kCorrupt))
        << size;
  }
}

TEST(ByteStream, RefusesEveryFlippedBit) {
  const Bytes bytes = Sample();
  for (std::size_t k = 0; k < 8 * bytes.size(); ++k) {
    Bytes flipped = bytes;
    flipped[k / 8] ^= static_cast<std::uint8_t>(1 << (k % 8));
    EXPECT_THAT(ByteReader::Unseal(flipped, "test", 3), FailsWith(kCorrupt)) << k;
  }
}

TEST(ByteStream, BelievesNoLengthBeyondItsBytes) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t length : {std::int64_t{-1}, std::int64_t{9}, kMost}) {
    const Bytes bytes = ByteWriter().Add(length).Add(std::int64_t{0}).Sealed("test", 1);
    const auto reader = [&] { return ByteReader::Unseal(bytes, "test", 1).value(); };
    auto text = reader(), block = reader(), each = reader(), matrix = reader();
    EXPECT_EQ(text.Text(), "");
    EXPECT_THAT(text.Finish(), FailsWith(kCorrupt)) << length;
    EXPECT_TRUE(block.Block().empty());
    EXPECT_THAT(block.Finish(), FailsWith(kCorrupt)) << length;
    int calls = 0;
    each.ReadEach([&] {
      ++calls;
      (void)each.Integer();
    });
    EXPECT_LE(calls, 9);
    EXPECT_THAT(each.Finish(), FailsWith(kCorrupt)) << length;
    EXPECT_EQ(matrix.Read<Points>().rows(), 0);
    EXPECT_THAT(matrix.Finish(), FailsWith(kCorrupt)) << length;
  }
}

TEST(ByteStream, BelievesNoMatrixWhoseSizeOverflows) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (const std::int64_t rows : {std::int64_t{1} << 32, std::int64_t{1} << 62}) {
    for (const std::int64_t columns : {rows, std::int64_t{0}, std::int64_t{-1}}) {
      const Bytes bytes = ByteWriter().Add(rows).Add(columns).Sealed("test", 1);
      auto in = ByteReader::Unseal(bytes, "test", 1).value();
      EXPECT_EQ(in.Read<Matrix>().size(), 0);
      EXPECT_THAT(in.Finish(), FailsWith(kCorrupt)) << rows << " x " << columns;
    }
  }
}

TEST(ByteStream, SaysWhenBytesAreLeft) {
  const Bytes bytes = Sample();
  auto in = ByteReader::Unseal(bytes, "test", 3).value();
  (void)in.Integer();
  EXPECT_THAT(in.Finish(), FailsWith(kCorrupt));
}

}  // namespace
}  // namespace posespace
