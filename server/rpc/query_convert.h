// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_QUERY_CONVERT_H_
#define POSESPACE_RPC_QUERY_CONVERT_H_

#include <span>
#include <string>
#include <vector>

#include "drawing/render.h"
#include "geometry/result.h"
#include "posespace/v1/pose_service.pb.h"
#include "session/pose_space.h"

// Queries and frames, as they travel and as the pose space has them.  All functions are pure.

namespace posespace {

// Fields in errors are relative to the query: "at", "weights", "options.sigma".
// Fails  kInvalidOption (no position, unknown enum value, refits, sigma), kPoseNotFinite,
//        kWeightsNotFinite.
Result<Query> QueryFromProto(const v1::Query& query);

// The same into a query whose memory is used again; after a failure it means nothing.
Result<void> QueryFromProto(const v1::Query& query, Query* result);

// A request has 1 to `most` queries.  Fails  kTooManyQueries, kInvalidOption (none).
Result<void> CheckQueryCount(int count, int most);

// An empty revision is any.  Fails  kRevisionNotFound.
Result<void> CheckRevision(const PoseSpace& pose_space, const std::string& revision);

// The path of a request's query: "queries[3]".
std::string QueryField(int index);

// A query, and its path in the request, such as "queries[3]", which begins each field of an error.
struct NamedQuery {
  const v1::Query* query;
  std::string field;
};

// The blend of each query, solved together (PoseSpace::BlendAll).
std::vector<Result<Frame>> BlendQueries(const PoseSpace& pose_space,
                                        std::span<const NamedQuery> queries, bool weights_only);

// The blend of one query.
Result<Frame> BlendQuery(const PoseSpace& pose_space, const v1::Query& query,
                         const std::string& field, bool weights_only);

// About how long a blend takes, in microseconds, alone or together with others like it: good enough
// to decide which thread should do it.
double EstimateMicroseconds(const PoseSpace& pose_space, const v1::Query& query, bool weights_only,
                            bool together = false);

// Vertices become little-endian float32 x0 y0 x1 y1 ...; weights are left out unless wanted.
void ToProto(const Frame& frame, bool with_weights, v1::Frame* out);

// Fails  kInvalidOption (unknown value).
Result<PaintEdges> EdgesFromProto(v1::Edges edges);

// What a picture shows: the request's box, or the pose space's default.
// Fails  kInvalidOption (size, format, view).
Result<View> ViewFromProto(const v1::RenderRequest& request, const PoseSpace& pose_space,
                           int max_side);

}  // namespace posespace

#endif  // POSESPACE_RPC_QUERY_CONVERT_H_
