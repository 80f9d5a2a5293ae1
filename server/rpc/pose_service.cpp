// SPDX-License-Identifier: Apache-2.0
#include "rpc/pose_service.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rpc/animate_stream.h"
#include "rpc/call.h"
#include "rpc/convert.h"
#include "rpc/play_reactor.h"
#include "rpc/query_convert.h"
#include "rpc/render_stream.h"

namespace posespace {

// gRPC knows methods by their place in the proto file.
int PoseService::PlayIndex() {
  const auto* const service =
      v1::PlayRequest::descriptor()->file()->FindServiceByName("PoseService");
  return service->FindMethodByName("Play")->index();
}

Result<std::shared_ptr<const PoseSpace>> PoseService::Built(const std::string& session_id) const {
  const auto session = TRY(registry_.Find(session_id));
  return session->Built();
}

grpc::ServerUnaryReactor* PoseService::GetMesh(grpc::CallbackServerContext* context,
                                               const v1::GetMeshRequest* request,
                                               v1::GetMeshResponse* response) {
  return ReplyFrom(bulk_pool_, context, "GetMesh", [=, this]() -> Result<void> {
    const auto pose_space = TRY(Built(request->session_id()));
    TRY(CheckRevision(*pose_space, request->revision()));
    ToProto(*pose_space, response->mutable_mesh());
    return {};
  });
}

grpc::ServerUnaryReactor* PoseService::GetTexture(grpc::CallbackServerContext* context,
                                                  const v1::GetTextureRequest* request,
                                                  v1::GetTextureResponse* response) {
  return ReplyFrom(bulk_pool_, context, "GetTexture", [=, this]() -> Result<void> {
    const auto pose_space = TRY(Built(request->session_id()));
    const auto& drawings = pose_space->drawings();
    const auto drawing = std::find_if(drawings.begin(), drawings.end(), [&](const auto& each) {
      return each->id == request->shape_id();
    });
    if (drawing == drawings.end()) {
      return Error{ErrorCode::kShapeNotFound,
                   "shape '" + request->shape_id() + "' is not in the built pose space",
                   {}};
    }
    const auto png = Packed(**drawing).png;
    response->mutable_png()->assign(png->begin(), png->end());
    ToProto((*drawing)->texture, response->mutable_placement());
    return {};
  });
}

// Short enough for the thread that took the call.  A request that will be refused is short, too.
bool PoseService::IsShort(const Session& session, const v1::BlendRequest& request) const {
  const auto pose_space = session.Built();
  if (!pose_space || request.queries_size() > registry_.limits().max_queries) return true;
  double sum = 0.0;
  for (const v1::Query& query : request.queries()) {
    sum += EstimateMicroseconds(**pose_space, query, request.weights_only());
  }
  return sum <= PlayStream::kShortWork;
}

grpc::ServerUnaryReactor* PoseService::Blend(grpc::CallbackServerContext* context,
                                             const v1::BlendRequest* request,
                                             v1::BlendResponse* response) {
  const auto blend = [=, this](const std::shared_ptr<Session>& session) -> Result<void> {
    const auto pose_space = TRY(session->Built());
    TRY(CheckRevision(*pose_space, request->revision()));
    TRY(CheckQueryCount(request->queries_size(), registry_.limits().max_queries));
    std::vector<NamedQuery> queries;
    for (int k = 0; k < request->queries_size(); ++k) {
      queries.push_back({&request->queries(k), QueryField(k)});
    }
    for (auto& blended : BlendQueries(*pose_space, queries, request->weights_only())) {
      const Frame frame = TRY(std::move(blended));
      ToProto(frame, /*with_weights=*/true, response->add_frames());
    }
    response->set_revision(pose_space->revision());
    return {};
  };
  const auto session = registry_.Peek(request->session_id());
  if (session && *session != nullptr && !IsShort(**session, *request)) {
    return ReplyFrom(blend_pool_, context, "Blend",
                     [=, session = *session] { return blend(session); });
  }
  return ReplyAbout(request->session_id(), registry_, bulk_pool_, context, "Blend", blend);
}

grpc::ServerBidiReactor<v1::PlayRequest, MessageBytes>* PoseService::Play() {
  return new PlayReactor(registry_, streams_, blend_pool_, bulk_pool_);
}

grpc::ServerWriteReactor<v1::AnimateResponse>* PoseService::Animate(
    grpc::CallbackServerContext* /*context*/, const v1::AnimateRequest* request) {
  return new AnimateStream(registry_, streams_, blend_pool_, bulk_pool_, *request);
}

grpc::ServerWriteReactor<v1::RenderResponse>* PoseService::Render(
    grpc::CallbackServerContext* /*context*/, const v1::RenderRequest* request) {
  return new RenderStream(registry_, streams_, bulk_pool_, pictures_, *request);
}

}  // namespace posespace
