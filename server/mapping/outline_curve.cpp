// SPDX-License-Identifier: Apache-2.0
#include "mapping/outline_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr std::array kWindows = {1.0 / 64, 1.0 / 32, 1.0 / 16, 1.0 / 8};  // turns
// The spread of a ring's area: the radius of gyration about the centroid, times sqrt(2 pi), which
// makes it the square root of the area for a disc and more for anything else.  Unlike that root it
// is alike for a thin letter and a bold one.
double SpreadOf(const Points& ring, const Point& centroid) {
  double moment = 0.0;
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    const Point p = ring.row(k).transpose() - centroid;
    const Point q = ring.row((k + 1) % ring.rows()).transpose() - centroid;
    const double cross = p.x() * q.y() - p.y() * q.x();
    moment += cross * (p.squaredNorm() + p.dot(q) + q.squaredNorm()) / 12.0;
  }
  return std::sqrt(2.0 * std::numbers::pi * moment / SignedArea(ring));
}

constexpr int kThicknessSamples = 512;
constexpr double kDirectionReach = 0.004;  // turns either side, for the direction of the outline
constexpr double kInwardSpread = 0.35;     // radians either side of straight inward
constexpr double kLeastThickness = 0.004;  // of the perimeter
constexpr double kMostThickness = 0.12;

constexpr double kCornerReach = 1e-6;  // turns within which a nearest point is the corner itself

}  // namespace

OutlineCurve::OutlineCurve(const Points& outline, const Eigen::MatrixXd& colours)
    : outline_(outline),
      colours_(colours.rows() == outline.rows() ? colours : Eigen::MatrixXd()),
      perimeter_(Perimeter(outline)),
      size_(std::sqrt(SignedArea(outline))),
      centroid_(AreaCentroid(outline)),
      spread_(SpreadOf(outline, centroid_)) {
  positions_.reserve(outline.rows());
  double length = 0.0;
  for (Eigen::Index k = 0; k < outline.rows(); ++k) {
    positions_.push_back(length / perimeter_);
    length += (outline.row((k + 1) % outline.rows()) - outline.row(k)).norm();
  }
}

OutlineCurve::Place OutlineCurve::Find(double position) const {
  position -= std::floor(position);
  const auto after = std::upper_bound(positions_.begin(), positions_.end(), position);
  const int edge = static_cast<int>(after - positions_.begin()) - 1;
  const double begin = positions_[edge], end = after == positions_.end() ? 1.0 : *after;
  return {edge, std::clamp((position - begin) / (end - begin), 0.0, 1.0)};
}

Point OutlineCurve::At(double position) const {
  const auto [edge, fraction] = Find(position);
  const int next = (edge + 1) % num_corners();
  return corner(edge) + fraction * (corner(next) - corner(edge));
}

OutlineCurve::Nearest OutlineCurve::NearestTo(const Point& p) const {
  double least = std::numeric_limits<double>::infinity();
  Place place{0, 0.0};
  for (int edge = 0; edge < num_corners(); ++edge) {
    const Point a = corner(edge), along = corner((edge + 1) % num_corners()) - a;
    const double fraction = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (p - a - fraction * along).norm();
    if (distance < least) {
      least = distance;
      place = {edge, fraction};
    }
  }
  const int next = (place.edge + 1) % num_corners();
  const double begin = positions_[place.edge], end = next == 0 ? 1.0 : positions_[next];
  const double position = begin + place.fraction * (end - begin);
  if (position - begin < kCornerReach) return {begin, corner(place.edge), least};
  if (end - position < kCornerReach) return {positions_[next], corner(next), least};
  return {position, corner(place.edge) + place.fraction * (corner(next) - corner(place.edge)),
          least};
}

