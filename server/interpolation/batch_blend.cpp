// SPDX-License-Identifier: Apache-2.0
#include "interpolation/batch_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "interpolation/blend_kernel.h"
#include "interpolation/blend_scratch.h"
#include "interpolation/blend_tables.h"

namespace posespace {
namespace {

// Where the first solve errs by more of the size than this, as on long thin strips, it is polished
// with another one, if that helps.
constexpr double kPolishedFrom = 1.5e-6;
constexpr int kMostPolishes = 3;

Eigen::Map<const Eigen::VectorXd> WeightsOf(const BlendJob& job) {
  return {job.weights.data(), static_cast<Eigen::Index>(job.weights.size())};
}

}  // namespace

struct BatchBlend::Tables {
  explicit Tables(RigidBlend blend) : exact(std::move(blend)) {}

  void SolveGroup(std::span<BlendJob> jobs, const BlendOptions& options) const;
  void SolveAlone(BlendJob& job, const BlendOptions& options) const;
  void SetWeights(const BlendJob& job, ShearLimit limit, int lane, int lanes,
                  const BlendScratch& scratch) const;
  void SetPlacing(const BlendJob& job, const BlendOptions& options, int lane, int lanes,
                  const BlendScratch& scratch) const;
  void Hold(const MeshPoint& anchor, const BlendJob& job, int lane, int lanes,
            const BlendScratch& scratch) const;
  void Finish(BlendJob& job, const BlendOptions& options, int lane, int lanes,
              const BlendScratch& scratch) const;
  void SolveFast(std::span<BlendJob> jobs, const BlendOptions& options) const;
  void SolveExactly(BlendJob& job, const BlendOptions& options) const;
  void Mend(BlendJob& job, const BlendOptions& options) const;
  void PlaceFolded(BlendJob& job, const BlendOptions& options, int lane, int lanes,
                   const BlendScratch& scratch) const;
  double WorstError() const;
  void ChoosePolishes();
  void CountFoldsOf(BlendJob& job) const {
    const auto count = static_cast<std::size_t>(layout.tables.num_vertices);
    const std::span<const float> coordinates(job.vertices, 2 * count);
    job.folds = CountFolds(exact.model().triangles, coordinates);
  }

