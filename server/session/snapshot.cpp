// SPDX-License-Identifier: Apache-2.0
#include "session/snapshot.h"

#include <string_view>
#include <utility>

#include "session/byte_stream.h"

namespace posespace {
namespace {

constexpr std::string_view kSessionKind = "sess";
constexpr std::string_view kDrawingKind = "draw";
constexpr std::string_view kPoseSpaceKind = "pose";
constexpr int kSessionVersion = 2;
constexpr int kDrawingVersion = 1;
constexpr int kPoseSpaceVersion = 2;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Time = std::chrono::system_clock::time_point;

void Write(const Point& point, ByteWriter& out) { out.Add(point.x()).Add(point.y()); }

Point ReadPoint(ByteReader& in) {
  const double x = in.Real(), y = in.Real();
  return {x, y};
}

void Write(Time time, ByteWriter& out) {
  out.Add(std::int64_t{
      std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count()});
}

Time ReadTime(ByteReader& in) { return Time(std::chrono::nanoseconds(in.Integer())); }

int ReadInt(ByteReader& in) {
  const std::int64_t value = in.Integer();
  const int narrow = static_cast<int>(value);
  if (narrow != value) in.Fail();
  return narrow;
}

void Write(const std::vector<std::string>& texts, ByteWriter& out) {
  out.AddEach(texts, [&](const std::string& text) { out.Add(text); });
}

std::vector<std::string> ReadTexts(ByteReader& in) {
  std::vector<std::string> texts;
  in.ReadEach([&] { texts.push_back(in.Text()); });
  return texts;
}

void Write(const std::vector<int>& values, ByteWriter& out) {
  out.AddEach(values, [&](int value) { out.Add(std::int64_t{value}); });
}

std::vector<int> ReadInts(ByteReader& in) {
  std::vector<int> values;
  in.ReadEach([&] { values.push_back(ReadInt(in)); });
  return values;
}

void Write(const std::vector<DrawingName>& names, ByteWriter& out) {
  out.AddEach(names, [&](const DrawingName& name) { out.Add(name.id).Add(name.digest); });
}

std::vector<DrawingName> ReadDrawingNames(ByteReader& in) {
  std::vector<DrawingName> names;
  in.ReadEach([&] {
    std::string id = in.Text(), digest = in.Text();
    names.push_back({std::move(id), std::move(digest)});
  });
  return names;
}

// Shape ids with points: a correspondence, or placements.
void Write(const std::map<std::string, Point>& points, ByteWriter& out) {
  out.AddEach(points, [&](const auto& entry) {
    out.Add(entry.first);
    Write(entry.second, out);
  });
}

std::map<std::string, Point> ReadNamedPoints(ByteReader& in) {
  std::map<std::string, Point> points;
  in.ReadEach([&] {
    std::string id = in.Text();
    points[std::move(id)] = ReadPoint(in);
  });
  return points;
}

void Write(const MappingReport& report, ByteWriter& out) {
  out.Add(std::int64_t{report.outline_vertices})
      .Add(std::int64_t{report.steiner_vertices})
      .Add(report.min_angle);
  for (const LevelCount& level : report.levels) {
    out.Add(std::int64_t{level.parts}).Add(std::int64_t{level.steiner_vertices});
  }
  out.AddEach(report.confidence, [&](double value) { out.Add(value); });
  out.AddEach(report.seconds, [&](const auto& stage) { out.Add(stage.first).Add(stage.second); });
  for (const auto* ghosts : {&report.ghosts_before, &report.ghosts_after}) {
    out.AddEach(*ghosts, [&](double value) { out.Add(value); });
  }
}

MappingReport ReadMappingReport(ByteReader& in) {
  MappingReport report;
  report.outline_vertices = ReadInt(in);
  report.steiner_vertices = ReadInt(in);
  report.min_angle = in.Real();
  for (LevelCount& level : report.levels) {
    level.parts = ReadInt(in);
    level.steiner_vertices = ReadInt(in);
  }
  in.ReadEach([&] { report.confidence.push_back(in.Real()); });
  in.ReadEach([&] {
    std::string stage = in.Text();
    report.seconds.emplace_back(std::move(stage), in.Real());
  });
  for (auto* ghosts : {&report.ghosts_before, &report.ghosts_after}) {
    in.ReadEach([&] { ghosts->push_back(in.Real()); });
  }
  return report;
}

void Write(const BuildSummary& summary, ByteWriter& out) {
  out.Add(summary.revision)
      .Add(std::int64_t{summary.vertices})
      .Add(std::int64_t{summary.triangles});
  Write(summary.shape_ids, out);
  Write(summary.mapping, out);
  Write(summary.warnings, out);
}

BuildSummary ReadBuildSummary(ByteReader& in) {
  BuildSummary summary;
  summary.revision = in.Text();
  summary.vertices = ReadInt(in);
  summary.triangles = ReadInt(in);
  summary.shape_ids = ReadTexts(in);
  summary.mapping = ReadMappingReport(in);
  summary.warnings = ReadTexts(in);
  return summary;
}

void Write(const CompatibleMesh& mesh, ByteWriter& out) {
  out.Add(mesh.triangles);
  out.AddEach(mesh.poses, [&](const Points& pose) { out.Add(pose); });
  out.AddEach(mesh.boundary, [&](const std::vector<int>& loop) { Write(loop, out); });
  Write(mesh.landmarks, out);
}

CompatibleMesh ReadMesh(ByteReader& in) {
  CompatibleMesh mesh;
  mesh.triangles = in.Read<Triangles>();
  in.ReadEach([&] { mesh.poses.push_back(in.Read<Points>()); });
  in.ReadEach([&] { mesh.boundary.push_back(ReadInts(in)); });
  mesh.landmarks = ReadInts(in);
  return mesh;
}

void Write(const PoseWeightsFit& fit, ByteWriter& out) {
  out.Add(fit.lattice.vertices).Add(fit.lattice.triangles);
  Write(fit.lattice.pose_vertices, out);
  Write(fit.lattice.size, out);
  out.Add(fit.lattice.spacing).Add(fit.data);
}

PoseWeightsFit ReadWeights(ByteReader& in) {
  PoseWeightsFit fit;
  fit.lattice.vertices = in.Read<Points>();
  fit.lattice.triangles = in.Read<Triangles>();
  fit.lattice.pose_vertices = ReadInts(in);
  fit.lattice.size = ReadPoint(in);
  fit.lattice.spacing = in.Real();
  fit.data = in.Read<LatticeData>();
  return fit;
}

}  // namespace

Bytes ToBytes(const SessionRecord& record) {
  ByteWriter out;
  out.Add(record.id).Add(record.display_name);
  out.AddEach(record.labels, [&](const auto& label) { out.Add(label.first).Add(label.second); });
  out.Add(record.nonce).Add(record.version);
  Write(record.created, out);
  Write(record.updated, out);
  Write(record.drawings, out);
  out.AddEach(record.correspondences, [&](const Correspondence& tuple) { Write(tuple, out); });
  Write(record.placements, out);
  out.Add(record.builds).Add(record.build_id).Add(std::int64_t{record.built.has_value()});
  if (record.built) Write(*record.built, out);
  Write(record.built_from, out);
  return out.Sealed(kSessionKind, kSessionVersion);
}

Result<SessionRecord> SessionRecordFromBytes(std::span<const std::uint8_t> bytes) {
  ByteReader in = TRY(ByteReader::Unseal(bytes, kSessionKind, kSessionVersion));
  SessionRecord record;
  record.id = in.Text();
  record.display_name = in.Text();
  in.ReadEach([&] {
    std::string key = in.Text();
    record.labels[std::move(key)] = in.Text();
  });
  record.nonce = in.Text();
  record.version = in.Integer();
  record.created = ReadTime(in);
  record.updated = ReadTime(in);
  record.drawings = ReadDrawingNames(in);
  in.ReadEach([&] { record.correspondences.push_back(ReadNamedPoints(in)); });
  record.placements = ReadNamedPoints(in);
  record.builds = in.Integer();
  record.build_id = in.Text();
  if (in.Integer() != 0) record.built = ReadBuildSummary(in);
  record.built_from = ReadDrawingNames(in);
  TRY(in.Finish());
  return record;
}

Bytes ToBytes(const Drawing& drawing) {
  ByteWriter out;
  out.Add(drawing.digest).Add(std::int64_t{drawing.flipped});
  out.Add(drawing.width).Add(drawing.height);
  const Outline& outline = drawing.outline;
  out.Add(outline.outer);
  out.AddEach(outline.holes, [&](const Points& hole) { out.Add(hole); });
  out.Add(RowMajor(outline.colours)).Add(std::int64_t{outline.holes_filled});
  Write(outline.warnings, out);
  const Texture& texture = drawing.texture;
  Write(texture.origin, out);
  out.Add(texture.scale)
      .Add(std::int64_t{texture.image.width})
      .Add(std::int64_t{texture.image.height});
  out.Add(drawing.png ? std::span<const std::uint8_t>(*drawing.png)
                      : std::span<const std::uint8_t>());
  return out.Sealed(kDrawingKind, kDrawingVersion);
}

Result<Drawing> DrawingFromBytes(const DrawingName& name, std::span<const std::uint8_t> bytes) {
  ByteReader in = TRY(ByteReader::Unseal(bytes, kDrawingKind, kDrawingVersion));
  Drawing drawing;
  drawing.id = name.id;
  drawing.digest = in.Text();
  if (drawing.digest != name.digest) in.Fail();
  drawing.flipped = in.Integer() != 0;
  drawing.width = in.Real();
  drawing.height = in.Real();
  Outline& outline = drawing.outline;
  outline.outer = in.Read<Points>();
  in.ReadEach([&] { outline.holes.push_back(in.Read<Points>()); });
  outline.colours = in.Read<RowMajor>();
  outline.holes_filled = ReadInt(in);
  outline.warnings = ReadTexts(in);
  Texture& texture = drawing.texture;
  texture.origin = ReadPoint(in);
  texture.scale = in.Real();
  texture.image.width = ReadInt(in);
  texture.image.height = ReadInt(in);
  const auto png = in.Block();
  if (!png.empty()) {
    drawing.png = std::make_shared<const std::vector<std::uint8_t>>(png.begin(), png.end());
  }
  TRY(in.Finish());
  return drawing;
}

Bytes ToBytes(const PoseSpace& pose_space) {
  const PoseSpace::Parts parts = pose_space.ToParts();
  std::vector<DrawingName> names;
  for (const auto& drawing : parts.drawings) names.push_back({drawing->id, drawing->digest});
  ByteWriter out;
  out.Add(pose_space.revision());
  Write(names, out);
  out.Add(parts.mesh_digest);
  Write(parts.mesh, out);
  Write(parts.mapping, out);
  Write(parts.warnings, out);
  out.Add(parts.placements);
  Write(parts.turns, out);
  Write(parts.weights, out);
  Write(parts.report, out);
  out.Add(parts.reach);
  return out.Sealed(kPoseSpaceKind, kPoseSpaceVersion);
}

Result<std::shared_ptr<const PoseSpace>> PoseSpaceFromBytes(std::span<const std::uint8_t> bytes,
                                                            const FindDrawing& find) {
  ByteReader in = TRY(ByteReader::Unseal(bytes, kPoseSpaceKind, kPoseSpaceVersion));
  const std::string revision = in.Text();
  PoseSpace::Parts parts;
  for (const DrawingName& name : ReadDrawingNames(in)) {
    parts.drawings.push_back(find(name));
    if (parts.drawings.back() == nullptr) in.Fail();
  }
  parts.mesh_digest = in.Text();
  parts.mesh = ReadMesh(in);
  parts.mapping = ReadMappingReport(in);
  parts.warnings = ReadTexts(in);
  parts.placements = in.Read<Points>();
  parts.turns = ReadInts(in);
  parts.weights = ReadWeights(in);
  parts.report = ReadMappingReport(in);
  parts.reach = in.Read<Points>();
  if (revision != RevisionDigest(parts.mesh_digest, parts.placements)) in.Fail();
  TRY(in.Finish());
  return PoseSpace::FromParts(std::move(parts));
}

std::string DrawingKey(const std::string& digest) { return "drawing/" + digest; }

std::string PoseSpaceKey(const std::string& revision) { return "pose-space/" + revision; }

}  // namespace posespace
