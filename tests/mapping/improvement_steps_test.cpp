// SPDX-License-Identifier: Apache-2.0
// The laws of each step of mesh improvement: it keeps every triangle positive in every drawing, and
// the smallest angle never falls below what the caller allows.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "mapping/compatible_triangulation.h"
#include "mapping/mesh_improvement.h"
#include "mapping/mesh_refinement.h"
#include "mapping/mesh_relaxation.h"
#include "mapping/triangle_quality.h"
#include "mapping/vertex_removal.h"
#include "tests/mapping/compatible_mesh_check.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/fails_with.h"

namespace posespace {
namespace {

using Targets = std::vector<double>;

struct Step {
  std::string name;
  // Changes the mesh without a triangle sharper than `sharpest` where there was none.
  std::function<void(EditableMesh&, const Targets&, double sharpest)> run;
};

void PrintTo(const Step& step, std::ostream* out) { *out << step.name; }

const std::vector<Step>& Steps() {
  static const std::vector<Step> steps = {
      {"Smooth", [](EditableMesh& mesh, const Targets&,
                    double sharpest) { SmoothVertices(mesh, sharpest, nullptr); }},
      {"Flip", [](EditableMesh& mesh, const Targets&,
                  double sharpest) { FlipEdges(mesh, sharpest, nullptr); }},
      {"Relax", [](EditableMesh& mesh, const Targets&,
                   double sharpest) { Relax(mesh, 3, 2, sharpest, nullptr); }},
      {"Split",
       [](EditableMesh& mesh, const Targets& targets, double sharpest) {
         SplitLongEdges(mesh, targets, 1.4, sharpest, 500, nullptr);
       }},
      {"Collapse",
       [](EditableMesh& mesh, const Targets& targets, double sharpest) {
         CollapseShortEdges(mesh, targets, 0.8, sharpest, nullptr);
       }},
      {"RemoveAtSharpTriangles", [](EditableMesh& mesh, const Targets&,
                                    double) { RemoveAtSharpTriangles(mesh, 1.0, nullptr); }},
  };
  return steps;
}

class ImprovementStep : public testing::TestWithParam<Step> {};

TEST_P(ImprovementStep, KeepsMeshesValidAndTheirSmallestAngle) {
  int changed = 0;
  for (std::uint64_t seed = 0; seed < 21; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const int count = 1 + static_cast<int>(seed % 3);
    const auto outlines = DrawOutlines(OutlineFamilies()[seed % 7], seed, count, 18);
    const auto triangulated = TriangulateCompatibly(outlines, {});
    ASSERT_THAT(triangulated, Succeeds());
    ImprovementOptions coarse;
    coarse.target_edge_length = 0.2;
    const auto refined = ImproveMesh(triangulated->mesh, coarse);
    ASSERT_THAT(refined, Succeeds());
    for (const CompatibleMesh& mesh : {triangulated->mesh, *refined}) {
      const double sharpest = SharpestOf(mesh);
      EditableMesh editable(mesh);
      GetParam().run(editable, TargetLengths(mesh, 0.15), sharpest);
      const CompatibleMesh after = editable.Finish();
      EXPECT_THAT(after, IsACompatibleDisc());
      EXPECT_LE(SharpestOf(after), sharpest);
      const bool same_size = after.num_vertices() == mesh.num_vertices() &&
                             after.num_triangles() == mesh.num_triangles();
      const bool same = same_size && after.poses == mesh.poses && after.triangles == mesh.triangles;
      changed += same ? 0 : 1;
    }
  }
  EXPECT_GT(changed, 0);
}

INSTANTIATE_TEST_SUITE_P(Steps, ImprovementStep, testing::ValuesIn(Steps()),
                         [](const auto& step) { return step.param.name; });

TEST(RemoveVertex, LeavesNoSharperTriangleThanAllowed) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto outlines = DrawOutlines(OutlineFamilies()[0], seed, 2, 12);
    const auto improved = ImproveMesh(TriangulateCompatibly(outlines, {})->mesh);
    ASSERT_THAT(improved, Succeeds());
    EditableMesh mesh(*improved);
    for (int v = 0; v < mesh.num_vertices(); ++v) {
      if (!mesh.IsLive(v) || mesh.IsFixed(v)) continue;
      const double limit = SharpnessAround(mesh, v), before = SharpestOf(mesh.Finish());
      RemoveVertex(mesh, v, limit);
      EXPECT_LE(SharpestOf(mesh.Finish()), before);
    }
  }
}

}  // namespace
}  // namespace posespace
