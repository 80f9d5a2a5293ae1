// SPDX-License-Identifier: Apache-2.0
#include "mapping/cut_stages.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "geometry/polygon.h"
#include "mapping/link_paths.h"
#include "mapping/triangle_quality.h"
#include "mapping/visibility.h"
#include "mapping/zero_steiner.h"

namespace posespace {
namespace {

constexpr int kMaxStraightRows = 400;  // of rings that are cut by a chord
constexpr int kMaxBentRows = 150;      // of rings that are cut along a path
constexpr int kMaxBends = 4;           // longer paths add as many vertices as an overlay
constexpr int kMaxPaths = 200;         // whose looks are compared, for each number of bends
constexpr int kMaxTries = 24;          // cuts whose sides are triangulated

// Which runs i, i + 1, ... j of rows, around the end, have a triangulation in common that ends at
// the chord (i, j).  Says something of runs whose chord is a diagonal of every ring.
class CommonRuns {
 public:
  CommonRuns(std::span<const Points> rings, const ChordTable& chords, Progress* progress)
      : n_(chords.size()), has_(static_cast<std::size_t>(n_) * n_, 0) {
    for (int i = 0; i < n_; ++i) At(i, (i + 1) % n_) = 1;
    for (int length = 2; length < n_ - 1; ++length) {
      for (int i = 0; i < n_ && !IsCancelled(progress); ++i) {
        const int j = (i + length) % n_;
        if (chords.Allows(i, j)) At(i, j) = HasApex(rings, i, j, length) ? 1 : 0;
      }
    }
  }

  bool Has(int i, int j) const { return has_[static_cast<std::size_t>(i) * n_ + j] != 0; }

 private:
  std::uint8_t& At(int i, int j) { return has_[static_cast<std::size_t>(i) * n_ + j]; }

  bool HasApex(std::span<const Points> rings, int i, int j, int length) const {
    for (int step = 1; step < length; ++step) {
      const int k = (i + step) % n_;
      if (!Has(i, k) || !Has(k, j)) continue;
      if (std::all_of(rings.begin(), rings.end(), [&](const Points& ring) {
            return Orientation(ring.row(i), ring.row(k), ring.row(j)) > 0;
          })) {
        return true;
      }
    }
    return false;
  }

  int n_;
  std::vector<std::uint8_t> has_;
};

// The angle at `at` between the ways to p and q, radians.
double AngleAt(const Point& at, const Point& p, const Point& q) {
  return std::abs(std::atan2(Cross(at, p, q), (p - at).dot(q - at)));
}

// The smallest angle between the ring and a path that leaves row i towards `to`.
double AngleAtEnd(const Points& ring, int i, const Point& to) {
  const Eigen::Index n = ring.rows();
  const Point at = ring.row(i);
  return std::min(AngleAt(at, ring.row((i + 1) % n), to),
                  AngleAt(at, to, ring.row((i + n - 1) % n)));
}

// A cut before its sides are triangulated.
struct Candidate {
  int i, j;
  std::vector<Points> bends;
  double merit = 0.0;  // balance times the smallest angle at the ends, over all rings
};

void Judge(std::span<const Points> rings, Candidate& candidate) {
  const int n = static_cast<int>(rings[0].rows()), i = candidate.i, j = candidate.j;
  double angle = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < rings.size(); ++s) {
    const Points& bends = candidate.bends[s];
    const bool straight = bends.rows() == 0;
    const Point after_i = straight ? rings[s].row(j) : bends.row(0);
    const Point before_j = straight ? rings[s].row(i) : bends.row(bends.rows() - 1);
    angle = std::min({angle, AngleAtEnd(rings[s], i, after_i), AngleAtEnd(rings[s], j, before_j)});
  }
  const int rows = std::min(j - i, n - (j - i)) + 1;
  candidate.merit = angle * rows / n;
}

std::array<CutSide, 2> SidesOf(int n, int i, int j, int bends) {
  std::array<CutSide, 2> sides;
  for (int k = i; k <= j; ++k) sides[0].rows.push_back(k);
  for (int b = bends - 1; b >= 0; --b) sides[0].rows.push_back(n + b);
  for (int k = j; k <= i + n; ++k) sides[1].rows.push_back(k % n);
  for (int b = 0; b < bends; ++b) sides[1].rows.push_back(n + b);
  return sides;
}

std::vector<Points> RingsOf(std::span<const Points> rings, std::span<const Points> bends,
                            const std::vector<int>& rows) {
  const Eigen::Index n = rings[0].rows();
  std::vector<Points> parts;
  for (std::size_t s = 0; s < rings.size(); ++s) {
    Points& part = parts.emplace_back(static_cast<Eigen::Index>(rows.size()), 2);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      part.row(static_cast<Eigen::Index>(k)) =
          rows[k] < n ? rings[s].row(rows[k]) : bends[s].row(rows[k] - n);
    }
  }
  return parts;
}

