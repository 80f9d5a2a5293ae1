// SPDX-License-Identifier: Apache-2.0
#include "posespace/client.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "tests/client_cpp/live_service.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::Not;
using ::testing::SizeIs;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ClientTest : public ::testing::Test {
 protected:
  // Tests only read it.
  const Session& stars() {
    static const Session session = MakeStars(client_);
    return session;
  }

  const Client client_{SharedAddress(), {.timeout = 30s}};
};

// A session whose build takes seconds.
Session SlowSession(const Client& client) {
  Session session = client.CreateSession();
  for (int k = 0; k < 6; ++k) {
    PolygonSource blob;
    for (int row = 0; row < 900; ++row) {
      const double angle = row * 2.0 * std::numbers::pi / 900;
      const double radius =
          90.0 * (1.0 + 0.12 * std::sin((9 + k) * angle)) * (1.0 + 0.1 * std::sin(angle));
      blob.outer.push_back({120.0 + radius * std::cos(angle), 120.0 + radius * std::sin(angle)});
    }
    session.PutShape("blob" + std::to_string(k), std::move(blob));
  }
  return session;
}

const BuildOptions kSlow{.tolerance = 0.001, .target_edge_length = 0.02};

BuildState EndOfBuild(const Session& session) {
  for (int k = 0; k < 6'000; ++k) {
    const auto build = session.State().build;
    if (build && build->state != BuildState::kQueued && build->state != BuildState::kRunning) {
      return build->state;
    }
    std::this_thread::sleep_for(10ms);
  }
  return BuildState::kRunning;
}

TEST_F(ClientTest, PingsAServiceThatServesAndNoOther) {
  client_.Ping();
  const Client nobody("127.0.0.1:1", {.timeout = 2s});
  const Error error = ErrorOf([&] { nobody.Ping(); });
  EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(error.what(), HasSubstr("127.0.0.1:1"));
}

TEST_F(ClientTest, MakesFindsListsAndDeletesSessions) {
  Session made = client_.CreateSession("made-1", "Made", {{"who", "me"}});
  const SessionState state = client_.Session("made-1").State();
  EXPECT_EQ(state.display_name, "Made");
  EXPECT_THAT(state.labels, ElementsAre(std::pair("who", "me")));
  EXPECT_GT(state.create_time, std::chrono::system_clock::now() - 1h);
  EXPECT_FALSE(state.build);
  const auto has_it = [&] {
    const auto sessions = client_.Sessions();
    return std::any_of(sessions.begin(), sessions.end(),
                       [](const Session& session) { return session.id() == "made-1"; });
  };
  EXPECT_TRUE(has_it());
  EXPECT_THAT([&] { client_.CreateSession("made-1"); },
              Refuses(ErrorCode::kAlreadyExists, "SESSION_EXISTS"));
  EXPECT_THAT([&] { made.Delete("another"); }, Refuses(ErrorCode::kConflict, "ETAG_MISMATCH"));
  made.Delete(state.etag);
  EXPECT_FALSE(has_it());
  EXPECT_THAT([&] { client_.Session("made-1"); },
              Refuses(ErrorCode::kNotFound, "SESSION_NOT_FOUND"));
  EXPECT_THAT([&] { client_.CreateSession("a b"); },
              Refuses(ErrorCode::kInvalidArgument, "INVALID_ID"));
}

