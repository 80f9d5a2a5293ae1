// SPDX-License-Identifier: Apache-2.0
#include "session/digest.h"
#include "session/pose_space.h"

namespace posespace {
namespace {

// Names the algorithms from drawings to mesh, and from mesh to weights: a change of results needs a
// new number, so that nothing built by older code is taken for the same.
constexpr std::string_view kMeshVersion = "posespace-mesh/6";
constexpr std::string_view kRevisionVersion = "posespace-revision/1";

void AddOptions(const MappingOptions& options, Digest& digest) {
  digest.Add(options.matching.position_weight)
      .Add(options.matching.colour_weight)
      .Add(options.matching.stretch_weight)
      .Add(options.matching.thickness_weight)
      .Add(options.matching.max_colour_difference)
      .Add(options.matching.max_landmark_distance);
  digest.Add(options.simplification.tolerance).Add(options.simplification.min_corner_angle);
  digest.Add(static_cast<std::int64_t>(options.triangulation.max_vertices))
      .Add(static_cast<std::int64_t>(options.triangulation.seed));
  digest.Add(options.improvement.target_edge_length)
      .Add(static_cast<std::int64_t>(options.improvement.max_vertices));
}

void AddLandmark(const Landmark& landmark, Digest& digest) {
  digest.Add(static_cast<std::int64_t>(landmark.points.size()));
  for (const auto& point : landmark.points) {
    digest.Add(static_cast<std::int64_t>(point.has_value()));
    if (point) digest.Add(point->x()).Add(point->y());
  }
}

}  // namespace

std::string MeshDigest(const BuildInputs& inputs) {
  Digest digest(kMeshVersion);
  digest.Add(static_cast<std::int64_t>(inputs.drawings.size()));
  for (const auto& drawing : inputs.drawings) digest.Add(drawing->id).Add(drawing->digest);
  digest.Add(static_cast<std::int64_t>(inputs.landmarks.size()));
  for (const Landmark& landmark : inputs.landmarks) AddLandmark(landmark, digest);
  AddOptions(inputs.options, digest);
  digest.Add(static_cast<std::int64_t>(inputs.align));
  return digest.Hex();
}

std::string RevisionDigest(const BuildInputs& inputs) {
  return RevisionDigest(MeshDigest(inputs), inputs.placements);
}

std::string RevisionDigest(const std::string& mesh_digest, const Points& placements) {
  return Digest(kRevisionVersion).Add(mesh_digest).Add(placements).Hex();
}

}  // namespace posespace
