// SPDX-License-Identifier: Apache-2.0
#include "drawing/paper.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "drawing/frame_colour.h"
#include "drawing/pixel_placement.h"
#include "drawing/soft_edge.h"
#include "drawing/working_picture.h"

namespace posespace {
namespace {

constexpr double kOpaqueShare = 0.98;   // of the box around what is painted
constexpr double kPageShare = 0.9;      // of the picture, that this box is
constexpr double kFrameShare = 0.6;     // of its frame, that has one colour
constexpr double kSmallestKept = 1e-3;  // of the drawing: smaller enclosed paper goes unmentioned

// Marks in the map of a picture's pixels.
constexpr std::uint8_t kDrawing = 0, kPaperColoured = 1, kPaper = 2, kEnclosed = 3;

// The part of a picture in a box.
Image Crop(const Image& image, const PaintedBox& box) {
  Image crop{box.width, box.height, {}};
  crop.rgba.reserve(4 * static_cast<std::size_t>(box.width) * box.height);
  for (int y = box.top; y < box.top + box.height; ++y) {
    crop.rgba.insert(crop.rgba.end(), image.at(box.left, y), image.at(box.left, y) + 4 * box.width);
  }
  return crop;
}

// Where the paper is: what has its colour and hangs together with the frame.
cv::Mat1b FloodFromFrame(const Image& page, const Rgb& paper, int threshold) {
  cv::Mat1b marks(page.height, page.width);
  for (int y = 0; y < page.height; ++y) {
    for (int x = 0; x < page.width; ++x) {
      const std::uint8_t* pixel = page.at(x, y);
      const bool same = pixel[3] < threshold || ColourDistance(pixel, paper.data()) <= kSameColour;
      marks(y, x) = same ? kPaperColoured : kDrawing;
    }
  }
  ForFrame(page, [&](int x, int y) {
    if (marks(y, x) == kPaperColoured) cv::floodFill(marks, cv::Point(x, y), kPaper);
  });
  return marks;
}

// Says which regions of the paper's colour were kept, if any.
std::vector<std::string> EnclosedPaper(cv::Mat1b& marks, const PaintedBox& page,
                                       const PixelPlacement& placement) {
  const double smallest = kSmallestKept * cv::countNonZero(marks != kPaper);
  int kept = 0, largest = 0;
  cv::Rect box;
  for (int y = 0; y < marks.rows; ++y) {
    for (int x = 0; x < marks.cols; ++x) {
      if (marks(y, x) != kPaperColoured) continue;
      cv::Rect region;
      const int area = cv::floodFill(marks, cv::Point(x, y), kEnclosed, &region);
      if (area < smallest) continue;
      ++kept;
      if (area <= largest) continue;
      largest = area;
      box = region;
    }
  }
  if (kept == 0) return {};
  const std::string where = placement.SizeText(box.width, box.height) + " pixels at " +
                            placement.PlaceText(page.left + box.x, page.top + box.y);
  return {(kept == 1 ? "1 region of the paper's colour inside the drawing, " + where + ", was"
                     : std::to_string(kept) +
                           " regions of the paper's colour inside the drawing, the largest " +
                           where + ", were") +
          " kept as part of it; with foreground light or dark they would become transparent"};
}

}  // namespace

std::vector<std::string> RemovePaper(Texture* texture, int threshold) {
  const PaintedBox box = FindPainted(texture->image, threshold);
  const double picture = static_cast<double>(texture->image.width) * texture->image.height;
  const double boxed = static_cast<double>(box.width) * box.height;
  if (box.painted == 0 || boxed < kPageShare * picture) return {};
  if (static_cast<double>(box.painted) < kOpaqueShare * boxed) return {};
  Image page = Crop(texture->image, box);
  const FrameColour frame = FindFrameColour(page);
  if (frame.share < kFrameShare) return {};

  cv::Mat1b marks = FloodFromFrame(page, frame.colour, threshold);
  Background background{frame.colour, cv::Mat1b(marks.size()), marks != kPaper, 0};
  if (cv::countNonZero(background.painted) == 0) return {};
  for (int y = 0; y < page.height; ++y) {
    for (int x = 0; x < page.width; ++x) {
      background.distance(y, x) =
          static_cast<std::uint8_t>(ColourDistance(page.at(x, y), frame.colour.data()));
    }
  }
  FadeBackground(background, &page);

  for (int y = 0; y < page.height; ++y) {
    std::copy(page.at(0, y), page.at(0, y) + 4 * page.width,
              texture->image.at(box.left, box.top + y));
  }
  std::vector<std::string> warnings = {"the picture is opaque all over: its paper, of colour " +
                                       ColourText(frame.colour) +
                                       ", was made transparent from the edges inwards"};
  const PixelPlacement placement{texture->origin, texture->scale};
  for (std::string& kept : EnclosedPaper(marks, box, placement)) {
    warnings.push_back(std::move(kept));
  }
  return warnings;
}

}  // namespace posespace
