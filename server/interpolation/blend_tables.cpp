// SPDX-License-Identifier: Apache-2.0
#include "interpolation/blend_tables.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <numeric>
#include <utility>

namespace posespace {
namespace {

using Indices = std::vector<std::int32_t>;

constexpr int kNobody = -1;

// The triangles part by part in the order of their first place, each part filled up to whole
// blocks with kNobody.
Indices TriangleSlots(const Triangles& places, const Indices& part_of_place, int num_parts) {
  std::vector<Indices> of_part(static_cast<std::size_t>(num_parts));
  for (Eigen::Index t = 0; t < places.rows(); ++t) {
    of_part[part_of_place[places(t, 0)]].push_back(static_cast<std::int32_t>(t));
  }
  Indices slots;
  for (Indices& part : of_part) {
    std::stable_sort(part.begin(), part.end(), [&](std::int32_t a, std::int32_t b) {
      return places.row(a).minCoeff() < places.row(b).minCoeff();
    });
    slots.insert(slots.end(), part.begin(), part.end());
    while (slots.size() % kTriangleBlock != 0) slots.push_back(kNobody);
  }
  return slots;
}

template <typename T>
AlignedArray<T> Aligned(std::size_t count) {
  auto array = hwy::AllocateAligned<T>(std::max<std::size_t>(count, 1));
  if (!array) throw std::bad_alloc();
  std::fill_n(array.get(), count, T{});
  return array;
}

}  // namespace

Result<void> BlendLayout::Fill(const RigidModel& model) {
  const auto& [gradients, areas, masses, rotations, stretches] = model.rigid;
  const int num_poses = static_cast<int>(model.poses.size());
  const Eigen::Index num_triangles = model.triangles.rows();
  const int num_vertices = static_cast<int>(model.parts.part_of.size());
  size = std::sqrt(areas.sum());

  factor = TRY(BlockFactor::Factor(NormalMatrix(model.triangles, model.parts, gradients, masses)));
  coefficients = Aligned<float>(factor.coefficients.size());
  std::copy(factor.coefficients.begin(), factor.coefficients.end(), coefficients.get());

  // Parts are the matrix's components: each is a run of places.
  part_begin.assign(factor.components.begin(), factor.components.end());
  const int num_parts = static_cast<int>(part_begin.size());
  part_begin.push_back(num_vertices);
  place_of.resize(factor.order.size());
  Indices part_of_place(factor.order.size());
  for (int part = 0; part < num_parts; ++part) {
    model_part.push_back(model.parts.part_of[factor.order[part_begin[part]]]);
    for (int p = part_begin[part]; p < part_begin[part + 1]; ++p) {
      place_of[factor.order[p]] = p;
      part_of_place[p] = part;
    }
  }

  // Triangles, and what each place sums of them.
  const Triangles places = model.triangles.unaryExpr([&](int vertex) { return place_of[vertex]; });
  const Indices slots = TriangleSlots(places, part_of_place, num_parts);
  const std::size_t num_blocks = slots.size() / kTriangleBlock;
  const std::size_t stride =
      (4 * static_cast<std::size_t>(num_poses) + kGradientRows) * kTriangleBlock;
  triangle_numbers = Aligned<float>(num_blocks * stride);
  corners = Aligned<std::int32_t>(slots.size() * 3);
  std::vector<Indices> pulls(factor.order.size());
  Eigen::VectorXd mean(num_poses);
  for (int i = 0; i < num_poses; ++i) {
    mean[i] = model.mean_rotations[i] + 2.0 * std::numbers::pi * model.turns[i];
  }
  for (std::size_t slot = 0; slot < slots.size(); ++slot) {
    const std::size_t block = slot / kTriangleBlock, k = slot % kTriangleBlock;
    float* const numbers = triangle_numbers.get() + block * stride + k;
    std::int32_t* const corner = corners.get() + block * 3 * kTriangleBlock + k;
    const Eigen::Index t = slots[slot];
    if (t == kNobody) {
      for (int c = 0; c < 3; ++c) corner[c * kTriangleBlock] = corner[c * kTriangleBlock - 1];
      continue;
    }
    const double mass = masses[t] / (size * size);
    for (int i = 0; i < num_poses; ++i) {
      float* const pose = numbers + static_cast<std::size_t>(4 * i) * kTriangleBlock;
      pose[0] = static_cast<float>(rotations(t, i) - mean[i]);
      for (int s = 0; s < 3; ++s) {
        pose[(1 + s) * kTriangleBlock] =
            static_cast<float>(mass * stretches(s * num_triangles + t, i));
      }
    }
    float* const rest = numbers + 4 * static_cast<std::size_t>(num_poses) * kTriangleBlock;
    for (int g = 0; g < 4; ++g) {
      rest[g * kTriangleBlock] = static_cast<float>(gradients(t, 2 + g) * size);
    }
    rest[4 * kTriangleBlock] = static_cast<float>(mass);
    for (int c = 0; c < 3; ++c) {
      corner[c * kTriangleBlock] = places(t, c);
      pulls[places(t, c)].push_back(
          static_cast<std::int32_t>((block * 3 + c) * kTriangleBlock + k));
    }
  }
  incident_begin.assign(1, 0);
  for (const Indices& each : pulls) {
    incident.insert(incident.end(), each.begin(), each.end());
    incident_begin.push_back(static_cast<std::int32_t>(incident.size()));
  }

  // Boundary edges run with their triangle on the left, as cross products count its area.
  std::vector<Indices> edges(static_cast<std::size_t>(num_parts));
  const Edges all_edges = EdgesOf(places);
  for (const auto& edge : all_edges.rowwise()) {
    if (edge[3] >= 0) continue;
    int a = 0;
    while (places(edge[2], a) != edge[0]) ++a;
    const bool forwards = places(edge[2], (a + 1) % 3) == edge[1];
    Indices& part = edges[part_of_place[edge[0]]];
    part.push_back(forwards ? edge[0] : edge[1]);
    part.push_back(forwards ? edge[1] : edge[0]);
  }
  boundary_begin.assign(1, 0);
  for (int part = 0; part < num_parts; ++part) {
    boundary.insert(boundary.end(), edges[part].begin(), edges[part].end());
    boundary_begin.push_back(static_cast<std::int32_t>(boundary.size() / 2));
    const auto distance = [&](int place) {
      return (model.poses[0].row(factor.order[place]) - model.centroids[0].row(model_part[part]))
          .squaredNorm();
    };
    int nearest = part_begin[part];
    for (int p = nearest; p < part_begin[part + 1]; ++p) {
      if (distance(p) < distance(nearest)) nearest = p;
    }
    part_origin.push_back(nearest);
  }

  tables = {num_poses,
            num_vertices,
            static_cast<int>(num_blocks),
            num_parts,
            triangle_numbers.get(),
            corners.get(),
            incident.data(),
            incident_begin.data(),
            boundary.data(),
            boundary_begin.data(),
            part_origin.data(),
            part_begin.data(),
            /*polishes=*/0,
            &factor,
            coefficients.get()};
  return {};
}

int BlendLayout::PartOf(int vertex) const {
  const auto after = std::upper_bound(part_begin.begin(), part_begin.end(), place_of[vertex]);
  return static_cast<int>(after - part_begin.begin()) - 1;
}

}  // namespace posespace
