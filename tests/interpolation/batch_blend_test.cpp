// SPDX-License-Identifier: Apache-2.0
#include "interpolation/batch_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "interpolation/blend_kernel.h"
#include "tests/interpolation/counted_allocations.h"
#include "tests/interpolation/sample_meshes.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using Weights = std::vector<Eigen::VectorXd>;

constexpr double kPi = std::numbers::pi;

BatchBlend Prepared(const CompatibleMesh& mesh, std::vector<int> turns = {}) {
  auto blend = BatchBlend::Prepare(mesh, std::move(turns));
  EXPECT_TRUE(blend) << blend.error().message;
  return *blend;
}

struct Found {
  FloatPoints vertices;
  int folds;
};

std::vector<Found> Together(const BatchBlend& blend, const Weights& weights,
                            const BlendOptions& options = {}) {
  const Eigen::Index count = blend.exact().model().poses[0].rows();
  std::vector<Found> found(weights.size(), {FloatPoints(count, 2), -1});
  std::vector<BlendJob> jobs;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    jobs.push_back({{weights[k].data(), static_cast<std::size_t>(weights[k].size())},
                    found[k].vertices.data()});
  }
  blend.Solve(jobs, options);
  for (std::size_t k = 0; k < weights.size(); ++k) found[k].folds = jobs[k].folds;
  return found;
}

Found Alone(const BatchBlend& blend, const Eigen::VectorXd& weights,
            const BlendOptions& options = {}) {
  return Together(blend, {weights}, options)[0];
}

// The root of the poses' mean area.
double SizeOf(const CompatibleMesh& mesh) {
  double sum = 0.0;
  for (const Points& pose : mesh.poses) {
    for (const auto& t : mesh.triangles.rowwise()) {
      sum += 0.5 * Cross(pose.row(t[0]), pose.row(t[1]), pose.row(t[2])) / mesh.num_poses();
    }
  }
  return std::sqrt(sum);
}

// The poses themselves, places among them, and beyond them.
Weights SampleWeights(int num_poses) {
  std::mt19937 random(7);
  Weights weights;
  for (int i = 0; i < num_poses; ++i) weights.push_back(Eigen::VectorXd::Unit(num_poses, i));
  for (int k = 0; k < 10; ++k) weights.push_back(RandomWeights(num_poses, &random));
  for (int k = 0; k < 6; ++k) {
    weights.push_back(1.6 * RandomWeights(num_poses, &random));
    weights.back()[k % num_poses] -= 0.6;
  }
  return weights;
}

// The largest distance from the exact blend, / sum |w_i|.
double WorstError(const CompatibleMesh& mesh, const std::vector<int>& refits = {0, 1, 2, 3}) {
  const BatchBlend blend = Prepared(mesh);
  const Weights weights = SampleWeights(mesh.num_poses());
  double worst = 0.0;
  for (const int count : refits) {
    const auto found = Together(blend, weights, {.refits = count});
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const Points expected = blend.exact().At(weights[k], {.refits = count});
      const double error = Apart(found[k].vertices.cast<double>(), expected);
      worst = std::max(worst, error / weights[k].cwiseAbs().sum());
    }
  }
  return worst;
}

CompatibleMesh Limbs(unsigned seed, int cells_per_unit, double most = 1.0, int num_poses = 4) {
  std::mt19937 random(seed);
  return PlusMesh(cells_per_unit, RandomLimbs(num_poses, most, &random));
}

CompatibleMesh Strip(int columns, int rows) {
  const double length = columns;
  return StripMesh(columns, rows, 1.0, {Bent(length, 0.0), Bent(length, 1.0), Bent(length, -3.0)});
}

TEST(BatchBlend, AgreesWithTheExactBlend) {
  RecordProperty("instructions", BestBlendKernel().instructions);
  for (const int cells : {1, 2, 3, 5, 10}) {  // 45 to 2,981 vertices
    const CompatibleMesh mesh = Limbs(cells, cells, 1.5, 3 + cells % 5);
    EXPECT_LT(WorstError(mesh), 2e-6 * SizeOf(mesh)) << mesh.num_vertices() << " vertices";
  }
}

TEST(BatchBlend, AgreesWithTheExactBlendOnThinStrips) {
  for (const auto& [columns, rows] : {std::pair(20, 1), {100, 1}, {200, 2}, {748, 3}}) {
    const CompatibleMesh mesh = Strip(columns, rows);
    EXPECT_LT(WorstError(mesh, {0, 3}), 5e-6 * SizeOf(mesh)) << columns << " x " << rows;
  }
}

