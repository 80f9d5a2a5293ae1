// SPDX-License-Identifier: Apache-2.0
#include "mapping/enclosing_ring.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr double kMidpointPull = 1e-3;  // keeps the optimum unique on straight runs
constexpr double kGapKept = 0.25;       // share of an old gap that a collapse must leave
constexpr double kGapLimit = 0.25;      // gaps wider than this, / tolerance, may narrow freely
constexpr double kFirstNudge = 1e-12, kLastNudge = 2e-8;  // / size of the drawing

double Angle(const Point& a, const Point& corner, const Point& b) {
  const Point u = a - corner, v = b - corner;
  return std::atan2(std::abs(u.x() * v.y() - u.y() * v.x()), u.dot(v));
}

Point NearestOnSegment(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double length2 = along.squaredNorm();
  if (length2 == 0.0) return a;
  return a + std::clamp((p - a).dot(along) / length2, 0.0, 1.0) * along;
}

double Distance(const Point& p, const Point& a, const Point& b) {
  return (p - NearestOnSegment(p, a, b)).norm();
}

// Between segments that do not cross.
double Distance(const Point& a, const Point& b, const Point& c, const Point& d) {
  return std::min({Distance(a, c, d), Distance(b, c, d), Distance(c, a, b), Distance(d, a, b)});
}

// Where the lines through (a, b) and (c, d) cross, if doubles can tell.
std::optional<Point> LinesCross(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u = b - a, v = d - c;
  const double cross = u.x() * v.y() - u.y() * v.x();
  const Point x = a + u * (((c - a).x() * v.y() - (c - a).y() * v.x()) / cross);
  if (!x.allFinite()) return std::nullopt;
  return x;
}

// True when segments (shared, b) and (shared, d) have more than their end in common.
bool Overlap(const Point& shared, const Point& b, const Point& d) {
  return IsOnSegment(b, shared, d) || IsOnSegment(d, shared, b);
}

}  // namespace

EnclosingRing::EnclosingRing(const Points& outline, double tolerance, double min_corner_angle)
    : original_(outline),
      area_(SignedArea(outline)),
      size_(std::sqrt(area_)),
      tolerance_(tolerance * size_),
      origin_(outline.row(0).transpose()),
      min_corner_angle_(min_corner_angle),
      grid_(outline) {
  const int n = static_cast<int>(outline.rows());
  vertices_.reserve(n);
  anchors_.reserve(n);
  quadrics_.resize(n);
  for (int v = 0; v < n; ++v) {
    vertices_.push_back(outline.row(v).transpose());
    anchors_.push_back({static_cast<double>(v), vertices_[v]});
  }
  for (int v = 0; v < n; ++v) {
    const int next = (v + 1) % n;
    const Point along = vertices_[next] - vertices_[v];
    const double length = along.norm();
    const Point normal = Point(along.y(), -along.x()) / length;
    const Eigen::Matrix2d a = length * normal * normal.transpose();
    const Point g = a * (vertices_[v] - origin_);
    for (const int end : {v, next}) {
      quadrics_[end].a += a;
      quadrics_[end].g += g;
    }
    grid_.Insert(v, vertices_[v], vertices_[next]);
  }
}

std::optional<EdgeCollapse> EnclosingRing::Plan(const EdgeContext& at, Freedom freedom) const {
  std::vector<Point> candidates;
  if (freedom == Freedom::kStayAtA) candidates = {vertices_[at.a]};
  if (freedom == Freedom::kStayAtB) candidates = {vertices_[at.b]};
  if (freedom == Freedom::kAnywhere) candidates = Candidates(at);

  const Point &p = vertices_[at.p], &a = vertices_[at.a], &b = vertices_[at.b],
              &q = vertices_[at.q];
  for (const Point& candidate : candidates) {
    Point x = candidate;
    if (freedom == Freedom::kAnywhere) {
      const auto pushed = PushedBeyondLines(at, candidate);
      if (!pushed) continue;
      x = *pushed;
    } else if (Orientation(p, a, x) > 0 || Orientation(a, b, x) > 0 || Orientation(b, q, x) > 0) {
      continue;
    }
    if (MakesSharpCorner(at, x)) continue;
    const Anchor anchor = NearestAnchor(x, anchors_[at.a], anchors_[at.b]);
    const double distance =
        std::max({(x - anchor.point).norm(), ChainDistance(anchors_[at.p], anchor, p, x),
                  ChainDistance(anchor, anchors_[at.q], x, q)});
    if (distance > tolerance_) continue;
    const double added = -0.5 * (Cross(p, a, x) + Cross(a, b, x) + Cross(b, q, x));
    return EdgeCollapse{x, std::max(added, 0.0), distance};
  }
  return std::nullopt;
}

