// SPDX-License-Identifier: Apache-2.0
#include "rpc/query_convert.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace posespace {
namespace {

Result<MeshPoint> MeshPointFromProto(const v1::MeshPoint& point) {
  constexpr double kRounding = 1e-6;
  const double least = std::min({point.b(), point.c(), 1.0 - point.b() - point.c()});
  if (!(least >= -kRounding)) {
    return ErrorAt(ErrorCode::kInvalidOption, "options.anchor",
                   "is not in its triangle: b = " + std::to_string(point.b()) +
                       ", c = " + std::to_string(point.c()) +
                       ", which must not be negative nor sum to over 1");
  }
  return MeshPoint{point.triangle(), point.b(), point.c()};
}

Result<BlendOptions> BlendOptionsFromProto(const v1::BlendOptions& options) {
  BlendOptions blend;
  switch (options.method()) {
    case v1::BLEND_METHOD_UNSPECIFIED:
    case v1::BLEND_METHOD_RIGID:
      blend.method = BlendMethod::kRigid;
      break;
    case v1::BLEND_METHOD_LINEAR:
      blend.method = BlendMethod::kLinear;
      break;
    case v1::BLEND_METHOD_PAPER:
      blend.method = BlendMethod::kPaper;
      break;
    default:
      return ErrorAt(ErrorCode::kInvalidOption, "options.method",
                     "is " + std::to_string(options.method()) + ", which is not known here");
  }
  switch (options.shear_limit()) {
    case v1::SHEAR_LIMIT_UNSPECIFIED:
      blend.shear_limit =
          blend.method == BlendMethod::kPaper ? ShearLimit::kHermite : ShearLimit::kBand;
      break;
    case v1::SHEAR_LIMIT_BAND:
      blend.shear_limit = ShearLimit::kBand;
      break;
    case v1::SHEAR_LIMIT_HERMITE:
      blend.shear_limit = ShearLimit::kHermite;
      break;
    case v1::SHEAR_LIMIT_OFF:
      blend.shear_limit = ShearLimit::kOff;
      break;
    default:
      return ErrorAt(ErrorCode::kInvalidOption, "options.shear_limit",
                     "is " + std::to_string(options.shear_limit()) + ", which is not known here");
  }
  switch (options.stretch()) {
    case v1::STRETCH_BLEND_UNSPECIFIED:
    case v1::STRETCH_BLEND_LINEAR:
      blend.stretch = StretchBlend::kLinear;
      break;
    case v1::STRETCH_BLEND_LOG:
      blend.stretch = StretchBlend::kLog;
      break;
    case v1::STRETCH_BLEND_METRIC:
      blend.stretch = StretchBlend::kMetric;
      break;
    default:
      return ErrorAt(ErrorCode::kInvalidOption, "options.stretch",
                     "is " + std::to_string(options.stretch()) + ", which is not known here");
  }
  blend.repair = options.repair();
  if (options.has_anchor()) blend.anchor = TRY(MeshPointFromProto(options.anchor()));
  if (options.has_refits()) blend.refits = options.refits();
  if (blend.refits < 0 || blend.refits > 3) {
    return ErrorAt(ErrorCode::kInvalidOption, "options.refits",
                   "is " + std::to_string(blend.refits) + ", not 0 to 3");
  }
  return blend;
}

}  // namespace

Result<Query> QueryFromProto(const v1::Query& query) {
  Query result;
  TRY(QueryFromProto(query, &result));
  return result;
}

Result<void> QueryFromProto(const v1::Query& query, Query* result) {
  switch (query.position_case()) {
    case v1::Query::kAt: {
      const Point at(query.at().x(), query.at().y());
      if (!at.allFinite()) return ErrorAt(ErrorCode::kPoseNotFinite, "at", "is not finite");
      result->position = at;
      break;
    }
    case v1::Query::kWeights: {
      const auto& values = query.weights().values();
      const Eigen::Map<const Eigen::VectorXd> weights(values.data(), values.size());
      if (!weights.allFinite()) {
        return ErrorAt(ErrorCode::kWeightsNotFinite, "weights", "are not all finite");
      }
      result->position = Eigen::VectorXd(weights);
      break;
    }
    case v1::Query::POSITION_NOT_SET:
      return ErrorAt(ErrorCode::kInvalidOption, "position", "is missing: give at or weights");
  }
  result->options = TRY(BlendOptionsFromProto(query.options()));
  result->sigma = query.options().sigma();
  if (!(result->sigma >= 0.0 && result->sigma <= 1.0)) {
    return ErrorAt(ErrorCode::kInvalidOption, "options.sigma",
                   "is " + std::to_string(result->sigma) + ", not 0 to 1");
  }
  return {};
}

Result<void> CheckQueryCount(int count, int most) {
  if (count == 0) return ErrorAt(ErrorCode::kInvalidOption, "queries", "is empty");
  if (count <= most) return {};
  return ErrorAt(
      ErrorCode::kTooManyQueries, "queries",
      "has " + std::to_string(count) + " entries; at most " + std::to_string(most) + " are taken");
}

Result<void> CheckRevision(const PoseSpace& pose_space, const std::string& revision) {
  if (revision.empty() || revision == pose_space.revision()) return {};
  return Error{ErrorCode::kRevisionNotFound,
               "revision '" + revision + "' is not current; " + pose_space.revision() + " is",
               {}};
}

std::string QueryField(int index) { return "queries[" + std::to_string(index) + "]"; }

