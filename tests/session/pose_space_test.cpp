// SPDX-License-Identifier: Apache-2.0
#include "session/pose_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <thread>

#include "geometry/polygon.h"
#include "session/placements.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::shared_ptr<const PoseSpace> Built(const BuildInputs& inputs) {
  auto built = PoseSpace::Build(inputs);
  EXPECT_THAT(built, Succeeds());
  return built ? *built : nullptr;
}

// A pose space of three creatures that tests share, since it is immutable.
const PoseSpace& Creatures() {
  static const auto pose_space = Built(CreatureInputs(3));
  return *pose_space;
}

Query At(double x, double y) { return {Point(x, y), {}, 0.0}; }

Query With(std::initializer_list<double> weights) {
  Query query{Eigen::VectorXd(static_cast<Eigen::Index>(weights.size())), {}, 0.0};
  std::copy(weights.begin(), weights.end(), std::get<Eigen::VectorXd>(query.position).begin());
  return query;
}

double Distance(const FloatPoints& a, const Points& b) {
  return (a.cast<double>() - b).rowwise().norm().maxCoeff();
}

// Drawing pixels that blends of these small drawings may err by.
constexpr double kBlendError = 5e-4;

TEST(PoseSpace, ReproducesEachDrawingAtItsPlace) {
  const PoseSpace& space = Creatures();
  for (int i = 0; i < 3; ++i) {
    const Point place = space.placements().row(i);
    const auto frame = space.Blend(At(place.x(), place.y()));
    ASSERT_THAT(frame, Succeeds());
    EXPECT_LT(Distance(frame->vertices, space.mesh().poses[i]), kBlendError);
    EXPECT_NEAR(frame->weights[i], 1.0, 1e-9);
    EXPECT_NEAR(frame->texture_weights[i], 1.0, 1e-9);
    EXPECT_EQ(frame->folds, 0);
  }
}

TEST(PoseSpace, HasAMeshThatIsValidInEveryDrawing) {
  const PoseSpace& space = Creatures();
  EXPECT_FALSE(FindDefect(space.mesh()).has_value());
  EXPECT_EQ(space.mesh().num_poses(), 3);
  EXPECT_EQ(space.drawings()[1]->id, "pose1");
}

TEST(PoseSpace, IsOneDrawingEverywhereWhenThereIsOne) {
  const auto space = Built(CreatureInputs(1));
  ASSERT_NE(space, nullptr);
  for (const Query& query : {At(0, 0), At(5, -7), At(1e300, 0), With({1.0})}) {
    const auto frame = space->Blend(query);
    ASSERT_THAT(frame, Succeeds());
    EXPECT_LT(Distance(frame->vertices, space->mesh().poses[0]), kBlendError);
  }
}

TEST(PoseSpace, BlendsManyAsItBlendsOne) {
  std::vector<Query> queries;
  for (int k = 0; k < 40; ++k) {
    queries.push_back(At(0.05 * k - 0.5, 0.03 * k));
    if (k % 3 == 1) queries.back().options.refits = 0;
    if (k % 7 == 2) queries.back().options.method = BlendMethod::kLinear;
    if (k % 10 == 4) queries.back() = At(std::nan(""), 0);
  }
  const auto frames = Creatures().BlendAll(queries);
  ASSERT_EQ(frames.size(), queries.size());
  for (std::size_t k = 0; k < queries.size(); ++k) {
    const auto alone = Creatures().Blend(queries[k]);
    ASSERT_EQ(static_cast<bool>(frames[k]), static_cast<bool>(alone)) << k;
    if (!alone) continue;
    EXPECT_EQ(frames[k]->vertices, alone->vertices) << k;
    EXPECT_EQ(frames[k]->weights, alone->weights) << k;
    EXPECT_EQ(frames[k]->folds, alone->folds) << k;
  }
  EXPECT_TRUE(Creatures().BlendAll({}).empty());
}

TEST(PoseSpace, GivesWeightsThatSumToOneEverywhere) {
  for (const Query& query :
       {At(0, 0), At(0.3, 0.4), At(-40, 7), At(1e300, -1e300), With({0.2, 0.3, 0.5004})}) {
    const auto frame = Creatures().Blend(query);
    ASSERT_THAT(frame, Succeeds());
    EXPECT_NEAR(frame->weights.sum(), 1.0, 1e-9);
    EXPECT_NEAR(frame->texture_weights.sum(), 1.0, 1e-9);
    EXPECT_TRUE(frame->vertices.allFinite());
  }
}

