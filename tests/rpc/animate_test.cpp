// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "tests/rpc/service_fixture.h"

namespace posespace {
namespace {

using grpc::StatusCode;
using ::testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Limits FewFrames() {
  Limits limits;
  limits.max_animation_frames = 61;
  limits.max_render_frames = 3;
  return limits;
}

class AnimateTest : public ServiceTest {
 protected:
  explicit AnimateTest(const Limits& limits = {}) : ServiceTest(limits) {}

  // From (0, 0) to (0, 1) and beyond, a second a leg.
  static v1::Animation Along(const std::vector<double>& ys, double fps, bool loop = false) {
    v1::Animation animation;
    for (const double y : ys) {
      animation.mutable_path()->add_waypoints()->mutable_at()->set_y(y);
    }
    animation.mutable_path()->set_loop(loop);
    animation.set_fps(fps);
    return animation;
  }

  static v1::AnimateRequest Request(const v1::Animation& animation) {
    v1::AnimateRequest request;
    request.set_session_id("cell");
    *request.mutable_animation() = animation;
    return request;
  }

  grpc::Status Play(const v1::AnimateRequest& request, std::vector<v1::AnimateResponse>* frames) {
    const auto context = Client::Context();
    const auto reader = client_.poses->Animate(context.get(), request);
    for (v1::AnimateResponse frame; reader->Read(&frame);) frames->push_back(frame);
    return reader->Finish();
  }

  std::vector<v1::AnimateResponse> Frames(const v1::AnimateRequest& request) {
    std::vector<v1::AnimateResponse> frames;
    EXPECT_THAT(Play(request, &frames), Succeeds());
    return frames;
  }