Eigen::MatrixXd OutlineCurve::Features(const std::vector<double>& positions,
                                       double position_weight) const {
  Eigen::MatrixXd features(positions.size(), 2 * kWindows.size() + 2);
  const double share = 1.0 / std::sqrt(2.0 * kWindows.size());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const Point here = At(positions[k]);
    for (std::size_t w = 0; w < kWindows.size(); ++w) {
      const Point before = At(positions[k] - kWindows[w]), after = At(positions[k] + kWindows[w]);
      const Point a = here - before, b = after - here;
      const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) / std::numbers::pi;
      const double chord = (after - before).norm() / (2.0 * kWindows[w] * perimeter_) - 1.0;
      features(k, 2 * w) = share * turn;
      features(k, 2 * w + 1) = share * chord;
    }
    features.row(k).tail<2>() = std::sqrt(position_weight) * (here - centroid_) / spread_;
  }
  return features;
}

double OutlineCurve::WayThrough(const Point& from, const Point& direction) const {
  const auto side = [&](const Point& p) {
    return direction.x() * (p.y() - from.y()) - direction.y() * (p.x() - from.x());
  };
  const double least = kLeastThickness * perimeter_;  // what is nearer is the outline left behind
  double way = kMostThickness * perimeter_;
  Point begin = corner(num_corners() - 1);
  double begin_side = side(begin);
  for (int k = 0; k < num_corners(); ++k) {
    const Point end = corner(k);
    const double end_side = side(end);
    if ((begin_side > 0.0) != (end_side > 0.0)) {
      const Point hit = begin + begin_side / (begin_side - end_side) * (end - begin);
      const double along = direction.dot(hit - from);
      if (along > least) way = std::min(way, along);
    }
    begin = end;
    begin_side = end_side;
  }
  return way;
}

void OutlineCurve::MeasureThickness() {
  log_thickness_.assign(kThicknessSamples, 0.0);
  for (int k = 0; k < kThicknessSamples; ++k) {
    const double position = static_cast<double>(k) / kThicknessSamples;
    const Point along = At(position + kDirectionReach) - At(position - kDirectionReach);
    const double inward = std::atan2(along.x(), -along.y());
    for (const double angle : {inward - kInwardSpread, inward, inward + kInwardSpread}) {
      const Point direction(std::cos(angle), std::sin(angle));
      log_thickness_[k] += std::log(WayThrough(At(position), direction) / perimeter_) / 3.0;
    }
  }
  const double mean =
      std::accumulate(log_thickness_.begin(), log_thickness_.end(), 0.0) / kThicknessSamples;
  for (double& thickness : log_thickness_) thickness -= mean;
}

Eigen::VectorXd OutlineCurve::LogThickness(const std::vector<double>& positions) const {
  Eigen::VectorXd thickness(static_cast<Eigen::Index>(positions.size()));
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const double sample = (positions[k] - std::floor(positions[k])) * kThicknessSamples;
    const int before = static_cast<int>(sample) % kThicknessSamples;
    const double share = sample - std::floor(sample);
    thickness[static_cast<Eigen::Index>(k)] =
        (1.0 - share) * log_thickness_[before] +
        share * log_thickness_[(before + 1) % kThicknessSamples];
  }
  return thickness;
}

Eigen::MatrixXd OutlineCurve::Colours(const std::vector<double>& positions) const {
  Eigen::MatrixXd colours(positions.size(), 3);
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const auto [edge, fraction] = Find(positions[k]);
    const int next = (edge + 1) % num_corners();
    colours.row(k) = (1.0 - fraction) * colours_.row(edge) + fraction * colours_.row(next);
  }
  return colours;
}

OutlineCurve OutlineCurve::Mirrored() const {
  Points outline = outline_.colwise().reverse();
  outline.col(0) *= -1.0;
  OutlineCurve mirrored(outline, colours_.colwise().reverse());
  if (!log_thickness_.empty()) mirrored.MeasureThickness();
  return mirrored;
}

OutlineMap MapBetween(const OutlineCurve& a, const OutlineCurve& b) {
  std::vector<double> from, to;
  for (int k = 0; k < a.num_corners(); ++k) {
    from.push_back(a.corner_position(k));
    to.push_back(b.corner_position(k));
  }
  from.push_back(1.0);
  to.push_back(1.0);
  return {std::move(from), std::move(to)};
}

}  // namespace posespace