TEST(PoseSpace, KeepsTextureWeightsWithinZeroAndOneForRawWeights) {
  Query query = With({1.5, -0.75, 0.25});
  query.options.shear_limit = ShearLimit::kOff;
  const auto frame = Creatures().Blend(query);
  ASSERT_THAT(frame, Succeeds());
  EXPECT_GE(frame->texture_weights.minCoeff(), 0.0);
  EXPECT_LE(frame->texture_weights.maxCoeff(), 1.0);
  EXPECT_EQ(frame->weights[0], 1.5);
}

TEST(PoseSpace, LeavesVerticesOutWhenOnlyWeightsAreWanted) {
  const auto frame = Creatures().Blend(At(0.1, 0.2), true);
  ASSERT_THAT(frame, Succeeds());
  EXPECT_EQ(frame->vertices.rows(), 0);
  EXPECT_EQ(frame->weights, Creatures().Blend(At(0.1, 0.2))->weights);
}

TEST(PoseSpace, RefusesWhatIsNoQuery) {
  const PoseSpace& space = Creatures();
  EXPECT_THAT(space.Blend(At(kNan, 0)), FailsWith(ErrorCode::kPoseNotFinite, "at"));
  EXPECT_THAT(space.Blend(At(0, kInfinity)), FailsWith(ErrorCode::kPoseNotFinite, "at"));
  EXPECT_THAT(space.Blend(With({})), FailsWith(ErrorCode::kWeightsCountMismatch, "weights"));
  EXPECT_THAT(space.Blend(With({1, 0})), FailsWith(ErrorCode::kWeightsCountMismatch, "weights"));
  EXPECT_THAT(space.Blend(With({1, kNan, 0})),
              FailsWith(ErrorCode::kWeightsNotFinite, "weights[1]"));
  EXPECT_THAT(space.Blend(With({kInfinity, -kInfinity, 1})),
              FailsWith(ErrorCode::kWeightsNotFinite, "weights[0]"));
  EXPECT_THAT(space.Blend(With({1e7, -1e7, 1})),
              FailsWith(ErrorCode::kInvalidOption, "weights[0]"));

  Query refits = At(0, 0), sigma = At(0, 0);
  for (const int bad : {-1, 4}) {
    refits.options.refits = bad;
    EXPECT_THAT(space.Blend(refits), FailsWith(ErrorCode::kInvalidOption, "options.refits"));
  }
  for (const double bad : {-0.1, 1.1, kNan}) {
    sigma.sigma = bad;
    EXPECT_THAT(space.Blend(sigma), FailsWith(ErrorCode::kInvalidOption, "options.sigma"));
  }
}

TEST(PoseSpace, TakesWeightsWhoseSumIsNearlyOne) {
  EXPECT_THAT(Creatures().Blend(With({0.5, 0.4, 0.1009})), Succeeds());
  EXPECT_THAT(Creatures().Blend(With({0.5, 0.4, 0.0991})), Succeeds());
  EXPECT_THAT(Creatures().Blend(With({0.5, 0.4, 0.1011})), FailsWith(ErrorCode::kWeightsSumNotOne));
  EXPECT_THAT(Creatures().Blend(With({0.5, 0.4, 0.0989})), FailsWith(ErrorCode::kWeightsSumNotOne));
  EXPECT_THAT(Creatures().Blend(With({0, 0, 0})), FailsWith(ErrorCode::kWeightsSumNotOne));
}

TEST(PoseSpace, IsTheSameForTheSameInputs) {
  const auto again = Built(CreatureInputs(3));
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(again->revision(), Creatures().revision());
  EXPECT_EQ(again->mesh().triangles, Creatures().mesh().triangles);
  EXPECT_EQ(again->mesh().poses, Creatures().mesh().poses);
  EXPECT_EQ(again->Blend(At(0.2, 0.1))->vertices, Creatures().Blend(At(0.2, 0.1))->vertices);
}

TEST(PoseSpace, KeepsItsMeshAtOtherPlacements) {
  const Points places = PointsOf("0 0, 2 0, 0 3");
  const auto moved = Creatures().WithPlacements(places);
  ASSERT_THAT(moved, Succeeds());
  EXPECT_EQ(&(*moved)->mesh(), &Creatures().mesh());
  EXPECT_EQ((*moved)->mesh_digest(), Creatures().mesh_digest());
  EXPECT_NE((*moved)->revision(), Creatures().revision());

  BuildInputs inputs = CreatureInputs(3);
  inputs.placements = places;
  const auto scratch = Built(inputs);
  ASSERT_NE(scratch, nullptr);
  EXPECT_EQ((*moved)->revision(), scratch->revision());
  EXPECT_EQ((*moved)->Blend(At(0.7, 0.7))->vertices, scratch->Blend(At(0.7, 0.7))->vertices);

  const auto back = (*moved)->WithPlacements(Creatures().placements());
  ASSERT_THAT(back, Succeeds());
  EXPECT_EQ((*back)->revision(), Creatures().revision());
}

