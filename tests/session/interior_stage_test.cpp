// SPDX-License-Identifier: Apache-2.0
#include "session/interior_stage.h"

#include <gtest/gtest.h>

#include "drawing/png_file.h"
#include "geometry/polygon.h"
#include "session/placements.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

// A disc that looks to where its eye is.
std::shared_ptr<const Drawing> Ball(const std::string& id, double eye_x, double eye_y) {
  Image image = PictureOf(160, 160);
  PaintDisc(&image, 80, 80, 70, kBlue);
  PaintDisc(&image, eye_x, eye_y, 18, kWhite);
  PaintDisc(&image, eye_x, eye_y, 9, kBlack);
  return DrawingOf(id, ImageSource{EncodePng(image)});
}

BuildInputs Balls() {
  BuildInputs inputs;
  inputs.drawings = {Ball("left", 72, 80), Ball("right", 88, 80), Ball("down", 80, 92)};
  inputs.placements = DefaultPlacements(3);
  return inputs;
}

Mapping MappingOf(const BuildInputs& inputs) {
  auto mapping = MapShapes(MatchingShapesOf(inputs.drawings), inputs.landmarks, inputs.options);
  EXPECT_THAT(mapping, Succeeds());
  return std::move(*mapping);
}

TEST(AlignMapping, LowersTheGhostLossAndSaysSo) {
  const BuildInputs inputs = Balls();
  Mapping mapping = MappingOf(inputs);
  const CompatibleMesh given = mapping.mesh;
  ASSERT_THAT(AlignMapping(inputs.drawings, &mapping, nullptr), Succeeds());
  ASSERT_EQ(mapping.report.ghosts_before.size(), 4u);
  ASSERT_EQ(mapping.report.ghosts_after.size(), 4u);
  EXPECT_LT(mapping.report.ghosts_after[0], 0.5 * mapping.report.ghosts_before[0]);
  EXPECT_EQ(mapping.report.seconds.back().first, "alignment");
  EXPECT_NE(mapping.mesh.poses, given.poses);
  EXPECT_EQ(mapping.mesh.triangles, given.triangles);
  EXPECT_FALSE(FindDefect(mapping.mesh).has_value());
  EXPECT_EQ(mapping.report.min_angle, MinAngle(mapping.mesh));
}

TEST(AlignMapping, SaysNothingOfGhostsWhereThereIsNothingToAlign) {
  for (const int count : {1, 3}) {
    const BuildInputs inputs = CreatureInputs(count);
    Mapping mapping = MappingOf(inputs);
    const CompatibleMesh given = mapping.mesh;
    ASSERT_THAT(AlignMapping(inputs.drawings, &mapping, nullptr), Succeeds());
    EXPECT_EQ(mapping.mesh.poses, given.poses);
    EXPECT_TRUE(mapping.report.ghosts_before.empty());
    EXPECT_TRUE(mapping.report.ghosts_after.empty());
  }
}

TEST(AlignMapping, StopsWhenCancelled) {
  const BuildInputs inputs = Balls();
  Mapping mapping = MappingOf(inputs);
  Progress cancelled;
  cancelled.Cancel();
  EXPECT_THAT(AlignMapping(inputs.drawings, &mapping, &cancelled),
              FailsWith(ErrorCode::kCancelled));
}

TEST(PoseSpace, KeepsTheMeshOfTheMappingBitForBitWhenAlignmentIsOff) {
  BuildInputs inputs = Balls();
  inputs.align = false;
  const auto space = PoseSpace::Build(inputs);
  ASSERT_THAT(space, Succeeds());
  EXPECT_EQ((*space)->mesh().poses, MappingOf(inputs).mesh.poses);
  EXPECT_TRUE((*space)->report().ghosts_before.empty());
}

TEST(PoseSpace, BlendsTheAlignedVertices) {
  const BuildInputs inputs = Balls();
  const auto space = PoseSpace::Build(inputs);
  ASSERT_THAT(space, Succeeds());
  EXPECT_FALSE((*space)->report().ghosts_before.empty());
  for (int i = 0; i < 3; ++i) {
    const auto frame = (*space)->Blend({Point(inputs.placements.row(i)), {}, 0.0});
    ASSERT_THAT(frame, Succeeds());
    const Points vertices = frame->vertices.cast<double>();
    EXPECT_LT((vertices - (*space)->mesh().poses[i]).rowwise().norm().maxCoeff(), 1e-3);
  }
}

}  // namespace
}  // namespace posespace
