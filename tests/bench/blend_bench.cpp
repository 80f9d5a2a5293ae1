// SPDX-License-Identifier: Apache-2.0
// How long a blend takes: see tests/bench/README.md.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "interpolation/batch_blend.h"
#include "interpolation/pose_weights.h"
#include "tests/bench/eigen_blend.h"
#include "tests/interpolation/sample_meshes.h"

namespace posespace {
namespace {

constexpr int kBatch = 64;  // poses solved together
constexpr int kDefaultRefits = BlendOptions().refits;

// A bar three times as long as wide, bent and stretched into N poses, with `kBatch` places among
// them to blend at.
struct Scene {
  Scene(int rows, int num_poses) {
    std::vector<Deformation> poses;
    for (int i = 0; i < num_poses; ++i) {
      const double share = static_cast<double>(i) / num_poses;
      const Deformation bent = Bent(3.0 * rows, 4.0 * share - 2.0);
      poses.push_back([=](const Point& p) -> Point {
        return bent({p.x(), (1.0 + 0.3 * share) * p.y()});
      });
    }
    const CompatibleMesh mesh = StripMesh(3 * rows, rows, 1.0, poses);
    vertices = mesh.num_vertices();
    blend = std::make_unique<BatchBlend>(*BatchBlend::Prepare(mesh));
    eigen = std::make_unique<EigenBlend>(blend->exact().model());
    std::mt19937 random(1);
    out.resize(kBatch, 2 * static_cast<std::size_t>(vertices));
    for (int k = 0; k < kBatch; ++k) weights.push_back(RandomWeights(num_poses, &random));
    for (int k = 0; k < kBatch; ++k) {
      jobs.push_back({{weights[k].data(), static_cast<std::size_t>(num_poses)}, out.row(k).data()});
    }
    for (const Points& pose : mesh.poses) {
      float_poses.push_back(pose.cast<float>());
    }
  }

  int vertices;
  std::unique_ptr<BatchBlend> blend;
  std::unique_ptr<EigenBlend> eigen;
  std::vector<Eigen::VectorXd> weights;
  std::vector<FloatPoints> float_poses;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> out;
  std::vector<BlendJob> jobs;