TEST_F(ClientTest, PutsListsAndDeletesDrawings) {
  Session session = client_.CreateSession();
  PolygonSource ringed = Star();
  ringed.holes = {{{90, 90}, {110, 90}, {110, 110}, {90, 110}}};
  const Shape shape = session.PutShape("ringed", ringed);
  EXPECT_EQ(shape.id, "ringed");
  EXPECT_THAT(shape.outline, SizeIs(2));
  EXPECT_THAT(shape.outline[0], SizeIs(10));
  EXPECT_EQ(shape.holes_filled, 1);
  session.PutShape("star", Star(6));
  EXPECT_THAT([&] { session.PutShape("star", Star(7)); },
              Refuses(ErrorCode::kAlreadyExists, "SHAPE_EXISTS"));
  session.PutShape("star", Star(7), /*replace=*/true);
  EXPECT_THAT(session.Shape("star").outline[0], SizeIs(14));
  EXPECT_THAT(session.ShapeIds(), ElementsAre("ringed", "star"));
  EXPECT_THAT(session.Shapes(), SizeIs(2));
  session.DeleteShape("ringed");
  EXPECT_THAT(session.ShapeIds(), ElementsAre("star"));
  EXPECT_THAT([&] { session.Shape("ringed"); }, Refuses(ErrorCode::kNotFound, "SHAPE_NOT_FOUND"));
}

TEST_F(ClientTest, SaysWhatIsWrongWithADrawing) {
  Session session = client_.CreateSession();
  EXPECT_THAT([&] { session.PutShape("junk", ImageSource{"hello"}); },
              Refuses(ErrorCode::kInvalidDrawing, "IMAGE_UNDECODABLE"));
  EXPECT_THAT([&] { session.PutShape("blank", ImageSource{}); },
              Refuses(ErrorCode::kInvalidDrawing, "SHAPE_SOURCE_MISSING"));
  PolygonSource torn = Star();
  torn.outer[3].y = kNan;
  const Error error = ErrorOf([&] { session.PutShape("torn", torn); });
  EXPECT_THAT(error.what(), HasSubstr("torn"));
}

TEST_F(ClientTest, NamesTheLimitOfARequestThatIsTooLarge) {
  Session session = client_.CreateSession();
  const Error error =
      ErrorOf([&] { session.PutShape("huge", ImageSource{std::string((16 << 20) + 100, 'x')}); });
  EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
  EXPECT_EQ(error.reason(), "REQUEST_TOO_LARGE");
  EXPECT_THAT(error.what(), AllOf(HasSubstr("16.0 MiB"), HasSubstr("at most 16 MiB")));
  EXPECT_THAT([&] { session.PutShape("large", ImageSource{std::string((16 << 20) - 100, 'x')}); },
              Refuses(ErrorCode::kInvalidDrawing, "IMAGE_UNDECODABLE"));
}

TEST_F(ClientTest, TellsEveryLandmarkAtFault) {
  Session session = client_.CreateSession();
  session.PutShape("a", Star());
  session.PutShape("b", Star(5, 0.1));
  const Point a = StarRing(5)[0], b = StarRing(5, 0.1)[0];
  const Error error = ErrorOf([&] {
    session.SetCorrespondences({{{"a", {1000, 1000}}}, {{"a", a}, {"b", b}}, {{"b", {-500, 3}}}});
  });
  EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(error.reason(), "LANDMARK_OFF_OUTLINE");
  EXPECT_THAT(error.fields(),
              AllOf(Contains(Key(HasSubstr("tuples[0]"))), Contains(Key(HasSubstr("tuples[2]"))),
                    Not(Contains(Key(HasSubstr("tuples[1]"))))));
  const SessionState state = session.SetCorrespondences({{{"a", a}, {"b", b}}});
  ASSERT_THAT(state.correspondences, SizeIs(1));
  EXPECT_EQ(state.correspondences[0].at("b"), b);
  EXPECT_THAT([&] { session.SetCorrespondences({}, "outdated"); },
              Refuses(ErrorCode::kConflict, "ETAG_MISMATCH"));
  EXPECT_THAT(session.SetCorrespondences({}, state.etag).correspondences, IsEmpty());
}

