// SPDX-License-Identifier: Apache-2.0
#include "rpc/session_service.h"

#include <string>
#include <utility>

#include "rpc/build_watch.h"
#include "rpc/call.h"
#include "rpc/convert.h"
#include "rpc/suggest_call.h"

namespace posespace {
namespace {

constexpr int kDefaultPage = 100;
constexpr int kLargestPage = 1'000;

Result<int> PageSize(int asked) {
  if (asked == 0) return kDefaultPage;
  if (asked > 0 && asked <= kLargestPage) return asked;
  const std::string wrong = "is " + std::to_string(asked) + ", not 0 to 1000";
  return Error{ErrorCode::kInvalidOption, "page_size " + wrong, {{"page_size", wrong}}};
}

}  // namespace

grpc::ServerUnaryReactor* SessionService::CreateSession(grpc::CallbackServerContext* context,
                                                        const v1::CreateSessionRequest* request,
                                                        v1::CreateSessionResponse* response) {
  return ReplyFrom(pool_, context, "CreateSession", [=, this]() -> Result<void> {
    const auto session = TRY(registry_.Create({request->session_id(),
                                               request->display_name(),
                                               {request->labels().begin(), request->labels().end()},
                                               request->request_id()}));
    ToProto(session->View(), response->mutable_session());
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::GetSession(grpc::CallbackServerContext* context,
                                                     const v1::GetSessionRequest* request,
                                                     v1::GetSessionResponse* response) {
  const auto show = [=](const std::shared_ptr<Session>& session) -> Result<void> {
    ToProto(session->View(), response->mutable_session());
    return {};
  };
  return ReplyAbout(request->session_id(), registry_, pool_, context, "GetSession", show);
}

grpc::ServerUnaryReactor* SessionService::ListSessions(grpc::CallbackServerContext* context,
                                                       const v1::ListSessionsRequest* request,
                                                       v1::ListSessionsResponse* response) {
  return ReplyFrom(pool_, context, "ListSessions", [=, this]() -> Result<void> {
    const int count = TRY(PageSize(request->page_size()));
    auto page = TRY(registry_.List(count, request->page_token()));
    for (const SessionView& view : page.sessions) ToProto(view, response->add_sessions());
    response->set_next_page_token(std::move(page.next_token));
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::DeleteSession(grpc::CallbackServerContext* context,
                                                        const v1::DeleteSessionRequest* request,
                                                        v1::DeleteSessionResponse* /*response*/) {
  return ReplyFrom(pool_, context, "DeleteSession", [=, this]() -> Result<void> {
    auto deleted = registry_.Delete(request->session_id(), request->etag());
    const bool missing = !deleted && deleted.error().code == ErrorCode::kSessionNotFound;
    if (missing && request->allow_missing()) return {};
    return deleted;
  });
}

grpc::ServerUnaryReactor* SessionService::PutShape(grpc::CallbackServerContext* context,
                                                   const v1::PutShapeRequest* request,
                                                   v1::PutShapeResponse* response) {
  return ReplyFrom(pool_, context, "PutShape", [=, this]() -> Result<void> {
    const auto session = TRY(registry_.Find(request->session_id()));
    auto source = TRY(ShapeSourceFromProto(*request));
    const auto drawing = TRY(session->PutShape(request->shape_id(), std::move(source),
                                               request->replace(), request->flip()));
    ToProto(*drawing, response->mutable_shape());
    response->set_etag(session->View().etag);
    registry_.Trim();
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::GetShape(grpc::CallbackServerContext* context,
                                                   const v1::GetShapeRequest* request,
                                                   v1::GetShapeResponse* response) {
  const auto show = [=](const std::shared_ptr<Session>& session) -> Result<void> {
    ToProto(*TRY(session->FindShape(request->shape_id())), response->mutable_shape());
    return {};
  };
  return ReplyAbout(request->session_id(), registry_, pool_, context, "GetShape", show);
}

grpc::ServerUnaryReactor* SessionService::ListShapes(grpc::CallbackServerContext* context,
                                                     const v1::ListShapesRequest* request,
                                                     v1::ListShapesResponse* response) {
  return ReplyFrom(pool_, context, "ListShapes", [=, this]() -> Result<void> {
    const auto session = TRY(registry_.Find(request->session_id()));
    for (const auto& drawing : session->Shapes()) ToProto(*drawing, response->add_shapes());
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::DeleteShape(grpc::CallbackServerContext* context,
                                                      const v1::DeleteShapeRequest* request,
                                                      v1::DeleteShapeResponse* response) {
  return Reply(context, "DeleteShape", [&]() -> Result<void> {
    const auto session = TRY(registry_.Find(request->session_id()));
    TRY(session->DeleteShape(request->shape_id()));
    response->set_etag(session->View().etag);
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::SetCorrespondences(
    grpc::CallbackServerContext* context, const v1::SetCorrespondencesRequest* request,
    v1::SetCorrespondencesResponse* response) {
  return ReplyFrom(pool_, context, "SetCorrespondences", [=, this]() -> Result<void> {
    const auto session = TRY(registry_.Find(request->session_id()));
    auto tuples = CorrespondencesFromProto(*request);
    TRY(session->SetCorrespondences(std::move(tuples), request->etag()));
    ToProto(session->View(), response->mutable_session());
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::SuggestCorrespondences(
    grpc::CallbackServerContext* /*context*/, const v1::SuggestCorrespondencesRequest* request,
    v1::SuggestCorrespondencesResponse* response) {
  return new SuggestCall(registry_, streams_, matching_, *request, *response);
}

grpc::ServerUnaryReactor* SessionService::SetPlacements(grpc::CallbackServerContext* context,
                                                        const v1::SetPlacementsRequest* request,
                                                        v1::SetPlacementsResponse* response) {
  return ReplyFrom(pool_, context, "SetPlacements", [=, this]() -> Result<void> {
    const auto session = TRY(registry_.Find(request->session_id()));
    auto placements = TRY(PlacementsFromProto(*request));
    TRY(session->SetPlacements(std::move(placements), request->etag()));
    ToProto(session->View(), response->mutable_session());
    return {};
  });
}

grpc::ServerUnaryReactor* SessionService::StartBuild(grpc::CallbackServerContext* context,
                                                     const v1::StartBuildRequest* request,
                                                     v1::StartBuildResponse* response) {
  return ReplyFrom(pool_, context, "StartBuild", [=, this]() -> Result<void> {
    const auto session = TRY(registry_.Find(request->session_id()));
    const BuildRequest build = TRY(BuildRequestFromProto(request->options()));
    const BuildStatus status = TRY(session->StartBuild(build, registry_.build_pool()));
    ToProto(status, response->mutable_build());
    response->set_attached(status.attached);
    registry_.Trim();
    return {};
  });
}

grpc::ServerWriteReactor<v1::WatchBuildResponse>* SessionService::WatchBuild(
    grpc::CallbackServerContext* /*context*/, const v1::WatchBuildRequest* request) {
  return new BuildWatch(registry_, streams_, pool_, *request);
}

grpc::ServerUnaryReactor* SessionService::CancelBuild(grpc::CallbackServerContext* context,
                                                      const v1::CancelBuildRequest* request,
                                                      v1::CancelBuildResponse* response) {
  const auto cancel = [=](const std::shared_ptr<Session>& session) -> Result<void> {
    if (const auto job = session->LatestBuild()) {
      if (request->build_id().empty() || request->build_id() == job->Status().id) job->Cancel();
      ToProto(job->Status(), response->mutable_build());
    }
    return {};
  };
  return ReplyAbout(request->session_id(), registry_, pool_, context, "CancelBuild", cancel);
}

}  // namespace posespace