TEST(BatchBlend, AgreesWithTheExactBlendOnThreadsAsFloatAllows) {
  for (const int length : {200, 1500}) {  // up to 3,002 vertices
    EXPECT_LT(WorstError(Strip(length, 1), {0, 3}), 2e-6 * length);
  }
}

TEST(BatchBlend, GivesTheSameBitsAloneAndInAnyBatch) {
  for (const CompatibleMesh& mesh : {Limbs(3, 3, 2.5), Strip(90, 1)}) {  // a polished one, too
    const BatchBlend blend = Prepared(mesh);
    std::mt19937 random(3);
    Weights weights;
    for (int k = 0; k < 37; ++k) weights.push_back(3.0 * RandomWeights(mesh.num_poses(), &random));
    for (Eigen::VectorXd& each : weights) each[0] -= 2.0;
    for (const int refits : {0, 1, 3}) {
      for (const auto limit : {ShearLimit::kBand, ShearLimit::kOff}) {  // off: many fold
        const BlendOptions options{.shear_limit = limit, .refits = refits};
        const auto together = Together(blend, weights, options);
        const auto shifted = Together(blend, {weights.begin() + 5, weights.end()}, options);
        for (std::size_t k = 0; k < weights.size(); ++k) {
          const Found alone = Alone(blend, weights[k], options);
          ASSERT_EQ(together[k].vertices, alone.vertices) << k;
          ASSERT_EQ(together[k].folds, alone.folds);
          if (k < 5) continue;
          ASSERT_EQ(shifted[k - 5].vertices, alone.vertices) << k;
        }
      }
    }
  }
}