TEST_F(ClientTest, BuildsWithProgressThatNeverFalls) {
  Session session = client_.CreateSession();
  session.PutShape("a", Star());
  session.PutShape("b", Star(5, 0.1));
  std::vector<double> fractions;
  const BuildReport report = session.Build(
      {.on_progress = [&](std::string_view, double fraction) { fractions.push_back(fraction); }});
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  ASSERT_FALSE(fractions.empty());
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_EQ(report.revision, session.State().revision);
  EXPECT_GT(report.min_angle, 0.0);
  EXPECT_THAT(report.confidence, AllOf(Contains(Key("a")), Contains(Key("b"))));
  const Mesh mesh = session.Mesh();
  EXPECT_EQ(mesh.revision, report.revision);
  EXPECT_THAT(mesh.triangles, SizeIs(3 * static_cast<std::size_t>(report.triangles)));
  EXPECT_THAT(mesh.poses[1].vertices, SizeIs(2 * static_cast<std::size_t>(report.vertices)));
}

TEST_F(ClientTest, RefusesToBlendBeforeABuildAndToBuildWithoutDrawings) {
  Session session = client_.CreateSession();
  EXPECT_THAT([&] { session.Build(); }, Refuses(ErrorCode::kNotBuilt, "NO_SHAPES"));
  session.PutShape("a", Star());
  const Point origin{};
  const auto refused = Refuses(ErrorCode::kNotBuilt, "SESSION_NOT_BUILT");
  EXPECT_THAT([&] { session.Blend(origin); }, refused);
  EXPECT_THAT([&] { session.BlendMany(std::vector{origin}); }, refused);
  EXPECT_THAT([&] { session.Render(origin); }, refused);
  EXPECT_THAT([&] { session.Play(); }, refused);
  EXPECT_THAT([&] { session.Mesh(); }, refused);
}

TEST_F(ClientTest, ReproducesEachDrawingAtItsPlace) {
  const Mesh mesh = stars().Mesh();
  const std::vector<Point> places = {{0, 0}, {1, 0}, {0, 1}};
  for (std::size_t pose = 0; pose < places.size(); ++pose) {
    const Frame frame = stars().Blend(places[pose]);
    EXPECT_LT(Distance(frame.vertices, mesh.poses[pose].vertices), 1e-3);
    EXPECT_NEAR(frame.weights.at(mesh.poses[pose].shape_id), 1.0, 1e-9);
    EXPECT_EQ(frame.folds, 0);
    EXPECT_EQ(frame.revision, mesh.revision);
  }
}

TEST_F(ClientTest, MixesStretchAndRepairsAsAsked) {
  const Frame plain = stars().Blend({0.3, 0.4});
  const std::vector<double> expected(plain.vertices.begin(), plain.vertices.end());
  for (const auto stretch : {StretchBlend::kLog, StretchBlend::kMetric}) {
    // The stars differ by turns alone: there is no stretch to mix.
    const Frame frame = stars().Blend({0.3, 0.4}, {.stretch = stretch});
    EXPECT_LT(Distance(frame.vertices, expected), 1e-3);
  }
  const Frame repaired = stars().Blend({0.3, 0.4}, {.repair = true});
  EXPECT_EQ(repaired.vertices, plain.vertices);
  EXPECT_EQ(repaired.mended, 0);
}

TEST_F(ClientTest, HoldsAnAnchor) {
  const Mesh mesh = stars().Mesh();
  const std::string& first = mesh.poses[0].shape_id;
  const MeshPoint corner{0, 0.25, 0.5};
  const auto place_in = [&](const auto& vertices) {
    Point sum;
    for (const auto& [k, weight] : {std::pair(0, 0.25), {1, 0.25}, {2, 0.5}}) {
      sum.x += weight * vertices[2 * mesh.triangles[k]];
      sum.y += weight * vertices[2 * mesh.triangles[k] + 1];
    }
    return sum;
  };
  const MeshPoint found = mesh.At(first, place_in(mesh.poses[0].vertices));
  EXPECT_EQ(found.triangle, corner.triangle);
  EXPECT_NEAR(found.b, corner.b, 1e-9);
  EXPECT_NEAR(found.c, corner.c, 1e-9);

  const Frame frame = stars().Blend({0.3, 0.4}, {.anchor = found});
  Point wanted;
  for (const PoseMesh& pose : mesh.poses) {
    const Point place = place_in(pose.vertices);
    wanted.x += frame.weights.at(pose.shape_id) * place.x;
    wanted.y += frame.weights.at(pose.shape_id) * place.y;
  }
  const Point is = place_in(frame.vertices);
  EXPECT_NEAR(is.x, wanted.x, 1e-3);
  EXPECT_NEAR(is.y, wanted.y, 1e-3);

  EXPECT_THROW((void)mesh.At("nobody", {0, 0}), Error);
  EXPECT_THROW((void)mesh.At(first, {-1e6, 0}), Error);
  EXPECT_THROW((void)stars().Blend({0, 0}, {.anchor = MeshPoint{1 << 20, 0, 0}}), Error);
}

