// SPDX-License-Identifier: Apache-2.0
#include "session/build_warnings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace posespace {
namespace {

// A drawing whose matching is less clear than this should be checked (MatchedOutlines::confidence).
constexpr double kLeastConfidence = 0.5;

// More Steiner vertices than this mostly come from wrong matches.
constexpr int kManySteinerVertices = 12;

// True when a person has said which part of drawing i is which: three marks leave little to find.
bool IsMarked(const BuildInputs& inputs, std::size_t i) {
  constexpr int kEnoughMarks = 3;
  return std::count_if(inputs.landmarks.begin(), inputs.landmarks.end(), [i](const Landmark& each) {
           return each.points[i].has_value();
         }) >= kEnoughMarks;
}

// Marked correspondences by their numbers, one or two of them.
std::string Named(const std::vector<int>& tuples) {
  return tuples.size() == 1
             ? "tuple " + std::to_string(tuples[0])
             : "tuples " + std::to_string(tuples[0]) + " and " + std::to_string(tuples[1]);
}

}  // namespace

std::vector<std::string> BuildWarnings(const Mapping& mapping, const BuildInputs& inputs) {
  const MappingReport& report = mapping.report;
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < report.confidence.size(); ++i) {
    if (mapping.proposal.flips[i]) {
      warnings.push_back("drawing '" + inputs.drawings[i]->id +
                         "' seems to face the other way: suggest() shows it; if it does, put it "
                         "again with flip");
      continue;
    }
    if (report.confidence[i] >= kLeastConfidence || IsMarked(inputs, i)) continue;
    warnings.push_back("please check shape '" + inputs.drawings[i]->id +
                       "': it is not clear which part of it is which part of the others; mark "
                       "correspondences");
  }
  if (const auto& mismatch = mapping.mismatch) {
    warnings.push_back(
        "much of drawings '" + inputs.drawings[mismatch->first]->id + "' and '" +
        inputs.drawings[mismatch->second]->id + "' (" +
        std::to_string(std::lround(100.0 * mismatch->share)) +
        " % of their outlines) has no counterpart in the other" +
        (mismatch->landmarks.empty() ? "" : ", most of it by " + Named(mismatch->landmarks)) +
        ": where limbs cross, leave one of these poses out" +
        (mismatch->landmarks.empty() ? "" : "; else check these marks"));
  }
  if (const auto& missed = mapping.missed_corners) {
    const auto place = [](const Point& point) {
      return "(" + std::to_string(std::lround(point.x())) + ", " +
             std::to_string(std::lround(point.y())) + ")";
    };
    warnings.push_back(std::to_string(missed->count) + " sharp corners of drawing '" +
                       inputs.drawings[missed->first]->id + "' lie beside those of '" +
                       inputs.drawings[missed->second]->id + "' and would be cut off in between: " +
                       "mark one in both, as " + place(missed->on_first) + " and " +
                       place(missed->on_second) + ", or check the marks near it");
  }
  for (std::size_t t = 0; t < inputs.landmarks.size(); ++t) {
    const auto& points = inputs.landmarks[t].points;
    if (points.size() < 2) continue;
    const auto marked = [](const auto& point) { return point.has_value(); };
    if (std::count_if(points.begin(), points.end(), marked) != 1) continue;
    const auto only = std::find_if(points.begin(), points.end(), marked) - points.begin();
    warnings.push_back(Named({static_cast<int>(t)}) + " marks only shape '" +
                       inputs.drawings[only]->id +
                       "': that makes its place a vertex, but does not say what corresponds to it");
  }
  if (report.steiner_vertices > kManySteinerVertices) {
    warnings.push_back("please check the matching: the drawings needed " +
                       std::to_string(report.steiner_vertices) +
                       " inner vertices to share one mesh, as wrongly matched drawings do");
  }
  return warnings;
}

}  // namespace posespace
