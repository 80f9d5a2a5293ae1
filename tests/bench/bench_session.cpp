// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/bench_session.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <stop_token>

#include "posespace/v1/pose_service.grpc.pb.h"

namespace posespace {
namespace {

using SessionStub = v1::SessionService::Stub;

std::shared_ptr<grpc::Channel> ChannelTo(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

void MustBeOk(const grpc::Status& status) {
  if (!status.ok()) throw std::runtime_error("the service refuses: " + status.error_message());
}

// A star of five arms, the longer and the more turned the later the pose.
v1::Ring StarOfPose(int pose, int corners) {
  v1::Ring ring;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / corners;
    const double radius = 70.0 + (10.0 + 5.0 * pose) * std::cos(5.0 * angle);
    const double turned = angle + 0.15 * pose;
    ring.add_coordinates(100.0 + (1.0 + 0.1 * pose) * radius * std::sin(turned));
    ring.add_coordinates(100.0 - (1.0 - 0.1 * pose) * radius * std::cos(turned));
  }
  return ring;
}

void PutStars(SessionStub& stub, const std::string& session, int corners) {
  {
    grpc::ClientContext context;
    v1::CreateSessionRequest request;
    request.set_session_id(session);
    v1::CreateSessionResponse response;
    MustBeOk(stub.CreateSession(&context, request, &response));
  }
  v1::SetPlacementsRequest placements;
  placements.set_session_id(session);
  for (std::size_t pose = 0; pose < kBenchPlaces.size(); ++pose) {
    grpc::ClientContext context;
    v1::PutShapeRequest request;
    request.set_session_id(session);
    request.set_shape_id("pose" + std::to_string(pose));
    *request.mutable_polygon()->mutable_outer() = StarOfPose(static_cast<int>(pose), corners);
    v1::PutShapeResponse response;
    MustBeOk(stub.PutShape(&context, request, &response));
    v1::Placement& placement = *placements.add_placements();
    placement.set_shape_id(request.shape_id());
    placement.mutable_at()->set_x(kBenchPlaces[pose].x());
    placement.mutable_at()->set_y(kBenchPlaces[pose].y());
  }
  grpc::ClientContext context;
  v1::SetPlacementsResponse response;
  MustBeOk(stub.SetPlacements(&context, placements, &response));
}

// Builds and waits; returns the last state.
v1::Build Build(SessionStub& stub, const std::string& session, double tolerance,
                double target_edge_length, const std::stop_token& stop = {}) {
  v1::StartBuildRequest start;
  start.set_session_id(session);
  start.mutable_options()->set_tolerance(tolerance);
  start.mutable_options()->set_target_edge_length(target_edge_length);
  grpc::ClientContext start_context, watch_context;
  v1::StartBuildResponse started;
  MustBeOk(stub.StartBuild(&start_context, start, &started));
  v1::WatchBuildRequest watch;
  watch.set_session_id(session);
  const std::stop_callback cancel(stop, [&] { watch_context.TryCancel(); });
  const auto reader = stub.WatchBuild(&watch_context, watch);
  v1::WatchBuildResponse event;
  while (reader->Read(&event)) {
  }
  reader->Finish();
  return event.build();
}

}  // namespace

CompatibleMesh BuildStars(const std::string& address, const std::string& session, int corners,
                          double target_edge_length) {
  const auto channel = ChannelTo(address);
  const auto sessions = v1::SessionService::NewStub(channel);
  PutStars(*sessions, session, corners);
  if (Build(*sessions, session, 0.01, target_edge_length).state() != v1::BUILD_STATE_SUCCEEDED) {
    throw std::runtime_error("the build failed");
  }
  grpc::ClientContext context;
  v1::GetMeshRequest request;
  request.set_session_id(session);
  v1::GetMeshResponse response;
  MustBeOk(v1::PoseService::NewStub(channel)->GetMesh(&context, request, &response));

  const v1::Mesh& from = response.mesh();
  CompatibleMesh mesh;
  mesh.triangles =
      Eigen::Map<const Triangles>(from.triangles().data(), from.triangles_size() / 3, 3);
  for (const v1::PoseMesh& pose : from.poses()) {
    mesh.poses.push_back(
        Eigen::Map<const Points>(pose.vertices().data(), pose.vertices_size() / 2, 2));
  }
  for (const v1::VertexLoop& loop : from.boundary()) {
    mesh.boundary.emplace_back(loop.vertices().begin(), loop.vertices().end());
  }
  return mesh;
}

BusyBuilds::BusyBuilds(const std::string& address, int count)
    : stub_(v1::SessionService::NewStub(ChannelTo(address))) {
  constexpr int kCorners = 600;
  for (int k = 0; k < count; ++k) {
    const std::string session = "busy" + std::to_string(k);
    PutStars(*stub_, session, kCorners);
    threads_.emplace_back([this, session](const std::stop_token& stop) {
      for (int turn = 0; !stop.stop_requested(); ++turn) {  // other options, or nothing is built
        Build(*stub_, session, 0.002 + 1e-6 * turn, 0.02, stop);
      }
      grpc::ClientContext context;
      v1::DeleteSessionRequest request;
      request.set_session_id(session);
      v1::DeleteSessionResponse response;
      stub_->DeleteSession(&context, request, &response);
    });
  }
}

BusyBuilds::~BusyBuilds() = default;

}  // namespace posespace
