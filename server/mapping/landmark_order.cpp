// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace posespace {
namespace {

constexpr int kMaxTrials = 20'000;  // insertions tried before a common order is given up

// Indices of a longest increasing subsequence.
std::vector<int> LongestIncreasing(const std::vector<int>& values) {
  std::vector<int> tails, previous(values.size(), -1);
  for (int k = 0; k < static_cast<int>(values.size()); ++k) {
    const auto place =
        std::lower_bound(tails.begin(), tails.end(), values[k],
                         [&](int index, int value) { return values[index] < value; });
    if (place != tails.begin()) previous[k] = *(place - 1);
    if (place == tails.end()) {
      tails.push_back(k);
    } else {
      *place = k;
    }
  }
  std::vector<int> chosen;
  for (int k = tails.back(); k >= 0; k = previous[k]) chosen.push_back(k);
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

// A label at a time is inserted where every order allows it; dead ends are taken back.
class OrderSearch {
 public:
  OrderSearch(int num_labels, const std::vector<std::vector<int>>& orders,
              std::span<const double> preferred)
      : orders_(orders), preferred_(preferred), places_(orders.size()) {
    std::vector<int> uses(num_labels, 0);
    for (std::size_t d = 0; d < orders.size(); ++d) {
      places_[d].assign(num_labels, -1);
      for (std::size_t k = 0; k < orders[d].size(); ++k) {
        places_[d][orders[d][k]] = static_cast<int>(k);
        ++uses[orders[d][k]];
      }
    }
    queue_.resize(num_labels);
    std::iota(queue_.begin(), queue_.end(), 0);
    std::stable_sort(queue_.begin(), queue_.end(), [&](int a, int b) { return uses[a] > uses[b]; });
  }

  std::optional<std::vector<int>> Run() {
    if (!Insert(0)) return std::nullopt;
    return ring_;
  }

 private:
  bool Insert(std::size_t index) {
    if (index == queue_.size()) return true;
    const int label = queue_[index];
    for (const int gap : AllowedGaps(label)) {
      if (++trials_ > kMaxTrials) return false;
      ring_.insert(ring_.begin() + gap, label);
      if (Insert(index + 1)) return true;
      ring_.erase(ring_.begin() + gap);
    }
    return false;
  }

  // Gap g is before ring_[g]; the preferred one comes first.
  std::vector<int> AllowedGaps(int label) const {
    const int size = static_cast<int>(ring_.size());
    if (size == 0) return {0};
    std::vector<bool> allowed(size, true);
    for (std::size_t d = 0; d < orders_.size(); ++d) {
      if (places_[d][label] >= 0) Restrict(d, label, allowed);
    }
    const auto turns = [](double from, double to) { return to - from - std::floor(to - from); };
    std::vector<int> gaps, others;
    for (int gap = 0; gap < size; ++gap) {
      if (!allowed[gap]) continue;
      const double before = preferred_[ring_[(gap + size - 1) % size]];
      const double after = preferred_[ring_[gap]];
      const bool is_preferred =
          size == 1 || turns(before, preferred_[label]) < turns(before, after);
      (is_preferred ? gaps : others).push_back(gap);
    }
    gaps.insert(gaps.end(), others.begin(), others.end());
    return gaps;
  }

  // Forbids the gaps outside the arc between the label's neighbours in one order.
  void Restrict(std::size_t order, int label, std::vector<bool>& allowed) const {
    const int size = static_cast<int>(ring_.size());
    const std::vector<int>& places = places_[order];
    const int length = static_cast<int>(orders_[order].size());
    int before = -1, after = -1, nearest_before = length, nearest_after = length;
    for (int k = 0; k < size; ++k) {
      if (places[ring_[k]] < 0) continue;
      const int ahead = (places[ring_[k]] - places[label] + length) % length;
      if (ahead < nearest_after) {
        nearest_after = ahead;
        after = k;
      }
      if (length - ahead < nearest_before) {
        nearest_before = length - ahead;
        before = k;
      }
    }
    if (before == after) return;  // none or one of its companions: any gap will do
    for (int k = after; k != before; k = (k + 1) % size) allowed[(k + 1) % size] = false;
  }

  const std::vector<std::vector<int>>& orders_;
  std::span<const double> preferred_;
  std::vector<std::vector<int>> places_;  // [order][label], -1 where absent
  std::vector<int> queue_;                // labels, the most used first
  std::vector<int> ring_;
  int trials_ = 0;
};

}  // namespace

std::vector<std::pair<int, int>> FindOrderConflicts(const std::vector<int>& one,
                                                    const std::vector<int>& other) {
  const int n = static_cast<int>(one.size());
  if (n < 3) return {};
  // From here on labels are ranks in `one`.
  std::vector<int> ranks;
  for (const int label : other) {
    ranks.push_back(static_cast<int>(std::find(one.begin(), one.end(), label) - one.begin()));
  }
  std::vector<int> kept;  // indices into `ranks`, in its order
  for (int start = 0; start < n; ++start) {
    std::vector<int> relative(n);
    for (int k = 0; k < n; ++k) relative[k] = (ranks[(start + k) % n] - ranks[start] + n) % n;
    std::vector<int> chosen = LongestIncreasing(relative);
    if (chosen.size() <= kept.size()) continue;
    for (int& k : chosen) k = (start + k) % n;
    kept = std::move(chosen);
  }

  std::vector<bool> is_kept(n, false);
  for (const int k : kept) is_kept[k] = true;
  const int m = static_cast<int>(kept.size());
  // The index into `kept` of the last kept label at or before `value` by a cyclic measure.
  const auto last_before = [&](int value, const auto& measure) {
    int best = 0, least = n;
    for (int k = 0; k < m; ++k) {
      const int behind = (value - measure(kept[k]) + n) % n;
      if (behind < least) {
        least = behind;
        best = k;
      }
    }
    return best;
  };
  std::vector<std::pair<int, int>> conflicts;
  for (int k = 0; k < n; ++k) {
    if (is_kept[k]) continue;
    const int gap_one = last_before(ranks[k], [&](int index) { return ranks[index]; });
    const int gap_other = last_before(k, [](int index) { return index; });
    const int forward = (gap_other - gap_one + m) % m, backward = m - forward;
    const auto add = [&](int first, int count) {
      for (int step = 0; step < count; ++step) {
        conflicts.emplace_back(other[k], other[kept[(first + step) % m]]);
      }
    };
    if (forward <= backward) add(gap_one + 1, forward);
    if (backward <= forward) add(gap_other + 1, backward);
  }
  return conflicts;
}

std::optional<std::vector<int>> FindCommonOrder(int num_labels,
                                                const std::vector<std::vector<int>>& orders,
                                                std::span<const double> preferred) {
  return OrderSearch(num_labels, orders, preferred).Run();
}

}  // namespace posespace