  // Each blends all kBatch places.
  void Batch(int refits) { blend->Solve(jobs, {.refits = refits}); }
  void Single(int refits) {
    for (BlendJob& job : jobs) blend->Solve({&job, 1}, {.refits = refits});
  }
  void Eigens(int refits) {
    for (int k = 0; k < kBatch; ++k) {
      jobs[k].folds = eigen->Solve(weights[k], refits);
      std::memcpy(jobs[k].vertices, eigen->vertices().data(),
                  sizeof(float) * eigen->vertices().size());
    }
  }
  void Linear(int /*refits*/) {
    for (int k = 0; k < kBatch; ++k) {
      Eigen::Map<FloatPoints> to(jobs[k].vertices, vertices, 2);
      to = static_cast<float>(weights[k][0]) * float_poses[0];
      for (std::size_t i = 1; i < float_poses.size(); ++i) {
        to += static_cast<float>(weights[k][i]) * float_poses[i];
      }
    }
  }
};

Scene& SceneOf(int rows, int num_poses) {
  static std::map<std::pair<int, int>, std::unique_ptr<Scene>> scenes;
  auto& scene = scenes[{rows, num_poses}];
  if (!scene) scene = std::make_unique<Scene>(rows, num_poses);
  return *scene;
}

// Reads what a blend reads of the pose space and nothing else: the least that one blend alone, or
// each group of a batch, can take.
std::size_t BytesRead(const Scene& scene) {
  const std::size_t triangles = scene.blend->exact().model().triangles.rows();
  const std::size_t poses = scene.weights[0].size();
  const std::size_t per_triangle = (4 * poses + 5) * sizeof(float) + 3 * sizeof(std::int32_t);
  return triangles * per_triangle + scene.blend->factor_bytes();
}

void Floor(benchmark::State& state, int rows, int num_poses) {
  const std::size_t count = BytesRead(SceneOf(rows, num_poses)) / sizeof(std::uint64_t);
  std::vector<std::uint64_t> memory(count, 1);
  for (auto _ : state) {
    std::uint64_t sums[8] = {};
    for (std::size_t k = 0; k + 8 <= count; k += 8) {
      for (int lane = 0; lane < 8; ++lane) sums[lane] += memory[k + lane];
    }
    benchmark::DoNotOptimize(sums);
  }
  state.counters["bytes"] = static_cast<double>(count * sizeof(std::uint64_t));
}

void Weigh(benchmark::State& state, int num_poses) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  const Points placements =
      Points::NullaryExpr(num_poses, 2, [&](Eigen::Index, Eigen::Index) { return place(random); });
  const PoseWeights weights = PoseWeights::Fit(placements).value();
  const Points asked =
      Points::NullaryExpr(1024, 2, [&](Eigen::Index, Eigen::Index) { return place(random); });
  std::vector<double> found(static_cast<std::size_t>(num_poses));
  Eigen::Index k = 0;
  for (auto _ : state) {
    weights.At(asked.row(k++ % asked.rows()).transpose(), found);
    benchmark::DoNotOptimize(found.data());
  }
}

constexpr int kUsualRows = 10, kUsualPoses = 6;  // 341 vertices

void Register() {
  for (const int num_poses : {2, 4, 8, 16}) {
    benchmark::RegisterBenchmark(("weights/poses:" + std::to_string(num_poses)).c_str(),
                                 [=](benchmark::State& state) { Weigh(state, num_poses); });
  }
  using Run = void (Scene::*)(int);
  const std::pair<const char*, Run> runs[] = {{"batch", &Scene::Batch},
                                              {"single", &Scene::Single},
                                              {"eigen", &Scene::Eigens},
                                              {"linear", &Scene::Linear}};
  for (const int rows : {5, kUsualRows, 18, 31}) {  // 96, 341, 1045, 3008 vertices
    for (const int num_poses : {2, kUsualPoses, 16}) {
      const std::string shape = "/vertices:" + std::to_string((3 * rows + 1) * (rows + 1)) +
                                "/poses:" + std::to_string(num_poses);
      benchmark::RegisterBenchmark(("floor" + shape).c_str(), [=](benchmark::State& state) {
        Floor(state, rows, num_poses);
      })->Unit(benchmark::kMicrosecond);
      const bool usual = rows == kUsualRows && num_poses == kUsualPoses;
      for (const int refits : usual ? std::vector{0, 1, 2, 3} : std::vector{0, 3}) {
        for (const auto& [kind, run] : runs) {
          if (run == &Scene::Linear && refits > 0) continue;
          const std::string name =
              std::string(kind) + "/vertices:" + std::to_string((3 * rows + 1) * (rows + 1)) +
              "/poses:" + std::to_string(num_poses) + "/refits:" + std::to_string(refits);
          benchmark::RegisterBenchmark(name.c_str(), [=, run = run](benchmark::State& state) {
            Scene& scene = SceneOf(rows, num_poses);
            for (auto _ : state) (scene.*run)(refits);
            state.counters["seconds_per_pose"] =
                benchmark::Counter(kBatch * static_cast<double>(state.iterations()),
                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
          })->Unit(benchmark::kMicrosecond);
        }
      }
    }
  }
}

double ThreadSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Seconds of this thread's CPU that one call takes: the least of a few.
template <typename Call>
double Seconds(Call call) {
  double least = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double start = ThreadSeconds();
    call();
    least = std::min(least, ThreadSeconds() - start);
  }
  return least;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// Two threads that blend at once with one pose space, over two that have one each: 1 when sharing
// costs nothing.
void PrintSharing(int rounds) {
  Scene first(kUsualRows, kUsualPoses), second(kUsualRows, kUsualPoses);
  const auto rate =
      [&](const BatchBlend& blend) {  // batches a second, the second thread's by `blend`
        constexpr int kCalls = 50;
        const auto start = std::chrono::steady_clock::now();
        const auto work = [](const BatchBlend& with, std::vector<BlendJob>& jobs) {
          for (int call = 0; call < kCalls; ++call) with.Solve(jobs, {.refits = 0});
        };
        std::jthread other([&] { work(*first.blend, first.jobs); });
        work(blend, second.jobs);
        other.join();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        return kCalls / took.count();
      };
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    const double own = rate(*second.blend);
    ratios.push_back(rate(*first.blend) / own);
  }
  std::printf("ratio blend.shared_vs_own %.2f\n", Median(ratios));
}

// The median over rounds in which all three take turns, so that a busy machine slows them alike.
void PrintRatios(int rounds) {
  Scene& scene = SceneOf(kUsualRows, kUsualPoses);
  const auto print = [&](int refits, const char* batch_name, const char* single_name) {
    std::vector<double> batch, single;
    for (int round = 0; round < rounds; ++round) {
      const double eigen = Seconds([&] { scene.Eigens(refits); });
      batch.push_back(eigen / Seconds([&] { scene.Batch(refits); }));
      single.push_back(eigen / Seconds([&] { scene.Single(refits); }));
    }
    std::printf("ratio %s %.2f\n", batch_name, Median(batch));
    std::printf("ratio %s %.2f\n", single_name, Median(single));
  };
  print(0, "blend.batch_vs_eigen", "blend.single_vs_eigen");
  print(kDefaultRefits, "blend.batch_vs_eigen_refit", "blend.single_vs_eigen_refit");
}

}  // namespace
}  // namespace posespace

int main(int argc, char** argv) {
  bool quick = false;
  std::vector<char*> arguments;
  for (int k = 0; k < argc; ++k) {
    if (std::strcmp(argv[k], "--quick") == 0) {
      quick = true;
    } else {
      arguments.push_back(argv[k]);
    }
  }
  std::string less_time = "--benchmark_min_time=0.02";
  if (quick) arguments.insert(arguments.begin() + 1, less_time.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  posespace::Register();
  benchmark::RunSpecifiedBenchmarks();
  posespace::PrintRatios(quick ? 15 : 101);
  posespace::PrintSharing(quick ? 15 : 101);
  return 0;
}
