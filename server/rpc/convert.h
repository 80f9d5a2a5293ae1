// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_CONVERT_H_
#define POSESPACE_RPC_CONVERT_H_

#include <string>
#include <vector>

#include "geometry/result.h"
#include "posespace/v1/geometry.pb.h"
#include "posespace/v1/session_service.pb.h"
#include "session/build_job.h"
#include "session/pose_space.h"
#include "session/session.h"

// Authoring messages <-> session types; queries and frames are in query_convert.h.  Reading checks
// what only a message can get wrong: what is missing, given twice, odd, or not known here.  Numbers
// are checked where they are used.  All functions are pure.

namespace posespace {

// Fails  kShapeSourceMissing, kInvalidOption (foreground, an odd number of coordinates).
Result<ShapeSource> ShapeSourceFromProto(const v1::PutShapeRequest& request);

std::vector<Correspondence> CorrespondencesFromProto(const v1::SetCorrespondencesRequest& request);

// Fails  kInvalidOption (samples not 1 to 1024, an unknown rotation).
Result<SuggestRequest> SuggestRequestFromProto(const v1::SuggestCorrespondencesRequest& request);

// Fails  kInvalidOption (no place, a shape placed twice); all faults at once.
Result<Placements> PlacementsFromProto(const v1::SetPlacementsRequest& request);

// Fails  kInvalidOption (an unknown rotation).
Result<BuildRequest> BuildRequestFromProto(const v1::BuildOptions& options);

void ToProto(const SessionView& view, v1::Session* session);
void ToProto(const Suggestion& suggestion, v1::SuggestCorrespondencesResponse* response);
void ToProto(const Drawing& drawing, v1::Shape* shape);
void ToProto(const BuildStatus& status, v1::Build* build);
void ToProto(const Texture& texture, v1::TexturePlacement* placement);
void ToProto(const BuildSummary& summary, v1::BuildReport* report);
void ToProto(const PoseSpace& pose_space, v1::Mesh* mesh);

}  // namespace posespace

#endif  // POSESPACE_RPC_CONVERT_H_
