// SPDX-License-Identifier: Apache-2.0
#include "session/interior_stage.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "drawing/alignment.h"
#include "interpolation/rigid_blend.h"

namespace posespace {
namespace {

// Aligns, and writes the ghost losses and the new smallest angle to the report.
Result<void> Align(std::span<const std::shared_ptr<const Drawing>> drawings, Mapping* mapping,
                   Progress* progress) {
  const int count = static_cast<int>(drawings.size());
  std::vector<ReducedTexture> textures;
  for (const auto& drawing : drawings) {
    if (IsCancelled(progress)) {
      return Error{ErrorCode::kCancelled, "the alignment was cancelled", {}};
    }
    textures.push_back(Reduce(TextureOf(*drawing), AlignmentSize(count)));
  }
  const bool plain = std::all_of(textures.begin(), textures.end(),
                                 [](const ReducedTexture& each) { return each.plain; });
  if (count < 2 || plain) return {};

  const auto blend = TRY(RigidBlend::Prepare(mapping->mesh));
  const Points common = blend.At(Eigen::VectorXd::Constant(count, 1.0 / count));
  Alignment aligned = TRY(AlignInteriors(mapping->mesh, common, textures, progress));

  mapping->mesh.poses = std::move(aligned.poses);
  MappingReport& report = mapping->report;
  report.min_angle = MinAngle(mapping->mesh);
  aligned.each.insert(aligned.each.begin(), aligned.all);
  for (const GhostChange& change : aligned.each) {
    report.ghosts_before.push_back(change.before);
    report.ghosts_after.push_back(change.after);
  }
  return {};
}

}  // namespace

Result<void> AlignMapping(std::span<const std::shared_ptr<const Drawing>> drawings,
                          Mapping* mapping, Progress* progress) {
  const auto start = std::chrono::steady_clock::now();
  TRY(Align(drawings, mapping, progress));
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  mapping->report.seconds.emplace_back("alignment", spent.count());
  return {};
}

}  // namespace posespace