TEST_F(ClientTest, BlendsAtThePointAndAtItsWeightsAlike) {
  const Frame at = stars().Blend({0.3, 0.4});
  const Frame by_weights = stars().Blend(at.weights);
  EXPECT_EQ(at.vertices, by_weights.vertices);
  const Frame half = stars().Blend({{"up", 0.5}, {"left", 0.5}});
  EXPECT_EQ(half.weights.at("right"), 0.0);
  EXPECT_THAT(
      [&] {
        stars().Blend({{"nobody", 1.0}});
      },
      Refuses(ErrorCode::kNotFound, "SHAPE_NOT_FOUND"));
  EXPECT_THAT(
      [&] {
        stars().Blend({{"up", 0.4}});
      },
      Refuses(ErrorCode::kInvalidArgument, "WEIGHTS_SUM_NOT_ONE"));
  EXPECT_THAT(
      [&] {
        stars().Blend({kNan, 0.0});
      },
      Refuses(ErrorCode::kInvalidArgument, "POSE_NOT_FINITE"));
}

TEST_F(ClientTest, PassesBlendOptionsOn) {
  const Point at{0.3, 0.4};
  const auto linear = stars().Blend(at, {.method = BlendMethod::kLinear});
  EXPECT_NE(linear.vertices, stars().Blend(at).vertices);
  const Mesh mesh = stars().Mesh();
  std::vector<double> mean(mesh.poses[0].vertices.size());
  for (const PoseMesh& pose : mesh.poses) {
    for (std::size_t k = 0; k < mean.size(); ++k) {
      mean[k] += linear.weights.at(pose.shape_id) * pose.vertices[k];
    }
  }
  EXPECT_LT(Distance(linear.vertices, mean), 1e-3);
  EXPECT_THAT([&] { stars().Blend(at, {.refits = 4}); },
              Refuses(ErrorCode::kInvalidArgument, "INVALID_OPTION"));
  EXPECT_NO_THROW(stars().Blend(at, {.refits = 3, .sigma = 1.0}));
}

TEST_F(ClientTest, BlendsMoreThanOneMessageHolds) {
  std::vector<Point> points;
  for (int k = 0; k < 600; ++k) points.push_back({k / 600.0, 0.25});
  const FrameBatch batch = stars().BlendMany(points);
  ASSERT_EQ(batch.size(), points.size());
  for (const std::size_t k : {0u, 255u, 256u, 599u}) {
    EXPECT_EQ(Distance(batch[k], stars().Blend(points[k]).vertices), 0.0);
  }
  EXPECT_EQ(stars().BlendMany({}).size(), 0u);
  points[300].x = kNan;
  EXPECT_THAT([&] { stars().BlendMany(points); },
              Refuses(ErrorCode::kInvalidArgument, "POSE_NOT_FINITE"));
}

