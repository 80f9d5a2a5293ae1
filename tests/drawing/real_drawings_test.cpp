// SPDX-License-Identifier: Apache-2.0
// Sprites as artists deliver them; skipped where the development shapes are not at hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "drawing/decode.h"
#include "drawing/outline.h"
#include "geometry/polygon.h"

namespace posespace {
namespace {

std::vector<std::filesystem::path> Sprites() {
  const char* shapes = std::getenv("POSESPACE_SHAPES");
  const std::filesystem::path folder =
      std::filesystem::path(shapes != nullptr ? shapes : "../shared/shapes") / "sprite";
  std::vector<std::filesystem::path> sprites;
  if (!std::filesystem::is_directory(folder)) return sprites;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".png") sprites.push_back(entry.path());
  }
  std::sort(sprites.begin(), sprites.end());
  return sprites;
}

Result<DecodedImage> ReadImage(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  return DecodeImage({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

TEST(RealDrawings, AreTracedWithEveryPaintedPixelEnclosedAndNothingLeftOut) {
  const auto sprites = Sprites();
  if (sprites.empty()) GTEST_SKIP() << "no drawings at ../shared/shapes; set POSESPACE_SHAPES";
  for (const auto& path : sprites) {
    SCOPED_TRACE(path.string());
    const auto image = ReadImage(path);
    ASSERT_TRUE(image) << image.error().message;
    const auto outline = TraceOutline(*image);
    ASSERT_TRUE(outline) << outline.error().message;
    EXPECT_TRUE(IsSimple(outline->outer));
    EXPECT_GT(SignedArea(outline->outer), 0.0);
    EXPECT_LT(outline->outer.rows(), 512);
    for (int y = 0; y < image->height; ++y) {
      for (int x = 0; x < image->width; ++x) {
        if (image->at(x, y)[3] < 128) continue;
        ASSERT_EQ(Locate({x + 0.5, y + 0.5}, outline->outer), 1) << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace posespace
