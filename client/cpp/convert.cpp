// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/convert.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

#include "posespace/error.h"

namespace posespace {

std::string ReadFile(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(), path.string());
  }
  return bytes;
}

namespace internal {
namespace {

static_assert(std::endian::native == std::endian::little, "vertices travel little-endian");

v1::Foreground NumberOf(Foreground foreground) {
  switch (foreground) {
    case Foreground::kAlpha:
      return v1::FOREGROUND_ALPHA;
    case Foreground::kLight:
      return v1::FOREGROUND_LIGHT;
    case Foreground::kDark:
      return v1::FOREGROUND_DARK;
  }
  return v1::FOREGROUND_UNSPECIFIED;
}

v1::BlendMethod NumberOf(BlendMethod method) {
  switch (method) {
    case BlendMethod::kRigid:
      return v1::BLEND_METHOD_RIGID;
    case BlendMethod::kLinear:
      return v1::BLEND_METHOD_LINEAR;
    case BlendMethod::kPaper:
      return v1::BLEND_METHOD_PAPER;
  }
  return v1::BLEND_METHOD_UNSPECIFIED;
}

v1::ShearLimit NumberOf(ShearLimit limit) {
  switch (limit) {
    case ShearLimit::kByMethod:
      return v1::SHEAR_LIMIT_UNSPECIFIED;
    case ShearLimit::kBand:
      return v1::SHEAR_LIMIT_BAND;
    case ShearLimit::kHermite:
      return v1::SHEAR_LIMIT_HERMITE;
    case ShearLimit::kOff:
      return v1::SHEAR_LIMIT_OFF;
  }
  return v1::SHEAR_LIMIT_UNSPECIFIED;
}

v1::StretchBlend NumberOf(StretchBlend stretch) {
  switch (stretch) {
    case StretchBlend::kLinear:
      return v1::STRETCH_BLEND_LINEAR;
    case StretchBlend::kLog:
      return v1::STRETCH_BLEND_LOG;
    case StretchBlend::kMetric:
      return v1::STRETCH_BLEND_METRIC;
  }
  return v1::STRETCH_BLEND_UNSPECIFIED;
}

void RingToMessage(const Ring& ring, v1::Ring* message) {
  for (const Point& point : ring) {
    message->add_coordinates(point.x);
    message->add_coordinates(point.y);
  }
}

// A picture file with its options: of an image or an SVG document.
template <typename Source, typename Sourced>
void ForegroundToMessage(const Source& source, Sourced* message) {
  message->set_foreground(NumberOf(source.foreground));
  if (source.threshold) message->set_threshold(*source.threshold);
}

void OptionsToMessage(const BlendOptions& options, v1::Query* message) {
  if (options == BlendOptions{}) {
    message->clear_options();
  } else {
    ToMessage(options, message->mutable_options());
  }
}

BuildState FromMessage(v1::BuildState state) {
  switch (state) {
    case v1::BUILD_STATE_QUEUED:
      return BuildState::kQueued;
    case v1::BUILD_STATE_SUCCEEDED:
      return BuildState::kSucceeded;
    case v1::BUILD_STATE_FAILED:
      return BuildState::kFailed;
    case v1::BUILD_STATE_CANCELLED:
      return BuildState::kCancelled;
    default:  // a state that this client does not know is not an end
      return BuildState::kRunning;
  }
}

Point FromMessage(const v1::Point& message) { return {message.x(), message.y()}; }

GhostLoss FromMessage(const v1::GhostLoss& message) { return {message.before(), message.after()}; }

Ring FromMessage(const v1::Ring& message) {
  Ring ring;
  for (int k = 0; k + 1 < message.coordinates_size(); k += 2) {
    ring.push_back({message.coordinates(k), message.coordinates(k + 1)});
  }
  return ring;
}

std::vector<Ring> FromMessage(const google::protobuf::RepeatedPtrField<v1::Ring>& messages) {
  std::vector<Ring> rings;
  for (const v1::Ring& message : messages) rings.push_back(FromMessage(message));
  return rings;
}

TexturePlacement FromMessage(const v1::TexturePlacement& message) {
  return {FromMessage(message.origin()), message.scale(), message.width(), message.height()};
}

std::chrono::system_clock::time_point FromMessage(const google::protobuf::Timestamp& message) {
  using std::chrono::system_clock;
  return system_clock::time_point(std::chrono::duration_cast<system_clock::duration>(
      std::chrono::seconds(message.seconds()) + std::chrono::nanoseconds(message.nanos())));
}

std::map<std::string, double> ByDrawing(const google::protobuf::RepeatedField<double>& values,
                                        const std::vector<std::string>& shape_ids) {
  std::map<std::string, double> named;
  for (std::size_t k = 0; k < shape_ids.size() && k < static_cast<std::size_t>(values.size());
       ++k) {
    named[shape_ids[k]] = values[static_cast<int>(k)];
  }
  return named;
}

}  // namespace

void ToMessage(Point point, v1::Point* message) {
  message->set_x(point.x);
  message->set_y(point.y);
}

void ToMessage(const BlendOptions& options, v1::BlendOptions* message) {
  message->set_method(NumberOf(options.method));
  message->set_shear_limit(NumberOf(options.shear_limit));
  if (options.refits) {
    message->set_refits(*options.refits);
  } else {
    message->clear_refits();
  }
  message->set_sigma(options.sigma);
  message->set_stretch(NumberOf(options.stretch));
  message->set_repair(options.repair);
  if (options.anchor) {
    v1::MeshPoint& anchor = *message->mutable_anchor();
    anchor.set_triangle(options.anchor->triangle);
    anchor.set_b(options.anchor->b);
    anchor.set_c(options.anchor->c);
  } else {
    message->clear_anchor();
  }
}

void ToMessage(ShapeSource source, v1::PutShapeRequest* message) {
  if (auto* image = std::get_if<ImageSource>(&source)) {
    ForegroundToMessage(*image, message->mutable_image());
    message->mutable_image()->set_data(std::move(image->data));
  } else if (auto* svg = std::get_if<SvgSource>(&source)) {
    ForegroundToMessage(*svg, message->mutable_svg());
    message->mutable_svg()->set_document(std::move(svg->document));
  } else {
    auto& polygon = std::get<PolygonSource>(source);
    RingToMessage(polygon.outer, message->mutable_polygon()->mutable_outer());
    for (const Ring& hole : polygon.holes) {
      RingToMessage(hole, message->mutable_polygon()->add_holes());
    }
    message->mutable_polygon()->set_texture(std::move(polygon.texture));
  }
}

void ToMessage(const AnimateOptions& options, std::span<const Waypoint> path,
               v1::AnimateRequest* message) {
  v1::Animation& animation = *message->mutable_animation();
  for (const Waypoint& waypoint : path) {
    v1::Waypoint& added = *animation.mutable_path()->add_waypoints();
    ToMessage(waypoint.at, added.mutable_at());
    if (waypoint.time) added.set_time(*waypoint.time);
  }
  animation.mutable_path()->set_loop(options.loop);
  animation.mutable_path()->set_easing(options.easing == Easing::kInOut ? v1::EASING_IN_OUT
                                                                        : v1::EASING_UNIFORM);
  if (options.duration) animation.mutable_path()->set_duration(*options.duration);
  animation.set_fps(options.fps);
  ToMessage(options.blend, animation.mutable_options());
  message->set_paced(options.paced);
}

void ToMessage(Point at, const BlendOptions& options, v1::Query* message) {
  ToMessage(at, message->mutable_at());
  OptionsToMessage(options, message);
}

void ToMessage(std::span<const double> weights, const BlendOptions& options, v1::Query* message) {
  message->mutable_weights()->mutable_values()->Assign(weights.begin(), weights.end());
  OptionsToMessage(options, message);
}

std::vector<double> InOrder(const Weights& weights, const std::vector<std::string>& shape_ids) {
  std::size_t used = 0;
  std::vector<double> values;
  std::string known;
  for (const std::string& shape_id : shape_ids) {
    const auto found = weights.map().find(shape_id);
    values.push_back(found == weights.map().end() ? 0.0 : found->second);
    used += found == weights.map().end() ? 0 : 1;
    known += (known.empty() ? "" : ", ") + shape_id;
  }
  if (used == weights.map().size()) return values;
  for (const auto& [shape_id, weight] : weights.map()) {
    if (std::find(shape_ids.begin(), shape_ids.end(), shape_id) != shape_ids.end()) continue;
    throw Error(ErrorCode::kNotFound,
                "weights name shape '" + shape_id +
                    "', which the built pose space does not have; it has " + known,
                "SHAPE_NOT_FOUND");
  }
  return values;
}

Shape FromMessage(const v1::Shape& message) {
  return {message.id(),
          message.width(),
          message.height(),
          FromMessage(message.outline()),
          message.holes_filled(),
          {message.warnings().begin(), message.warnings().end()},
          FromMessage(message.texture()),
          message.flipped()};
}

BuildReport FromMessage(const v1::BuildReport& message) {
  BuildReport report;
  report.revision = message.revision();
  report.vertices = message.vertices();
  report.triangles = message.triangles();
  report.outline_vertices = message.outline_vertices();
  report.steiner_vertices = message.steiner_vertices();
  report.min_angle = message.min_angle();
  report.levels = {message.levels().begin(), message.levels().end()};
  report.steiner_by_level = {message.steiner_by_level().begin(), message.steiner_by_level().end()};
  report.seconds = {message.seconds().begin(), message.seconds().end()};
  report.confidence = {message.confidence().begin(), message.confidence().end()};
  report.warnings = {message.warnings().begin(), message.warnings().end()};
  if (message.has_ghost_loss()) report.ghost_loss = FromMessage(message.ghost_loss());
  for (const auto& [shape_id, loss] : message.ghost_losses()) {
    report.ghost_losses[shape_id] = FromMessage(loss);
  }
  return report;
}

Suggestion FromMessage(const v1::SuggestCorrespondencesResponse& message) {
  Suggestion suggestion;
  for (const v1::ShapeSuggestion& shape : message.shapes()) {
    suggestion.confidence[shape.shape_id()] = shape.confidence();
    if (shape.flip()) suggestion.flips.push_back(shape.shape_id());
    suggestion.arcs[shape.shape_id()] = FromMessage(shape.arc());
  }
  suggestion.flip_gain = message.flip_gain();
  suggestion.etag = message.etag();
  return suggestion;
}

BuildStatus FromMessage(const v1::Build& message) {
  BuildStatus status;
  status.id = message.id();
  status.state = FromMessage(message.state());
  status.stage = message.stage();
  status.fraction = message.fraction();
  if (message.has_report()) status.report = FromMessage(message.report());
  return status;
}

SessionState FromMessage(const v1::Session& message) {
  SessionState state;
  state.id = message.id();
  state.display_name = message.display_name();
  state.labels = {message.labels().begin(), message.labels().end()};
  state.shape_ids = {message.shape_ids().begin(), message.shape_ids().end()};
  for (const v1::Correspondence& tuple : message.correspondences()) {
    auto& points = state.correspondences.emplace_back();
    for (const auto& [shape_id, at] : tuple.points()) points[shape_id] = FromMessage(at);
  }
  for (const v1::Placement& placement : message.placements()) {
    state.placements[placement.shape_id()] = FromMessage(placement.at());
  }
  state.placements_are_default = message.placements_are_default();
  state.etag = message.etag();
  state.create_time = FromMessage(message.create_time());
  state.update_time = FromMessage(message.update_time());
  state.revision = message.revision();
  if (message.has_build()) state.build = FromMessage(message.build());
  return state;
}

Mesh FromMessage(const v1::Mesh& message) {
  Mesh mesh;
  mesh.revision = message.revision();
  mesh.triangles = {message.triangles().begin(), message.triangles().end()};
  for (const v1::PoseMesh& pose : message.poses()) {
    mesh.poses.push_back({pose.shape_id(),
                          {pose.vertices().begin(), pose.vertices().end()},
                          FromMessage(pose.outlines()),
                          pose.turns(),
                          FromMessage(pose.texture())});
  }
  for (const v1::VertexLoop& loop : message.boundary()) {
    mesh.boundary.emplace_back(loop.vertices().begin(), loop.vertices().end());
  }
  mesh.landmarks = {message.landmarks().begin(), message.landmarks().end()};
  mesh.report = FromMessage(message.report());
  return mesh;
}

Frame FromMessage(const v1::Frame& message, const std::vector<std::string>& shape_ids,
                  const std::string& revision) {
  Frame frame;
  AppendVertices(message.vertices(), &frame.vertices);
  frame.weights = ByDrawing(message.weights(), shape_ids);
  frame.texture_weights = ByDrawing(message.texture_weights(), shape_ids);
  frame.folds = message.folds();
  frame.mended = message.mended();
  frame.revision = revision;
  return frame;
}

void AppendVertices(const std::string& bytes, std::vector<float>* vertices) {
  const std::size_t before = vertices->size();
  vertices->resize(before + bytes.size() / sizeof(float));
  std::memcpy(vertices->data() + before, bytes.data(),
              bytes.size() / sizeof(float) * sizeof(float));
}

}  // namespace internal
}  // namespace posespace
