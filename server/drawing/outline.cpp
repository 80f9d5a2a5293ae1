// SPDX-License-Identifier: Apache-2.0
#include "drawing/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "drawing/detached_parts.h"
#include "drawing/outline_colours.h"
#include "drawing/pixel_placement.h"
#include "drawing/raster_ring.h"
#include "drawing/with_opencv.h"
#include "drawing/working_picture.h"
#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr std::int64_t kMinPaintedPixels = 16;
constexpr int kMinWorkingSize = 64, kMaxWorkingSize = 4096;
constexpr double kSmallestPartShare = 0.004;   // of the painted area: smaller parts are dropped
constexpr double kSmallestHoleShare = 0.0005;  // of the painted area: smaller holes go unmentioned
constexpr int kSmallestHolePixels = 4;         // working pixels
constexpr int kBridgeWidth = 5;                // working pixels, before widening
constexpr double kLongestEdge = 1.0 / 32.0;    // of the working size: colours change within it
constexpr double kColourDepth = 3.0;           // working pixels inside the outline
constexpr std::size_t kPartsNamed = 3;         // dropped parts that get a warning of their own

// Every pixel within this disc of 21 becomes painted.  Rings run at least 2.47 working pixels from
// each painted pixel's centre then; half a pixel's diagonal (a source pixel's centre against its
// working pixel's) and a simplification by 1 leave more than half a pixel of enclosure.
cv::Mat1b WideningDisc() {
  cv::Mat1b disc = cv::Mat1b::ones(5, 5);
  disc(0, 0) = disc(0, 4) = disc(4, 0) = disc(4, 4) = 0;
  return disc;
}
constexpr double kSimplifications[] = {1.0, 0.5, 0.25, 0.0};  // tolerances, coarsest that is simple

std::string Counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// What of the picture's own pixels lies in one part of the working mask.
struct Part {
  std::int64_t painted = 0;
  int left = std::numeric_limits<int>::max(), top = std::numeric_limits<int>::max();
  int right = -1, bottom = -1;
};

std::vector<Part> MeasureParts(const cv::Mat1i& part_of, int parts, const Image& image,
                               int threshold, const WorkingFrame& frame) {
  std::vector<Part> measured(parts);
  const PaintedBox& box = frame.box();
  for (int y = box.top; y < box.top + box.height; ++y) {
    const int* row = part_of[frame.row(y)];
    for (int x = box.left; x < box.left + box.width; ++x) {
      if (image.at(x, y)[3] < threshold) continue;
      Part& part = measured[row[frame.column(x)]];
      ++part.painted;
      part.left = std::min(part.left, x);
      part.right = std::max(part.right, x);
      part.top = std::min(part.top, y);
      part.bottom = std::max(part.bottom, y);
    }
  }
  return measured;
}

void WarnOfDroppedParts(std::vector<Part> dropped, const PixelPlacement& placement,
                        std::vector<std::string>* warnings) {
  std::erase_if(dropped, [](const Part& part) { return part.painted == 0; });
  std::sort(dropped.begin(), dropped.end(), [](const Part& a, const Part& b) {
    return std::tuple(-a.painted, a.top, a.left) < std::tuple(-b.painted, b.top, b.left);
  });
  for (std::size_t k = 0; k < std::min(kPartsNamed, dropped.size()); ++k) {
    const Part& part = dropped[k];
    warnings->push_back("a detached part of " +
                        placement.SizeText(part.right - part.left + 1, part.bottom - part.top + 1) +
                        " pixels at " + placement.PlaceText(part.left, part.top) + " was left out");
  }
  if (dropped.size() > kPartsNamed) {
    warnings->push_back(Counted(dropped.size() - kPartsNamed, "more, smaller detached part was",
                                "more, smaller detached parts were") +
                        " left out");
  }
}

// The first pixel, in reading order, of the region with this label.
cv::Point FirstPixel(const cv::Mat1i& labels, const cv::Mat1i& stats, int label) {
  const int top = stats(label, cv::CC_STAT_TOP);
  int x = stats(label, cv::CC_STAT_LEFT);
  while (labels(top, x) != label) ++x;
  return {x, top};
}

// A traced ring with as few rows as keep it simple, in working and in drawing pixels.
struct TracedRing {
  Points working, drawing;
};

Result<TracedRing> Simplest(const Points& traced, double longest_edge, int max_points,
                            const WorkingFrame& frame) {
  for (const double tolerance : kSimplifications) {
    TracedRing ring;
    ring.working = DivideEdges(SimplifyRing(traced, tolerance), longest_edge);
    if (ring.working.rows() > max_points) {
      return Error{ErrorCode::kOutlineTooLong,
                   "the outline needs " + std::to_string(ring.working.rows()) +
                       " points; at most " + std::to_string(max_points) + " are accepted",
                   {}};
    }
    ring.drawing.resizeLike(ring.working);
    for (int k = 0; k < ring.working.rows(); ++k) {
      ring.drawing.row(k) = frame.ToDrawing(ring.working.row(k).transpose()).transpose();
    }
    if (IsSimple(ring.drawing)) return ring;
  }
  return Error{ErrorCode::kOutlineNotSimple, "the traced outline crosses itself", {}};
}

// Moves each row of a positive ring a little way to the inside.
Points JustInside(const Points& ring, double depth) {
  const auto n = ring.rows();
  Points inside = ring;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Point along = (ring.row((k + 1) % n) - ring.row((k + n - 1) % n)).transpose();
    if (along.norm() > 0.0) {
      inside.row(k) += depth / along.norm() * Point(-along.y(), along.x()).transpose();
    }
  }
  return inside;
}