TEST_F(ClientTest, AnswersWeightsThatSumToOne) {
  const std::vector<Point> points = {{0, 1}, {0.2, 0.3}, {-3, 7}};
  const WeightTable table = stars().Weights(points);
  ASSERT_EQ(table.size(), 3u);
  EXPECT_THAT(table.shape_ids, ElementsAre("up", "left", "right"));
  EXPECT_NEAR(table[0][2], 1.0, 1e-9);
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_NEAR(std::accumulate(table[row].begin(), table[row].end(), 0.0), 1.0, 1e-9);
  }
}

TEST_F(ClientTest, RendersPictures) {
  const Picture picture = stars().Render({0.5, 0.0}, {.width = 64, .height = 48});
  ASSERT_EQ(picture.rgba.size(), 64u * 48u * 4u);
  EXPECT_EQ(picture.rgba[3], 0) << "the corner is empty";
  EXPECT_EQ(picture.rgba[4 * (24 * 64 + 32) + 3], 255) << "the middle is not";
  const Frame frame = stars().Blend({0.5, 0.0});
  EXPECT_EQ(stars().Render(frame.weights, {.width = 64, .height = 48}).rgba, picture.rgba);
  const RenderOptions soft{.width = 64, .height = 48, .view = {}, .edges = Edges::kSoft};
  EXPECT_NE(stars().Render({0.5, 0.0}, soft).rgba, picture.rgba);
  EXPECT_THAT(
      [&] {
        stars().Render({0, 0}, {.width = 0});
      },
      Refuses(ErrorCode::kInvalidArgument, "INVALID_OPTION"));
  EXPECT_THAT(stars().TexturePng("up"), ::testing::StartsWith("\x89PNG"));
}

TEST_F(ClientTest, DrawsPicturesAlongAPath) {
  const std::vector<Waypoint> path = {{{0.5, 0.0}}, {{0.0, 0.5}}};
  PictureStream pictures = stars().RenderAnimation(path, {.fps = 4}, {.width = 40, .height = 30});
  const std::optional<Picture> first = pictures.Next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->rgba, stars().Render({0.5, 0.0}, {.width = 40, .height = 30}).rgba);
  int count = 1;
  while (const auto picture = pictures.Next()) {
    ++count;
    EXPECT_EQ(picture->rgba.size(), 4u * 40 * 30);
  }
  EXPECT_EQ(count, 5);
  EXPECT_THAT([&] { stars().RenderAnimation({}, {}).Next(); },
              Refuses(ErrorCode::kInvalidArgument, "PATH_INVALID"));
}

TEST_F(ClientTest, SuggestsMatchesAndKeepsAcceptedFlips) {
  Session session = client_.CreateSession();
  EXPECT_THAT([&] { session.Suggest(); }, Refuses(ErrorCode::kNotBuilt, "NO_SHAPES"));
  // The letter L, twice, and once in a mirror.
  const Ring letter = {{0, 0}, {20, 0}, {20, 80}, {70, 80}, {70, 100}, {0, 100}};
  Ring mirrored = letter;
  for (Point& point : mirrored) point.x = 70 - point.x;
  session.PutShape("a", PolygonSource{.outer = letter});
  session.PutShape("b", PolygonSource{.outer = letter});
  EXPECT_FALSE(session.PutShape("c", PolygonSource{.outer = mirrored}).flipped);
  const Suggestion before = session.Suggest(16);
  EXPECT_EQ(before.flips, std::vector<std::string>{"c"});
  EXPECT_GE(before.flip_gain, 1.05);
  EXPECT_LT(before.confidence.at("c"), 0.5);
  EXPECT_EQ(before.arcs.at("a").size(), 16u);
  EXPECT_EQ(before.etag, session.State().etag);

  EXPECT_TRUE(session
                  .PutShape("c", PolygonSource{.outer = mirrored}, /*replace=*/true,
                            /*flip=*/true)
                  .flipped);
  const Suggestion after = session.Suggest();
  EXPECT_TRUE(after.flips.empty());
  EXPECT_EQ(after.flip_gain, 1.0);
  EXPECT_GT(after.confidence.at("c"), 0.5);
  EXPECT_EQ(after.arcs.at("a").size(), 64u);
}

