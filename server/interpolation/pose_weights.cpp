// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "interpolation/biharmonic_fit.h"
#include "interpolation/clough_tocher.h"
#include "interpolation/triangle_locator.h"

namespace posespace {
namespace {

// All relative to the diameter of the placements.
constexpr double kSpacing = 1.0 / 48.0;
constexpr double kMargin = 0.5;
constexpr double kEasedWidth = 0.2;  // of the band along the rim, see Eased()
constexpr double kCoincident = 1e-3;

// Outside these limits the gradient term vanishes in, or swamps, double precision.
constexpr double kLeastLevelling = 1e-2;
constexpr double kMostLevelling = 1e2;

// The least and the largest distance between placements.
struct Spread {
  double least = std::numeric_limits<double>::infinity();
  double diameter = 0.0;
  Eigen::Index a = 0, b = 0;  // the nearest two
};

Spread SpreadOf(const Points& placements) {
  Spread spread;
  for (Eigen::Index a = 0; a < placements.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < placements.rows(); ++b) {
      const double distance = (placements.row(a) - placements.row(b)).stableNorm();
      spread.diameter = std::max(spread.diameter, distance);
      if (!(distance < spread.least)) continue;
      spread.least = distance;
      spread.a = a;
      spread.b = b;
    }
  }
  return spread;
}

Violation PlacementAt(Eigen::Index row, const std::string& description) {
  return {"placements[" + std::to_string(row) + "]", description};
}

// What is wrong with the placements, if anything.
std::optional<Error> Refusal(const Points& placements, const Spread& spread) {
  if (placements.rows() == 0) {
    return Error{ErrorCode::kNoShapes, "a pose space needs at least one placement", {}};
  }
  for (Eigen::Index i = 0; i < placements.rows(); ++i) {
    if (placements.row(i).allFinite()) continue;
    return Error{ErrorCode::kPlacementNotFinite,
                 "placement " + std::to_string(i) + " is not a finite point",
                 {PlacementAt(i, "not finite")}};
  }
  if (!std::isfinite(spread.diameter)) {
    return Error{ErrorCode::kPlacementNotFinite, "the placements' distances overflow", {}};
  }
  const bool vanishes = spread.diameter < std::numeric_limits<double>::min();
  if (placements.rows() > 1 && (vanishes || spread.least < kCoincident * spread.diameter)) {
    const std::string a = std::to_string(spread.a), b = std::to_string(spread.b);
    return Error{ErrorCode::kPlacementsCoincide,
                 "placements " + a + " and " + b +
                     " are closer than 1/1000 of the distance between the farthest two",
                 {PlacementAt(spread.a, "too close to placement " + b),
                  PlacementAt(spread.b, "too close to placement " + a)}};
  }
  return std::nullopt;
}

// The placements' units and the domain [0, size], in units of their diameter.
struct Chart {
  Point low;  // of the placements' bounding box
  double diameter;

  Point ToDomain(const Point& point) const {
    return (point - low) / diameter + Point::Constant(kMargin);
  }
};

// A coordinate of the domain [0, size], brought to where the weights are read: unchanged inside,
// slowed down to a halt through a band along the rim, constant outside.  C1, so that weights are C1
// across the rim and at its corners, and their slopes fade over the band's width.
double Eased(double x, double size) {
  const auto past = [](double depth) {  // by how much to step back, `depth` into the band
    return depth * depth / (2.0 * kEasedWidth);
  };
  x = std::clamp(x, 0.0, size);
  if (x < kEasedWidth) return x + past(kEasedWidth - x);
  if (x > size - kEasedWidth) return x - past(x - (size - kEasedWidth));
  return x;
}

// Placements in the domain, and its size.
struct Layout {
  Chart chart;
  Points in_domain;
  Point size = Point::Zero();
};

Layout LayoutOf(const Points& placements, double diameter) {
  Layout layout{{placements.colwise().minCoeff().transpose(), diameter},
                Points(placements.rows(), 2)};
  for (Eigen::Index i = 0; i < placements.rows(); ++i) {
    const Point place = layout.chart.ToDomain(placements.row(i).transpose());
    layout.in_domain.row(i) = place;
    layout.size = layout.size.cwiseMax(place + Point::Constant(kMargin));
  }
  return layout;
}

// True when a lattice has the size of the layout's, and triangles that can be walked through.
bool IsLatticeOf(const Layout& layout, const PoseLattice& lattice) {
  const auto num_vertices = static_cast<std::int32_t>(lattice.vertices.rows());
  if (lattice.size != layout.size) return false;
  // A tessellation fits its spacing to the rectangle; a far smaller one would be a flood of cells.
  if (!(lattice.spacing >= 0.5 * kSpacing && lattice.spacing <= 2.0 * kSpacing)) return false;
  if (num_vertices == 0 || lattice.triangles.rows() == 0) return false;
  if (lattice.triangles.minCoeff() < 0 || lattice.triangles.maxCoeff() >= num_vertices) {
    return false;
  }
  const Points& vertices = lattice.vertices;
  for (const auto& triangle : lattice.triangles.rowwise()) {
    const double area =
        Cross(vertices.row(triangle[0]), vertices.row(triangle[1]), vertices.row(triangle[2]));
    if (!(area > 0.0)) return false;
  }
  return vertices.allFinite();
}

}  // namespace