TEST(PoseSpace, TurnsTheWayItsPlacementsSay) {
  BuildInputs inputs;
  for (int i = 0; i < 4; ++i) {
    const PolygonSource source{TurnedCreatureRing(1.9 * i), {}, {}};
    inputs.drawings.push_back(DrawingOf("turn" + std::to_string(i), source));
  }
  for (const int row : {0, 20, 40}) {
    Landmark& landmark = inputs.landmarks.emplace_back();
    for (int i = 0; i < 4; ++i) landmark.points.emplace_back(TurnedCreatureRing(1.9 * i).row(row));
  }
  inputs.placements = PointsOf("0 0, 1 0, 2 0, 3 0");
  inputs.options.improvement.target_edge_length = 0.25;
  const auto space = Built(inputs);
  ASSERT_NE(space, nullptr);

  // Each step in the row turns on by 1.9, so half-way between neighbours it is turned by 0.95 more:
  // 5.7 altogether, which is less than a turn but more than a half.
  for (int i = 0; i < 3; ++i) {
    Query query{Eigen::VectorXd::Zero(4).eval(), {}, 0.0};
    auto& weights = std::get<Eigen::VectorXd>(query.position);
    weights[i] = weights[i + 1] = 0.5;
    const auto frame = space->Blend(query);
    ASSERT_THAT(frame, Succeeds());
    const double size = std::sqrt(SignedArea(TurnedCreatureRing(0.0)));
    const Points& pose = space->mesh().poses[0];
    const double angle = 1.9 * i + 0.95;
    const Points centred = pose.rowwise() - Point(100, 100).transpose();
    Eigen::Matrix2d rotation;
    rotation << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    const Points expected =
        (centred * rotation.transpose()).rowwise() + Point(100, 100).transpose();
    EXPECT_LT(Distance(frame->vertices, expected), 0.2 * size) << i;
  }

  const auto circled = space->WithPlacements(PointsOf("0 0, 3 0, 1 0, 2 0"));
  ASSERT_THAT(circled, Succeeds());
  EXPECT_NE((*circled)->turns(), space->turns());
}

TEST(PoseSpace, DrawsItsBlendWithTheDrawingsPixels) {
  BuildInputs inputs;
  for (int i = 0; i < 2; ++i) {
    inputs.drawings.push_back(DrawingOf("pose" + std::to_string(i), CreaturePicture(0.2 * i)));
  }
  inputs.placements = DefaultPlacements(2);
  const auto space = Built(inputs);
  ASSERT_NE(space, nullptr);
  const auto frame = space->Blend(At(0, 0));
  ASSERT_THAT(frame, Succeeds());
  const Image image = space->Render(*frame, space->DefaultView(100, 80));
  ASSERT_EQ(image.width, 100);
  ASSERT_EQ(image.height, 80);
  EXPECT_EQ(image.at(0, 0)[3], 0);
  EXPECT_EQ(image.at(99, 79)[3], 0);

  const View view = space->DefaultView(100, 80);
  const Point middle = (Point(64, 64) - view.origin) * view.scale;
  const std::uint8_t* pixel = image.at(static_cast<int>(middle.x()), static_cast<int>(middle.y()));
  EXPECT_NEAR(pixel[0], 240, 2);
  EXPECT_NEAR(pixel[1], 140, 2);
  EXPECT_NEAR(pixel[2], 20, 2);
  EXPECT_EQ(pixel[3], 255);
}

TEST(PoseSpace, DrawsNothingForAFrameWithoutVertices) {
  const auto frame = Creatures().Blend(At(0, 0), true);
  ASSERT_THAT(frame, Succeeds());
  const Image image = Creatures().Render(*frame, Creatures().DefaultView(20, 10));
  EXPECT_EQ(image.rgba, std::vector<std::uint8_t>(20 * 10 * 4));
}

// Whether all vertices lie in a view of 200 x 100 pixels.
bool IsShown(const View& view, const Points& vertices) {
  return std::all_of(vertices.rowwise().begin(), vertices.rowwise().end(), [&](const auto& vertex) {
    const Point pixel = (Point(vertex.transpose()) - view.origin) * view.scale;
    return pixel.x() > 0 && pixel.x() < 200 && pixel.y() > 0 && pixel.y() < 100;
  });
}

