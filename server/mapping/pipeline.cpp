// SPDX-License-Identifier: Apache-2.0
#include "mapping/pipeline.h"

#include <algorithm>
#include <chrono>
#include <numeric>

#include "geometry/polygon.h"

namespace posespace {
namespace {

// Names the stage to the progress and its duration to the report.
class Stage {
 public:
  Stage(MappingReport& report, Progress* progress, const char* name, double begin, double end)
      : report_(report), name_(name) {
    if (progress != nullptr) progress->EnterStage(name, begin, end);
  }
  ~Stage() {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    report_.seconds.emplace_back(name_, spent.count());
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

 private:
  MappingReport& report_;
  const char* name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// The outlines' indices in an order that does not depend on the caller's: by their coordinates.
std::vector<int> OrderByContent(std::span<const Points> outlines) {
  std::vector<int> order(outlines.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) {
    return std::ranges::lexicographical_compare(outlines[i].reshaped(), outlines[j].reshaped());
  });
  return order;
}

}  // namespace

Result<Mapping> MapShapes(std::span<const MatchingShape> shapes,
                          std::span<const Landmark> landmarks, const MappingOptions& options,
                          Progress* progress) {
  Mapping result;
  MappingReport& report = result.report;

  auto matched = [&] {
    const Stage stage(report, progress, "matching", 0.0, 0.4);
    return MatchBoundaries(shapes, landmarks, options.matching, progress);
  }();
  if (!matched) return std::move(matched).error();

  auto simplified = [&] {
    const Stage stage(report, progress, "simplification", 0.4, 0.5);
    return SimplifyBoundaries(matched->outlines, matched->landmark_rows, options.simplification,
                              progress);
  }();
  if (!simplified) return std::move(simplified).error();

  // Triangulation lays one drawing over the others: the mesh must not depend on who came first.
  const std::vector<int> order = OrderByContent(simplified->outlines);
  std::vector<Points> ordered(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) ordered[k] = simplified->outlines[order[k]];

  auto triangulated = [&] {
    const Stage stage(report, progress, "triangulation", 0.5, 0.8);
    return TriangulateCompatibly(ordered, simplified->landmark_rows, options.triangulation,
                                 progress);
  }();
  if (!triangulated) return std::move(triangulated).error();

  auto improved = [&] {
    const Stage stage(report, progress, "improvement", 0.8, 1.0);
    return ImproveMesh(std::move(triangulated->mesh), options.improvement, progress);
  }();
  if (!improved) return std::move(improved).error();
  for (std::size_t k = 0; k < order.size(); ++k) ordered[order[k]] = std::move(improved->poses[k]);
  improved->poses = std::move(ordered);

  if (const auto defect = FindDefect(*improved)) {
    return Error{ErrorCode::kInternal,
                 "the finished mesh folds over in shape '" + shapes[defect->pose].name + "'",
                 {}};
  }
  result.mesh = std::move(*improved);
  report.outline_vertices = static_cast<int>(simplified->outlines[0].rows());
  report.steiner_vertices = triangulated->steiner_vertices;
  report.levels = triangulated->levels;
  report.min_angle = MinAngle(result.mesh);
  report.confidence = std::move(matched->confidence);
  result.proposal = std::move(matched->proposal);
  result.mismatch = matched->mismatch;
  result.missed_corners = matched->missed_corners;
  return result;
}

}  // namespace posespace