struct PoseWeights::Field {
  struct Surface {
    Chart chart;
    PoseLattice lattice;
    TriangleLocator locator;
    LatticeData data;
  };

  Field() : num_poses(1) {}
  Field(const Layout& layout, PoseLattice lattice, LatticeData data)
      : num_poses(static_cast<int>(layout.in_domain.rows())) {
    TriangleLocator locator(lattice.vertices, lattice.triangles, lattice.size, lattice.spacing);
    surface = Surface{layout.chart, std::move(lattice), std::move(locator), std::move(data)};
  }

  int num_poses;
  std::optional<Surface> surface;  // none for a single pose: its weight is 1 everywhere
};

Result<PoseWeights> PoseWeights::Fit(const Points& placements, const PoseWeightsOptions& options,
                                     Progress* progress) {
  const Spread spread = SpreadOf(placements);
  if (auto refusal = Refusal(placements, spread)) return *std::move(refusal);
  if (!(options.levelling >= kLeastLevelling && options.levelling <= kMostLevelling)) {
    return Error{ErrorCode::kInvalidOption,
                 "levelling must lie between 0.01 and 100",
                 {{"levelling", "out of range"}}};
  }
  if (placements.rows() == 1) return PoseWeights(std::make_shared<const Field>());

  const Layout layout = LayoutOf(placements, spread.diameter);
  PoseLattice lattice = TessellateAround(layout.in_domain, layout.size, kSpacing);
  Report(progress, 0.2);
  LatticeData data = TRY(FitBiharmonic(lattice, options.levelling, progress));
  Report(progress, 1.0);
  return PoseWeights(std::make_shared<const Field>(layout, std::move(lattice), std::move(data)));
}

PoseWeightsFit PoseWeights::fit() const {
  if (!field_->surface) return {};
  return {field_->surface->lattice, field_->surface->data};
}

Result<PoseWeights> PoseWeights::FromFit(const Points& placements, PoseWeightsFit fit) {
  const Spread spread = SpreadOf(placements);
  if (auto refusal = Refusal(placements, spread)) return *std::move(refusal);
  const Error misfit{ErrorCode::kSizeMismatch, "the weights are not those of these placements", {}};
  if (placements.rows() == 1) {
    if (fit.data.size() != 0) return misfit;
    return PoseWeights(std::make_shared<const Field>());
  }
  const Layout layout = LayoutOf(placements, spread.diameter);
  if (!IsLatticeOf(layout, fit.lattice) || fit.data.rows() != 3 * fit.lattice.vertices.rows() ||
      fit.data.cols() != placements.rows()) {
    return misfit;
  }
  if (!fit.data.allFinite()) {
    return Error{ErrorCode::kWeightsNotFinite, "the weights are not finite", {}};
  }
  return PoseWeights(
      std::make_shared<const Field>(layout, std::move(fit.lattice), std::move(fit.data)));
}

Eigen::VectorXd PoseWeights::At(const Point& point) const {
  Eigen::VectorXd weights(field_->num_poses);
  At(point, {weights.data(), static_cast<std::size_t>(field_->num_poses)});
  return weights;
}

void PoseWeights::At(const Point& point, std::span<double> weights) const {
  Eigen::Map<Eigen::VectorXd> sum(weights.data(), field_->num_poses);
  if (!field_->surface) {
    sum.setOnes();
    return;
  }
  const auto& [chart, lattice, locator, data] = *field_->surface;
  const Point place = chart.ToDomain(point);
  const auto [t, barycentric] =
      locator.Find(Point(Eased(place.x(), lattice.size.x()), Eased(place.y(), lattice.size.y())));

  std::array<Point, 3> corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = lattice.vertices.row(lattice.triangles(t, k)).transpose();
  const CornerShares shares = CloughTocher(corners, barycentric);
  sum.setZero();
  for (int k = 0; k < 3; ++k) {
    for (int d = 0; d < 3; ++d) {
      sum += shares[k][d] * data.row(3 * lattice.triangles(t, k) + d).transpose();
    }
  }
}

int PoseWeights::num_poses() const { return field_->num_poses; }

std::int64_t PoseWeights::MemoryBytes() const {
  if (!field_->surface) return sizeof(Field);
  const auto& [chart, lattice, locator, data] = *field_->surface;
  // The lattice is held twice, by itself and with its neighbours in the locator.
  const std::size_t numbers = data.size() + 2 * lattice.vertices.size();
  const std::size_t indices = 3 * lattice.triangles.size();
  return static_cast<std::int64_t>(numbers * sizeof(double) + indices * sizeof(std::int32_t));
}

}  // namespace posespace
