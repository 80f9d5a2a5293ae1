// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_SESSION_SERVICE_H_
#define POSESPACE_RPC_SESSION_SERVICE_H_

#include "posespace/v1/session_service.grpc.pb.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "session/registry.h"

namespace posespace {

// Authoring calls; what each does is said in session_service.proto.  Each handler translates,
// calls, translates; those that decode, trace, check, copy much or wait for the store do so on
// `pool`, those that match on `matching`.
class SessionService final : public v1::SessionService::CallbackService {
 public:
  SessionService(Registry& registry, LiveStreams& streams, ComputePool& pool, ComputePool& matching)
      : registry_(registry), streams_(streams), pool_(pool), matching_(matching) {}

  grpc::ServerUnaryReactor* CreateSession(grpc::CallbackServerContext* context,
                                          const v1::CreateSessionRequest* request,
                                          v1::CreateSessionResponse* response) override;
  grpc::ServerUnaryReactor* GetSession(grpc::CallbackServerContext* context,
                                       const v1::GetSessionRequest* request,
                                       v1::GetSessionResponse* response) override;
  grpc::ServerUnaryReactor* ListSessions(grpc::CallbackServerContext* context,
                                         const v1::ListSessionsRequest* request,
                                         v1::ListSessionsResponse* response) override;
  grpc::ServerUnaryReactor* DeleteSession(grpc::CallbackServerContext* context,
                                          const v1::DeleteSessionRequest* request,
                                          v1::DeleteSessionResponse* response) override;

  grpc::ServerUnaryReactor* PutShape(grpc::CallbackServerContext* context,
                                     const v1::PutShapeRequest* request,
                                     v1::PutShapeResponse* response) override;
  grpc::ServerUnaryReactor* GetShape(grpc::CallbackServerContext* context,
                                     const v1::GetShapeRequest* request,
                                     v1::GetShapeResponse* response) override;
  grpc::ServerUnaryReactor* ListShapes(grpc::CallbackServerContext* context,
                                       const v1::ListShapesRequest* request,
                                       v1::ListShapesResponse* response) override;
  grpc::ServerUnaryReactor* DeleteShape(grpc::CallbackServerContext* context,
                                        const v1::DeleteShapeRequest* request,
                                        v1::DeleteShapeResponse* response) override;

  grpc::ServerUnaryReactor* SetCorrespondences(grpc::CallbackServerContext* context,
                                               const v1::SetCorrespondencesRequest* request,
                                               v1::SetCorrespondencesResponse* response) override;
  grpc::ServerUnaryReactor* SuggestCorrespondences(
      grpc::CallbackServerContext* context, const v1::SuggestCorrespondencesRequest* request,
      v1::SuggestCorrespondencesResponse* response) override;
  grpc::ServerUnaryReactor* SetPlacements(grpc::CallbackServerContext* context,
                                          const v1::SetPlacementsRequest* request,
                                          v1::SetPlacementsResponse* response) override;

  grpc::ServerUnaryReactor* StartBuild(grpc::CallbackServerContext* context,
                                       const v1::StartBuildRequest* request,
                                       v1::StartBuildResponse* response) override;
  grpc::ServerWriteReactor<v1::WatchBuildResponse>* WatchBuild(
      grpc::CallbackServerContext* context, const v1::WatchBuildRequest* request) override;
  grpc::ServerUnaryReactor* CancelBuild(grpc::CallbackServerContext* context,
                                        const v1::CancelBuildRequest* request,
                                        v1::CancelBuildResponse* response) override;

 private:
  Registry& registry_;
  LiveStreams& streams_;
  ComputePool& pool_;
  ComputePool& matching_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_SESSION_SERVICE_H_