int SolvedSides(const Cut& cut) {
  return (cut.sides[0].triangles ? 1 : 0) + (cut.sides[1].triangles ? 1 : 0);
}

// True where the path of a side runs so straight that a triangle at a bend would be a sliver.
bool IsFlat(const Points& part, int bends) {
  const Eigen::Index n = part.rows();
  for (Eigen::Index k = n - bends; k < n; ++k) {
    const Point before = part.row(k - 1), at = part.row(k), after = part.row((k + 1) % n);
    const double area = std::abs(Cross(before, at, after));
    if (!((at - before).dot(after - at) <= kSliverSharpness * area)) return true;
  }
  return false;
}

// The candidate with its sides triangulated where they can be; nothing when a side is not a simple
// ring, its path hardly bends, or it would be cut again although it is no smaller.
std::optional<Cut> TryCut(std::span<const Points> rings, Level level, Candidate candidate,
                          Progress* progress) {
  const int n = static_cast<int>(rings[0].rows());
  const int bends = static_cast<int>(candidate.bends[0].rows());
  Cut cut{level, std::move(candidate.bends), SidesOf(n, candidate.i, candidate.j, bends)};
  for (CutSide& side : cut.sides) {
    const std::vector<Points> parts = RingsOf(rings, cut.bends, side.rows);
    if (bends > 0 && !std::all_of(parts.begin(), parts.end(), [&](const Points& part) {
          return IsSimple(part) && !IsFlat(part, bends);
        })) {
      return std::nullopt;
    }
    side.triangles = TriangulateRings(parts, {}, progress);
    if (!side.triangles && static_cast<int>(side.rows.size()) >= n) return std::nullopt;
  }
  return cut;
}

// Of two cuts the one with more solved sides, then the one that leaves fewer rows to solve.
bool LeavesLess(const Cut& a, const Cut& b) {
  const auto left = [](const Cut& cut) {
    std::size_t rows = 0;
    for (const CutSide& side : cut.sides) rows += side.triangles ? 0 : side.rows.size();
    return rows;
  };
  const int solved_a = SolvedSides(a), solved_b = SolvedSides(b);
  return solved_a != solved_b ? solved_a > solved_b : solved_a > 0 && left(a) < left(b);
}

// Triangulates the sides of the candidates of most merit; the best of them, or the first with
// `enough` solved sides.
std::optional<Cut> TryBest(std::span<const Points> rings, Level level,
                           std::vector<Candidate> candidates, int enough, Progress* progress) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.merit > b.merit; });
  std::optional<Cut> best;
  int tries = 0;
  for (Candidate& candidate : candidates) {
    if (++tries > kMaxTries || IsCancelled(progress)) break;
    auto cut = TryCut(rings, level, std::move(candidate), progress);
    if (cut && (!best || LeavesLess(*cut, *best))) best = std::move(cut);
    if (best && SolvedSides(*best) >= enough) break;
  }
  return best;
}

