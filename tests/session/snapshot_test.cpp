// SPDX-License-Identifier: Apache-2.0
#include "session/snapshot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "session/byte_stream.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr auto kCorrupt = ErrorCode::kSnapshotCorrupt;

// Cut short at many places and with bits flipped at many places, evenly spread.
template <typename Read>
void ExpectRefusesDamage(const Bytes& bytes, Read read) {
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 100);
  for (std::size_t k = 0; k < bytes.size(); k += step) {
    EXPECT_THAT(read(Bytes(bytes.begin(), bytes.begin() + k)), FailsWith(kCorrupt)) << k;
    Bytes flipped = bytes;
    flipped[k] ^= static_cast<std::uint8_t>(1 << (k % 8));
    EXPECT_THAT(read(flipped), FailsWith(kCorrupt)) << k;
  }
}

// What a checksum cannot catch: well sealed, but cut or changed before.
template <typename Read>
void ExpectSurvivesSealedDamage(const Bytes& bytes, std::string_view kind, Read read) {
  constexpr std::size_t kHeader = 84;
  const std::span<const std::uint8_t> payload = std::span(bytes).subspan(kHeader);
  const std::size_t step = std::max<std::size_t>(1, payload.size() / 100);
  for (std::size_t k = 0; k < payload.size(); k += step) {
    EXPECT_THAT(read(Seal(kind, 1, payload.first(k))), FailsWith(kCorrupt)) << k;
    Bytes changed(payload.begin(), payload.end());
    changed[k] ^= 0xff;
    (void)read(Seal(kind, 1, changed));  // may make sense by chance; must come back
  }
}

