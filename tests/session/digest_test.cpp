// SPDX-License-Identifier: Apache-2.0
#include "session/digest.h"

#include <gtest/gtest.h>

#include "session/random_id.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using std::string_view_literals::operator""sv;

TEST(Digest, IsSha256OfLengthAndBytes) {
  // printf '\3\0\0\0\0\0\0\0abc' | sha256sum
  EXPECT_EQ(Digest("abc").Hex(),
            "ce91dc5eec0139adf091900d225971d6ad246a845bad791b5693a9d0d55dd391");
}

TEST(Digest, TellsSequencesApartThatJoinToTheSameBytes) {
  EXPECT_NE(Digest("t").Add("ab"sv).Add("c"sv).Hex(), Digest("t").Add("a"sv).Add("bc"sv).Hex());
  EXPECT_NE(Digest("t").Add(""sv).Hex(), Digest("t").Hex());
  EXPECT_NE(Digest("t").Add(PointsOf("1 2, 3 4")).Hex(),
            Digest("t").Add(PointsOf("1 2")).Add(PointsOf("3 4")).Hex());
}

TEST(Digest, TellsNumbersApartInTheirLastBit) {
  EXPECT_NE(Digest("t").Add(1.0).Hex(), Digest("t").Add(std::nextafter(1.0, 2.0)).Hex());
  EXPECT_EQ(Digest("t").Add(0.1).Hex(), Digest("t").Add(0.1).Hex());
}

TEST(ToHex, WritesTwoDigitsAByte) {
  const std::uint8_t bytes[] = {0, 15, 255};
  EXPECT_EQ(ToHex(bytes), "000fff");
}

TEST(RandomId, NeverComesTwice) {
  EXPECT_EQ(RandomId().size(), 32u);
  EXPECT_NE(RandomId(), RandomId());
}

}  // namespace
}  // namespace posespace
