// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "drawing/alignment.h"

namespace posespace {

int AlignmentSize(int num_drawings) {
  constexpr double kSize = 512.0, kDrawings = 8.0;
  const double share = std::min(1.0, kDrawings / std::max(1, num_drawings));
  return static_cast<int>(kSize * std::sqrt(share));
}

ReducedTexture Reduce(const Texture& texture, int size) {
  const Image& image = texture.image;
  const int block = std::max(1, (std::max(image.width, image.height) + size - 1) / size);
  ReducedTexture reduced;
  reduced.width = (image.width + block - 1) / block;
  reduced.height = (image.height + block - 1) / block;
  reduced.origin = texture.origin;
  reduced.scale = texture.scale / block;
  reduced.rgba.assign(4 * static_cast<std::size_t>(reduced.width) * reduced.height, 0.0f);
  const float share = 1.0f / (255.0f * static_cast<float>(block) * static_cast<float>(block));
  const std::uint8_t* painted = nullptr;
  for (int y = 0; y < image.height; ++y) {
    float* const row = &reduced.rgba[4 * static_cast<std::size_t>(y / block) * reduced.width];
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* const pixel = image.at(x, y);
      if (pixel[3] == 0) continue;
      if (painted == nullptr) painted = pixel;
      reduced.plain = reduced.plain && std::equal(pixel, pixel + 3, painted);
      const float alpha = share * static_cast<float>(pixel[3]);
      float* const texel = row + 4 * (x / block);
      for (int c = 0; c < 3; ++c) texel[c] += alpha * static_cast<float>(pixel[c]) / 255.0f;
      texel[3] += alpha;
    }
  }
  return reduced;
}

}  // namespace posespace
