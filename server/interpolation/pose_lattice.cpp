// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace posespace {
namespace {

// A pose's nearest neighbour is at least this many edges away.  A snapped vertex moves by at most
// 1 / sqrt(3) of an edge, so from 1 + 2 / sqrt(3) = 2.16 on no triangle has two snapped corners.
constexpr double kClearance = 2.5;

// The lattice is halved within this many of its edges from a close pose, ...
constexpr double kHalvedRadius = 3.0;

// ... and poses within this many edges of a close one count as close: then the rim of a halved
// region, which is never more than two edges wide, does not touch a snapped vertex's triangles.
constexpr double kReach = 7.0;

using Corners = std::array<int, 3>;

struct Leaf {
  Corners corners;
  int level;
};

// The lattice while it is built: leaves may have the midpoint of a halved neighbour on an edge.
class Builder {
 public:
  Builder(const Point& size, double spacing);

  // Halves leaves until every pose has its clearance.
  void Halve(const Points& placements);

  // Splits leaves at midpoints on their edges and returns all triangles.
  std::vector<Corners> Close() const;

  const std::vector<Point>& vertices() const { return vertices_; }
  double spacing() const { return spacing_; }

 private:
  static std::uint64_t Key(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
  }
  int MidpointOf(int a, int b) const {  // -1 when the edge is whole
    const auto found = midpoints_.find(Key(a, b));
    return found == midpoints_.end() ? -1 : found->second;
  }
  int Split(int a, int b);
  std::array<Leaf, 4> Quarter(const Leaf& leaf);
  bool MustSplit(const Leaf& leaf) const;
  template <typename Predicate>
  bool QuarterWhere(Predicate predicate);