// Rings around the unpainted regions inside the body, negatively oriented.
Result<std::vector<Points>> HoleRings(const cv::Mat1b& painted, const cv::Mat1i& part_of, int body,
                                      const OutlineOptions& options, const WorkingFrame& frame) {
  cv::Mat1i labels, stats;
  cv::Mat1d centroids;
  const cv::Mat1b unpainted = painted == 0;
  const int regions = cv::connectedComponentsWithStats(unpainted, labels, stats, centroids, 4);
  const int outside = labels(0, 0);
  const double smallest =
      std::max<double>(kSmallestHolePixels, kSmallestHoleShare * cv::countNonZero(painted));
  std::vector<Points> holes;
  for (int region = 1; region < regions; ++region) {
    if (region == outside || stats(region, cv::CC_STAT_AREA) < smallest) continue;
    const cv::Point first = FirstPixel(labels, stats, region);
    if (part_of(first - cv::Point(0, 1)) != body) continue;  // a hole of a dropped part
    const Points traced = TraceRing(labels, first, Connectivity::kFour);
    const TracedRing ring =
        TRY(Simplest(traced, std::numeric_limits<double>::max(), options.max_points, frame));
    holes.push_back(ring.drawing.colwise().reverse());
  }
  return holes;
}

Result<Outline> Trace(const Image& image, const PixelPlacement& placement,
                      const OutlineOptions& options) {
  const PaintedBox box = FindPainted(image, options.threshold);
  const auto too_small = [](std::int64_t painted) {
    return Error{ErrorCode::kOutlineTooSmall,
                 "the drawing has only " + Counted(painted, "painted pixel", "painted pixels") +
                     " in one piece; at least " + std::to_string(kMinPaintedPixels) + " are needed",
                 {}};
  };
  if (box.painted == 0) {
    return Error{ErrorCode::kOutlineEmpty,
                 "nothing is painted: no pixel of the " + std::to_string(image.width) + " x " +
                     std::to_string(image.height) + " picture has an alpha of at least " +
                     std::to_string(options.threshold),
                 {}};
  }
  if (box.painted < kMinPaintedPixels) return too_small(box.painted);

  // One body: parts of some size are joined, all is widened, what still stands apart is dropped.
  Outline outline;
  const WorkingFrame frame(box, options.working_size);
  const cv::Mat1b painted = frame.Paint(image, options.threshold);
  cv::Mat1b joined = painted.clone();
  const JoinedParts parts = JoinParts(joined, kSmallestPartShare, kBridgeWidth);
  cv::dilate(joined, joined, WideningDisc());
  cv::Mat1i part_of, stats;
  cv::Mat1d centroids;
  const int num_parts = cv::connectedComponentsWithStats(joined, part_of, stats, centroids, 8);
  const int body = part_of(parts.body);
  std::vector<Part> measured = MeasureParts(part_of, num_parts, image, options.threshold, frame);
  if (measured[body].painted < kMinPaintedPixels) return too_small(measured[body].painted);

  // Its outer ring; what it surrounds is filled by leaving it out.
  const Points traced = TraceRing(part_of, FirstPixel(part_of, stats, body), Connectivity::kEight);
  TracedRing ring =
      TRY(Simplest(traced, kLongestEdge * options.working_size, options.max_points, frame));
  outline.colours =
      ColoursAt(JustInside(ring.working, kColourDepth), image, options.threshold, frame);
  outline.outer = std::move(ring.drawing);
  outline.holes = TRY(HoleRings(painted, part_of, body, options, frame));
  outline.holes_filled = static_cast<int>(outline.holes.size());

  if (box.painted == static_cast<std::int64_t>(image.width) * image.height) {
    outline.warnings.push_back("every pixel is opaque: the whole picture was taken as the drawing");
  }
  if (parts.bridges > 0) {
    outline.warnings.push_back(Counted(parts.bridges, "detached part was", "detached parts were") +
                               " joined to the body by " +
                               (parts.bridges == 1 ? "a thin bridge" : "thin bridges"));
  }
  if (outline.holes_filled > 0) {
    outline.warnings.push_back(Counted(outline.holes_filled,
                                       "hole was filled; its transparency is kept",
                                       "holes were filled; their transparency is kept"));
  }
  measured[0].painted = measured[body].painted = 0;  // neither the background nor the body
  WarnOfDroppedParts(std::move(measured), placement, &outline.warnings);
  outline.outer = placement.ToDrawing(std::move(outline.outer));
  for (Points& hole : outline.holes) hole = placement.ToDrawing(std::move(hole));
  return outline;
}

Error OutOfRange(const std::string& field, int value, int low, int high) {
  const std::string message = field + " is " + std::to_string(value) + "; it must lie in " +
                              std::to_string(low) + " .. " + std::to_string(high);
  return Error{ErrorCode::kInvalidOption, message, {{field, message}}};
}

Result<Outline> CheckedTrace(const Image& image, const PixelPlacement& placement,
                             const OutlineOptions& options) {
  TRY(CheckThreshold(options.threshold));
  if (options.working_size < kMinWorkingSize || options.working_size > kMaxWorkingSize) {
    return OutOfRange("working_size", options.working_size, kMinWorkingSize, kMaxWorkingSize);
  }
  return WithOpenCv([&] { return Trace(image, placement, options); });
}

}  // namespace

Result<void> CheckThreshold(int threshold) {
  if (threshold >= 1 && threshold <= 255) return {};
  return OutOfRange("threshold", threshold, 1, 255);
}

Result<Outline> TraceOutline(const Image& image, const OutlineOptions& options) {
  return CheckedTrace(image, {}, options);
}

Result<Outline> TraceOutline(const Texture& texture, const OutlineOptions& options) {
  return CheckedTrace(texture.image, {texture.origin, texture.scale}, options);
}

}  // namespace posespace
