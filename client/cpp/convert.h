// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_CONVERT_H_
#define POSESPACE_CLIENT_CPP_CONVERT_H_

#include <span>
#include <string>
#include <vector>

#include "posespace/options.h"
#include "posespace/results.h"
#include "posespace/v1/pose_service.pb.h"
#include "posespace/v1/session_service.pb.h"

// Values to messages and back.
namespace posespace::internal {

void ToMessage(Point point, v1::Point* message);
void ToMessage(const BlendOptions& options, v1::BlendOptions* message);
void ToMessage(ShapeSource source, v1::PutShapeRequest* message);
void ToMessage(const AnimateOptions& options, std::span<const Waypoint> path,
               v1::AnimateRequest* message);

// Leaves an allocated `message` of the same form allocated, so that it can be filled again and
// again.
void ToMessage(Point at, const BlendOptions& options, v1::Query* message);
void ToMessage(std::span<const double> weights, const BlendOptions& options, v1::Query* message);

// Weights in the order of `shape_ids`; drawings without one get 0.  Throws kNotFound for others.
std::vector<double> InOrder(const Weights& weights, const std::vector<std::string>& shape_ids);

Shape FromMessage(const v1::Shape& message);
BuildReport FromMessage(const v1::BuildReport& message);
BuildStatus FromMessage(const v1::Build& message);
SessionState FromMessage(const v1::Session& message);
Suggestion FromMessage(const v1::SuggestCorrespondencesResponse& message);
Mesh FromMessage(const v1::Mesh& message);
Frame FromMessage(const v1::Frame& message, const std::vector<std::string>& shape_ids,
                  const std::string& revision);

// Appends the floats of a frame's vertices.
void AppendVertices(const std::string& bytes, std::vector<float>* vertices);

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_CONVERT_H_