TEST_F(ClientTest, MatchesDrawingsThatMayBeTurnedAtWill) {
  Session session = client_.CreateSession();
  // The letter L, and turned by half a turn.
  const Ring letter = {{0, 0}, {20, 0}, {20, 80}, {70, 80}, {70, 100}, {0, 100}};
  Ring turned = letter;
  for (Point& point : turned) point = {70 - point.x, 100 - point.y};
  session.PutShape("a", PolygonSource{.outer = letter});
  session.PutShape("b", PolygonSource{.outer = turned});
  const Suggestion found = session.Suggest(32, Rotation::kAny);
  for (std::size_t k = 0; k < 32; ++k) {
    const Point a = found.arcs.at("a")[k], b = found.arcs.at("b")[k];
    EXPECT_LT(std::hypot(70 - a.x - b.x, 100 - a.y - b.y), 1.0) << k;
  }
  const std::string upright = session.Build().revision;
  EXPECT_NE(session.Build({.rotation = Rotation::kAny}).revision, upright);
}

TEST_F(ClientTest, TellsWhatAlignmentGained) {
  Session session = client_.CreateSession();
  session.PutShape("star", Star(5));
  session.PutShape("other", Star(6));
  EXPECT_FALSE(session.Build({.align = false}).ghost_loss);  // one colour: nothing to align
  EXPECT_TRUE(session.Build().ghost_losses.empty());
}

TEST_F(ClientTest, BuildsAndBlendsASessionOfOneDrawing) {
  Session session = client_.CreateSession();
  session.PutShape("only", Star());
  session.Build();
  const Mesh mesh = session.Mesh();
  for (const Point at : {Point{0, 0}, Point{3, -2}}) {
    const Frame frame = session.Blend(at);
    EXPECT_LT(Distance(frame.vertices, mesh.poses[0].vertices), 1e-3);
    EXPECT_NEAR(frame.weights.at("only"), 1.0, 1e-12);
  }
}

TEST_F(ClientTest, FollowsARebuildBetweenTwoCalls) {
  Session session = MakeStars(client_);
  const Frame before = session.Blend({0.5, 0.0});
  Session elsewhere = client_.Session(session.id());
  elsewhere.SetPlacements({{"up", {0, 0}}, {"left", {0.5, 0}}, {"right", {0, 1}}});
  const Frame after = session.Blend({0.5, 0.0});
  EXPECT_NE(after.revision, before.revision);
  EXPECT_NEAR(after.weights.at("left"), 1.0, 1e-9);

  elsewhere.DeleteShape("left");
  elsewhere.PutShape("seven", Star(7));
  elsewhere.SetPlacements({{"up", {0, 0}}, {"right", {0, 1}}, {"seven", {1, 1}}});
  elsewhere.Build({.target_edge_length = 0.3});
  EXPECT_NEAR(session.Blend({{"seven", 1.0}}).weights.at("seven"), 1.0, 1e-12);
  EXPECT_THAT(session.Weights(std::vector{Point{}}).shape_ids, ElementsAre("up", "right", "seven"));
}

TEST_F(ClientTest, SaysThatASessionWasDeleted) {
  Session session = MakeStars(client_);
  session.Blend({0, 0});
  client_.Session(session.id()).Delete();
  EXPECT_THAT([&] { session.Blend({0, 0}); }, Refuses(ErrorCode::kNotFound, "SESSION_NOT_FOUND"));
  EXPECT_THAT([&] { session.Build(); }, Refuses(ErrorCode::kNotFound, "SESSION_NOT_FOUND"));
}

