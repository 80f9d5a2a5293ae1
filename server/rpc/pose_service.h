// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_POSE_SERVICE_H_
#define POSESPACE_RPC_POSE_SERVICE_H_

#include "posespace/v1/pose_service.grpc.pb.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "rpc/message_bytes_traits.h"
#include "rpc/picture_budget.h"
#include "session/registry.h"

namespace posespace {

// Every call by callbacks; Play with answers that are bytes already.
using PoseCallbackService =
    v1::PoseService::WithCallbackMethod_GetMesh<v1::PoseService::WithCallbackMethod_GetTexture<
        v1::PoseService::WithCallbackMethod_Blend<v1::PoseService::WithCallbackMethod_Animate<
            v1::PoseService::WithCallbackMethod_Render<v1::PoseService::Service>>>>>;

// Run-time calls; what each does is said in pose_service.proto.  Blends run on `blend_pool` unless
// they are short, pictures and whole meshes on `bulk_pool`, so that frames never wait for pictures.
class PoseService final : public PoseCallbackService {
 public:
  PoseService(Registry& registry, LiveStreams& streams, ComputePool& blend_pool,
              ComputePool& bulk_pool)
      : registry_(registry),
        streams_(streams),
        blend_pool_(blend_pool),
        bulk_pool_(bulk_pool),
        pictures_(registry.limits().max_picture_bytes) {
    MarkMethodCallback(PlayIndex(),
                       new grpc::internal::CallbackBidiHandler<v1::PlayRequest, MessageBytes>(
                           [this](grpc::CallbackServerContext*) { return Play(); }));
  }

  grpc::ServerUnaryReactor* GetMesh(grpc::CallbackServerContext* context,
                                    const v1::GetMeshRequest* request,
                                    v1::GetMeshResponse* response) override;
  grpc::ServerUnaryReactor* GetTexture(grpc::CallbackServerContext* context,
                                       const v1::GetTextureRequest* request,
                                       v1::GetTextureResponse* response) override;
  grpc::ServerUnaryReactor* Blend(grpc::CallbackServerContext* context,
                                  const v1::BlendRequest* request,
                                  v1::BlendResponse* response) override;
  grpc::ServerWriteReactor<v1::AnimateResponse>* Animate(
      grpc::CallbackServerContext* context, const v1::AnimateRequest* request) override;
  grpc::ServerWriteReactor<v1::RenderResponse>* Render(grpc::CallbackServerContext* context,
                                                       const v1::RenderRequest* request) override;

 private:
  static int PlayIndex();
  grpc::ServerBidiReactor<v1::PlayRequest, MessageBytes>* Play();
  Result<std::shared_ptr<const PoseSpace>> Built(const std::string& session_id) const;
  bool IsShort(const Session& session, const v1::BlendRequest& request) const;

  Registry& registry_;
  LiveStreams& streams_;
  ComputePool& blend_pool_;
  ComputePool& bulk_pool_;
  PictureBudget pictures_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_POSE_SERVICE_H_
