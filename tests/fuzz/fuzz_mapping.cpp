// SPDX-License-Identifier: Apache-2.0
// Rings and landmarks through the whole mapping: what is accepted must end as a valid mesh, what is
// refused must say why.
//
//   fuzz_mapping rings|landmarks SECONDS [SEED]   random cases; what fails is left in FOUND.txt
//   fuzz_mapping FOLDER                           the cases in a folder again, as tests/fuzz/corpus
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "drawing/outline.h"
#include "geometry/polygon.h"
#include "mapping/pipeline.h"
#include "tests/fuzz/ring_case.h"
#include "tests/mapping/compatible_mesh_check.h"

namespace posespace {
namespace {

using Clock = std::chrono::steady_clock;

// What a case may be refused for: its own faults.
constexpr std::array kFaults = {
    ErrorCode::kOutlineTooSmall,    ErrorCode::kOutlineNotSimple,    ErrorCode::kOutlineTooLong,
    ErrorCode::kOutlineEmpty,       ErrorCode::kInvalidOption,       ErrorCode::kLandmarkNotFinite,
    ErrorCode::kLandmarkOffOutline, ErrorCode::kLandmarksOutOfOrder, ErrorCode::kMeshTooLarge};

struct Outcome {
  bool accepted = false;
  std::string failure;  // empty: as it should be
};

Outcome Refused(const Error& error) {
  const bool known = std::find(kFaults.begin(), kFaults.end(), error.code) != kFaults.end();
  if (known && !error.message.empty()) return {};
  return {false, std::string(ReasonName(error.code)) + ": " + error.message};
}

Outcome Try(const RingCase& input, Progress* progress) {
  std::vector<MatchingShape> shapes;
  for (const Points& ring : input.rings) {
    auto outline = OutlineFromRings(ring, {});
    if (!outline) return Refused(outline.error());
    shapes.push_back(
        {std::string(1, static_cast<char>('a' + shapes.size())), std::move(outline->outer), {}});
  }
  MappingOptions options;
  options.improvement.target_edge_length = 0.15;  // cases matter more than fine meshes
  const auto mapping = MapShapes(shapes, input.landmarks, options, progress);
  if (!mapping) return Refused(mapping.error());

  testing::StringMatchResultListener said;
  if (!testing::ExplainMatchResult(IsACompatibleDisc(), mapping->mesh, &said)) {
    return {true, "the mesh " + said.str()};
  }
  if (!(mapping->report.min_angle > 0.0)) return {true, "the mesh has an angle of 0"};
  if (mapping->mesh.landmarks.size() != input.landmarks.size()) {
    return {true, "a landmark is no vertex"};
  }
  return {true, ""};
}

int Replay(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  int failed = 0;
  for (const auto& file : files) {
    std::ifstream in(file);
    const Outcome outcome = Try(CaseOf(in), nullptr);
    if (outcome.failure.empty()) continue;
    std::printf("%s: %s\n", file.c_str(), outcome.failure.c_str());
    ++failed;
  }
  std::printf("%zu cases, %d failed\n", files.size(), failed);
  return failed == 0 && !files.empty() ? 0 : 1;
}

int Search(RingCase (*draw)(Random&), double seconds, std::uint64_t seed) {
  constexpr std::chrono::seconds kPatience{60};  // for one case
  const auto start = Clock::now();
  const auto spent = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  int cases = 0, accepted = 0;
  double slowest = 0.0;
  for (; spent() < seconds; ++seed, ++cases) {
    Random random(seed);
    const RingCase input = draw(random);
    const auto began = Clock::now();
    Progress* running = nullptr;
    Progress progress([&](std::string_view, double) {
      if (Clock::now() - began > kPatience) running->Cancel();
    });
    running = &progress;
    std::ofstream("FOUND.txt") << TextOf(input);  // before it is tried: it may crash
    const Outcome outcome = Try(input, &progress);
    slowest = std::max(slowest, std::chrono::duration<double>(Clock::now() - began).count());
    accepted += outcome.accepted ? 1 : 0;
    if (outcome.failure.empty()) continue;
    std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), outcome.failure.c_str());
    return 1;
  }
  std::printf("%d cases up to seed %llu, %d accepted; the slowest took %.1f s\n", cases,
              static_cast<unsigned long long>(seed), accepted, slowest);
  std::remove("FOUND.txt");
  return 0;
}

}  // namespace
}  // namespace posespace

int main(int argc, char** argv) {
  const std::string_view mode = argc > 1 ? argv[1] : "";
  if (mode == "rings" || mode == "landmarks") {
    const double seconds = argc > 2 ? std::strtod(argv[2], nullptr) : 10.0;
    const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
    return posespace::Search(mode == "rings" ? posespace::DrawRings : posespace::DrawLandmarks,
                             seconds, seed);
  }
  if (!std::filesystem::is_directory(mode)) {
    std::puts("usage: fuzz_mapping rings|landmarks [SECONDS [SEED]] | FOLDER");
    return 2;
  }
  return posespace::Replay(mode);
}