  grpc::Status Refusal(const v1::AnimateRequest& request) {
    std::vector<v1::AnimateResponse> frames;
    const grpc::Status status = Play(request, &frames);
    EXPECT_TRUE(frames.empty());
    return status;
  }
};

class FewFramesTest : public AnimateTest {
 protected:
  FewFramesTest() : AnimateTest(FewFrames()) {}
};

TEST_F(AnimateTest, SendsTheFramesOfThePathInOrderAndItsEnd) {
  const std::string revision = Built("cell");
  const auto frames = Frames(Request(Along({0, 1}, 60.0)));
  ASSERT_EQ(frames.size(), 61u);
  for (int k = 0; k <= 60; ++k) {
    const auto& frame = frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(frame.index(), k);
    EXPECT_DOUBLE_EQ(frame.time(), k / 60.0);
    EXPECT_NEAR(frame.at().y(), k / 60.0, 1e-12);
    EXPECT_EQ(frame.revision(), revision);
  }
}

TEST_F(AnimateTest, AFrameIsTheBlendAtItsPlace) {
  Built("cell");
  auto request = Request(Along({0, 1, -0.5}, 7.0));
  request.mutable_animation()->mutable_options()->set_method(v1::BLEND_METHOD_PAPER);
  request.mutable_animation()->mutable_options()->set_sigma(0.5);
  for (const auto& frame : Frames(request)) {
    v1::BlendRequest blend;
    blend.set_session_id("cell");
    *blend.add_queries()->mutable_at() = frame.at();
    *blend.mutable_queries(0)->mutable_options() = request.animation().options();
    v1::BlendResponse response;
    ASSERT_THAT(client_.Call(&PoseStub::Blend, blend, &response), Succeeds());
    EXPECT_EQ(frame.frame().SerializeAsString(), response.frames(0).SerializeAsString());
  }
}

TEST_F(AnimateTest, ALoopEndsAFrameBeforeItRepeats) {
  Built("cell");
  const auto frames = Frames(Request(Along({0, 1}, 10.0, /*loop=*/true)));
  ASSERT_EQ(frames.size(), 20u);
  EXPECT_NEAR(frames[10].at().y(), 1.0, 1e-12);
  EXPECT_NEAR(frames[1].at().y(), frames[19].at().y(), 1e-12);
}

TEST_F(AnimateTest, EndsAtTheEndAlsoWhenNoFrameFallsOnIt) {
  Built("cell");
  const auto frames = Frames(Request(Along({0, 1}, 2.5)));  // at 0, 0.4, 0.8 and 1 seconds
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_DOUBLE_EQ(frames[2].time(), 0.8);
  EXPECT_DOUBLE_EQ(frames[3].time(), 1.0);
  EXPECT_NEAR(frames[3].at().y(), 1.0, 1e-12);
}

TEST_F(AnimateTest, NeverRunsAheadOfTheClockWhenPaced) {
  Built("cell");
  auto request = Request(Along({0, 1}, 20.0));
  request.mutable_animation()->mutable_path()->set_duration(0.5);
  request.set_paced(true);
  const auto context = Client::Context();
  const auto start = std::chrono::steady_clock::now();
  const auto reader = client_.poses->Animate(context.get(), request);
  int count = 0;
  for (v1::AnimateResponse frame; reader->Read(&frame); ++count) {
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - start;
    EXPECT_GE(since.count(), frame.time());
  }
  EXPECT_THAT(reader->Finish(), Succeeds());
  EXPECT_EQ(count, 11);
}

TEST_F(AnimateTest, EndsWhenTheCallerGoesAway) {
  Built("cell");
  auto request = Request(Along({0, 1}, 0.01));  // the second frame is due in a hundred seconds
  request.mutable_animation()->mutable_path()->set_duration(3'600.0);
  request.set_paced(true);
  {
    const auto context = Client::Context();
    const auto reader = client_.poses->Animate(context.get(), request);
    v1::AnimateResponse frame;
    ASSERT_TRUE(reader->Read(&frame));
    EXPECT_GE(server_->open_streams(), 1u);
    context->TryCancel();
    EXPECT_EQ(reader->Finish().error_code(), StatusCode::CANCELLED);
  }
  while (server_->open_streams() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

TEST_F(AnimateTest, EndsWithTheService) {
  Built("cell");
  auto request = Request(Along({0, 1}, 0.01));
  request.mutable_animation()->mutable_path()->set_duration(3'600.0);
  request.set_paced(true);
  const auto context = Client::Context();
  const auto reader = client_.poses->Animate(context.get(), request);
  v1::AnimateResponse frame;
  ASSERT_TRUE(reader->Read(&frame));
  server_->BeginDrain(std::chrono::milliseconds(10));
  EXPECT_FALSE(reader->Read(&frame));
  EXPECT_THAT(reader->Finish(), Refuses(StatusCode::UNAVAILABLE, "DRAINING"));
}

TEST_F(AnimateTest, KeepsItsRevisionWhileTheSessionChanges) {
  const std::string revision = Built("cell");
  auto request = Request(Along({0, 1}, 1'000.0));
  request.mutable_animation()->mutable_path()->set_duration(3.0);
  const auto context = Client::Context();
  const auto reader = client_.poses->Animate(context.get(), request);
  v1::AnimateResponse frame;
  ASSERT_TRUE(reader->Read(&frame));
  EXPECT_NE(Place("cell", 2.0).revision(), revision);
  int count = 1;
  for (; reader->Read(&frame); ++count) EXPECT_EQ(frame.revision(), revision);
  EXPECT_EQ(count, 3'001);
  EXPECT_THAT(reader->Finish(), Succeeds());
  request.set_revision(revision);
  EXPECT_THAT(Refusal(request), Refuses(StatusCode::NOT_FOUND, "REVISION_NOT_FOUND"));
}

TEST_F(AnimateTest, RefusesWhatIsNoPathNamingTheField) {
  Built("cell");
  const auto refuses = [&](const v1::Animation& animation, const char* reason, const char* field) {
    const grpc::Status status = Refusal(Request(animation));
    EXPECT_THAT(status, Refuses(StatusCode::INVALID_ARGUMENT, reason));
    EXPECT_THAT(FieldsOf(status), ElementsAre(field));
  };
  refuses({}, "PATH_INVALID", "animation.path.waypoints");
  refuses(Along({0, 1, 1}, 60.0), "PATH_INVALID", "animation.path.waypoints[2].at");
  refuses(Along({0, kNan}, 60.0), "POSE_NOT_FINITE", "animation.path.waypoints[1].at");
  for (const double fps : {0.0, -1.0, 1'000.1, kNan}) {
    refuses(Along({0, 1}, fps), "INVALID_OPTION", "animation.fps");
  }
  v1::Animation timed = Along({0, 1}, 60.0);
  timed.mutable_path()->mutable_waypoints(1)->set_time(1.0);
  refuses(timed, "PATH_INVALID", "animation.path.waypoints");
  v1::Animation sharp = Along({0, 1}, 60.0);
  sharp.mutable_options()->set_sigma(2.0);
  refuses(sharp, "INVALID_OPTION", "animation.options.sigma");
  v1::Animation eased = Along({0, 1}, 60.0);
  eased.mutable_path()->set_easing(static_cast<v1::Easing>(77));
  refuses(eased, "INVALID_OPTION", "animation.path.easing");
}

TEST_F(FewFramesTest, TakesAsManyFramesAsTheLimitSays) {
  Built("cell");
  EXPECT_EQ(Frames(Request(Along({0, 1}, 60.0))).size(), 61u);
  EXPECT_THAT(Refusal(Request(Along({0, 1}, 60.1))),
              Refuses(StatusCode::INVALID_ARGUMENT, "TOO_MANY_FRAMES"));
  EXPECT_EQ(Frames(Request(Along({0, 1}, 30.5, /*loop=*/true))).size(), 61u);
}

TEST_F(FewFramesTest, RendersAPathAsItRendersItsPlaces) {
  Built("cell");
  const auto render = [&](const v1::RenderRequest& request, std::vector<v1::RenderResponse>* all) {
    const auto context = Client::Context();
    const auto reader = client_.poses->Render(context.get(), request);
    for (v1::RenderResponse picture; reader->Read(&picture);) all->push_back(picture);
    return reader->Finish();
  };
  v1::RenderRequest request;
  request.set_session_id("cell");
  request.set_width(64);
  request.set_height(64);
  v1::RenderRequest along = request;
  *along.mutable_animation() = Along({0, 1}, 2.0);
  for (const double y : {0.0, 0.5, 1.0}) request.add_queries()->mutable_at()->set_y(y);

  std::vector<v1::RenderResponse> places, path, none;
  ASSERT_THAT(render(request, &places), Succeeds());
  ASSERT_THAT(render(along, &path), Succeeds());
  ASSERT_EQ(path.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(path[k].image(), places[k].image());

  along.mutable_animation()->set_fps(3.0);
  EXPECT_THAT(render(along, &none), Refuses(StatusCode::INVALID_ARGUMENT, "TOO_MANY_FRAMES"));
  along.mutable_animation()->set_fps(2.0);
  along.add_queries()->mutable_at()->set_y(0.5);
  EXPECT_THAT(render(along, &none), Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_OPTION"));
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace posespace
