// SPDX-License-Identifier: Apache-2.0
#include "posespace/session.h"

#include <algorithm>
#include <utility>

#include "client/cpp/channel.h"
#include "client/cpp/convert.h"
#include "client/cpp/session_handle.h"

namespace posespace {
namespace {

constexpr std::chrono::seconds kMatching{60};  // longer than other calls take

}  // namespace

using internal::FromMessage;
using internal::ToMessage;

const std::string& Session::id() const { return handle_->id; }

SessionState Session::State() const {
  v1::GetSessionRequest request;
  request.set_session_id(id());
  v1::GetSessionResponse response;
  handle_->channel->Call(request, &response);
  return FromMessage(response.session());
}

std::vector<std::string> Session::ShapeIds() const { return State().shape_ids; }

void Session::Delete(const std::string& etag) {
  v1::DeleteSessionRequest request;
  request.set_session_id(id());
  request.set_etag(etag);
  v1::DeleteSessionResponse response;
  handle_->channel->Call(request, &response);
}

Shape Session::PutShape(const std::string& shape_id, ShapeSource source, bool replace, bool flip) {
  v1::PutShapeRequest request;
  request.set_session_id(id());
  request.set_shape_id(shape_id);
  request.set_replace(replace);
  request.set_flip(flip);
  ToMessage(std::move(source), &request);
  v1::PutShapeResponse response;
  handle_->channel->Call(request, &response);
  return FromMessage(response.shape());
}

Shape Session::Shape(const std::string& shape_id) const {
  v1::GetShapeRequest request;
  request.set_session_id(id());
  request.set_shape_id(shape_id);
  v1::GetShapeResponse response;
  handle_->channel->Call(request, &response);
  return FromMessage(response.shape());
}

std::vector<Shape> Session::Shapes() const {
  v1::ListShapesRequest request;
  request.set_session_id(id());
  v1::ListShapesResponse response;
  handle_->channel->Call(request, &response);
  std::vector<posespace::Shape> shapes;
  for (const v1::Shape& message : response.shapes()) shapes.push_back(FromMessage(message));
  return shapes;
}

void Session::DeleteShape(const std::string& shape_id) {
  v1::DeleteShapeRequest request;
  request.set_session_id(id());
  request.set_shape_id(shape_id);
  v1::DeleteShapeResponse response;
  handle_->channel->Call(request, &response);
}

SessionState Session::SetCorrespondences(const std::vector<std::map<std::string, Point>>& tuples,
                                         const std::string& etag) {
  v1::SetCorrespondencesRequest request;
  request.set_session_id(id());
  request.set_etag(etag);
  for (const auto& tuple : tuples) {
    auto& points = *request.add_tuples()->mutable_points();
    for (const auto& [shape_id, at] : tuple) ToMessage(at, &points[shape_id]);
  }
  v1::SetCorrespondencesResponse response;
  handle_->channel->Call(request, &response);
  return FromMessage(response.session());
}

namespace {

v1::Rotation ToMessage(Rotation rotation) {
  return rotation == Rotation::kAny ? v1::ROTATION_ANY : v1::ROTATION_UPRIGHT;
}

}  // namespace

Suggestion Session::Suggest(std::optional<int> samples, Rotation rotation) const {
  v1::SuggestCorrespondencesRequest request;
  request.set_session_id(id());
  if (samples) request.set_samples(*samples);
  request.set_rotation(ToMessage(rotation));
  v1::SuggestCorrespondencesResponse response;
  handle_->channel->Call(request, &response, kMatching);
  return FromMessage(response);
}

SessionState Session::SetPlacements(const std::map<std::string, Point>& placements,
                                    const std::string& etag) {
  v1::SetPlacementsRequest request;
  request.set_session_id(id());
  request.set_etag(etag);
  for (const auto& [shape_id, at] : placements) {
    v1::Placement& placement = *request.add_placements();
    placement.set_shape_id(shape_id);
    ToMessage(at, placement.mutable_at());
  }
  v1::SetPlacementsResponse response;
  handle_->channel->Call(request, &response);
  return FromMessage(response.session());
}

namespace {

v1::StartBuildRequest BuildRequest(const std::string& session_id, const BuildOptions& options) {
  v1::StartBuildRequest request;
  request.set_session_id(session_id);
  v1::BuildOptions& message = *request.mutable_options();
  if (options.tolerance) message.set_tolerance(*options.tolerance);
  if (options.target_edge_length) message.set_target_edge_length(*options.target_edge_length);
  message.set_rotation(ToMessage(options.rotation));
  if (options.max_vertices) message.set_max_vertices(*options.max_vertices);
  if (options.align) message.set_align(*options.align);
  return request;
}

}  // namespace

BuildReport Session::Build(const BuildOptions& options) {
  return internal::BuildAndWait(handle_->channel, BuildRequest(id(), options), options);
}

BuildStatus Session::StartBuild(const BuildOptions& options) {
  v1::StartBuildResponse response;
  handle_->channel->Call(BuildRequest(id(), options), &response);
  return FromMessage(response.build());
}

void Session::CancelBuild() {
  v1::CancelBuildRequest request;
  request.set_session_id(id());
  v1::CancelBuildResponse response;
  handle_->channel->Call(request, &response);
}

}  // namespace posespace
