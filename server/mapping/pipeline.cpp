// SPDX-License-Identifier: Apache-2.0
#include "mapping/pipeline.h"

#include <chrono>

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

  auto triangulated = [&] {
    const Stage stage(report, progress, "triangulation", 0.5, 0.8);
    return TriangulateCompatibly(simplified->outlines, simplified->landmark_rows,
                                 options.triangulation, progress);
  }();
  if (!triangulated) return std::move(triangulated).error();

  auto improved = [&] {
    const Stage stage(report, progress, "improvement", 0.8, 1.0);
    return ImproveMesh(std::move(triangulated->mesh), options.improvement, progress);
  }();
  if (!improved) return std::move(improved).error();

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
  return result;
}

}  // namespace posespace