  std::vector<Point> vertices_;
  std::vector<Leaf> leaves_;
  std::unordered_map<std::uint64_t, int> midpoints_;
  double spacing_;
};

Builder::Builder(const Point& size, double spacing) {
  // Even numbers of triangles and rows put the rectangle's mirror axes on the lattice's.
  const int columns = 2 * std::max(1, static_cast<int>(std::lround(size.x() / (2.0 * spacing))));
  spacing_ = size.x() / columns;
  const double row_height = 0.5 * std::numbers::sqrt3 * spacing_;
  const int rows = 4 * std::max(1, static_cast<int>(std::lround(size.y() / (4.0 * row_height))));

  // Even rows hold 0, h, 2h, ..; odd rows are shifted by h / 2 and hold both ends besides.
  std::vector<int> row_begin;
  for (int row = 0; row <= rows; ++row) {
    row_begin.push_back(static_cast<int>(vertices_.size()));
    const double y = row == rows ? size.y() : size.y() * row / rows;
    const bool is_odd = row % 2 == 1;
    for (int k = 0; k <= columns + is_odd; ++k) {
      const double place = is_odd ? std::clamp(k - 0.5, 0.0, double(columns)) : k;
      vertices_.emplace_back(place == columns ? size.x() : size.x() * place / columns, y);
    }
  }
  for (int row = 0; row < rows; ++row) {
    const bool odd_above = row % 2 == 0;
    const int even = row_begin[odd_above ? row : row + 1];
    const int odd = row_begin[odd_above ? row + 1 : row];
    for (int k = 0; k <= columns; ++k) {
      Corners towards_even{even + k, odd + k + 1, odd + k};
      if (!odd_above) std::swap(towards_even[1], towards_even[2]);
      leaves_.push_back({towards_even, 0});
      if (k == columns) break;
      Corners towards_odd{even + k, even + k + 1, odd + k + 1};
      if (!odd_above) std::swap(towards_odd[1], towards_odd[2]);
      leaves_.push_back({towards_odd, 0});
    }
  }
}

int Builder::Split(int a, int b) {
  const auto [entry, is_new] =
      midpoints_.try_emplace(Key(a, b), static_cast<int>(vertices_.size()));
  if (is_new) vertices_.push_back(0.5 * (vertices_[a] + vertices_[b]));
  return entry->second;
}

std::array<Leaf, 4> Builder::Quarter(const Leaf& leaf) {
  const auto [a, b, c] = leaf.corners;
  const int ab = Split(a, b), bc = Split(b, c), ca = Split(c, a);
  const int level = leaf.level + 1;
  return {Leaf{{a, ab, ca}, level}, Leaf{{ab, b, bc}, level}, Leaf{{ca, bc, c}, level},
          Leaf{{ab, bc, ca}, level}};
}

// True when a leaf has more than one midpoint on its sides: bisection would not close it.
bool Builder::MustSplit(const Leaf& leaf) const {
  int count = 0;
  for (int k = 0; k < 3; ++k) {
    const int a = leaf.corners[k], b = leaf.corners[(k + 1) % 3];
    const int middle = MidpointOf(a, b);
    if (middle < 0) continue;
    if (++count > 1 || MidpointOf(a, middle) >= 0 || MidpointOf(middle, b) >= 0) return true;
  }
  return false;
}

template <typename Predicate>
bool Builder::QuarterWhere(Predicate predicate) {
  std::vector<Leaf> leaves;
  leaves.reserve(leaves_.size());
  for (const Leaf& leaf : leaves_) {
    if (predicate(leaf)) {
      for (const Leaf& quarter : Quarter(leaf)) leaves.push_back(quarter);
    } else {
      leaves.push_back(leaf);
    }
  }
  const bool any = leaves.size() > leaves_.size();
  leaves_ = std::move(leaves);
  return any;
}

// The poses that need shorter edges than `edge`, and those in their reach.
std::vector<Point> ClosePoses(const Points& placements, const std::vector<double>& needed,
                              double edge) {
  std::vector<bool> is_close(needed.size(), false);
  std::vector<Point> close;
  const auto add = [&](std::size_t i) {
    is_close[i] = true;
    close.emplace_back(placements.row(static_cast<Eigen::Index>(i)).transpose());
  };
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (edge > needed[i]) add(i);
  }
  for (std::size_t next = 0; next < close.size(); ++next) {
    const Point from = close[next];
    for (std::size_t i = 0; i < needed.size(); ++i) {
      const Point pose = placements.row(static_cast<Eigen::Index>(i)).transpose();
      if (!is_close[i] && (pose - from).norm() < kReach * edge) add(i);
    }
  }
  return close;
}

void Builder::Halve(const Points& placements) {
  // The edge length each pose needs.
  const Eigen::Index count = placements.rows();
  std::vector<double> needed(static_cast<std::size_t>(count),
                             std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      if (i == j) continue;
      needed[i] = std::min(needed[i], (placements.row(i) - placements.row(j)).norm() / kClearance);
    }
  }

  bool any = true;
  for (int level = 0; any; ++level) {
    const double edge = std::ldexp(spacing_, -level);
    const std::vector<Point> close = ClosePoses(placements, needed, edge);
    if (close.empty()) return;
    any = QuarterWhere([&](const Leaf& leaf) {
      if (leaf.level != level) return false;
      const auto& [a, b, c] = leaf.corners;
      const Point centre = (vertices_[a] + vertices_[b] + vertices_[c]) / 3.0;
      return std::any_of(close.begin(), close.end(), [&](const Point& pose) {
        return (pose - centre).squaredNorm() < std::pow(kHalvedRadius * edge, 2);
      });
    });
    while (QuarterWhere([&](const Leaf& leaf) { return MustSplit(leaf); })) {
    }
  }
}

std::vector<Corners> Builder::Close() const {
  std::vector<Corners> triangles;
  triangles.reserve(leaves_.size());
  for (const Leaf& leaf : leaves_) {
    int k = 0, middle = -1;
    for (; k < 3 && middle < 0; ++k) {
      middle = MidpointOf(leaf.corners[k], leaf.corners[(k + 1) % 3]);
    }
    if (middle < 0) {
      triangles.push_back(leaf.corners);
      continue;
    }
    const int a = leaf.corners[k - 1], b = leaf.corners[k % 3], c = leaf.corners[(k + 1) % 3];
    triangles.push_back({a, middle, c});
    triangles.push_back({middle, b, c});
  }
  return triangles;
}

