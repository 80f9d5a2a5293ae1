// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_marks.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "mapping/landmark_order.h"

namespace posespace {
namespace {

constexpr double kSamePlace = 1e-6;  // turns within which two marks are one place
constexpr std::size_t kFaultsInMessage = 6;

// Faults of one kind, and the error that names them.
class Faults {
 public:
  explicit Faults(ErrorCode code) : code_(code) {}

  template <typename... Parts>
  void Add(std::string field, const Parts&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    where_.push_back({std::move(field), text.str()});
  }
  bool empty() const { return where_.empty(); }

  // These faults, then those of the other kinds.
  Error ToError(const std::vector<const Faults*>& others) const {
    std::string message = where_[0].description;
    for (std::size_t k = 1; k < std::min(where_.size(), kFaultsInMessage); ++k) {
      message += "; " + where_[k].description;
    }
    if (where_.size() > kFaultsInMessage) {
      message += "; and " + std::to_string(where_.size() - kFaultsInMessage) + " more";
    }
    Error error{code_, std::move(message), where_};
    for (const Faults* faults : others) {
      if (faults == this) continue;
      error.where.insert(error.where.end(), faults->where_.begin(), faults->where_.end());
    }
    return error;
  }

 private:
  ErrorCode code_;
  std::vector<Violation> where_;
};

std::string Field(std::size_t tuple, const std::string& shape) {
  return "tuples[" + std::to_string(tuple) + "].points['" + shape + "']";
}

bool IsSamePlace(const Mark& a, const Mark& b) {
  const double turns = std::abs(a.position - b.position);
  return std::min(turns, 1.0 - turns) <= kSamePlace;
}

// Tuples that share a place in some drawing are one landmark; then they must share it wherever two
// of them mark a drawing.
Marks JoinSamePlaces(const std::vector<std::vector<std::optional<Mark>>>& tuples,
                     std::span<const MatchingShape> shapes, Faults& faults) {
  Marks marks;
  marks.of_tuple.assign(tuples.size(), -1);
  const auto share_a_place = [&](std::size_t t, std::size_t u) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (tuples[t][i] && tuples[u][i] && IsSamePlace(*tuples[t][i], *tuples[u][i])) return true;
    }
    return false;
  };
  for (std::size_t first = 0; first < tuples.size(); ++first) {
    if (marks.of_tuple[first] >= 0) continue;
    const int landmark = static_cast<int>(marks.on.size());
    marks.on.emplace_back(shapes.size());
    marks.of_tuple[first] = landmark;
    for (std::vector<std::size_t> members = {first}; !members.empty();) {
      const std::size_t t = members.back();
      members.pop_back();
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        auto& mark = marks.on[landmark][i];
        if (mark && tuples[t][i] && !IsSamePlace(*mark, *tuples[t][i])) {
          faults.Add(Field(t, shapes[i].name), "tuple ", t,
                     " marks one place with another tuple in one shape but not in shape '",
                     shapes[i].name, "'");
        }
        if (!mark) mark = tuples[t][i];
      }
      for (std::size_t u = first + 1; u < tuples.size(); ++u) {
        if (marks.of_tuple[u] >= 0 || !share_a_place(t, u)) continue;
        marks.of_tuple[u] = landmark;
        members.push_back(u);
      }
    }
  }
  return marks;
}

// The landmarks that drawing i marks, along its outline.
std::vector<int> OrderOn(const Marks& marks, std::size_t i) {
  std::vector<int> order;
  for (std::size_t l = 0; l < marks.on.size(); ++l) {
    if (marks.on[l][i]) order.push_back(static_cast<int>(l));
  }
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return marks.on[a][i]->position < marks.on[b][i]->position; });
  return order;
}

void CheckOrders(const Marks& marks, std::span<const MatchingShape> shapes, Faults& faults) {
  std::vector<int> tuple_of(marks.on.size());
  for (std::size_t t = marks.of_tuple.size(); t-- > 0;) {
    tuple_of[marks.of_tuple[t]] = static_cast<int>(t);
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      std::vector<int> one = OrderOn(marks, i), other = OrderOn(marks, j);
      std::erase_if(one, [&](int l) { return !marks.on[l][j]; });
      std::erase_if(other, [&](int l) { return !marks.on[l][i]; });
      for (const auto& [a, b] : FindOrderConflicts(one, other)) {
        faults.Add(Field(tuple_of[a], shapes[j].name), "tuples ", tuple_of[a], " and ", tuple_of[b],
                   " follow each other differently along shape '", shapes[i].name,
                   "' and along shape '", shapes[j].name,
                   "': if limbs cross there, no outline fits both, and one is better left out");
      }
    }
  }
  if (!faults.empty() || FindCommonOrder(marks, std::vector<double>(marks.on.size(), 0.0))) return;
  for (std::size_t t = 0; t < marks.of_tuple.size(); ++t) {
    faults.Add("tuples[" + std::to_string(t) + "]",
               "no order around the outline agrees with all drawings' tuples together (tuple ", t,
               " among them), though any two drawings agree");
  }
}

}  // namespace

Result<Marks> PlaceLandmarks(std::span<const MatchingShape> shapes,
                             std::span<const OutlineCurve> curves,
                             std::span<const Landmark> landmarks, const MatchingOptions& options) {
  Faults not_finite(ErrorCode::kLandmarkNotFinite);
  Faults off_outline(ErrorCode::kLandmarkOffOutline);
  Faults out_of_order(ErrorCode::kLandmarksOutOfOrder);
  std::vector<std::vector<std::optional<Mark>>> tuples(landmarks.size());
  for (std::size_t t = 0; t < landmarks.size(); ++t) {
    tuples[t].resize(shapes.size());
    if (std::none_of(landmarks[t].points.begin(), landmarks[t].points.end(),
                     [](const auto& point) { return point.has_value(); })) {
      not_finite.Add("tuples[" + std::to_string(t) + "]", "tuple ", t, " marks no shape");
    }
    for (std::size_t i = 0; i < std::min(shapes.size(), landmarks[t].points.size()); ++i) {
      if (!landmarks[t].points[i]) continue;
      const Point& point = *landmarks[t].points[i];
      if (!point.allFinite()) {
        not_finite.Add(Field(t, shapes[i].name), "tuple ", t, " is not finite in shape '",
                       shapes[i].name, "'");
        continue;
      }
      const OutlineCurve::Nearest nearest = curves[i].NearestTo(point);
      const double limit = options.max_landmark_distance * curves[i].size();
      if (!(nearest.distance <= limit)) {
        off_outline.Add(Field(t, shapes[i].name), "tuple ", t, " is ", nearest.distance,
                        " px from the outline of shape '", shapes[i].name, "', limit ", limit,
                        " px");
        continue;
      }
      tuples[t][i] = Mark{nearest.position, nearest.point};
    }
  }
  Marks marks = JoinSamePlaces(tuples, shapes, out_of_order);
  if (out_of_order.empty()) CheckOrders(marks, shapes, out_of_order);

  const std::vector<const Faults*> kinds = {&not_finite, &off_outline, &out_of_order};
  for (const Faults* faults : kinds) {
    if (!faults->empty()) return faults->ToError(kinds);
  }
  return marks;
}

std::optional<std::vector<int>> FindCommonOrder(const Marks& marks,
                                                std::span<const double> preferred) {
  std::vector<std::vector<int>> orders;
  for (std::size_t i = 0; !marks.on.empty() && i < marks.on[0].size(); ++i) {
    orders.push_back(OrderOn(marks, i));
  }
  return FindCommonOrder(static_cast<int>(marks.on.size()), orders, preferred);
}

}  // namespace posespace