std::optional<Cut> StageI(std::span<const Points> rings, Progress* progress) {
  const int n = static_cast<int>(rings[0].rows());
  ChordTable chords(n);
  for (const Points& ring : rings) chords.KeepChordsInside(ring);
  const CommonRuns runs(rings, chords, progress);

  std::vector<Candidate> candidates;
  int longest = 0;  // rows of the longest side that has a triangulation
  for (int i = 0; i < n && !IsCancelled(progress); ++i) {
    for (int j = i + 2; j < n; ++j) {
      if ((i == 0 && j == n - 1) || !chords.Allows(i, j)) continue;
      const int solved = std::max(runs.Has(i, j) ? j - i : 0, runs.Has(j, i) ? n - (j - i) : 0);
      if (solved < longest) continue;
      if (!std::all_of(rings.begin(), rings.end(),
                       [&](const Points& ring) { return RowSeesRow(ring, i, j); })) {
        continue;
      }
      if (solved > longest) candidates.clear();
      longest = solved;
      candidates.push_back({i, j, std::vector<Points>(rings.size(), Points(0, 2))});
      Judge(rings, candidates.back());
    }
  }
  // Were both sides solved, so would be the whole.
  return TryBest(rings, Level::kStraightCut, std::move(candidates), longest > 0 ? 1 : 0, progress);
}

// The cuts along paths of so many bends; only a few of very many are looked at, spread evenly.
std::vector<Candidate> PathsOf(std::span<const Points> rings, std::span<const LinkPaths> paths,
                               int bends, Progress* progress) {
  const int n = static_cast<int>(rings[0].rows());
  std::vector<std::pair<int, int>> ends;
  for (int i = 0; i < n; ++i) {
    for (int j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (std::all_of(paths.begin(), paths.end(),
                      [&](const LinkPaths& in) { return in.Bends(i, j) <= bends; })) {
        ends.emplace_back(i, j);
      }
    }
  }
  const std::size_t step = 1 + ends.size() / kMaxPaths;
  std::vector<Candidate> candidates;
  for (std::size_t k = 0; k < ends.size() && !IsCancelled(progress); k += step) {
    Candidate candidate{ends[k].first, ends[k].second, {}};
    for (std::size_t s = 0; s < rings.size(); ++s) {
      const auto path = paths[s].Path(candidate.i, candidate.j, bends);
      if (!path) break;
      Points& points = candidate.bends.emplace_back(bends, 2);
      for (int b = 0; b < bends; ++b) points.row(b) = (*path)[b].transpose();
    }
    if (candidate.bends.size() < rings.size()) continue;
    Judge(rings, candidate);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

std::optional<Cut> StageII(std::span<const Points> rings, std::span<const LinkPaths> paths,
                           Progress* progress) {
  return TryBest(rings, Level::kOnePointCut, PathsOf(rings, paths, 1, progress), 2, progress);
}

std::optional<Cut> StageIII(std::span<const Points> rings, std::span<const LinkPaths> paths,
                            Progress* progress) {
  for (int bends = 2; bends <= kMaxBends; ++bends) {
    auto cut =
        TryBest(rings, Level::kLinkPathCut, PathsOf(rings, paths, bends, progress), 2, progress);
    if (cut || IsCancelled(progress)) return cut;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Cut> FindCut(std::span<const Points> rings, Progress* progress) {
  const int n = static_cast<int>(rings[0].rows());
  if (n > kMaxStraightRows) return std::nullopt;
  if (auto cut = StageI(rings, progress)) return cut;
  if (n > kMaxBentRows || IsCancelled(progress)) return std::nullopt;
  std::vector<LinkPaths> paths;
  for (const Points& ring : rings) {
    paths.emplace_back(ring);
    if (IsCancelled(progress)) return std::nullopt;
  }
  if (auto cut = StageII(rings, paths, progress)) return cut;
  return StageIII(rings, paths, progress);
}

}  // namespace posespace
