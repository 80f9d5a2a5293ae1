// SPDX-License-Identifier: Apache-2.0
#include "rpc/convert.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "rpc/shown_error.h"
#include "session/ids.h"

namespace posespace {
namespace {

constexpr std::size_t kTextBytes = 1'024;  // of one warning or message
constexpr int kMostSamples = 1'024;        // of a suggested matching

Error Refusal(ErrorCode code, std::string field, std::string description) {
  return Error{code, field + " " + description, {{field, description}}};
}

// One error for all violations: the message tells the first.
Error Refusal(ErrorCode code, std::vector<Violation> where) {
  std::string message = where[0].field + " " + where[0].description;
  if (where.size() > 1) message += " (and " + std::to_string(where.size() - 1) + " more)";
  return Error{code, std::move(message), std::move(where)};
}

Result<Points> RingFromProto(const v1::Ring& ring, const std::string& field) {
  const int count = ring.coordinates_size();
  if (count % 2 != 0) {
    return Refusal(ErrorCode::kInvalidOption, field,
                   "has " + std::to_string(count) + " numbers: they should be pairs x y");
  }
  return Points(Eigen::Map<const Points>(ring.coordinates().data(), count / 2, 2));
}

std::vector<std::uint8_t> BytesOf(const std::string& data) { return {data.begin(), data.end()}; }

Result<ForegroundOptions> OptionsFromProto(v1::Foreground foreground, std::optional<int> threshold,
                                           const std::string& field) {
  switch (foreground) {
    case v1::FOREGROUND_UNSPECIFIED:
    case v1::FOREGROUND_ALPHA:
      return ForegroundOptions{Foreground::kAlpha, threshold};
    case v1::FOREGROUND_LIGHT:
      return ForegroundOptions{Foreground::kLight, threshold};
    case v1::FOREGROUND_DARK:
      return ForegroundOptions{Foreground::kDark, threshold};
    default:
      return Refusal(ErrorCode::kInvalidOption, field + ".foreground",
                     "is " + std::to_string(foreground) + ", which is not known here");
  }
}

// The options of a message that says which pixels of a picture are the drawing.
template <typename Message>
Result<ForegroundOptions> OptionsFromProto(const Message& message, const std::string& field) {
  const std::optional<int> threshold =
      message.has_threshold() ? std::optional(message.threshold()) : std::nullopt;
  return OptionsFromProto(message.foreground(), threshold, field);
}

Result<ShapeSource> ImageFromProto(const v1::ImageSource& image) {
  const ForegroundOptions options = TRY(OptionsFromProto(image, "image"));
  return ShapeSource(ImageSource{BytesOf(image.data()), options});
}

Result<ShapeSource> SvgFromProto(const v1::SvgSource& svg) {
  const ForegroundOptions options = TRY(OptionsFromProto(svg, "svg"));
  return ShapeSource(SvgSource{BytesOf(svg.document()), options});
}

Result<ShapeSource> PolygonFromProto(const v1::PolygonSource& polygon) {
  PolygonSource source;
  source.outer = TRY(RingFromProto(polygon.outer(), "polygon.outer"));
  for (int k = 0; k < polygon.holes_size(); ++k) {
    source.holes.push_back(
        TRY(RingFromProto(polygon.holes(k), "polygon.holes[" + std::to_string(k) + "]")));
  }
  source.texture = BytesOf(polygon.texture());
  return ShapeSource(std::move(source));
}

Result<Rotation> RotationFromProto(v1::Rotation rotation, const std::string& field) {
  switch (rotation) {
    case v1::ROTATION_UNSPECIFIED:
    case v1::ROTATION_UPRIGHT:
      return Rotation::kUpright;
    case v1::ROTATION_ANY:
      return Rotation::kAny;
    default:
      return Refusal(ErrorCode::kInvalidOption, field,
                     "is " + std::to_string(rotation) + ", which is not known here");
  }
}

void ToProto(const Point& point, v1::Point* out) {
  out->set_x(point.x());
  out->set_y(point.y());
}

void ToProto(const Points& ring, v1::Ring* out) {
  out->mutable_coordinates()->Assign(ring.data(), ring.data() + ring.size());
}

// Outer ring first, holes after it.
void ToProto(const Outline& outline, google::protobuf::RepeatedPtrField<v1::Ring>* rings) {
  ToProto(outline.outer, rings->Add());
  for (const Points& hole : outline.holes) ToProto(hole, rings->Add());
}

void ToProto(std::chrono::system_clock::time_point time, google::protobuf::Timestamp* out) {
  const auto since = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  out->set_seconds(seconds.count());
  out->set_nanos(static_cast<std::int32_t>(std::chrono::nanoseconds(since - seconds).count()));
}

v1::BuildState ToProto(BuildState state) {
  switch (state) {
    case BuildState::kQueued:
      return v1::BUILD_STATE_QUEUED;
    case BuildState::kRunning:
      return v1::BUILD_STATE_RUNNING;
    case BuildState::kSucceeded:
      return v1::BUILD_STATE_SUCCEEDED;
    case BuildState::kFailed:
      return v1::BUILD_STATE_FAILED;
    case BuildState::kCancelled:
      return v1::BUILD_STATE_CANCELLED;
  }
  return v1::BUILD_STATE_UNSPECIFIED;
}

Result<ShapeSource> SourceFromProto(const v1::PutShapeRequest& request) {
  switch (request.source_case()) {
    case v1::PutShapeRequest::kImage:
      return ImageFromProto(request.image());
    case v1::PutShapeRequest::kPolygon:
      return PolygonFromProto(request.polygon());
    case v1::PutShapeRequest::kSvg:
      return SvgFromProto(request.svg());
    case v1::PutShapeRequest::SOURCE_NOT_SET:
      break;
  }
  return Refusal(ErrorCode::kShapeSourceMissing, "source",
                 "is missing: give an image, an SVG document or a polygon");
}

}  // namespace

Result<ShapeSource> ShapeSourceFromProto(const v1::PutShapeRequest& request) {
  auto source = SourceFromProto(request);
  if (source) return source;
  Error refused = std::move(source).error();
  refused.message = "shape '" + request.shape_id() + "': " + refused.message;
  return refused;
}

std::vector<Correspondence> CorrespondencesFromProto(const v1::SetCorrespondencesRequest& request) {
  std::vector<Correspondence> tuples;
  for (const v1::Correspondence& marks : request.tuples()) {
    Correspondence& tuple = tuples.emplace_back();
    for (const auto& [shape_id, point] : marks.points()) {
      tuple.emplace(shape_id, Point(point.x(), point.y()));
    }
  }
  return tuples;
}

Result<SuggestRequest> SuggestRequestFromProto(const v1::SuggestCorrespondencesRequest& request) {
  SuggestRequest suggest;
  if (request.has_samples()) suggest.samples = request.samples();
  if (suggest.samples < 1 || suggest.samples > kMostSamples) {
    return Refusal(
        ErrorCode::kInvalidOption, "samples",
        "is " + std::to_string(suggest.samples) + ", not 1 to " + std::to_string(kMostSamples));
  }
  suggest.rotation = TRY(RotationFromProto(request.rotation(), "rotation"));
  return suggest;
}

Result<Placements> PlacementsFromProto(const v1::SetPlacementsRequest& request) {
  Placements placements;
  std::vector<Violation> unusable;
  for (const v1::Placement& placement : request.placements()) {
    const std::string field = "placements[" + Quoted(placement.shape_id()) + "]";
    if (!placement.has_at()) unusable.push_back({field + ".at", "is missing"});
    const Point at(placement.at().x(), placement.at().y());
    if (!placements.emplace(placement.shape_id(), at).second) {
      unusable.push_back({field, "is given twice"});
    }
  }
  if (!unusable.empty()) return Refusal(ErrorCode::kInvalidOption, std::move(unusable));
  return placements;
}

Result<BuildRequest> BuildRequestFromProto(const v1::BuildOptions& options) {
  BuildRequest request;
  if (options.has_tolerance()) request.tolerance = options.tolerance();
  if (options.has_target_edge_length()) request.target_edge_length = options.target_edge_length();
  request.rotation = TRY(RotationFromProto(options.rotation(), "options.rotation"));
  if (options.has_align()) request.align = options.align();
  if (options.has_max_vertices()) request.max_vertices = options.max_vertices();
  return request;
}

void ToProto(const SessionView& view, v1::Session* session) {
  session->set_id(view.id);
  session->set_display_name(view.display_name);
  session->mutable_labels()->insert(view.labels.begin(), view.labels.end());
  session->mutable_shape_ids()->Assign(view.shape_ids.begin(), view.shape_ids.end());
  for (const Correspondence& tuple : view.correspondences) {
    auto& points = *session->add_correspondences()->mutable_points();
    for (const auto& [shape_id, point] : tuple) ToProto(point, &points[shape_id]);
  }
  for (const std::string& shape_id : view.shape_ids) {
    const auto place = view.placements.find(shape_id);
    if (place == view.placements.end()) continue;
    v1::Placement* const placement = session->add_placements();
    placement->set_shape_id(shape_id);
    ToProto(place->second, placement->mutable_at());
  }
  session->set_placements_are_default(view.placements_are_default);
  session->set_etag(view.etag);
  ToProto(view.created, session->mutable_create_time());
  ToProto(view.updated, session->mutable_update_time());
  session->set_revision(view.revision);
  if (view.build) ToProto(*view.build, session->mutable_build());
}

void ToProto(const Suggestion& suggestion, v1::SuggestCorrespondencesResponse* response) {
  for (std::size_t k = 0; k < suggestion.shape_ids.size(); ++k) {
    v1::ShapeSuggestion* const shape = response->add_shapes();
    shape->set_shape_id(suggestion.shape_ids[k]);
    shape->set_confidence(suggestion.confidence[k]);
    shape->set_flip(suggestion.proposal.flips[k]);
    ToProto(suggestion.arcs[k], shape->mutable_arc());
  }
  response->set_flip_gain(suggestion.proposal.gain);
  response->set_etag(suggestion.etag);
}

void ToProto(const Drawing& drawing, v1::Shape* shape) {
  shape->set_id(drawing.id);
  shape->set_width(drawing.width);
  shape->set_height(drawing.height);
  ToProto(drawing.outline, shape->mutable_outline());
  shape->set_holes_filled(drawing.outline.holes_filled);
  shape->set_flipped(drawing.flipped);
  for (const std::string& warning : drawing.outline.warnings) {
    shape->add_warnings(CleanText(warning, kTextBytes));
  }
  ToProto(drawing.texture, shape->mutable_texture());
}

void ToProto(const BuildStatus& status, v1::Build* build) {
  build->set_id(status.id);
  build->set_state(ToProto(status.state));
  build->set_stage(status.stage);
  build->set_fraction(status.fraction);
  build->set_sequence(status.sequence);
  if (status.summary) ToProto(*status.summary, build->mutable_report());
  if (status.error) {
    const Error error = Shown(*status.error);
    build->mutable_error()->set_reason(std::string(ReasonName(error.code)));
    build->mutable_error()->set_message(CleanText(error.message, kTextBytes));
    for (const Violation& violation : error.where) {
      build->mutable_error()->add_fields(CleanText(violation.field, kTextBytes));
    }
  }
}

void ToProto(const Texture& texture, v1::TexturePlacement* placement) {
  ToProto(texture.origin, placement->mutable_origin());
  placement->set_scale(texture.scale);
  placement->set_width(texture.image.width);
  placement->set_height(texture.image.height);
}

void ToProto(const BuildSummary& summary, v1::BuildReport* report) {
  const MappingReport& mapping = summary.mapping;
  report->set_revision(summary.revision);
  report->set_vertices(summary.vertices);
  report->set_triangles(summary.triangles);
  report->set_outline_vertices(mapping.outline_vertices);
  report->set_steiner_vertices(mapping.steiner_vertices);
  report->set_min_angle(mapping.min_angle);
  for (std::size_t k = 0; k < kNumLevels; ++k) {
    const LevelCount& level = mapping.levels[k];
    if (level.parts == 0) continue;
    (*report->mutable_levels())[kLevelNames[k]] = level.parts;
    (*report->mutable_steiner_by_level())[kLevelNames[k]] = level.steiner_vertices;
  }
  for (const auto& [stage, seconds] : mapping.seconds) {
    (*report->mutable_seconds())[stage] = seconds;
  }
  const std::size_t count = std::min(summary.shape_ids.size(), mapping.confidence.size());
  for (std::size_t k = 0; k < count; ++k) {
    (*report->mutable_confidence())[summary.shape_ids[k]] = mapping.confidence[k];
  }
  const std::size_t losses = std::min(
      {mapping.ghosts_before.size(), mapping.ghosts_after.size(), summary.shape_ids.size() + 1});
  for (std::size_t k = 0; k < losses; ++k) {
    v1::GhostLoss& loss = k == 0 ? *report->mutable_ghost_loss()
                                 : (*report->mutable_ghost_losses())[summary.shape_ids[k - 1]];
    loss.set_before(mapping.ghosts_before[k]);
    loss.set_after(mapping.ghosts_after[k]);
  }
  for (const std::string& warning : summary.warnings) {
    report->add_warnings(CleanText(warning, kTextBytes));
  }
}

void ToProto(const PoseSpace& pose_space, v1::Mesh* mesh) {
  const CompatibleMesh& compatible = pose_space.mesh();
  mesh->set_revision(pose_space.revision());
  mesh->mutable_triangles()->Assign(compatible.triangles.data(),
                                    compatible.triangles.data() + compatible.triangles.size());
  for (const std::vector<int>& loop : compatible.boundary) {
    mesh->add_boundary()->mutable_vertices()->Assign(loop.begin(), loop.end());
  }
  for (std::size_t k = 0; k < pose_space.drawings().size(); ++k) {
    const Drawing& drawing = *pose_space.drawings()[k];
    const Points& pose = compatible.poses[k];
    v1::PoseMesh* const out = mesh->add_poses();
    out->set_shape_id(drawing.id);
    out->mutable_vertices()->Assign(pose.data(), pose.data() + pose.size());
    ToProto(drawing.outline, out->mutable_outlines());
    out->set_turns(pose_space.turns()[k]);
    ToProto(drawing.texture, out->mutable_texture());
  }
  mesh->mutable_landmarks()->Assign(compatible.landmarks.begin(), compatible.landmarks.end());
  ToProto(pose_space.Summary(), mesh->mutable_report());
}

}  // namespace posespace
