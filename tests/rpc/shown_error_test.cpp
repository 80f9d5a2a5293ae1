// SPDX-License-Identifier: Apache-2.0
#include "rpc/shown_error.h"

#include <gmock/gmock.h>

#include <new>
#include <stdexcept>
#include <string>

#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"

namespace posespace {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(CleanText, KeepsTextThatFits) {
  EXPECT_EQ(CleanText("shape 'wälk' \u20ac \U0001F600", 100), "shape 'wälk' \u20ac \U0001F600");
  EXPECT_EQ(CleanText("", 0), "");
  EXPECT_EQ(CleanText("abc", 3), "abc");
}

TEST(CleanText, CutsBetweenCharacters) {
  EXPECT_EQ(CleanText("abc", 2), "ab");
  EXPECT_EQ(CleanText("a\u20ac", 3), "a");
  EXPECT_EQ(CleanText("a\u20ac", 4), "a\u20ac");
  EXPECT_EQ(CleanText("\U0001F600", 3), "");
}

TEST(CleanText, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(CleanText("a\xff"
                      "b",
                      10),
            "a?b");
  EXPECT_EQ(CleanText("\xc3", 10), "?");                 // cut short
  EXPECT_EQ(CleanText("\xc0\x80", 10), "??");            // overlong
  EXPECT_EQ(CleanText("\xed\xa0\x80", 10), "???");       // a surrogate
  EXPECT_EQ(CleanText("\xf4\x90\x80\x80", 10), "????");  // beyond Unicode
}

TEST(Shown, KeepsWhatTheCallerMayKnow) {
  const Error error{ErrorCode::kOutlineEmpty, "shape 'walk' is empty", {{"image", "is empty"}}};
  EXPECT_EQ(Shown(error).message, error.message);
  EXPECT_EQ(Shown(error).where.size(), 1u);
}

TEST(Shown, LeaksNothingOfABugAndGivesEachAnIdOfItsOwn) {
  const Error bug{ErrorCode::kInternal, "vector::_M_range_check /secret/path", {{"f", "d"}}};
  const Error shown = Shown(bug);
  EXPECT_EQ(shown.code, ErrorCode::kInternal);
  EXPECT_THAT(shown.message, Not(HasSubstr("secret")));
  EXPECT_TRUE(shown.where.empty());
  EXPECT_NE(shown.message, Shown(bug).message);
}

TEST(Guarded, TurnsAnythingThrownIntoAnError) {
  const auto thrown = [](auto what) { return Guarded([&]() -> Result<void> { throw what; }); };
  EXPECT_THAT(thrown(std::runtime_error("no luck")), FailsSaying(ErrorCode::kInternal, "no luck"));
  EXPECT_THAT(thrown(std::bad_alloc()), FailsWith(ErrorCode::kInternal));
  EXPECT_THAT(thrown(42), FailsWith(ErrorCode::kInternal));
}

TEST(Guarded, HandsTheAnswerOn) {
  EXPECT_EQ(Guarded([]() -> Result<int> { return 7; }).value(), 7);
}

}  // namespace
}  // namespace posespace