TEST(BatchBlend, GivesTheSameBitsToManyThreads) {
  const BatchBlend blend = Prepared(Limbs(4, 2));
  const Weights weights = SampleWeights(4);
  const auto expected = Together(blend, weights);
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (int& count : wrong) {
    threads.emplace_back([&] {
      for (int round = 0; round < 20; ++round) {
        const auto found = Together(blend, weights);
        for (std::size_t k = 0; k < found.size(); ++k) {
          count += found[k].vertices != expected[k].vertices;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

TEST(BatchBlend, AllocatesNothingOnceAThreadHasItsMemory) {
  const CompatibleMesh mesh = Limbs(5, 3);
  const BatchBlend blend = Prepared(mesh);
  const Weights weights = SampleWeights(4);
  std::vector<FloatPoints> vertices(weights.size(), FloatPoints(mesh.num_vertices(), 2));
  std::vector<BlendJob> jobs;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    jobs.push_back({{weights[k].data(), 4}, vertices[k].data()});
  }
  blend.Solve(jobs, {});
  const int before = CountedAllocations();
  blend.Solve(jobs, {});
  blend.Solve({jobs.data(), 1}, {});
  EXPECT_EQ(CountedAllocations(), before);
}

TEST(BatchBlend, CountsTheFoldsOfWhatItGives) {
  const CompatibleMesh mesh = Limbs(6, 3, 2.5);
  const BatchBlend blend = Prepared(mesh);
  std::mt19937 random(6);
  Weights weights;
  for (int k = 0; k < 30; ++k) {
    weights.push_back(3.0 * RandomWeights(4, &random));
    weights.back()[k % 4] -= 2.0;
  }
  int folded = 0;
  for (const Found& found : Together(blend, weights, {.shear_limit = ShearLimit::kOff})) {
    EXPECT_EQ(found.folds, CountFolds(mesh.triangles, Points(found.vertices.cast<double>())));
    folded += found.folds > 0;
  }
  EXPECT_GT(folded, 0);
  EXPECT_LT(folded, 30);
}

TEST(BatchBlend, PlacesWhatFoldsAwayAsTheExactBlendDoes) {
  // Pose 1 is half as wide: without a limit, at w = 3 the bar has turned inside out.
  const CompatibleMesh mesh =
      StripMesh(4, 4, 1.0, {Moved(0.0, {0, 0}), [](const Point& p) -> Point {
                              return {0.5 * p.x(), p.y()};
                            }});
  const BatchBlend blend = Prepared(mesh);
  for (const double w : {1.9, 2.1, 3.0}) {
    const Eigen::Vector2d weights(1.0 - w, w);
    const BlendOptions options{.shear_limit = ShearLimit::kOff, .refits = 0};
    const Points expected = blend.exact().At(weights, options);
    EXPECT_LT(Apart(Alone(blend, weights, options).vertices.cast<double>(), expected), 1e-4) << w;
  }
}

TEST(BatchBlend, HoldsAnAnchorInEveryWayToBlend) {
  const CompatibleMesh mesh = Limbs(6, 3, 2.5);
  const BatchBlend blend = Prepared(mesh);
  const MeshPoint anchor{mesh.num_triangles() / 2, 0.25, 0.625};
  std::mt19937 random(9);
  Weights weights;
  for (int k = 0; k < 20; ++k) weights.push_back(RandomWeights(4, &random));
  weights.push_back(6.0 * weights.back());
  weights.back()[0] -= 5.0;  // folds
  for (const BlendOptions& options :
       {BlendOptions{}, BlendOptions{.refits = 0}, BlendOptions{.repair = true},
        BlendOptions{.stretch = StretchBlend::kLog}, BlendOptions{.method = BlendMethod::kPaper},
        BlendOptions{.method = BlendMethod::kLinear}}) {
    BlendOptions held = options;
    held.anchor = anchor;
    std::vector<FloatPoints> all(weights.size(), FloatPoints(mesh.num_vertices(), 2));
    std::vector<BlendJob> jobs;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      jobs.push_back({{weights[k].data(), 4}, all[k].data()});
    }
    blend.Solve(jobs, held);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const Point wanted = AnchorPlace(anchor, mesh.triangles, mesh.poses,
                                       {weights[k].data(), static_cast<std::size_t>(4)});
      const Point is = anchor.In(
          mesh.triangles, [&](int v) -> Point { return all[k].row(v).cast<double>().transpose(); });
      EXPECT_LT((is - wanted).norm(), 1e-5 * SizeOf(mesh) * weights[k].lpNorm<1>()) << k;

      FloatPoints free(mesh.num_vertices(), 2), alone = free;
      BlendJob freely{{weights[k].data(), 4}, free.data()};
      blend.Solve({&freely, 1}, options);
      BlendJob again{{weights[k].data(), 4}, alone.data()};
      blend.Solve({&again, 1}, held);
      EXPECT_EQ(alone, all[k]) << "alone and in a batch";
      if (again.mended > 0) continue;  // mending may find another way
      const FloatPoints moved = all[k] - free;
      EXPECT_LT((moved.rowwise() - moved.row(0)).cwiseAbs().maxCoeff(),
                2e-5 * SizeOf(mesh) * weights[k].lpNorm<1>())
          << "moved as a whole " << k;
    }
  }
}

TEST(BatchBlend, MendsWhatFoldsWhenAskedAndNothingElse) {
  const CompatibleMesh mesh = Limbs(6, 3, 2.5);
  const BatchBlend blend = Prepared(mesh);
  std::mt19937 random(6);
  Weights weights;
  for (int k = 0; k < 20; ++k) {
    weights.push_back(6.0 * RandomWeights(4, &random));
    weights.back()[k % 4] -= 5.0;
  }
  weights.push_back(RandomWeights(4, &random));
  const auto plain = Together(blend, weights);
  std::vector<FloatPoints> mended(weights.size(), FloatPoints(mesh.num_vertices(), 2));
  int folded = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    BlendJob job{{weights[k].data(), 4}, mended[k].data()};
    blend.Solve({&job, 1}, {.repair = true});
    EXPECT_EQ(job.folds, 0) << k;
    EXPECT_EQ(job.mended, plain[k].folds) << k;
    folded += plain[k].folds > 0;
    if (plain[k].folds > 0) continue;
    EXPECT_EQ(mended[k], plain[k].vertices) << k;
  }
  EXPECT_GT(folded, 0);
}

TEST(BatchBlend, RollsAStripThroughTwoAndAHalfTurnsWithoutAFold) {
  const CompatibleMesh mesh = StripMesh(80, 2, 0.5, {Moved(0.0, {0, 0}), RolledUp});
  EXPECT_LT(WorstError(mesh, {0, 3}), 5e-6 * SizeOf(mesh));
  Weights weights;
  for (int k = 0; k <= 20; ++k) weights.push_back(Eigen::Vector2d(1.0 - 0.05 * k, 0.05 * k));
  for (const Found& found : Together(Prepared(mesh), weights)) EXPECT_EQ(found.folds, 0);
}

TEST(BatchBlend, TurnsTheWayRoundThatTurnsSay) {
  const CompatibleMesh mesh = StripMesh(4, 2, 1.0, {Moved(0.0, {0, 0}), Moved(0.5 * kPi, {0, 0})});
  for (const std::vector<int>& turns : {std::vector{0, 0}, {0, -1}, {5, 5}, {-300, 700}}) {
    const BatchBlend blend = Prepared(mesh, turns);
    for (const double w : {0.0, 0.3, 0.5, 1.2}) {
      const Eigen::Vector2d weights(1.0 - w, w);
      EXPECT_LT(Apart(Alone(blend, weights).vertices.cast<double>(), blend.exact().At(weights)),
                1e-5);
    }
  }
}

TEST(BatchBlend, GivesEveryOtherWayToBlendAsTheExactBlendDoes) {
  const BatchBlend blend = Prepared(Limbs(8, 2));
  const Weights weights = SampleWeights(4);
  for (const BlendOptions& options : {BlendOptions{.method = BlendMethod::kLinear},
                                      {.method = BlendMethod::kPaper},
                                      {.stretch = StretchBlend::kLog},
                                      {.stretch = StretchBlend::kMetric}}) {
    const auto found = Together(blend, weights, options);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      EXPECT_EQ(found[k].vertices, blend.exact().At(weights[k], options).cast<float>());
      EXPECT_EQ(found[k].folds, 0);
    }
  }
}

TEST(BatchBlend, SolvesATriangleAndSeparateParts) {
  CompatibleMesh triangle;
  triangle.triangles.resize(1, 3);
  triangle.triangles << 0, 1, 2;
  triangle.poses = {PointsOf("0 0, 2 0, 0 2"), PointsOf("5 5, 9 5, 5 7")};
  EXPECT_LT(WorstError(triangle), 1e-6 * SizeOf(triangle));
  triangle.poses.resize(1);
  EXPECT_LT(WorstError(triangle), 1e-6 * SizeOf(triangle));

  CompatibleMesh parts;
  parts.triangles.resize(5, 3);
  parts.triangles << 0, 1, 2, 3, 4, 5, 5, 4, 6, 7, 8, 9, 9, 10, 11;  // the last two share a vertex
  parts.poses = {
      PointsOf("0 0, 2 0, 0 2, 10 0, 12 0, 10 2, 13 3, 20 0, 22 0, 20 2, 21 3, 18 4"),
      PointsOf("0 0, 2 0, 0 2, 10 9, 12 9, 10 11, 12 12, 0 20, 0 23, -2 20, -3 21, -4 18")};
  for (const Points& pose : parts.poses) ASSERT_EQ(CountFolds(parts.triangles, pose), 0);
  EXPECT_LT(WorstError(parts), 1e-6 * 30);
}

TEST(BatchBlend, KeepsItsDigitsInAnyUnitAndAnywhere) {
  const CompatibleMesh mesh = Limbs(7, 2);
  for (const double scale : {1e-9, 1e-3, 1e3, 1e9}) {
    CompatibleMesh scaled = mesh;
    for (Points& pose : scaled.poses) pose *= scale;
    EXPECT_LT(WorstError(scaled), 2e-6 * SizeOf(scaled));
  }
  CompatibleMesh far = mesh;
  const Eigen::RowVector2d offset(1e5, -2e5);
  for (Points& pose : far.poses) pose.rowwise() += offset;
  EXPECT_LT(WorstError(far), 2.5e5 * 1.2e-7);  // float32's own rounding there
}

TEST(BatchBlend, StaysFiniteAtAbsurdWeights) {
  const BatchBlend blend = Prepared(Limbs(9, 2));
  for (const auto limit : {ShearLimit::kBand, ShearLimit::kOff}) {
    const Eigen::Vector4d weights(1e6, -1e6, 0.5, 0.5);
    EXPECT_TRUE(Alone(blend, weights, {.shear_limit = limit}).vertices.allFinite());
  }
}

TEST(BatchBlend, RefusesWhatTheExactBlendRefuses) {
  EXPECT_FALSE(BatchBlend::Prepare(CompatibleMesh{}));
  EXPECT_FALSE(BatchBlend::Prepare(Limbs(1, 1), {0, 1}));
}

}  // namespace
}  // namespace posespace
