// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_LANDMARK_ORDER_H_
#define POSESPACE_MAPPING_LANDMARK_ORDER_H_

#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace posespace {

// Cyclic orders of labels: (2, 0, 1) and (0, 1, 2) are the same.

// The pairs of labels that have passed each other between two cyclic orders of the same labels: a
// largest set of labels in common order is kept; each other label is paired with the kept ones that
// it jumped over, taking the shorter way round, or both ways when they are equally short.  Empty
// exactly when the orders agree.
//
// Cost  O(k^2 log k).
std::vector<std::pair<int, int>> FindOrderConflicts(const std::vector<int>& one,
                                                    const std::vector<int>& other);

// A cyclic order of labels 0 .. num_labels - 1 that contains each of `orders` (of some labels
// each). Where they leave a choice, a label goes where `preferred` (a position in turns per label)
// has it, if it can.  Nothing when there is no such order, or none within a bounded search: the
// question is NP-complete in general (Galil, Megiddo 1977), though not in practice.
std::optional<std::vector<int>> FindCommonOrder(int num_labels,
                                                const std::vector<std::vector<int>>& orders,
                                                std::span<const double> preferred);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_LANDMARK_ORDER_H_