std::vector<Result<Frame>> BlendQueries(const PoseSpace& pose_space,
                                        std::span<const NamedQuery> queries, bool weights_only) {
  std::vector<Result<Frame>> frames;
  std::vector<Query> parsed;
  std::vector<std::size_t> numbers;  // of those parsed
  for (std::size_t k = 0; k < queries.size(); ++k) {
    auto query = QueryFromProto(*queries[k].query);
    if (!query) {
      frames.push_back(std::move(query).error());
      continue;
    }
    parsed.push_back(std::move(*query));
    numbers.push_back(k);
    frames.push_back(Frame());
  }
  auto blended = pose_space.BlendAll(parsed, weights_only);
  for (std::size_t k = 0; k < numbers.size(); ++k) frames[numbers[k]] = std::move(blended[k]);

  for (std::size_t k = 0; k < queries.size(); ++k) {
    if (frames[k]) continue;
    Error error = std::move(frames[k]).error();
    if (error.where.empty()) {
      error.where.push_back({queries[k].query->has_weights() ? "weights" : "at", error.message});
    }
    error.message = queries[k].field + ": " + error.message;
    frames[k] = Under(queries[k].field, std::move(error));
  }
  return frames;
}

Result<Frame> BlendQuery(const PoseSpace& pose_space, const v1::Query& query,
                         const std::string& field, bool weights_only) {
  const NamedQuery named{&query, field};
  return std::move(BlendQueries(pose_space, {&named, 1}, weights_only).front());
}

double EstimateMicroseconds(const PoseSpace& pose_space, const v1::Query& query, bool weights_only,
                            bool together) {
  constexpr double kWeights = 0.3;          // the weight field and the limits
  constexpr double kSolve = 0.02;           // a vertex, each time it is solved for, alone
  constexpr double kSolveTogether = 0.004;  // the same, in the lanes of a vector
  constexpr double kExact = 0.12;           // the same, for what is blended in double
  constexpr double kLogarithms = 0.2;       // a vertex and pose
  constexpr double kMending = 10.0;         // a vertex
  if (weights_only) return kWeights;
  const v1::BlendOptions& options = query.options();
  const double vertices = pose_space.mesh().num_vertices();
  const bool is_rigid = options.method() == v1::BLEND_METHOD_UNSPECIFIED ||
                        options.method() == v1::BLEND_METHOD_RIGID;
  const bool is_linear = options.stretch() == v1::STRETCH_BLEND_UNSPECIFIED ||
                         options.stretch() == v1::STRETCH_BLEND_LINEAR;
  const int solves = 1 + (options.has_refits() ? options.refits() : BlendOptions().refits);
  const double solve = !is_rigid || !is_linear ? kExact : together ? kSolveTogether : kSolve;
  double sum = kWeights + solve * solves * vertices;
  if (!is_linear) sum += kLogarithms * pose_space.mesh().num_poses() * vertices;
  if (options.repair()) sum += kMending * vertices;
  return sum;
}

void ToProto(const Frame& frame, bool with_weights, v1::Frame* out) {
  if (with_weights) {
    out->mutable_weights()->Assign(frame.weights.data(),
                                   frame.weights.data() + frame.weights.size());
    out->mutable_texture_weights()->Assign(
        frame.texture_weights.data(), frame.texture_weights.data() + frame.texture_weights.size());
  }
  out->set_folds(frame.folds);
  out->set_mended(frame.mended);
  static_assert(std::endian::native == std::endian::little, "vertices travel little-endian");
  out->set_vertices(frame.vertices.data(), frame.vertices.size() * sizeof(float));
}

Result<PaintEdges> EdgesFromProto(v1::Edges edges) {
  switch (edges) {
    case v1::EDGES_UNSPECIFIED:
    case v1::EDGES_CRISP:
      return PaintEdges::kCrisp;
    case v1::EDGES_SOFT:
      return PaintEdges::kSoft;
    default:
      return ErrorAt(ErrorCode::kInvalidOption, "edges",
                     "is " + std::to_string(edges) + ", which is not known here");
  }
}

Result<View> ViewFromProto(const v1::RenderRequest& request, const PoseSpace& pose_space,
                           int max_side) {
  for (const auto& [field, side] :
       {std::pair("width", request.width()), std::pair("height", request.height())}) {
    if (side < 1 || side > max_side) {
      return ErrorAt(ErrorCode::kInvalidOption, field,
                     "is " + std::to_string(side) + ", not 1 to " + std::to_string(max_side));
    }
  }
  if (request.format() != v1::IMAGE_FORMAT_UNSPECIFIED &&
      request.format() != v1::IMAGE_FORMAT_PNG && request.format() != v1::IMAGE_FORMAT_RGBA) {
    return ErrorAt(ErrorCode::kInvalidOption, "format",
                   "is " + std::to_string(request.format()) + ", which is not known here");
  }
  if (!request.has_view()) return pose_space.DefaultView(request.width(), request.height());

  const v1::Box& box = request.view();
  const Point low(box.x(), box.y());
  const Point high(box.x() + box.width(), box.y() + box.height());
  // Beyond 1e9 a double no longer places pixels exactly enough to draw them.
  constexpr double kFarthest = 1e9;
  const bool usable = box.width() >= 1e-6 && box.height() >= 1e-6 &&
                      low.cwiseAbs().maxCoeff() <= kFarthest &&
                      high.cwiseAbs().maxCoeff() <= kFarthest;
  if (!usable || !low.allFinite() || !high.allFinite()) {
    return ErrorAt(ErrorCode::kInvalidOption, "view",
                   "is not a box with finite corners and a size greater than 0");
  }
  return FitView(low, high, request.width(), request.height());
}

}  // namespace posespace
