// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <string>

#include "drawing/outline.h"
#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr double kMaxCoordinate = 1e6;
constexpr double kMinArea = 1e-6;  // square pixels; glyphs in a unit square have about 0.1

Point Row(const Points& ring, int k) { return ring.row(k % ring.rows()).transpose(); }

std::string Near(const Point& p) {
  char text[64];
  std::snprintf(text, sizeof(text), " near (%.6g, %.6g)", p.x(), p.y());
  return text;
}

// A ring being checked: what it is called, and which row of the client's each of its rows is.
struct NamedRing {
  std::string field;  // as in Violation: "outline", "holes[2]"
  std::string name;   // as in a sentence: "the outline", "hole 2"
  Points points;
  std::vector<int> given_row;

  std::string Field(int k) const { return field + "[" + std::to_string(given_row[k]) + "]"; }
  std::string Edge(int k) const { return "edge " + std::to_string(given_row[k]); }
};

// A place that edges k of a and l of b have in common, in double.
Point MeetingPoint(const Points& a, int k, const Points& b, int l) {
  const Point p = Row(a, k), q = Row(a, k + 1), r = Row(b, l), s = Row(b, l + 1);
  const double from = Cross(r, s, p), to = Cross(r, s, q);
  if (from != to) {
    const double t = from / (from - to);
    if (t >= 0.0 && t <= 1.0) return p + t * (q - p);
  }
  return IsOnSegment(q, r, s) ? q : p;
}

Result<void> CheckCoordinates(const NamedRing& ring, int max_points) {
  if (ring.points.rows() > max_points) {
    return Error{ErrorCode::kOutlineTooLong,
                 ring.name + " has " + std::to_string(ring.points.rows()) + " points; at most " +
                     std::to_string(max_points) + " are accepted",
                 {{ring.field, "too many points"}}};
  }
  for (int k = 0; k < ring.points.rows(); ++k) {
    const Point p = Row(ring.points, k);
    if (p.allFinite() && p.cwiseAbs().maxCoeff() <= kMaxCoordinate) continue;
    const std::string field = ring.field + "[" + std::to_string(k) + "]";
    return Error{
        ErrorCode::kInvalidOption,
        "point " + std::to_string(k) + " of " + ring.name + " is not finite or beyond 1e6 pixels",
        {{field, "not finite, or a coordinate beyond 1e6"}}};
  }
  return {};
}

// Removes rows that repeat their neighbour or lie on the segment between their neighbours.
void RemoveNeedlessRows(NamedRing* ring) {
  std::vector<int> kept;
  const auto point = [&](int row) { return Row(ring->points, row); };
  const auto is_needless = [&](int before, int row, int after) {
    return point(row) == point(before) || IsOnSegment(point(row), point(before), point(after));
  };
  for (int row = 0; row < ring->points.rows(); ++row) {
    while (kept.size() >= 2 && is_needless(kept[kept.size() - 2], kept.back(), row)) {
      kept.pop_back();
    }
    if (!kept.empty() && point(kept.back()) == point(row)) kept.pop_back();
    kept.push_back(row);
  }
  // The same across the seam.
  std::size_t first = 0;
  for (bool changed = true; changed && kept.size() - first >= 3;) {
    changed = true;
    const int last = kept.back();
    if (is_needless(kept[kept.size() - 2], last, kept[first])) {
      kept.pop_back();
    } else if (is_needless(last, kept[first], kept[first + 1])) {
      ++first;
    } else {
      changed = false;
    }
  }
  kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(first));
  Points points(static_cast<Eigen::Index>(kept.size()), 2);
  for (std::size_t k = 0; k < kept.size(); ++k) points.row(k) = ring->points.row(kept[k]);
  ring->points = std::move(points);
  ring->given_row = std::move(kept);
}

// Checks one ring by itself, and brings it to the shape that Outline promises.
Result<void> CheckRing(NamedRing* ring, int max_points, int orientation) {
  TRY(CheckCoordinates(*ring, max_points));
  RemoveNeedlessRows(ring);
  const Points& points = ring->points;
  const int n = static_cast<int>(points.rows());
  const auto too_small = [&](const std::string& why) {
    return Error{ErrorCode::kOutlineTooSmall, ring->name + " " + why, {{ring->field, why}}};
  };
  if (n < 3) return too_small("has fewer than 3 distinct points");
  bool is_flat = true;
  for (int k = 2; k < n && is_flat; ++k) {
    is_flat = Orientation(Row(points, 0), Row(points, 1), Row(points, k)) == 0;
  }
  if (is_flat) return too_small("has no area: all its points are on one line");
  if (const auto crossing = FindCrossing(points)) {
    const auto [i, j] = *crossing;
    const std::string where = Near(MeetingPoint(points, i, points, j));
    return Error{ErrorCode::kOutlineNotSimple,
                 ring->name + ": " + ring->Edge(i) + " meets " + ring->Edge(j) + where,
                 {{ring->Field(i), "this edge meets " + ring->Edge(j) + where},
                  {ring->Field(j), "this edge meets " + ring->Edge(i) + where}}};
  }
  const double area = SignedArea(points);
  if (!(std::abs(area) >= kMinArea)) {
    return too_small("has an area below 1e-6 square pixels");
  }
  // Exact: at its lowest-leftmost point a simple ring turns the way it runs.
  int corner = 0;
  for (int k = 1; k < n; ++k) {
    if (std::pair(points(k, 0), points(k, 1)) < std::pair(points(corner, 0), points(corner, 1))) {
      corner = k;
    }
  }
  if (Orientation(Row(points, corner + n - 1), Row(points, corner), Row(points, corner + 1)) !=
      orientation) {
    // Edge k is named by its first row, which after turning round is the row that was its end.
    ring->points = points.colwise().reverse().eval();
    std::reverse(ring->given_row.begin(), ring->given_row.end() - 1);
  }
  return {};
}

