// SPDX-License-Identifier: Apache-2.0
#include "drawing/colour_space.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace posespace {
namespace {

// Fine enough for the dark end, where 8-bit steps are 1/3295 of linear light apart.
constexpr int kSteps = 1 << 16;

double Decode(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double Encode(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

const std::array<float, 256> kLinear = [] {
  std::array<float, 256> table;
  for (int k = 0; k < 256; ++k) table[k] = static_cast<float>(Decode(k / 255.0));
  return table;
}();

const std::array<std::uint8_t, kSteps + 1> kSrgb = [] {
  std::array<std::uint8_t, kSteps + 1> table;
  for (int k = 0; k <= kSteps; ++k) {
    table[k] =
        static_cast<std::uint8_t>(std::lround(255.0 * Encode(static_cast<double>(k) / kSteps)));
  }
  return table;
}();

}  // namespace

float LinearFromSrgb(std::uint8_t value) { return kLinear[value]; }

std::uint8_t SrgbFromLinear(float light) {
  return kSrgb[static_cast<int>(std::clamp(light, 0.0f, 1.0f) * kSteps + 0.5f)];
}

}  // namespace posespace