// The free optimum of the summed quadrics, the optima on the three lines, the lines' crossings and
// the edge's own ends, best first.
std::vector<Point> EnclosingRing::Candidates(const EdgeContext& at) const {
  const std::array ends = {vertices_[at.p], vertices_[at.a], vertices_[at.b], vertices_[at.q]};
  Eigen::Matrix2d a = quadrics_[at.a].a + quadrics_[at.b].a;
  const Point middle = 0.5 * (ends[1] + ends[2]) - origin_;
  const double pull = kMidpointPull * a.trace();
  const Point g = quadrics_[at.a].g + quadrics_[at.b].g + pull * middle;
  a.diagonal().array() += pull;

  std::vector<Point> found = {ends[1], ends[2], origin_ + Point(a.inverse() * g)};
  for (int line = 0; line < 3; ++line) {
    const Point start = ends[line] - origin_, along = ends[line + 1] - ends[line];
    const double step = along.dot(g - a * start) / along.dot(a * along);
    found.push_back(origin_ + start + step * along);
    for (int other = line + 1; other < 3; ++other) {
      const auto crossing = LinesCross(ends[line], ends[line + 1], ends[other], ends[other + 1]);
      if (crossing) found.push_back(*crossing);
    }
  }
  std::erase_if(found, [](const Point& x) { return !x.allFinite(); });

  std::vector<std::pair<double, Point>> ranked;
  ranked.reserve(found.size());
  for (const Point& point : found) {
    const Point x = point - origin_;
    ranked.emplace_back(x.dot(a * x) - 2.0 * g.dot(x), point);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& left, const auto& right) { return left.first < right.first; });
  for (std::size_t k = 0; k < ranked.size(); ++k) found[k] = ranked[k].second;
  return found;
}

// A candidate on a line is beyond it only up to rounding: it is pushed outward by as little as the
// exact predicate accepts.
std::optional<Point> EnclosingRing::PushedBeyondLines(const EdgeContext& at, Point x) const {
  const std::array ends = {vertices_[at.p], vertices_[at.a], vertices_[at.b], vertices_[at.q]};
  for (double nudge = kFirstNudge; nudge < kLastNudge; nudge *= 10.0) {
    Point outward = Point::Zero();
    bool beyond = true;
    for (int line = 0; line < 3; ++line) {
      if (Orientation(ends[line], ends[line + 1], x) <= 0) continue;
      const Point along = (ends[line + 1] - ends[line]).normalized();
      outward += Point(along.y(), -along.x());
      beyond = false;
    }
    if (beyond) return x;
    x += (nudge * size_) * outward;
  }
  return std::nullopt;
}

bool EnclosingRing::MakesSharpCorner(const EdgeContext& at, const Point& x) const {
  const Point &before = vertices_[at.before_p], &p = vertices_[at.p], &a = vertices_[at.a],
              &b = vertices_[at.b], &q = vertices_[at.q], &after = vertices_[at.after_q];
  const auto too_sharp = [&](double now, double was) {
    return now < min_corner_angle_ && now < was;
  };
  return too_sharp(Angle(p, x, q), std::min(Angle(p, a, b), Angle(a, b, q))) ||
         too_sharp(Angle(before, p, x), Angle(before, p, a)) ||
         too_sharp(Angle(x, q, after), Angle(b, q, after));
}

