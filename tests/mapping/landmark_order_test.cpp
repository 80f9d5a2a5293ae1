// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/mapping/rings.h"

namespace posespace {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;
using Pairs = std::vector<std::pair<int, int>>;

// Tries all sets of labels kept, unlike the function under test.
bool AgreeUpToRotation(const std::vector<int>& one, std::vector<int> other) {
  for (std::size_t k = 0; k < other.size(); ++k) {
    if (one == other) return true;
    std::rotate(other.begin(), other.begin() + 1, other.end());
  }
  return one == other;
}

TEST(FindOrderConflicts, SeesNoneWhenOrdersDifferByWhereTheyBegin) {
  EXPECT_THAT(FindOrderConflicts({3, 1, 4, 5}, {4, 5, 3, 1}), IsEmpty());
  EXPECT_THAT(FindOrderConflicts({}, {}), IsEmpty());
}

TEST(FindOrderConflicts, CannotContradictWithTwoLabels) {
  EXPECT_THAT(FindOrderConflicts({0, 1}, {1, 0}), IsEmpty());
}

TEST(FindOrderConflicts, NamesTheTwoNeighboursThatChangedPlaces) {
  const Pairs found = FindOrderConflicts({0, 1, 2, 3, 4}, {0, 2, 1, 3, 4});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT((std::vector{found[0].first, found[0].second}), UnorderedElementsAre(1, 2));
}

TEST(FindOrderConflicts, NamesEachLabelThatOneJumpedOver) {
  const Pairs found = FindOrderConflicts({0, 1, 2, 3, 4, 5}, {1, 2, 0, 3, 4, 5});
  EXPECT_THAT(found, UnorderedElementsAre(std::pair(0, 1), std::pair(0, 2)));
}

TEST(FindOrderConflicts, IsEmptyExactlyWhenOrdersAgree) {
  std::vector<int> one = {0, 1, 2, 3, 4};
  std::vector<int> other = one;
  do {
    EXPECT_EQ(FindOrderConflicts(one, other).empty(), AgreeUpToRotation(one, other));
  } while (std::next_permutation(other.begin(), other.end()));
}

TEST(FindCommonOrder, InterleavesOrdersThatShareSomeLabels) {
  const std::vector<std::vector<int>> orders = {{0, 1, 2}, {2, 3, 0}, {1, 3, 4}};
  const std::vector<double> preferred(5, 0.0);
  const auto found = FindCommonOrder(5, orders, preferred);
  ASSERT_TRUE(found.has_value());
  for (const std::vector<int>& order : orders) {
    std::vector<int> restricted = *found;
    std::erase_if(restricted, [&](int label) {
      return std::find(order.begin(), order.end(), label) == order.end();
    });
    EXPECT_TRUE(AgreeUpToRotation(order, restricted));
  }
}

TEST(FindCommonOrder, FindsNoneWhenThreeOrdersContradictThoughAnyTwoAgree) {
  // The first two force 0 1 2 3; the third has 3 between 0 and 1.
  const std::vector<double> preferred(4, 0.0);
  EXPECT_TRUE(FindCommonOrder(4, {{0, 1, 2}, {0, 2, 3}}, preferred).has_value());
  EXPECT_FALSE(FindCommonOrder(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}, preferred).has_value());
}

TEST(FindCommonOrder, FollowsThePreferenceWhereOrdersAreSilent) {
  const std::vector<double> preferred = {0.1, 0.6, 0.35, 0.9};
  const auto found = FindCommonOrder(4, {{0, 1}, {2, 3}}, preferred);
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(AgreeUpToRotation({0, 2, 1, 3}, *found));
}

TEST(FindCommonOrder, EndsOnManyLabelsInScatteredOrders) {
  Sequence next(4);
  std::vector<std::vector<int>> orders(40);
  for (auto& order : orders) {
    for (int k = 0; k < 5; ++k) {
      const int label = static_cast<int>(100 * next());
      if (std::find(order.begin(), order.end(), label) == order.end()) order.push_back(label);
    }
  }
  const std::vector<double> preferred(100, 0.0);
  const auto found = FindCommonOrder(100, orders, preferred);
  EXPECT_TRUE(!found || found->size() == 100u);
}

}  // namespace
}  // namespace posespace
