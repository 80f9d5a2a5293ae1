// SPDX-License-Identifier: Apache-2.0
// The part of Session that reads what was built.
#include <algorithm>
#include <array>
#include <utility>

#include "client/cpp/channel.h"
#include "client/cpp/convert.h"
#include "client/cpp/session_handle.h"
#include "posespace/session.h"

namespace posespace {
namespace internal {
namespace {

constexpr std::size_t kBatch = 256;  // queries in one message, the service's limit by default

v1::Mesh MeshOf(const Channel& channel, const std::string& session_id) {
  v1::GetMeshRequest request;
  request.set_session_id(session_id);
  v1::GetMeshResponse response;
  channel.Call(request, &response);
  return std::move(*response.mutable_mesh());
}

v1::BlendRequest BlendRequestOf(const std::string& session_id, const Built& built) {
  v1::BlendRequest request;
  request.set_session_id(session_id);
  request.set_revision(built.revision);
  return request;
}

Frame BlendOne(const Channel& channel, const v1::BlendRequest& request, const Built& built) {
  v1::BlendResponse response;
  channel.Call(request, &response);
  if (response.frames_size() != 1) throw Error(ErrorCode::kInternal, "a blend without a frame");
  return FromMessage(response.frames(0), built.shape_ids, response.revision());
}

// Hands the frames at all points, in order, to `take`; in as many messages as it needs.
template <typename Take>
void BlendBatches(const Channel& channel, v1::BlendRequest request, std::span<const Point> points,
                  const BlendOptions& options, const Take& take) {
  v1::BlendResponse response;
  while (!points.empty()) {
    const auto batch = points.first(std::min(kBatch, points.size()));
    request.clear_queries();
    for (const Point& at : batch) ToMessage(at, options, request.add_queries());
    channel.Call(request, &response);
    for (const v1::Frame& frame : response.frames()) take(frame);
    points = points.subspan(batch.size());
  }
}

v1::RenderRequest RenderRequestOf(const std::string& session_id, const RenderOptions& options) {
  v1::RenderRequest request;
  request.set_session_id(session_id);
  request.set_width(options.width);
  request.set_height(options.height);
  request.set_format(v1::IMAGE_FORMAT_RGBA);
  request.set_edges(options.edges == Edges::kSoft ? v1::EDGES_SOFT : v1::EDGES_CRISP);
  if (options.view) {
    request.mutable_view()->set_x(options.view->x);
    request.mutable_view()->set_y(options.view->y);
    request.mutable_view()->set_width(options.view->width);
    request.mutable_view()->set_height(options.view->height);
  }
  return request;
}

// With a revision, kNotFound when the picture is of another.
Picture RenderOne(const std::shared_ptr<Channel>& channel, const v1::RenderRequest& request,
                  const std::string& revision) {
  Answers answers(channel, std::make_unique<v1::RenderRequest>(request));
  v1::RenderResponse response;
  if (!answers.Next(&response, Clock::now() + channel->timeout())) {
    throw Error(ErrorCode::kInternal, "a rendering without a picture");
  }
  if (!revision.empty() && response.revision() != revision) {
    throw Error(ErrorCode::kNotFound, "rendered another revision", "REVISION_NOT_FOUND");
  }
  const std::string& image = response.image();
  return {request.width(), request.height(), {image.begin(), image.end()}};
}

}  // namespace

// What weights are refused with that are meant for other drawings than the built ones counts only
// when these were known from before.
bool SessionHandle::Overtaken(const Error& error, bool from_before) {
  if (error.reason() == "REVISION_NOT_FOUND") return true;
  return from_before &&
         (error.reason() == "SHAPE_NOT_FOUND" || error.reason() == "WEIGHTS_COUNT_MISMATCH");
}

std::pair<std::shared_ptr<const Built>, bool> SessionHandle::Current() {
  {
    const std::scoped_lock lock(mutex_);
    if (built_) return {built_, true};
  }
  const v1::Mesh mesh = MeshOf(*channel, id);
  auto built = std::make_shared<Built>();
  built->revision = mesh.revision();
  built->vertex_count = mesh.report().vertices();
  for (const v1::PoseMesh& pose : mesh.poses()) built->shape_ids.push_back(pose.shape_id());
  const std::scoped_lock lock(mutex_);
  built_ = built;
  return {built, false};
}

void SessionHandle::Forget(const std::shared_ptr<const Built>& built) {
  const std::scoped_lock lock(mutex_);
  if (built_ == built) built_ = nullptr;
}

}  // namespace internal

using internal::Built;
using internal::FromMessage;
using internal::ToMessage;

namespace {

constexpr double kLongestInstant =
    3'600.0;  // seconds from frame to frame, as long as a path may be

}  // namespace

Mesh Session::Mesh() const { return FromMessage(internal::MeshOf(*handle_->channel, id())); }

std::string Session::TexturePng(const std::string& shape_id) const {
  v1::GetTextureRequest request;
  request.set_session_id(id());
  request.set_shape_id(shape_id);
  v1::GetTextureResponse response;
  handle_->channel->Call(request, &response);
  return std::move(*response.mutable_png());
}

Frame Session::Blend(Point at, const BlendOptions& options) const {
  return handle_->OfOneRevision([&](const Built& built) {
    v1::BlendRequest request = internal::BlendRequestOf(id(), built);
    ToMessage(at, options, request.add_queries());
    return internal::BlendOne(*handle_->channel, request, built);
  });
}

Frame Session::Blend(const posespace::Weights& weights, const BlendOptions& options) const {
  return handle_->OfOneRevision([&](const Built& built) {
    v1::BlendRequest request = internal::BlendRequestOf(id(), built);
    ToMessage(internal::InOrder(weights, built.shape_ids), options, request.add_queries());
    return internal::BlendOne(*handle_->channel, request, built);
  });
}

FrameBatch Session::BlendMany(std::span<const Point> points, const BlendOptions& options) const {
  return handle_->OfOneRevision([&](const Built& built) {
    FrameBatch batch{built.revision, static_cast<std::size_t>(built.vertex_count), {}};
    batch.vertices.reserve(2 * batch.vertex_count * points.size());
    internal::BlendBatches(*handle_->channel, internal::BlendRequestOf(id(), built), points,
                           options, [&](const v1::Frame& frame) {
                             internal::AppendVertices(frame.vertices(), &batch.vertices);
                           });
    return batch;
  });
}

WeightTable Session::Weights(std::span<const Point> points) const {
  return handle_->OfOneRevision([&](const Built& built) {
    WeightTable table{built.shape_ids, {}};
    table.values.reserve(built.shape_ids.size() * points.size());
    v1::BlendRequest request = internal::BlendRequestOf(id(), built);
    request.set_weights_only(true);
    internal::BlendBatches(
        *handle_->channel, std::move(request), points, {}, [&](const v1::Frame& frame) {
          table.values.insert(table.values.end(), frame.weights().begin(), frame.weights().end());
        });
    return table;
  });
}

Picture Session::Render(Point at, const RenderOptions& options) const {
  v1::RenderRequest request = internal::RenderRequestOf(id(), options);
  ToMessage(at, options.blend, request.add_queries());
  return internal::RenderOne(handle_->channel, request, /*revision=*/{});
}

Picture Session::Render(const posespace::Weights& weights, const RenderOptions& options) const {
  return handle_->OfOneRevision([&](const Built& built) {
    v1::RenderRequest request = internal::RenderRequestOf(id(), options);
    ToMessage(internal::InOrder(weights, built.shape_ids), options.blend, request.add_queries());
    return internal::RenderOne(handle_->channel, request, built.revision);
  });
}

// An animation that is being read.
struct Animation::State {
  std::optional<TimedFrame> Read() {
    v1::AnimateResponse response;
    if (!answers->Next(&response, internal::Clock::now() + patience)) return std::nullopt;
    return TimedFrame{response.index(),
                      response.time(),
                      {response.at().x(), response.at().y()},
                      FromMessage(response.frame(), built.shape_ids, response.revision())};
  }