EnclosingRing::Anchor EnclosingRing::NearestAnchor(const Point& x, const Anchor& from,
                                                   const Anchor& to) const {
  const auto n = original_.rows();
  const double end = to.position < from.position ? to.position + n : to.position;
  Anchor nearest = from;
  double least = (x - from.point).squaredNorm();
  Point a = from.point;
  for (double position = from.position; position < end;) {
    const double corner = std::min(std::floor(position) + 1.0, end);
    const Point b =
        corner == end ? to.point : Point(original_.row(static_cast<int>(corner) % n).transpose());
    const Point on = NearestOnSegment(x, a, b);
    const double distance2 = (x - on).squaredNorm();
    if (distance2 < least) {
      const double length = (b - a).norm();
      const double share = length > 0.0 ? (on - a).norm() / length : 0.0;
      least = distance2;
      nearest = {std::fmod(position + share * (corner - position), static_cast<double>(n)), on};
    }
    a = b;
    position = corner;
  }
  return nearest;
}

// Bound of the distance, both ways, between segment (a, b) and the original chain between anchors,
// given that a and b are no farther from theirs: a distance to a segment is convex along each
// original edge, and nearest points sweep the segment continuously from anchor to anchor.
double EnclosingRing::ChainDistance(const Anchor& from, const Anchor& to, const Point& a,
                                    const Point& b) const {
  const auto n = original_.rows();
  const double end = to.position < from.position ? to.position + n : to.position;
  double most = 0.0;
  for (double corner = std::floor(from.position) + 1.0; corner < end; corner += 1.0) {
    most = std::max(most, Distance(original_.row(static_cast<int>(corner) % n).transpose(), a, b));
    if (most > tolerance_) break;
  }
  return most;
}

bool EnclosingRing::IsObstructed(const EdgeContext& at, const EdgeCollapse& collapse,
                                 const std::vector<int>& next) const {
  const Point &p = vertices_[at.p], &a = vertices_[at.a], &b = vertices_[at.b],
              &q = vertices_[at.q], &x = collapse.vertex;
  if (Overlap(x, p, q)) return true;
  if (Overlap(p, x, vertices_[at.before_p]) || Overlap(q, x, vertices_[at.after_q])) return true;

  const double reach = kGapLimit * tolerance_;
  const Point margin(reach, reach);
  const Point low = p.cwiseMin(x).cwiseMin(q) - margin, high = p.cwiseMax(x).cwiseMax(q) + margin;
  double gap = reach, old_gap = reach;
  const auto blocks = [&](int edge) {
    if (edge == at.p || edge == at.a || edge == at.b) return false;  // these go
    const Point &c = vertices_[edge], &d = vertices_[next[edge]];
    if ((c.cwiseMin(d).array() > high.array()).any()) return false;
    if ((c.cwiseMax(d).array() < low.array()).any()) return false;
    const bool touches_p = next[edge] == at.p, touches_q = edge == at.q;
    if (!touches_p && SegmentsMeet(p, x, c, d)) return true;
    if (!touches_q && SegmentsMeet(x, q, c, d)) return true;
    if (touches_p || touches_q) return false;
    gap = std::min({gap, Distance(p, x, c, d), Distance(x, q, c, d)});
    old_gap = std::min({old_gap, Distance(p, a, c, d), Distance(a, b, c, d), Distance(b, q, c, d)});
    return false;
  };
  return grid_.AnyNear(p, x, reach, blocks) || grid_.AnyNear(x, q, reach, blocks) ||
         gap < kGapKept * old_gap;
}

void EnclosingRing::Apply(const EdgeContext& at, const EdgeCollapse& collapse, int kept) {
  grid_.Erase(at.p, vertices_[at.p], vertices_[at.a]);
  grid_.Erase(at.a, vertices_[at.a], vertices_[at.b]);
  grid_.Erase(at.b, vertices_[at.b], vertices_[at.q]);

  const int dropped = kept == at.a ? at.b : at.a;
  anchors_[kept] = NearestAnchor(collapse.vertex, anchors_[at.a], anchors_[at.b]);
  quadrics_[kept].a += quadrics_[dropped].a;
  quadrics_[kept].g += quadrics_[dropped].g;
  vertices_[kept] = collapse.vertex;

  grid_.Insert(at.p, vertices_[at.p], vertices_[kept]);
  grid_.Insert(kept, vertices_[kept], vertices_[at.q]);
}

}  // namespace posespace
