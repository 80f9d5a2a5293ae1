// SPDX-License-Identifier: Apache-2.0
#include "interpolation/fold_repair.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "interpolation/rigid_blend.h"

namespace posespace {
namespace {

// The energy at some vertices, and what it is made of.
struct Evaluation {
  double energy = 0.0;
  double least_determinant = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd gradient;  // V x 2
};

Evaluation Evaluate(const Triangles& triangles, const TargetTriangles& targets,
                    const Eigen::MatrixXd& vertices, double epsilon) {
  Evaluation result;
  result.gradient = Eigen::MatrixXd::Zero(vertices.rows(), 2);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    double a = 0.0, b = 0.0, c = 0.0, d = 0.0;  // K = (a b; c d)
    for (int k = 0; k < 3; ++k) {
      const double x = vertices(triangles(t, k), 0), y = vertices(triangles(t, k), 1);
      const double gx = targets.gradients(t, 2 * k), gy = targets.gradients(t, 2 * k + 1);
      a += x * gx;
      b += x * gy;
      c += y * gx;
      d += y * gy;
    }
    const double determinant = a * d - b * c;
    result.least_determinant = std::min(result.least_determinant, determinant);

    // f = n / chi, and its derivative by K with det's derivative (d -c; -b a).
    const double root = std::hypot(epsilon, determinant);
    // Where det < 0 the sum would cancel.
    const double chi = determinant > 0.0 ? 0.5 * (determinant + root)
                                         : 0.5 * epsilon * epsilon / (root - determinant);
    const double n = a * a + b * b + c * c + d * d + determinant * determinant + 1.0;
    const double area = targets.areas[t];
    result.energy += area * n / chi;
    const double by_map = 2.0 * area / chi;
    const double by_determinant = area * (2.0 * determinant - n / root) / chi;
    const double fa = by_map * a + by_determinant * d, fb = by_map * b - by_determinant * c;
    const double fc = by_map * c - by_determinant * b, fd = by_map * d + by_determinant * a;
    for (int k = 0; k < 3; ++k) {
      const double gx = targets.gradients(t, 2 * k), gy = targets.gradients(t, 2 * k + 1);
      result.gradient(triangles(t, k), 0) += fa * gx + fb * gy;
      result.gradient(triangles(t, k), 1) += fc * gx + fd * gy;
    }
  }
  return result;
}

double Dot(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a.cwiseProduct(b).sum(); }

// The last steps and the change of gradient over each, newest first.
struct History {
  static constexpr std::size_t kLength = 8;
  std::deque<std::pair<Eigen::MatrixXd, Eigen::MatrixXd>> steps;

  void Add(const Eigen::MatrixXd& step, const Eigen::MatrixXd& change) {
    if (!(Dot(step, change) > 1e-12 * step.norm() * change.norm())) return;  // not convex there
    steps.emplace_front(step, change);
    if (steps.size() > kLength) steps.pop_back();
  }

  // The quasi-Newton direction down: two loops over the history around the preconditioner.
  template <typename Precondition>
  Eigen::MatrixXd Direction(const Eigen::MatrixXd& gradient, Precondition precondition) const {
    Eigen::MatrixXd direction = -gradient;
    std::vector<double> shares;
    for (const auto& [step, change] : steps) {
      shares.push_back(Dot(step, direction) / Dot(step, change));
      direction -= shares.back() * change;
    }
    direction = precondition(direction);
    if (!steps.empty()) {
      const auto& [step, change] = steps.front();
      direction *= Dot(step, change) / Dot(change, precondition(change));
    }
    for (std::size_t k = steps.size(); k-- > 0;) {
      const auto& [step, change] = steps[k];
      direction += (shares[k] - Dot(change, direction) / Dot(step, change)) * step;
    }
    return direction;
  }
};

// Small, and smaller the less is folded.
double Epsilon(double least_determinant) {
  const double folded = std::min(0.0, least_determinant);
  return std::sqrt(1e-6 + 0.04 * folded * folded);
}

}  // namespace

Points Unfolded(const Triangles& triangles, const TargetTriangles& targets, const Points& start,
                const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& precondition) {
  constexpr double kEnough = 1e-4;      // of the energy; less is not worth another step
  constexpr double kSufficient = 1e-4;  // of what the slope promises, for a step to be taken
  constexpr int kHalvings = 24;
  const auto most_steps = std::clamp<Eigen::Index>(60'000 / start.rows(), 20, 200);

  Points best = start;
  int fewest = CountFolds(triangles, start);
  Eigen::MatrixXd vertices = start;
  double epsilon = Epsilon(Evaluate(triangles, targets, vertices, 1.0).least_determinant);
  Evaluation now = Evaluate(triangles, targets, vertices, epsilon);
  History history;
  for (Eigen::Index step = 0; step < most_steps; ++step) {
    Eigen::MatrixXd direction = history.Direction(now.gradient, precondition);
    double slope = Dot(direction, now.gradient);
    if (!(slope < 0.0)) {
      history.steps.clear();
      direction = precondition(-now.gradient);
      slope = Dot(direction, now.gradient);
    }
    if (!(slope < 0.0)) break;

    double length = 1.0;
    Evaluation next = Evaluate(triangles, targets, vertices + direction, epsilon);
    for (int k = 0; k < kHalvings && !(next.energy <= now.energy + kSufficient * length * slope);
         ++k) {
      length *= 0.5;
      next = Evaluate(triangles, targets, vertices + length * direction, epsilon);
    }
    if (!(next.energy < now.energy)) break;
    vertices += length * direction;
    history.Add(length * direction, next.gradient - now.gradient);

    const int folds = CountFolds(triangles, Points(vertices));
    if (folds <= fewest) {
      best = vertices;
      fewest = folds;
    }
    const double gained = now.energy - next.energy;
    const double smaller = Epsilon(next.least_determinant);
    if (smaller < epsilon) {  // another energy: its gradient anew, the history still fits
      epsilon = smaller;
      now = Evaluate(triangles, targets, vertices, epsilon);
    } else {
      now = std::move(next);
      if (folds == 0 && gained < kEnough * now.energy) break;
    }
  }
  return best;
}

}  // namespace posespace