  RigidBlend exact;
  BlendLayout layout;
};

// Weights as the kernel reads them.
void BatchBlend::Tables::SetWeights(const BlendJob& job, ShearLimit limit, int lane, int lanes,
                                    const BlendScratch& scratch) const {
  double sum = 0.0;
  for (const double weight : job.weights) sum += LimitWeight(weight, limit);
  if (limit == ShearLimit::kOff) sum = 1.0;
  for (std::size_t i = 0; i < job.weights.size(); ++i) {
    const std::size_t at = i * static_cast<std::size_t>(lanes) + lane;
    scratch.rotation_weights[at] = static_cast<float>(job.weights[i]);
    scratch.stretch_weights[at] = static_cast<float>(LimitWeight(job.weights[i], limit) / sum);
  }
}

// The turn by the mean rotation, and shifts that bring each part's centroid to sum w_i c_i, or the
// anchor to its place.
void BatchBlend::Tables::SetPlacing(const BlendJob& job, const BlendOptions& options, int lane,
                                    int lanes, const BlendScratch& scratch) const {
  const RigidModel& model = exact.model();
  const auto row = [&](auto* rows, int k) -> auto& {
    return rows[static_cast<std::size_t>(k) * lanes + lane];
  };
  double angle = 0.0;
  for (std::size_t i = 0; i < job.weights.size(); ++i) {
    angle += job.weights[i] * (model.mean_rotations[i] + 2.0 * std::numbers::pi * model.turns[i]);
  }
  const double c = layout.size * std::cos(angle), s = layout.size * std::sin(angle);
  row(scratch.placing, 0) = static_cast<float>(c);
  row(scratch.placing, 1) = static_cast<float>(s);
  for (int part = 0; part < layout.tables.num_parts; ++part) {
    Point target = Point::Zero();
    for (std::size_t i = 0; i < job.weights.size(); ++i) {
      target += job.weights[i] * model.centroids[i].row(layout.model_part[part]).transpose();
    }
    const std::size_t origin = layout.tables.part_origin[part];
    Point centroid(row(scratch.z_x, static_cast<int>(origin)),
                   row(scratch.z_y, static_cast<int>(origin)));
    const double area = row(scratch.moments, 3 * part);
    if (area > 0.0) {
      centroid += Point(row(scratch.moments, 3 * part + 1), row(scratch.moments, 3 * part + 2)) /
                  (3.0 * area);
    }
    row(scratch.placing, 2 + 2 * part) =
        static_cast<float>(target.x() - (c * centroid.x() - s * centroid.y()));
    row(scratch.placing, 3 + 2 * part) =
        static_cast<float>(target.y() - (s * centroid.x() + c * centroid.y()));
  }
  if (options.anchor) Hold(*options.anchor, job, lane, lanes, scratch);
}

// Shifts all parts alike, so that the anchor comes to its place.
void BatchBlend::Tables::Hold(const MeshPoint& anchor, const BlendJob& job, int lane, int lanes,
                              const BlendScratch& scratch) const {
  const RigidModel& model = exact.model();
  const auto at = [&](int k) { return static_cast<std::size_t>(k) * lanes + lane; };
  const float* const placing = scratch.placing;
  const int part = layout.PartOf(model.triangles(anchor.triangle, 0));
  const Point solved = anchor.In(model.triangles, [&](int v) {
    const std::size_t place = at(layout.place_of[v]);
    return Point(scratch.z_x[place], scratch.z_y[place]);
  });
  const double c = placing[at(0)], s = placing[at(1)];
  const Point now(c * solved.x() - s * solved.y() + placing[at(2 + 2 * part)],
                  s * solved.x() + c * solved.y() + placing[at(3 + 2 * part)]);
  const Point shift = AnchorPlace(anchor, model.triangles, model.poses, job.weights) - now;
  for (int k = 2; k < 2 + 2 * layout.tables.num_parts; ++k) {
    scratch.placing[at(k)] += static_cast<float>(shift[k % 2]);
  }
}

// Counts folds where there may be any.
void BatchBlend::Tables::Finish(BlendJob& job, const BlendOptions& options, int lane, int lanes,
                                const BlendScratch& scratch) const {
  job.folds = 0;
  if (scratch.clear[lane] > 0.0f) return;
  CountFoldsOf(job);
  if (job.folds == 0) return;

  double absolute_area = 0.0;
  const auto vertex = [&](int v) {
    const std::size_t at = 2 * static_cast<std::size_t>(v);
    return Point(job.vertices[at], job.vertices[at + 1]);
  };
  for (const auto& t : exact.model().triangles.rowwise()) {
    absolute_area += std::abs(Cross(vertex(t[0]), vertex(t[1]), vertex(t[2])));
  }
  for (int part = 0; part < layout.tables.num_parts; ++part) {
    const double unit_area = scratch.moments[3 * static_cast<std::size_t>(part) * lanes + lane];
    const double signed_area = layout.size * layout.size * unit_area;
    if (signed_area > kLeastSignedArea * absolute_area) continue;
    PlaceFolded(job, options, lane, lanes, scratch);
    CountFoldsOf(job);
    return;
  }
}

// Where folds leave a part next to no area, its boundary gives no centroid: as RigidBlend places
// it.
void BatchBlend::Tables::PlaceFolded(BlendJob& job, const BlendOptions& options, int lane,
                                     int lanes, const BlendScratch& scratch) const {
  const RigidModel& model = exact.model();
  const BlendTables& tables = layout.tables;
  Points solved(tables.num_vertices, 2);
  for (int p = 0; p < tables.num_vertices; ++p) {
    const std::size_t at = static_cast<std::size_t>(p) * lanes + lane;
    solved.row(layout.factor.order[p]) << scratch.z_x[at], scratch.z_y[at];
  }
  Eigen::Matrix2d turn;
  const double c = scratch.placing[lane], s = scratch.placing[lanes + lane];
  turn << c, -s, s, c;
  solved *= turn.transpose();
  Points shifts = -PartCentroids(model.triangles, solved, model.parts);
  for (std::size_t i = 0; i < job.weights.size(); ++i) {
    shifts += job.weights[i] * model.centroids[i];
  }
  for (Eigen::Index v = 0; v < solved.rows(); ++v) {
    solved.row(v) += shifts.row(model.parts.part_of[v]);
  }
  if (options.anchor) exact.Hold(*options.anchor, WeightsOf(job), &solved);
  std::copy_n(solved.data(), solved.size(), job.vertices);
}

void BatchBlend::Tables::SolveGroup(std::span<BlendJob> jobs, const BlendOptions& options) const {
  const BlendKernel& kernel = BestBlendKernel();
  const int lanes = kernel.lanes, count = static_cast<int>(jobs.size());
  const BlendScratch scratch = ThreadScratch(layout.tables, lanes);
  for (int lane = 0; lane < lanes; ++lane) {  // spare lanes repeat the first
    SetWeights(jobs[lane < count ? lane : 0], options.shear_limit, lane, lanes, scratch);
  }
  kernel.solve_group(layout.tables, std::clamp(options.refits, 0, 3), scratch);
  float* out[16] = {};
  for (int lane = 0; lane < lanes; ++lane) {
    SetPlacing(jobs[lane < count ? lane : 0], options, lane, lanes, scratch);
    if (lane < count) out[lane] = jobs[lane].vertices;
  }
  kernel.place_group(layout.tables, count, scratch, out);
  for (int lane = 0; lane < count; ++lane) Finish(jobs[lane], options, lane, lanes, scratch);
}

void BatchBlend::Tables::SolveAlone(BlendJob& job, const BlendOptions& options) const {
  const BlendKernel& kernel = BestBlendKernel();
  const BlendScratch scratch = ThreadScratch(layout.tables, 1);
  SetWeights(job, options.shear_limit, 0, 1, scratch);
  kernel.solve_alone(layout.tables, std::clamp(options.refits, 0, 3), scratch);
  SetPlacing(job, options, 0, 1, scratch);
  kernel.place_alone(layout.tables, scratch, job.vertices);
  Finish(job, options, 0, 1, scratch);
}

void BatchBlend::Tables::ChoosePolishes() {
  int& polishes = layout.tables.polishes;
  double error = WorstError();
  while (error > kPolishedFrom * layout.size && polishes < kMostPolishes) {
    ++polishes;
    const double polished = WorstError();
    if (polished > 0.75 * error) {  // what is left is not the solve's
      --polishes;
      return;
    }
    error = polished;
  }
}

void BatchBlend::Tables::SolveFast(std::span<BlendJob> jobs, const BlendOptions& options) const {
  // A group takes as long however many of its lanes are used: as long as 3/8 of them alone.
  const auto lanes = static_cast<std::size_t>(BestBlendKernel().lanes);
  while (8 * jobs.size() > 3 * lanes) {
    const std::size_t count = std::min(jobs.size(), lanes);
    SolveGroup(jobs.first(count), options);
    jobs = jobs.subspan(count);
  }
  for (BlendJob& job : jobs) SolveAlone(job, options);
}

void BatchBlend::Tables::SolveExactly(BlendJob& job, const BlendOptions& options) const {
  const Points vertices = exact.At(WeightsOf(job), options);
  std::copy_n(vertices.data(), vertices.size(), job.vertices);
  CountFoldsOf(job);
}

void BatchBlend::Tables::Mend(BlendJob& job, const BlendOptions& options) const {
  const int folds = job.folds;
  Eigen::Map<FloatPoints> vertices(job.vertices, layout.tables.num_vertices, 2);
  const FloatPoints folded = vertices;
  vertices = exact.Mended(vertices.cast<double>(), WeightsOf(job), options).cast<float>();
  CountFoldsOf(job);
  if (job.folds >= folds) {  // in float no better
    vertices = folded;
    job.folds = folds;
  }
  job.mended = folds - job.folds;
}

// The largest distance from the exact blend at the poses and in their midst, without refits.
double BatchBlend::Tables::WorstError() const {
  const int num_poses = layout.tables.num_poses;
  FloatPoints vertices(layout.tables.num_vertices, 2);
  double worst = 0.0;
  for (int i = 0; i <= num_poses; ++i) {
    const Eigen::VectorXd weights = i < num_poses
                                        ? Eigen::VectorXd(Eigen::VectorXd::Unit(num_poses, i))
                                        : Eigen::VectorXd::Constant(num_poses, 1.0 / num_poses);
    BlendJob job{{weights.data(), static_cast<std::size_t>(num_poses)}, vertices.data()};
    BlendOptions once;
    once.refits = 0;
    SolveAlone(job, once);
    worst = std::max(
        worst, (vertices.cast<double>() - exact.At(weights, once)).rowwise().norm().maxCoeff());
  }
  return worst;
}

Result<BatchBlend> BatchBlend::Prepare(const CompatibleMesh& mesh, std::vector<int> turns) {
  auto tables = std::make_shared<Tables>(TRY(RigidBlend::Prepare(mesh, std::move(turns))));
  TRY(tables->layout.Fill(tables->exact.model()));
  tables->ChoosePolishes();
  return BatchBlend(std::move(tables));
}

void BatchBlend::Solve(std::span<BlendJob> jobs, const BlendOptions& options) const {
  const Tables& tables = *tables_;
  const bool is_exact =
      options.method != BlendMethod::kRigid || options.stretch != StretchBlend::kLinear;
  if (is_exact) {
    for (BlendJob& job : jobs) tables.SolveExactly(job, options);
  } else {
    tables.SolveFast(jobs, options);
  }
  for (BlendJob& job : jobs) {
    job.mended = 0;
    if (options.repair && job.folds > 0) tables.Mend(job, options);
  }
}

const RigidBlend& BatchBlend::exact() const { return tables_->exact; }

std::size_t BatchBlend::factor_bytes() const {
  const BlockFactor& factor = tables_->layout.factor;
  return factor.coefficients.size() * sizeof(float) + factor.rows.size() * sizeof(std::int32_t);
}

}  // namespace posespace
