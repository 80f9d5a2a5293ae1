// SPDX-License-Identifier: Apache-2.0
#include "drawing/frame_colour.h"

#include <array>
#include <cstdint>
#include <map>

namespace posespace {
namespace {

constexpr int kLevelsPerBin = 16;

}  // namespace

FrameColour FindFrameColour(const Image& image) {
  // The fullest bin of colours, then the mean of what lies around its own mean.
  struct Bin {
    std::array<std::int64_t, 3> sum{};
    std::int64_t count = 0;
    void Add(const std::uint8_t* pixel) {
      for (int c = 0; c < 3; ++c) sum[c] += pixel[c];
      ++count;
    }
    Rgb Mean() const {
      Rgb mean;
      for (int c = 0; c < 3; ++c) mean[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
      return mean;
    }
  };
  std::map<std::array<int, 3>, Bin> bins;
  std::int64_t frame = 0;
  ForFrame(image, [&](int x, int y) {
    const std::uint8_t* p = image.at(x, y);
    bins[{p[0] / kLevelsPerBin, p[1] / kLevelsPerBin, p[2] / kLevelsPerBin}].Add(p);
    ++frame;
  });
  if (frame == 0) return {};
  const auto fuller = [](const auto& a, const auto& b) { return a.second.count < b.second.count; };
  const Rgb centre = std::max_element(bins.begin(), bins.end(), fuller)->second.Mean();
  Bin around;
  ForFrame(image, [&](int x, int y) {
    if (ColourDistance(image.at(x, y), centre.data()) <= kSameColour) around.Add(image.at(x, y));
  });
  return {around.Mean(), static_cast<double>(around.count) / static_cast<double>(frame)};
}

std::string ColourText(const Rgb& colour) {
  return "(" + std::to_string(colour[0]) + ", " + std::to_string(colour[1]) + ", " +
         std::to_string(colour[2]) + ")";
}

}  // namespace posespace