// The vertex nearest to each placement, moved onto it.  Of equally near ones, but for rounding, the
// first, so that neither scale nor offset of the placements decides.
std::vector<int> SnapTo(const Points& placements, Points* vertices) {
  constexpr double kTie = 1.0 - 1e-9;
  std::vector<int> snapped;
  const Points lattice = *vertices;
  std::vector<bool> taken(static_cast<std::size_t>(lattice.rows()), false);
  for (const auto& placement : placements.rowwise()) {
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int v = 0; v < static_cast<int>(lattice.rows()); ++v) {
      const double distance = (lattice.row(v) - placement).squaredNorm();
      if (taken[v] || !(distance < kTie * least)) continue;
      least = distance;
      nearest = v;
    }
    taken[nearest] = true;
    vertices->row(nearest) = placement;
    snapped.push_back(nearest);
  }
  return snapped;
}

// Moves the snapped vertices' neighbours towards the means of theirs, a few times over, as long as
// every triangle stays positive.
void Relax(const Triangles& triangles, const std::vector<int>& snapped, Points* vertices) {
  constexpr int kSweeps = 3;
  std::vector<bool> is_snapped(static_cast<std::size_t>(vertices->rows()), false);
  for (const int v : snapped) is_snapped[v] = true;
  const Edges edges = EdgesOf(triangles);
  std::vector<bool> moves(is_snapped.size(), false);
  for (const auto& edge : edges.rowwise()) {
    for (int k = 0; k < 2; ++k) {
      if (is_snapped[edge[1 - k]] && !is_snapped[edge[k]]) moves[edge[k]] = true;
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    Points sums = Points::Zero(vertices->rows(), 2);
    Eigen::VectorXi counts = Eigen::VectorXi::Zero(vertices->rows());
    for (const auto& edge : edges.rowwise()) {
      for (int k = 0; k < 2; ++k) {
        if (!moves[edge[k]]) continue;
        sums.row(edge[k]) += vertices->row(edge[1 - k]);
        ++counts[edge[k]];
      }
    }
    Points relaxed = *vertices;
    for (Eigen::Index v = 0; v < relaxed.rows(); ++v) {
      if (moves[v]) relaxed.row(v) = sums.row(v) / counts[v];
    }
    for (const auto& triangle : triangles.rowwise()) {
      const Point a = relaxed.row(triangle[0]), b = relaxed.row(triangle[1]),
                  c = relaxed.row(triangle[2]);
      if (!(Cross(a, b, c) > 0.0)) return;
    }
    *vertices = std::move(relaxed);
  }
}

}  // namespace

PoseLattice TessellateAround(const Points& placements, const Point& size, double spacing) {
  Builder builder(size, spacing);
  builder.Halve(placements);

  PoseLattice lattice;
  lattice.size = size;
  lattice.spacing = builder.spacing();
  const std::vector<Corners> corners = builder.Close();
  lattice.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
  for (std::size_t t = 0; t < corners.size(); ++t) {
    lattice.triangles.row(static_cast<Eigen::Index>(t)) << corners[t][0], corners[t][1],
        corners[t][2];
  }
  lattice.vertices.resize(static_cast<Eigen::Index>(builder.vertices().size()), 2);
  for (std::size_t v = 0; v < builder.vertices().size(); ++v) {
    lattice.vertices.row(static_cast<Eigen::Index>(v)) = builder.vertices()[v];
  }
  lattice.pose_vertices = SnapTo(placements, &lattice.vertices);
  Relax(lattice.triangles, lattice.pose_vertices, &lattice.vertices);
  return lattice;
}

}  // namespace posespace
