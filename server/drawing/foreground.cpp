// SPDX-License-Identifier: Apache-2.0
#include "drawing/foreground.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "drawing/frame_colour.h"
#include "drawing/outline.h"
#include "drawing/paper.h"
#include "drawing/soft_edge.h"

namespace posespace {
namespace {

constexpr int kDefaultAlpha = 128;
constexpr int kPainted = 128;         // alpha of what reaches the user's threshold, at least
constexpr int kLeastRange = 16;       // of brightness: less is noise on an empty page
constexpr double kPlainShare = 0.6;   // of the frame: less is not a plain background
constexpr double kNoiseShare = 0.95;  // of the plain frame lies within the noise

int Luma(const std::uint8_t* pixel) {
  return (299 * pixel[0] + 587 * pixel[1] + 114 * pixel[2] + 500) / 1000;
}

// Lays a picture with transparency onto a page of one brightness.
void Flatten(int page, Image* image) {
  for (std::size_t k = 0; k < image->rgba.size(); k += 4) {
    std::uint8_t* pixel = image->rgba.data() + k;
    const int alpha = pixel[3];
    for (int c = 0; c < 3; ++c) {
      pixel[c] = static_cast<std::uint8_t>((pixel[c] * alpha + page * (255 - alpha) + 127) / 255);
    }
    pixel[3] = 255;
  }
}

// How far each pixel is on the drawing's side of the background, in brightness.
cv::Mat1b BrightnessDistance(const Image& image, int background, bool drawing_is_light) {
  cv::Mat1b distance(image.height, image.width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int lighter = Luma(image.at(x, y)) - background;
      distance(y, x) =
          static_cast<std::uint8_t>(std::max(0, drawing_is_light ? lighter : -lighter));
    }
  }
  return distance;
}

// The distance that most of the frame's background stays within.
int NoiseOf(const Image& image, const cv::Mat1b& distance, int threshold) {
  std::vector<int> distances;
  ForFrame(image, [&](int x, int y) {
    if (distance(y, x) < threshold) distances.push_back(distance(y, x));
  });
  if (distances.empty()) return 0;
  const auto at = distances.begin() + static_cast<std::ptrdiff_t>(
                                          kNoiseShare * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return std::min(*at, threshold / 2);
}

Result<Cutout> CutOutByBrightness(Texture texture, const ForegroundOptions& options) {
  const bool is_light = options.foreground == Foreground::kLight;
  const std::string lighter = is_light ? "lighter" : "darker";
  Image& image = texture.image;
  Flatten(is_light ? 0 : 255, &image);
  const FrameColour frame = FindFrameColour(image);
  const int background = Luma(frame.colour.data());
  Background plain{frame.colour, BrightnessDistance(image, background, is_light), {}, 0};
  double range = 0.0;
  cv::minMaxLoc(plain.distance, nullptr, &range);
  const int threshold = options.threshold.value_or(static_cast<int>(std::ceil(0.5 * range)));
  if (range < kLeastRange || range < threshold) {
    return Error{ErrorCode::kOutlineEmpty,
                 "nothing is " + lighter + " than the background, of brightness " +
                     std::to_string(background) + " of 255, by " +
                     std::to_string(std::max(threshold, kLeastRange)) + ": the most is " +
                     std::to_string(static_cast<int>(range)),
                 {}};
  }
  plain.painted = plain.distance >= threshold;
  plain.noise = NoiseOf(image, plain.distance, threshold);
  FadeBackground(plain, &image);
  for (int y = 0; y < image.height; ++y) {  // the user's threshold decides, whatever the mix
    for (int x = 0; x < image.width; ++x) {
      std::uint8_t& alpha = image.at(x, y)[3];
      alpha = plain.painted(y, x) != 0 ? std::max<std::uint8_t>(alpha, kPainted)
                                       : std::min<std::uint8_t>(alpha, kPainted - 1);
    }
  }

  Cutout cutout{std::move(texture), kPainted, {}};
  cutout.warnings.push_back("what is " + lighter + " than the background, of colour " +
                            ColourText(frame.colour) + ", by at least " +
                            std::to_string(threshold) +
                            " of 255 was taken as the drawing, the rest "
                            "made transparent");
  if (frame.share < kPlainShare) {
    cutout.warnings.push_back("the background is not plain: only " +
                              std::to_string(static_cast<int>(100.0 * frame.share)) +
                              " % of the picture's frame have its colour");
  }
  return cutout;
}

}  // namespace

Result<Cutout> CutOut(Texture texture, const ForegroundOptions& options) {
  TRY(CheckThreshold(options.threshold.value_or(kDefaultAlpha)));
  if (texture.image.rgba.empty()) return Cutout{std::move(texture), kDefaultAlpha, {}};
  try {
    if (options.foreground != Foreground::kAlpha) {
      return CutOutByBrightness(std::move(texture), options);
    }
    Cutout cutout{std::move(texture), options.threshold.value_or(kDefaultAlpha), {}};
    cutout.warnings = RemovePaper(&cutout.texture, cutout.threshold);
    return cutout;
  } catch (const cv::Exception& exception) {
    return Error{ErrorCode::kInternal, std::string("OpenCV: ") + exception.what(), {}};
  }
}

}  // namespace posespace