TEST(PoseSpace, ShowsEveryPoseInItsDefaultView) {
  const View view = Creatures().DefaultView(200, 100);
  for (const Points& pose : Creatures().mesh().poses) EXPECT_TRUE(IsShown(view, pose));
}

TEST(PoseSpace, ShowsABentBarHalfwayStraightInItsDefaultView) {
  // A bar bent up and the same bent down: straight between them, and wider than either.
  BuildInputs inputs = CreatureInputs(2);
  for (const int way : {-1, 1}) {
    Points ring(42, 2);
    for (int k = 0; k < 21; ++k) {
      const double angle = way * (k - 10) * 0.14;
      const Point outward(std::sin(angle), -way * std::cos(angle));
      ring.row(k) = (110.0 * outward).transpose();
      ring.row(41 - k) = (90.0 * outward).transpose();
    }
    inputs.drawings[way > 0] = DrawingOf(way > 0 ? "down" : "up", PolygonSource{ring, {}, {}});
  }
  const auto space = Built(inputs);
  ASSERT_NE(space, nullptr);
  const auto halfway = space->Blend(With({0.5, 0.5}));
  ASSERT_THAT(halfway, Succeeds());
  const double width = halfway->vertices.col(0).maxCoeff() - halfway->vertices.col(0).minCoeff();
  EXPECT_GT(width, 240.0);
  EXPECT_TRUE(IsShown(space->DefaultView(200, 100), halfway->vertices.cast<double>()));
}

TEST(PoseSpace, ReportsItsStagesInOrder) {
  std::vector<std::string> stages;
  double last = 0.0;
  Progress progress([&](std::string_view stage, double fraction) {
    if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1.0);
    last = fraction;
  });
  const auto space = PoseSpace::Build(CreatureInputs(2), &progress);
  ASSERT_THAT(space, Succeeds());
  const std::vector<std::string> expected = {"matching",    "simplification", "triangulation",
                                             "improvement", "alignment",      "weights"};
  EXPECT_EQ(stages, expected);
  EXPECT_GE(last, 0.9);

  std::vector<std::string> timed;
  for (const auto& [stage, seconds] : (*space)->report().seconds) timed.push_back(stage);
  EXPECT_EQ(timed, expected);
}

// Whether a person is asked to check a drawing.
bool AsksToCheck(const PoseSpace& space, const std::string& id) {
  return std::any_of(space.warnings().begin(), space.warnings().end(), [&](const auto& warning) {
    return warning.find("'" + id + "'") != std::string::npos;
  });
}

TEST(PoseSpace, AsksToCheckADrawingThatFacesTheOtherWay) {
  BuildInputs inputs = CreatureInputs(4);
  PolygonSource mirrored{CreatureRing(0.0), {}, {}};
  mirrored.outer.col(0) = 200.0 - mirrored.outer.col(0).array();
  inputs.drawings[2] = DrawingOf("mirrored", mirrored);
  const auto space = Built(inputs);
  ASSERT_NE(space, nullptr);
  EXPECT_TRUE(AsksToCheck(*space, "mirrored")) << space->report().confidence[2];
}

TEST(PoseSpace, AsksNothingAboutUnlikeDrawingsThatAPersonHasMarked) {
  BuildInputs inputs = CreatureInputs(2);
  const Points bar = PointsOf("0 90, 200 90, 200 110, 0 110");
  inputs.drawings[1] = DrawingOf("bar", PolygonSource{bar, {}, {}});
  const auto unmarked = Built(inputs);
  ASSERT_NE(unmarked, nullptr);
  EXPECT_TRUE(AsksToCheck(*unmarked, "bar")) << unmarked->report().confidence[1];

  // A mark a quarter of the way each: what lies between two fits its counterpart in length.
  const Points& creature = inputs.drawings[0]->outline.outer;
  const Points quarters = PointsOf("30 90, 185 90, 170 110, 15 110");
  for (int k = 0; k < 4; ++k) {
    const Point on_creature = creature.row(k * creature.rows() / 4).transpose();
    inputs.landmarks.push_back({{on_creature, Point(quarters.row(k).transpose())}});
  }
  const auto marked = Built(inputs);
  ASSERT_NE(marked, nullptr);
  EXPECT_FALSE(AsksToCheck(*marked, "bar")) << testing::PrintToString(marked->warnings());

  // Marks that squeeze nearly the whole creature into the end of the bar are doubted themselves.
  inputs.landmarks.clear();
  for (const int row : {0, 1, 2}) {
    const Point crowded = creature.row(creature.rows() / 24 * row).transpose();
    inputs.landmarks.push_back({{crowded, Point(bar.row(row).transpose())}});
  }
  const auto crowded = Built(inputs);
  ASSERT_NE(crowded, nullptr);
  EXPECT_TRUE(AsksToCheck(*crowded, "bar"));
  EXPECT_THAT(crowded->warnings(), testing::Contains(testing::HasSubstr("check these marks")));
}