  std::shared_ptr<internal::SessionHandle> session;
  v1::AnimateRequest request;
  internal::Clock::duration patience;  // between two frames
  Built built = {};
  std::optional<internal::Answers> answers = {};
};

Animation::Animation(std::unique_ptr<State> state) : state_(std::move(state)) {}
Animation::Animation(Animation&&) noexcept = default;
Animation& Animation::operator=(Animation&&) noexcept = default;
Animation::~Animation() = default;

std::optional<TimedFrame> Animation::Next() {
  if (state_->answers) return state_->Read();
  return state_->session->OfOneRevision([this](const Built& built) {
    state_->built = built;
    state_->request.set_revision(built.revision);
    state_->answers.emplace(state_->session->channel,
                            std::make_unique<v1::AnimateRequest>(state_->request));
    return state_->Read();
  });
}

Animation Session::Animate(std::span<const Waypoint> path, const AnimateOptions& options) const {
  v1::AnimateRequest request;
  request.set_session_id(id());
  ToMessage(options, path, &request);
  internal::Clock::duration patience = handle_->channel->timeout();
  if (options.paced && options.fps > 0.0) {
    const std::chrono::duration<double> instant(std::min(1.0 / options.fps, kLongestInstant));
    patience += std::chrono::duration_cast<internal::Clock::duration>(instant);
  }
  return Animation(
      std::make_unique<Animation::State>(Animation::State{handle_, std::move(request), patience}));
}

Animation Session::Animate(std::span<const Point> path, const AnimateOptions& options) const {
  std::vector<Waypoint> waypoints;
  for (const Point& at : path) waypoints.push_back({at});
  return Animate(waypoints, options);
}

// Pictures that are being read.
struct PictureStream::State {
  int width, height;
  internal::Clock::duration patience;  // between two pictures
  internal::Answers answers;
};

PictureStream::PictureStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
PictureStream::PictureStream(PictureStream&&) noexcept = default;
PictureStream& PictureStream::operator=(PictureStream&&) noexcept = default;
PictureStream::~PictureStream() = default;

std::optional<Picture> PictureStream::Next() {
  v1::RenderResponse response;
  if (!state_->answers.Next(&response, internal::Clock::now() + state_->patience)) {
    return std::nullopt;
  }
  const std::string& image = response.image();
  return Picture{state_->width, state_->height, {image.begin(), image.end()}};
}

PictureStream Session::RenderAnimation(std::span<const Waypoint> path,
                                       const AnimateOptions& animation,
                                       const RenderOptions& picture) const {
  auto request = std::make_unique<v1::RenderRequest>(internal::RenderRequestOf(id(), picture));
  v1::AnimateRequest along;
  ToMessage(animation, path, &along);
  *request->mutable_animation() = std::move(*along.mutable_animation());
  return PictureStream(std::make_unique<PictureStream::State>(
      PictureStream::State{picture.width, picture.height, handle_->channel->timeout(),
                           internal::Answers(handle_->channel, std::move(request))}));
}

Player Session::Play(const std::string& revision) const {
  return Player(handle_->channel, id(), revision);
}

}  // namespace posespace