SessionRecord SampleRecord() {
  SessionRecord record;
  record.id = "tux";
  record.display_name = "Tux \xf0\x9f\x90\xa7";
  record.labels = {{"owner", "me"}, {"empty", ""}};
  record.nonce = "n0nce";
  record.version = 12;
  record.created = std::chrono::system_clock::time_point(std::chrono::nanoseconds(1'700'000'000));
  record.updated = record.created + std::chrono::nanoseconds(123'456'789);
  record.drawings = {{"walk", "d1"}, {"jump", "d2"}};
  record.correspondences = {{{"walk", Point(1, 2)}, {"jump", Point(-3.5, 0.1)}}, {}};
  record.placements = {{"walk", Point(0, 0)}, {"jump", Point(0, 1)}};
  record.builds = 5;
  record.build_id = "4";
  BuildSummary built;
  built.revision = "r";
  built.vertices = 10;
  built.triangles = 12;
  built.shape_ids = {"walk", "jump"};
  built.mapping.outline_vertices = 9;
  built.mapping.steiner_vertices = 1;
  built.mapping.levels = {{{2, 0}, {1, 0}, {1, 1}, {0, 0}, {0, 0}}};
  built.mapping.min_angle = 0.25;
  built.mapping.confidence = {0.5, 1};
  built.mapping.seconds = {{"matching", 0.5}, {"weights", 0.25}};
  built.warnings = {"please check"};
  record.built = built;
  record.built_from = {{"walk", "d0"}, {"jump", "d2"}};
  return record;
}

TEST(SessionRecord, ComesBackAsItWas) {
  const SessionRecord record = SampleRecord();
  const auto again = SessionRecordFromBytes(ToBytes(record));
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ(ToBytes(*again), ToBytes(record));
  EXPECT_EQ(again->display_name, record.display_name);
  EXPECT_EQ(again->labels, record.labels);
  EXPECT_EQ(again->updated, record.updated);
  EXPECT_EQ(again->correspondences, record.correspondences);
  EXPECT_EQ(again->placements, record.placements);
  ASSERT_TRUE(again->built.has_value());
  EXPECT_EQ(again->built->mapping.seconds, record.built->mapping.seconds);
  EXPECT_EQ(again->built->warnings, record.built->warnings);
  EXPECT_EQ(again->built_from[0].digest, "d0");
}

TEST(SessionRecord, OfANewSessionComesBackToo) {
  SessionRecord record;
  record.id = "tux";
  const auto again = SessionRecordFromBytes(ToBytes(record));
  ASSERT_THAT(again, Succeeds());
  EXPECT_FALSE(again->built.has_value());
}

TEST(SessionRecord, IsNeverMadeOfDamagedBytes) {
  ExpectRefusesDamage(ToBytes(SampleRecord()), SessionRecordFromBytes);
  ExpectSurvivesSealedDamage(ToBytes(SampleRecord()), "sess", SessionRecordFromBytes);
}

Drawing SampleDrawing() { return Packed(*DrawingOf("walk", CreaturePicture(0.1))); }

TEST(DrawingSnapshot, ComesBackWithOutlineAndPixels) {
  const auto drawing = DrawingOf("walk", CreaturePicture(0.1));
  const Bytes bytes = ToBytes(Packed(*drawing));
  const auto again = DrawingFromBytes({"stroll", drawing->digest}, bytes);
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ(again->id, "stroll") << "the id is the session's";
  EXPECT_EQ(again->digest, drawing->digest);
  EXPECT_EQ(again->width, drawing->width);
  EXPECT_EQ(again->outline.outer, drawing->outline.outer);
  EXPECT_EQ(again->outline.colours, drawing->outline.colours);
  EXPECT_EQ(again->outline.warnings, drawing->outline.warnings);
  EXPECT_EQ(TextureOf(*again).image.rgba, drawing->texture.image.rgba);
  EXPECT_EQ(TextureOf(*again).scale, drawing->texture.scale);
}

TEST(DrawingSnapshot, OfAPolygonWithHolesComesBack) {
  const auto drawing = DrawingOf(
      "ring",
      PolygonSource{PointsOf("0 0, 40 0, 40 40, 0 40"), {PointsOf("9 9, 9 20, 20 20, 20 9")}, {}});
  const auto again = DrawingFromBytes({"ring", drawing->digest}, ToBytes(Packed(*drawing)));
  ASSERT_THAT(again, Succeeds());
  ASSERT_EQ(again->outline.holes.size(), 1u);
  EXPECT_EQ(again->outline.holes[0], drawing->outline.holes[0]);
  EXPECT_EQ(again->outline.colours.rows(), drawing->outline.colours.rows());
  EXPECT_EQ(TextureOf(*again).origin, drawing->texture.origin);
  EXPECT_EQ(TextureOf(*again).image.rgba, drawing->texture.image.rgba);
}

TEST(DrawingSnapshot, KeepsTheColoursOfInvisiblePixels) {
  Drawing drawing;
  drawing.texture.image = {2, 1, {10, 20, 30, 0, 1, 2, 3, 4}};
  EXPECT_EQ(TextureOf(Packed(drawing)).image.rgba, drawing.texture.image.rgba);
}

TEST(DrawingSnapshot, OfAnotherDrawingIsRefused) {
  EXPECT_THAT(DrawingFromBytes({"walk", "other digest"}, ToBytes(SampleDrawing())),
              FailsWith(kCorrupt));
}

TEST(DrawingSnapshot, IsNeverMadeOfDamagedBytes) {
  const Drawing drawing = SampleDrawing();
  const auto read = [&](const Bytes& bytes) {
    return DrawingFromBytes({"walk", drawing.digest}, bytes);
  };
  ExpectRefusesDamage(ToBytes(drawing), read);
  ExpectSurvivesSealedDamage(ToBytes(drawing), "draw", read);
}

class PoseSpaceSnapshot : public testing::Test {
 protected:
  static const PoseSpace& Creatures() {
    static const auto space = PoseSpace::Build(CreatureInputs(3)).value();
    return *space;
  }

  static Result<std::shared_ptr<const PoseSpace>> Read(const Bytes& bytes) {
    return PoseSpaceFromBytes(bytes, [](const DrawingName& name) {
      for (const auto& drawing : Creatures().drawings()) {
        if (drawing->id == name.id && drawing->digest == name.digest) return drawing;
      }
      return std::shared_ptr<const Drawing>();
    });
  }

  static void ExpectSameBlends(const PoseSpace& a, const PoseSpace& b) {
    for (int k = 0; k < 20; ++k) {
      Query query{Point(1.5 * std::cos(k), 0.1 * k * std::sin(k)), {}, 0.3};
      query.options.method = k % 3 == 0 ? BlendMethod::kPaper : BlendMethod::kRigid;
      const Frame one = *a.Blend(query), two = *b.Blend(query);
      EXPECT_EQ(one.vertices, two.vertices) << k;
      EXPECT_EQ(one.weights, two.weights) << k;
      EXPECT_EQ(one.texture_weights, two.texture_weights) << k;
    }
  }
};

TEST_F(PoseSpaceSnapshot, BlendsToTheLastBitAsBefore) {
  const Bytes bytes = ToBytes(Creatures());
  const auto again = Read(bytes);
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ((*again)->revision(), Creatures().revision());
  EXPECT_EQ((*again)->mesh_digest(), Creatures().mesh_digest());
  EXPECT_EQ(ToBytes(**again), bytes);
  ExpectSameBlends(Creatures(), **again);
}

TEST_F(PoseSpaceSnapshot, DrawsTheSamePicturesInTheSameView) {
  const auto again = *Read(ToBytes(Creatures()));
  const Frame frame = *Creatures().Blend({Point(0.2, 0.3), {}, 0.0});
  EXPECT_EQ(again->Render(frame, again->DefaultView(64, 64)).rgba,
            Creatures().Render(frame, Creatures().DefaultView(64, 64)).rgba);
}

TEST_F(PoseSpaceSnapshot, MovesToOtherPlacementsAsBefore) {
  const auto again = *Read(ToBytes(Creatures()));
  const Points places = PointsOf("0 0, 3 0, 0 2");
  ExpectSameBlends(**Creatures().WithPlacements(places), **again->WithPlacements(places));
}

TEST_F(PoseSpaceSnapshot, OfPosesThatTurnAroundKeepsTheirTurns) {
  BuildInputs inputs;
  for (int k = 0; k < 5; ++k) {
    const PolygonSource source{TurnedCreatureRing(1.5 * k), {}, {}};
    inputs.drawings.push_back(DrawingOf("pose" + std::to_string(k), source));
  }
  for (const int row : {0, 20, 40}) {
    Landmark& landmark = inputs.landmarks.emplace_back();
    for (int k = 0; k < 5; ++k) landmark.points.emplace_back(TurnedCreatureRing(1.5 * k).row(row));
  }
  inputs.placements = PointsOf("0 0, 1 0, 2 0, 3 0, 4 0");
  inputs.options.improvement.target_edge_length = 0.25;
  const auto space = *PoseSpace::Build(inputs);
  const auto again = PoseSpaceFromBytes(ToBytes(*space), [&](const DrawingName& name) {
    return *std::find_if(inputs.drawings.begin(), inputs.drawings.end(),
                         [&](const auto& drawing) { return drawing->id == name.id; });
  });
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ((*again)->turns(), space->turns());
  EXPECT_THAT(space->turns(), testing::Contains(testing::Ne(0)));
  ExpectSameBlends(*space, **again);
}

TEST_F(PoseSpaceSnapshot, OfOneDrawingComesBack) {
  const BuildInputs inputs = CreatureInputs(1);
  const auto space = *PoseSpace::Build(inputs);
  const auto again =
      PoseSpaceFromBytes(ToBytes(*space), [&](const DrawingName&) { return inputs.drawings[0]; });
  ASSERT_THAT(again, Succeeds());
  ExpectSameBlends(*space, **again);
}

TEST_F(PoseSpaceSnapshot, NeedsItsDrawings) {
  EXPECT_THAT(PoseSpaceFromBytes(ToBytes(Creatures()), [](const DrawingName&) { return nullptr; }),
              FailsWith(kCorrupt));
}

TEST_F(PoseSpaceSnapshot, IsNeverMadeOfDamagedBytes) {
  ExpectRefusesDamage(ToBytes(Creatures()), Read);
  ExpectSurvivesSealedDamage(ToBytes(Creatures()), "pose", Read);
}

TEST_F(PoseSpaceSnapshot, IsNotMadeOfPartsThatDoNotFit) {
  using Parts = PoseSpace::Parts;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(Parts&)>> changes = {
      [](Parts& parts) { parts.drawings.pop_back(); },
      [](Parts& parts) { parts.drawings.clear(); },
      [](Parts& parts) { parts.turns.pop_back(); },
      [](Parts& parts) { parts.turns[0] = 1 << 30; },
      [](Parts& parts) { parts.report.confidence.pop_back(); },
      [](Parts& parts) { parts.mesh.poses.pop_back(); },
      [](Parts& parts) { parts.mesh.poses[1].conservativeResize(4, 2); },
      [](Parts& parts) { parts.mesh.poses[1](0, 0) = kNan; },
      [](Parts& parts) { parts.mesh.triangles(0, 0) = parts.mesh.num_vertices(); },
      [](Parts& parts) { parts.mesh.triangles(0, 0) = -1; },
      [](Parts& parts) { parts.mesh.triangles.resize(0, 3); },
      [](Parts& parts) { std::swap(parts.mesh.triangles(0, 0), parts.mesh.triangles(0, 1)); },
      [](Parts& parts) { parts.mesh.boundary.clear(); },
      [](Parts& parts) { parts.mesh.boundary[0][0] = -1; },
      [](Parts& parts) { parts.mesh.landmarks = {1 << 20}; },
      [](Parts& parts) { parts.placements.conservativeResize(2, 2); },
      [](Parts& parts) { parts.placements(0, 0) = kNan; },
      [](Parts& parts) { parts.placements.setZero(); },
      [](Parts& parts) { parts.weights.data.conservativeResize(3, 3); },
      [](Parts& parts) { parts.weights.data(0, 0) = kNan; },
      [](Parts& parts) { parts.weights.lattice.size.x() *= 2; },
      [](Parts& parts) { parts.weights.lattice.spacing = 1e-9; },
      [](Parts& parts) { parts.weights.lattice.vertices(0, 0) = kNan; },
      [](Parts& parts) { parts.weights.lattice.triangles(0, 0) = -1; },
      [](Parts& parts) { parts.weights.lattice.triangles(0, 0) = 1 << 30; },
      [](Parts& parts) { parts.weights.lattice.triangles.row(0).setConstant(5); },
      [](Parts& parts) { parts.weights.lattice.triangles.resize(0, 3); },
      [](Parts& parts) { parts.reach.resize(1, 2); },
      [](Parts& parts) { parts.reach(0, 0) = kNan; }};
  ASSERT_THAT(PoseSpace::FromParts(Creatures().ToParts()), Succeeds());
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Parts parts = Creatures().ToParts();
    changes[k](parts);
    EXPECT_THAT(PoseSpace::FromParts(std::move(parts)), FailsWith(kCorrupt)) << k;
  }
}

TEST(SessionRecord, ShowsWithoutLoadingWhatTheSessionShows) {
  const SessionView view = ViewOf(SampleRecord());
  EXPECT_EQ(view.id, "tux");
  EXPECT_THAT(view.shape_ids, testing::ElementsAre("walk", "jump"));
  EXPECT_EQ(view.etag, "n0nce-12");
  EXPECT_EQ(view.revision, "r");
  ASSERT_TRUE(view.build.has_value());
  EXPECT_EQ(view.build->id, "4");
  EXPECT_EQ(view.build->state, BuildState::kSucceeded);
  EXPECT_EQ(view.build->summary->vertices, 10);
}

}  // namespace
}  // namespace posespace