TEST_F(ClientTest, AStopCancelsTheBuild) {
  Session session = SlowSession(client_);
  std::stop_source stop;
  BuildOptions options = kSlow;
  options.stop = stop.get_token();
  options.on_progress = [&](std::string_view, double) { stop.request_stop(); };
  EXPECT_THAT([&] { session.Build(options); }, Refuses(ErrorCode::kCancelled, "CANCELLED"));
  EXPECT_EQ(EndOfBuild(session), BuildState::kCancelled);
  EXPECT_THAT([&] { session.Build(options); }, Refuses(ErrorCode::kCancelled, "CANCELLED"));
  session.Delete();
}

TEST_F(ClientTest, AStopFromAnotherThreadEndsTheWait) {
  Session session = SlowSession(client_);
  std::stop_source stop;
  BuildOptions options = kSlow;
  options.stop = stop.get_token();
  std::atomic<bool> begun = false;
  options.on_progress = [&](std::string_view, double) { begun = true; };
  const std::jthread stopper([&] {
    while (!begun) std::this_thread::sleep_for(1ms);
    stop.request_stop();
  });
  EXPECT_THAT([&] { session.Build(options); }, Refuses(ErrorCode::kCancelled, "CANCELLED"));
  EXPECT_EQ(EndOfBuild(session), BuildState::kCancelled);
  session.Delete();
}

TEST_F(ClientTest, AnExceptionInProgressCancelsTheBuildAndPassesThrough) {
  Session session = SlowSession(client_);
  BuildOptions options = kSlow;
  options.on_progress = [](std::string_view, double) { throw std::runtime_error("no more"); };
  EXPECT_THROW(session.Build(options), std::runtime_error);
  EXPECT_EQ(EndOfBuild(session), BuildState::kCancelled);
  session.Delete();
}

TEST_F(ClientTest, ABuildThatTakesTooLongIsCancelledAndOneOfAnotherCallerIsNot) {
  Session session = SlowSession(client_);
  BuildOptions options = kSlow;
  options.timeout = 50ms;
  Error error = ErrorOf([&] { session.Build(options); });
  EXPECT_EQ(error.code(), ErrorCode::kDeadlineExceeded);
  EXPECT_THAT(error.what(), AllOf(HasSubstr("0.05 s"), HasSubstr("its build is cancelled")));
  EXPECT_EQ(EndOfBuild(session), BuildState::kCancelled);
  const BuildStatus started = session.StartBuild(kSlow);
  error = ErrorOf([&] { session.Build(options); });
  EXPECT_THAT(error.what(), HasSubstr("another caller's build goes on"));
  EXPECT_EQ(session.State().build->id, started.id);
  session.CancelBuild();
  EXPECT_EQ(EndOfBuild(session), BuildState::kCancelled);
  session.Delete();
}

TEST_F(ClientTest, AnotherBuildReplacesARunningOne) {
  Session session = SlowSession(client_);
  BuildOptions options = kSlow;
  options.on_progress = [&](std::string_view, double) { session.StartBuild({.tolerance = 0.1}); };
  EXPECT_THAT([&] { session.Build(options); }, Refuses(ErrorCode::kCancelled, "CANCELLED"));
  session.Delete();
}

TEST_F(ClientTest, OneClientServesManyThreads) {
  const Frame expected = stars().Blend({0.4, 0.4});
  std::atomic<int> wrong = 0;
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 8; ++thread) {
    threads.emplace_back([&, session = stars()] {
      for (int k = 0; k < 20; ++k) {
        if (session.Blend({0.4, 0.4}).vertices != expected.vertices) ++wrong;
      }
    });
  }
  threads.clear();
  EXPECT_EQ(wrong, 0);
}

TEST(ReadFile, SaysWhichFileIsNotThere) {
  EXPECT_THAT([] { ReadFile("nowhere.png"); },
              ::testing::ThrowsMessage<std::system_error>(HasSubstr("nowhere.png")));
  const auto path = std::filesystem::temp_directory_path() / ("bytes-" + std::to_string(getpid()));
  std::ofstream(path, std::ios::binary) << std::string("a\0b\n", 4);
  EXPECT_EQ(ReadFile(path), std::string("a\0b\n", 4));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace posespace
