// SPDX-License-Identifier: Apache-2.0
#include "mapping/outline_map.h"

#include <gtest/gtest.h>

namespace posespace {
namespace {

const OutlineMap kUneven({0.25, 0.5, 1.25}, {-0.1, 0.6, 0.9});

TEST(OutlineMap, GoesThroughItsKnotsAndStraightBetween) {
  EXPECT_DOUBLE_EQ(kUneven.At(0.25), -0.1);
  EXPECT_DOUBLE_EQ(kUneven.At(0.375), 0.25);
  EXPECT_DOUBLE_EQ(kUneven.At(0.5), 0.6);
}

TEST(OutlineMap, AdvancesATurnWithEveryTurn) {
  for (const double position : {-7.3, -1.0, 0.0, 0.24, 0.25, 0.99, 12.6}) {
    EXPECT_NEAR(kUneven.At(position + 1.0), kUneven.At(position) + 1.0, 1e-12);
  }
}

TEST(OutlineMap, IsUndoneByItsInverse) {
  const OutlineMap inverse = kUneven.Inverse();
  for (double position = -2.0; position < 2.0; position += 0.07) {
    EXPECT_NEAR(inverse.At(kUneven.At(position)), position, 1e-12);
  }
}

TEST(OutlineMap, ThenIsOneMapAfterTheOther) {
  const OutlineMap next({0.0, 0.1, 0.7, 1.0}, {3.4, 3.5, 3.55, 4.4});
  const OutlineMap both = kUneven.Then(next);
  for (double position = -2.0; position < 2.0; position += 0.013) {
    EXPECT_NEAR(both.At(position), next.At(kUneven.At(position)), 1e-11);
  }
}

TEST(OutlineMap, OfNoArgumentsMovesNothing) {
  EXPECT_DOUBLE_EQ(OutlineMap().At(0.3), 0.3);
  EXPECT_NEAR(OutlineMap().Then(kUneven).At(5.3), kUneven.At(5.3), 1e-12);
}

}  // namespace
}  // namespace posespace
