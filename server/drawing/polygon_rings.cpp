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
  std::string field;  // as in Violation: "outer", "holes[2]"
  std::string name;   // as in a sentence: "the outline", "hole 2"
  Points points;
  std::vector<int> given_row;
  std::string crossing;  // where it meets itself, if it does: "edge 0 meets edge 2 near (5, 5)"

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

// How many rows were dropped, and why.
struct Dropped {
  int closing = 0;   // the first point again at the end
  int repeated = 0;  // a point right after itself
  int straight = 0;  // on the segment between its neighbours
};

// Keeps the rows for which `is_needless(before, row, after)` is false, each asked with the
// neighbours that are left; returns how many went.
template <typename Predicate>
int DropRows(std::vector<int>* rows, const Predicate& is_needless) {
  std::vector<int> kept;
  for (const int row : *rows) {
    while (kept.size() >= 2 && is_needless(kept[kept.size() - 2], kept.back(), row)) {
      kept.pop_back();
    }
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
  const int dropped = static_cast<int>(rows->size() - kept.size());
  *rows = std::move(kept);
  return dropped;
}

Dropped DropNeedlessRows(NamedRing* ring) {
  Dropped dropped;
  const auto point = [&](int row) { return Row(ring->points, row); };
  std::vector<int> rows(ring->points.rows());
  std::iota(rows.begin(), rows.end(), 0);
  while (rows.size() > 1 && point(rows.back()) == point(rows.front())) {
    rows.pop_back();
    ++dropped.closing;
  }
  const auto repeats = [&](int a, int b) { return point(a) == point(b); };
  // The last of them stays, where the edge begins that is longer than nothing.
  const auto distinct = std::unique(rows.rbegin(), rows.rend(), repeats).base();
  dropped.repeated = static_cast<int>(distinct - rows.begin());
  rows.erase(rows.begin(), distinct);
  dropped.straight = DropRows(&rows, [&](int before, int row, int after) {
    return IsOnSegment(point(row), point(before), point(after));
  });
  Points points(static_cast<Eigen::Index>(rows.size()), 2);
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(k) = point(rows[k]).transpose();
  ring->points = std::move(points);
  ring->given_row = std::move(rows);
  return dropped;
}

void WarnOfDropped(const Dropped& dropped, const std::string& name,
                   std::vector<std::string>* warnings) {
  const auto warn = [&](int count, const std::string& one, const std::string& many) {
    if (count == 0) return;
    warnings->push_back(name + ": " + (count == 1 ? one : std::to_string(count) + many) +
                        " dropped");
  };
  warn(dropped.closing, "the first point, repeated at the end, was",
       " repetitions of the first point at the end were");
  warn(dropped.repeated, "1 repeated point was", " repeated points were");
  warn(dropped.straight, "1 point within a straight run was", " points within straight runs were");
}

// +1 for a positive ring, -1 for a negative one.  Exact: at its lowest-leftmost point a simple ring
// turns the way it runs.
int OrientationOfSimple(const Points& ring) {
  const int n = static_cast<int>(ring.rows());
  int corner = 0;
  for (int k = 1; k < n; ++k) {
    if (std::pair(ring(k, 0), ring(k, 1)) < std::pair(ring(corner, 0), ring(corner, 1))) {
      corner = k;
    }
  }
  return Orientation(Row(ring, corner + n - 1), Row(ring, corner), Row(ring, corner + 1));
}

// Checks one ring by itself, and brings it to the shape that Outline promises, unless it crosses
// itself.
Result<void> CheckRing(NamedRing* ring, int max_points, int orientation,
                       std::vector<std::string>* warnings) {
  TRY(CheckCoordinates(*ring, max_points));
  const Dropped dropped = DropNeedlessRows(ring);
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
  WarnOfDropped(dropped, ring->name, warnings);
  if (const auto crossing = FindCrossing(points)) {
    const auto [i, j] = *crossing;
    ring->crossing =
        ring->Edge(i) + " meets " + ring->Edge(j) + Near(MeetingPoint(points, i, points, j));
    return {};
  }
  if (!(std::abs(SignedArea(points)) >= kMinArea)) {
    return too_small("has an area below 1e-6 square pixels");
  }
  if (OrientationOfSimple(points) != orientation) {
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

// Checks that the holes keep apart from the outline (rings[0]) and from each other.
Result<void> CheckApart(std::span<const NamedRing> rings) {
  if (const auto meeting = FindMeeting(rings)) {
    const NamedRing &a = rings[meeting->ring_a], &b = rings[meeting->ring_b];
    const int k = meeting->edge_a, l = meeting->edge_b;
    const std::string where = Near(MeetingPoint(a.points, k, b.points, l));
    return Error{ErrorCode::kOutlineNotSimple,
                 b.name + ": " + b.Edge(l) + " meets " + a.Edge(k) + " of " + a.name + where,
                 {{a.Field(k), "this edge meets " + b.name + where},
                  {b.Field(l), "this edge meets " + a.name + where}}};
  }
  return {};
}

// Checks that the holes lie inside the outline (rings[0]) and not in each other.
// Requires  rings that are simple and keep apart.
Result<void> CheckNesting(std::span<const NamedRing> rings) {
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

// The outline of what the rings surround, where they cross themselves.
Result<Outline> Retraced(std::span<const NamedRing> rings, const OutlineOptions& options,
                         std::vector<std::string> warnings) {
  const NamedRing& crossed =
      *std::find_if(rings.begin(), rings.end(), [](const auto& r) { return !r.crossing.empty(); });
  std::vector<Points> holes;
  for (const NamedRing& hole : rings.subspan(1)) holes.push_back(hole.points);
  const Texture painted = PaintRings(rings[0].points, holes, options.working_size);
  auto traced = TraceOutline(
      painted, {.working_size = options.working_size, .max_points = options.max_points});
  if (!traced) {
    Error refused = std::move(traced).error();
    refused.message = crossed.name + " crosses itself (" + crossed.crossing +
                      "), and filled by the non-zero rule it cannot be traced: " + refused.message;
    refused.where = {{crossed.field, refused.message}};
    return refused;
  }
  warnings.push_back(crossed.name + " crosses itself (" + crossed.crossing +
                     "): the rings were filled by the non-zero rule and traced anew, at " +
                     std::to_string(options.working_size) + " points along the longer side");
  warnings.insert(warnings.end(), traced->warnings.begin(), traced->warnings.end());
  traced->warnings = std::move(warnings);
  traced->colours.resize(0, 3);  // the paint's, not the drawing's
  return traced;
}

// A rectangle along the axes, which may be the drawing itself but often is the page around it.
bool IsUprightRectangle(const Points& ring) {
  if (ring.rows() != 4) return false;
  for (int k = 0; k < 4; ++k) {
    const Point along = Row(ring, k + 1) - Row(ring, k);
    if (along.x() != 0.0 && along.y() != 0.0) return false;
  }
  return true;
}

}  // namespace

Result<Outline> OutlineFromRings(const Points& outer, std::span<const Points> holes,
                                 const OutlineOptions& options) {
  std::vector<NamedRing> rings;
  rings.push_back({"outer", "the outline", outer, {}, {}});
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
    rings.push_back({"holes[" + number + "]", "hole " + number, hole, {}, {}});
  }
  Outline outline;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const int orientation = r == 0 ? 1 : -1;
    TRY(CheckRing(&rings[r], options.max_points, orientation, &outline.warnings));
  }
  TRY(CheckApart(rings));
  if (std::any_of(rings.begin(), rings.end(), [](const auto& r) { return !r.crossing.empty(); })) {
    return Retraced(rings, options, std::move(outline.warnings));
  }
  TRY(CheckNesting(rings));

  outline.outer = std::move(rings[0].points);
  for (std::size_t r = 1; r < rings.size(); ++r)
    outline.holes.push_back(std::move(rings[r].points));
  outline.holes_filled = static_cast<int>(outline.holes.size());
  if (outline.holes_filled > 0) {
    outline.warnings.push_back(outline.holes_filled == 1
                                   ? "1 hole was filled; its transparency is kept"
                                   : std::to_string(outline.holes_filled) +
                                         " holes were filled; their transparency is kept");
  }
  if (IsUprightRectangle(outline.outer)) {
    outline.warnings.push_back(
        "the outline is an upright rectangle; if that is the page around a drawing, send the "
        "picture or the SVG document itself, which lose their paper");
  }
  return outline;
}

}  // namespace posespace