// Two rings that meet, and the edges that do.
struct Meeting {
  int ring_a, edge_a, ring_b, edge_b;
};

// A sweep along x over the edges of all rings, as in FindCrossing.
std::optional<Meeting> FindMeeting(std::span<const NamedRing> rings) {
  struct Edge {
    int ring, row;
    Point a, b;
    double low(int axis) const { return std::min(a[axis], b[axis]); }
    double high(int axis) const { return std::max(a[axis], b[axis]); }
  };
  std::vector<Edge> edges;
  for (int r = 0; r < static_cast<int>(rings.size()); ++r) {
    for (int k = 0; k < rings[r].points.rows(); ++k) {
      edges.push_back({r, k, Row(rings[r].points, k), Row(rings[r].points, k + 1)});
    }
  }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& e, const Edge& f) { return e.low(0) < f.low(0); });
  std::vector<const Edge*> active;
  for (const Edge& edge : edges) {
    std::erase_if(active, [&](const Edge* other) { return other->high(0) < edge.low(0); });
    for (const Edge* other : active) {
      if (other->ring == edge.ring) continue;
      if (other->high(1) < edge.low(1) || edge.high(1) < other->low(1)) continue;
      if (!SegmentsMeet(edge.a, edge.b, other->a, other->b)) continue;
      const bool ordered = other->ring < edge.ring;
      const Edge& first = ordered ? *other : edge;
      const Edge& second = ordered ? edge : *other;
      return Meeting{first.ring, first.row, second.ring, second.row};
    }
    active.push_back(&edge);
  }
  return std::nullopt;
}

// Checks that the holes lie inside the outline (rings[0]), apart from it and from each other.
Result<void> CheckNesting(std::span<const NamedRing> rings) {
  if (const auto meeting = FindMeeting(rings)) {
    const NamedRing &a = rings[meeting->ring_a], &b = rings[meeting->ring_b];
    const int k = meeting->edge_a, l = meeting->edge_b;
    const std::string where = Near(MeetingPoint(a.points, k, b.points, l));
    return Error{ErrorCode::kOutlineNotSimple,
                 b.name + ": " + b.Edge(l) + " meets " + a.Edge(k) + " of " + a.name + where,
                 {{a.Field(k), "this edge meets " + b.name + where},
                  {b.Field(l), "this edge meets " + a.name + where}}};
  }
  for (std::size_t h = 1; h < rings.size(); ++h) {
    const Point p = Row(rings[h].points, 0);
    const auto misplaced = [&](const std::string& how) {
      return Error{ErrorCode::kOutlineNotSimple,
                   rings[h].name + how + Near(p),
                   {{rings[h].field, "this hole" + how}}};
    };
    if (Locate(p, rings[0].points) < 0) return misplaced(" lies outside the outline");
    for (std::size_t g = 1; g < rings.size(); ++g) {
      if (g != h && Locate(p, rings[g].points) > 0) {
        return misplaced(" lies inside " + rings[g].name);
      }
    }
  }
  return {};
}

}  // namespace

Result<Outline> OutlineFromRings(const Points& outer, std::span<const Points> holes,
                                 const OutlineOptions& options) {
  std::vector<NamedRing> rings;
  rings.push_back({"outline", "the outline", outer, {}});
  std::int64_t hole_points = 0;
  for (const Points& hole : holes) hole_points += std::max<std::int64_t>(1, hole.rows());
  if (hole_points > options.max_points) {
    return Error{ErrorCode::kOutlineTooLong,
                 "the holes have " + std::to_string(hole_points) + " points in all; at most " +
                     std::to_string(options.max_points) + " are accepted",
                 {{"holes", "too many points"}}};
  }
  for (const Points& hole : holes) {
    const std::string number = std::to_string(rings.size() - 1);
    rings.push_back({"holes[" + number + "]", "hole " + number, hole, {}});
  }
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const int orientation = r == 0 ? 1 : -1;
    TRY(CheckRing(&rings[r], options.max_points, orientation));
  }
  TRY(CheckNesting(rings));

  Outline outline;
  outline.outer = std::move(rings[0].points);
  for (std::size_t r = 1; r < rings.size(); ++r)
    outline.holes.push_back(std::move(rings[r].points));
  outline.holes_filled = static_cast<int>(outline.holes.size());
  return outline;
}

}  // namespace posespace
