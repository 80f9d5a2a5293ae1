// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_RPC_SERVICE_FIXTURE_H_
#define POSESPACE_TESTS_RPC_SERVICE_FIXTURE_H_

#include <gmock/gmock.h>
#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "drawing/png_file.h"
#include "posespace/v1/pose_service.grpc.pb.h"
#include "posespace/v1/session_service.grpc.pb.h"
#include "rpc/server.h"
#include "tests/rpc/sample_shapes.h"
#include "tests/support/pictures.h"

namespace posespace {

// The reason in a refusal's details.
inline std::string ReasonOf(const grpc::Status& status) {
  google::rpc::Status details;
  google::rpc::ErrorInfo info;
  details.ParseFromString(status.error_details());
  for (const auto& any : details.details()) any.UnpackTo(&info);
  return info.reason();
}

inline std::vector<std::string> FieldsOf(const grpc::Status& status) {
  google::rpc::Status details;
  google::rpc::BadRequest request;
  details.ParseFromString(status.error_details());
  for (const auto& any : details.details()) {
    if (any.Is<google::rpc::BadRequest>()) any.UnpackTo(&request);
  }
  std::vector<std::string> fields;
  for (const auto& violation : request.field_violations()) fields.push_back(violation.field());
  return fields;
}

// EXPECT_THAT(Call(...), Refuses(grpc::StatusCode::NOT_FOUND, "SESSION_NOT_FOUND"));
MATCHER_P2(Refuses, code, reason, "is refused with " + std::string(reason)) {
  *result_listener << "code " << arg.error_code() << ", reason " << ReasonOf(arg) << ": "
                   << arg.error_message();
  return arg.error_code() == code && ReasonOf(arg) == reason;
}

MATCHER(Succeeds, "succeeds") {
  *result_listener << "code " << arg.error_code() << ", reason " << ReasonOf(arg) << ": "
                   << arg.error_message();
  return arg.ok();
}

// One client's connection; calls end after 60 s, so that a broken server fails a test.
class Client {
 public:
  explicit Client(const std::string& address) {
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(-1);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own
    channel = grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
    sessions = v1::SessionService::NewStub(channel);
    poses = v1::PoseService::NewStub(channel);
  }

  static std::unique_ptr<grpc::ClientContext> Context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    return context;
  }

  // Call(&v1::SessionService::Stub::GetSession, request, &response)
  template <typename Stub, typename Request, typename Response>
  grpc::Status Call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                    const Request& request, Response* response) {
    const auto context = Context();
    if constexpr (std::is_same_v<Stub, v1::SessionService::Stub>) {
      return ((*sessions).*method)(context.get(), request, response);
    } else {
      return ((*poses).*method)(context.get(), request, response);
    }
  }

  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::SessionService::Stub> sessions;
  std::unique_ptr<v1::PoseService::Stub> poses;
};

using SessionStub = v1::SessionService::Stub;
using PoseStub = v1::PoseService::Stub;

// A server on a port of its own, and a client.
class ServiceTest : public ::testing::Test {
 protected:
  explicit ServiceTest(const Limits& limits = {})
      : server_(std::move(Server::Start("127.0.0.1:0", limits)).value()),
        client_(server_->address()) {}

  // A drawing of an ellipse as a PNG file.
  static std::string PngOf(double half_width, double half_height, Colour colour) {
    Image image = PictureOf(200, 200);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double dx = (x + 0.5 - 100.0) / half_width, dy = (y + 0.5 - 100.0) / half_height;
        if (dx * dx + dy * dy <= 1.0) PaintPixel(&image, x, y, colour);
      }
    }
    const auto png = EncodePng(image);
    return {png.begin(), png.end()};
  }

  static v1::PutShapeRequest PutImage(const std::string& session, const std::string& shape,
                                      std::string png) {
    v1::PutShapeRequest request;
    request.set_session_id(session);
    request.set_shape_id(shape);
    request.mutable_image()->set_data(std::move(png));
    return request;
  }

  v1::Session Create(const std::string& id) {
    v1::CreateSessionRequest request;
    request.set_session_id(id);
    v1::CreateSessionResponse response;
    EXPECT_THAT(client_.Call(&SessionStub::CreateSession, request, &response), Succeeds());
    return response.session();
  }

  v1::Shape Put(const v1::PutShapeRequest& request) {
    v1::PutShapeResponse response;
    EXPECT_THAT(client_.Call(&SessionStub::PutShape, request, &response), Succeeds());
    return response.shape();
  }

  // Puts "wide" and "tall" at (0, 0) and (0, 1).
  void Draw(const std::string& session) {
    Put(PutImage(session, "wide", PngOf(80, 40, kRed)));
    Put(PutImage(session, "tall", PngOf(40, 80, kBlue)));
    Place(session, 1.0);
  }

  v1::Session Place(const std::string& session, double distance) {
    v1::SetPlacementsRequest request;
    request.set_session_id(session);
    for (const auto& [id, y] : {std::pair("wide", 0.0), std::pair("tall", distance)}) {
      auto* const placement = request.add_placements();
      placement->set_shape_id(id);
      placement->mutable_at()->set_y(y);
    }
    v1::SetPlacementsResponse response;
    EXPECT_THAT(client_.Call(&SessionStub::SetPlacements, request, &response), Succeeds());
    return response.session();
  }

  v1::Build StartBuild(const std::string& session) {
    v1::StartBuildRequest request;
    request.set_session_id(session);
    v1::StartBuildResponse response;
    EXPECT_THAT(client_.Call(&SessionStub::StartBuild, request, &response), Succeeds());
    return response.build();
  }

  // All events of the latest build after a sequence.
  std::vector<v1::Build> Watch(const std::string& session, std::int64_t after_sequence = 0) {
    v1::WatchBuildRequest request;
    request.set_session_id(session);
    request.set_after_sequence(after_sequence);
    const auto context = Client::Context();
    const auto reader = client_.sessions->WatchBuild(context.get(), request);
    std::vector<v1::Build> events;
    for (v1::WatchBuildResponse event; reader->Read(&event);) events.push_back(event.build());
    EXPECT_THAT(reader->Finish(), Succeeds());
    return events;
  }

  // A built session; returns its revision.
  std::string Built(const std::string& session) {
    Create(session);
    Draw(session);
    StartBuild(session);
    const auto events = Watch(session);
    EXPECT_EQ(events.back().state(), v1::BUILD_STATE_SUCCEEDED) << events.back().ShortDebugString();
    return events.back().report().revision();
  }

  static v1::BlendRequest BlendAt(const std::string& session, const std::vector<double>& ys) {
    v1::BlendRequest request;
    request.set_session_id(session);
    for (const double y : ys) request.add_queries()->mutable_at()->set_y(y);
    return request;
  }

  // Rows x y of a frame's vertices.
  static Points VerticesOf(const v1::Frame& frame) {
    std::vector<float> values(frame.vertices().size() / sizeof(float));
    std::memcpy(values.data(), frame.vertices().data(), frame.vertices().size());
    Points points(static_cast<Eigen::Index>(values.size() / 2), 2);
    for (std::size_t k = 0; k < values.size(); ++k) points.data()[k] = values[k];
    return points;
  }

  std::unique_ptr<Server> server_;
  Client client_;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_RPC_SERVICE_FIXTURE_H_