TEST(PoseSpace, AsksNothingAboutPosesThatMatchClearly) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(AsksToCheck(Creatures(), "pose" + std::to_string(i)))
        << Creatures().report().confidence[i];
  }
}

TEST(PoseSpace, StopsWhenCancelled) {
  Progress cancelled;
  cancelled.Cancel();
  EXPECT_THAT(PoseSpace::Build(CreatureInputs(3), &cancelled), FailsWith(ErrorCode::kCancelled));
  EXPECT_THAT(Creatures().WithPlacements(PointsOf("0 0, 1 0, 0 1"), &cancelled),
              FailsWith(ErrorCode::kCancelled));
}

TEST(PoseSpace, StopsInAnyStage) {
  for (const char* stage :
       {"matching", "simplification", "triangulation", "improvement", "alignment", "weights"}) {
    Progress* self = nullptr;
    Progress progress([&](std::string_view entered, double) {
      if (entered == stage) self->Cancel();
    });
    self = &progress;
    EXPECT_THAT(PoseSpace::Build(CreatureInputs(3), &progress), FailsWith(ErrorCode::kCancelled))
        << stage;
  }
}

TEST(PoseSpace, ChecksItsInputsBeforeAnyWork) {
  BuildInputs none;
  EXPECT_THAT(PoseSpace::Build(none), FailsWith(ErrorCode::kNoShapes));

  BuildInputs inputs = CreatureInputs(3);
  inputs.placements = PointsOf("0 0, 1 0");
  EXPECT_THAT(PoseSpace::Build(inputs), FailsWith(ErrorCode::kSizeMismatch));
  inputs.placements = PointsOf("0 0, 1 0, 0 0");
  EXPECT_THAT(PoseSpace::Build(inputs),
              FailsWith(ErrorCode::kPlacementsCoincide, "placements['pose2'].at"));
  inputs.placements(1, 1) = kNan;
  EXPECT_THAT(PoseSpace::Build(inputs),
              FailsWith(ErrorCode::kPlacementNotFinite, "placements['pose1'].at"));
  EXPECT_THAT(Creatures().WithPlacements(inputs.placements),
              FailsWith(ErrorCode::kPlacementNotFinite, "placements['pose1'].at"));
  EXPECT_THAT(Creatures().WithPlacements(PointsOf("0 0")), FailsWith(ErrorCode::kSizeMismatch));
}

TEST(PoseSpace, IsBlendedByManyThreadsAlike) {
  const FloatPoints expected = Creatures().Blend(At(0.3, -0.2))->vertices;
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 50; ++k) {
        if (Creatures().Blend(At(0.3, -0.2))->vertices != expected) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(RevisionDigest, DependsOnEveryInput) {
  const BuildInputs base = CreatureInputs(2);
  std::vector<BuildInputs> others(10, base);
  others[0].drawings.pop_back();
  std::swap(others[1].drawings[0], others[1].drawings[1]);
  auto renamed = *base.drawings[0];
  renamed.id = "other";
  others[2].drawings[0] = std::make_shared<const Drawing>(renamed);
  auto redrawn = *base.drawings[0];
  redrawn.digest = "other";
  others[3].drawings[0] = std::make_shared<const Drawing>(redrawn);
  others[4].landmarks.push_back({{Point(1, 2), std::nullopt}});
  others[5].landmarks.push_back({{std::nullopt, Point(1, 2)}});
  others[6].options.simplification.tolerance += 1e-12;
  others[7].options.improvement.target_edge_length += 1e-12;
  others[8].options.triangulation.seed += 1;
  others[9].align = false;
  std::set<std::string> digests = {MeshDigest(base)};
  for (const BuildInputs& other : others) digests.insert(MeshDigest(other));
  EXPECT_EQ(digests.size(), 11u);

  BuildInputs moved = base;
  moved.placements(0, 0) += 1e-12;
  EXPECT_EQ(MeshDigest(moved), MeshDigest(base));
  EXPECT_NE(RevisionDigest(moved), RevisionDigest(base));
  EXPECT_EQ(RevisionDigest(BuildInputs(base)), RevisionDigest(base));
}

}  // namespace
}  // namespace posespace
