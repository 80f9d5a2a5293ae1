// SPDX-License-Identifier: Apache-2.0
#include "mapping/boundary_simplification.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "mapping/enclosing_ring.h"

namespace posespace {
namespace {

// Drops rows of N outlines together, cheapest edge first, until no edge can go.
class Simplification {
 public:
  Simplification(std::span<const Points> outlines, std::span<const int> landmark_rows,
                 const SimplificationOptions& options)
      : num_rows_(static_cast<int>(outlines[0].rows())),
        live_(num_rows_),
        next_(num_rows_),
        previous_(num_rows_),
        alive_(num_rows_, true),
        is_landmark_(num_rows_, false),
        version_(num_rows_, 0),
        plans_(num_rows_) {
    for (const Points& outline : outlines) {
      rings_.emplace_back(outline, options.tolerance, options.min_corner_angle);
    }
    for (const int row : landmark_rows) is_landmark_[row] = true;
    for (int row = 0; row < num_rows_; ++row) {
      next_[row] = (row + 1) % num_rows_;
      previous_[next_[row]] = row;
    }
  }

  // False when cancelled.
  bool Run(Progress* progress) {
    for (int row = 0; row < num_rows_; ++row) {
      if (row % 64 == 0 && IsCancelled(progress)) return false;
      Consider(row);
    }
    for (int step = 0; !queue_.empty(); ++step) {
      if (step % 16 == 0) {
        if (IsCancelled(progress)) return false;
        Report(progress, 1.0 - static_cast<double>(live_) / num_rows_);
      }
      const auto [cost, row, version] = queue_.top();
      queue_.pop();
      if (version != version_[row] || live_ <= 3 || IsObstructed(row)) continue;
      Collapse(row);
    }
    return true;
  }

  SimplifiedOutlines Outcome(std::span<const int> landmark_rows) const {
    SimplifiedOutlines result;
    std::vector<int> new_row(num_rows_, -1);
    int count = 0;
    for (int row = 0; row < num_rows_; ++row) {
      if (alive_[row]) new_row[row] = count++;
    }
    for (const EnclosingRing& ring : rings_) {
      Points& outline = result.outlines.emplace_back(count, 2);
      for (int row = 0; row < num_rows_; ++row) {
        if (alive_[row]) outline.row(new_row[row]) = ring.vertex(row).transpose();
      }
    }
    for (const int row : landmark_rows) result.landmark_rows.push_back(new_row[row]);
    return result;
  }

 private:
  // Cost, edge, and the edge's version when it was considered; the smallest comes first, and equal
  // costs go by the edge's number.
  using Entry = std::tuple<double, int, int>;

  EdgeContext ContextOf(int row) const {
    const int p = previous_[row], b = next_[row], q = next_[b];
    return {previous_[p], p, row, b, q, next_[q]};
  }

  // Plans the collapse of the edge after `row` in every outline and queues it; whatever was planned
  // before is void.
  void Consider(int row) {
    ++version_[row];
    const bool a_stays = is_landmark_[row], b_stays = is_landmark_[next_[row]];
    if (live_ <= 3 || (a_stays && b_stays)) return;
    const Freedom freedom = a_stays   ? Freedom::kStayAtA
                            : b_stays ? Freedom::kStayAtB
                                      : Freedom::kAnywhere;
    double cost = 0.0;
    plans_[row].clear();
    for (const EnclosingRing& ring : rings_) {
      const auto plan = ring.Plan(ContextOf(row), freedom);
      if (!plan) return;
      plans_[row].push_back(*plan);
      cost = std::max(cost, (plan->added_area + plan->distance * plan->distance) / ring.area());
    }
    queue_.emplace(cost, row, version_[row]);
  }

  bool IsObstructed(int row) const {
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      if (rings_[i].IsObstructed(ContextOf(row), plans_[row][i], next_)) return true;
    }
    return false;
  }

  void Collapse(int row) {
    const EdgeContext at = ContextOf(row);
    const int kept = is_landmark_[at.b] ? at.b : at.a;
    const int dropped = kept == at.a ? at.b : at.a;
    for (std::size_t i = 0; i < rings_.size(); ++i) rings_[i].Apply(at, plans_[row][i], kept);
    alive_[dropped] = false;
    ++version_[dropped];
    next_[at.p] = kept;
    previous_[kept] = at.p;
    next_[kept] = at.q;
    previous_[at.q] = kept;
    --live_;
    for (const int changed : {at.before_p, at.p, kept, at.q}) Consider(changed);
  }

  int num_rows_;
  int live_;
  std::vector<int> next_;
  std::vector<int> previous_;
  std::vector<bool> alive_;
  std::vector<bool> is_landmark_;
  std::vector<int> version_;
  std::vector<std::vector<EdgeCollapse>> plans_;  // per edge, one for each outline
  std::vector<EnclosingRing> rings_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

Result<SimplifiedOutlines> SimplifyBoundaries(std::span<const Points> outlines,
                                              std::span<const int> landmark_rows,
                                              const SimplificationOptions& options,
                                              Progress* progress) {
  Simplification simplification(outlines, landmark_rows, options);
  if (!simplification.Run(progress)) {
    return Error{ErrorCode::kCancelled, "simplification was cancelled", {}};
  }
  return simplification.Outcome(landmark_rows);
}

}  // namespace posespace
