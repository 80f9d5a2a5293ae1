// SPDX-License-Identifier: Apache-2.0
#include "session/pose_space.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drawing/decode.h"
#include "drawing/png_file.h"
#include "geometry/polygon.h"
#include "interpolation/texture_weights.h"
#include "session/build_warnings.h"
#include "session/interior_stage.h"
#include "session/placements.h"
#include "session/reach.h"

namespace posespace {
namespace {

// The shares of a build's progress that mapping and alignment take; the weights take the rest.
constexpr double kMappingShare = 0.5;
constexpr double kAlignmentShare = 0.4;

// Larger weights are refused: they are no drawing, and their sums lose all digits.
constexpr double kMaxWeight = 1e6;

// How far an explicit sum of weights may be from 1.
constexpr double kMaxSumError = 1e-3;

// DefaultView's margin on each side, / size of the box.
constexpr double kViewMargin = 0.05;

std::vector<std::string> IdsOf(std::span<const std::shared_ptr<const Drawing>> drawings) {
  std::vector<std::string> ids;
  for (const auto& drawing : drawings) ids.push_back(drawing->id);
  return ids;
}

Error Refused(ErrorCode code, std::string field, std::string message) {
  std::vector<Violation> where{{std::move(field), message}};
  return Error{code, std::move(message), std::move(where)};
}

Error Cancelled() { return Error{ErrorCode::kCancelled, "the build was cancelled", {}}; }

// Explicit weights, divided by their sum.
Result<Eigen::VectorXd> CheckedWeights(const Eigen::VectorXd& weights, int num_poses) {
  if (weights.size() != num_poses) {
    return Refused(
        ErrorCode::kWeightsCountMismatch, "weights",
        std::to_string(weights.size()) + " weights for " + std::to_string(num_poses) + " drawings");
  }
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (std::abs(weights[i]) <= kMaxWeight) continue;
    const std::string field = "weights[" + std::to_string(i) + "]";
    if (std::isfinite(weights[i])) {
      return Refused(ErrorCode::kInvalidOption, field, field + " is beyond 1e6");
    }
    return Refused(ErrorCode::kWeightsNotFinite, field, field + " is not finite");
  }
  const double sum = weights.sum();
  if (std::abs(sum - 1.0) > kMaxSumError) {
    return Refused(ErrorCode::kWeightsSumNotOne, "weights",
                   "the weights sum to " + std::to_string(sum) + ", not to 1 within 0.001");
  }
  return Eigen::VectorXd(weights / sum);
}

bool IsUpright(const std::vector<int>& turns) {
  return std::all_of(turns.begin(), turns.end(), [](int turn) { return turn == 0; });
}

// Why parts do not fit together, or null: everything that later steps rely on but do not check.
const char* Misfit(const PoseSpace::Parts& parts) {
  const CompatibleMesh& mesh = parts.mesh;
  const std::size_t num_poses = parts.drawings.size();
  const int num_vertices = mesh.num_vertices();
  const auto is_vertex = [num_vertices](int v) { return v >= 0 && v < num_vertices; };
  if (num_poses == 0 || mesh.poses.size() != num_poses || parts.turns.size() != num_poses ||
      parts.mapping.confidence.size() != num_poses || parts.report.confidence.size() != num_poses) {
    return "its lists differ in length";
  }
  if (num_vertices < 3 || mesh.num_triangles() == 0) return "its mesh is empty";
  for (const Points& pose : mesh.poses) {
    if (pose.rows() != num_vertices || !pose.allFinite()) return "a pose is not of its mesh";
  }
  std::vector<bool> used(num_vertices, false);
  for (const std::int32_t v : mesh.triangles.reshaped()) {
    if (!is_vertex(v)) return "a triangle has no such vertex";
    used[v] = true;
  }
  if (!std::all_of(used.begin(), used.end(), [](bool each) { return each; })) {
    return "a vertex has no triangle";
  }
  if (mesh.boundary.empty()) return "its mesh has no boundary";
  for (const std::vector<int>& loop : mesh.boundary) {
    if (loop.size() < 3 || !std::all_of(loop.begin(), loop.end(), is_vertex)) {
      return "a boundary loop is none";
    }
  }
  if (!std::all_of(mesh.landmarks.begin(), mesh.landmarks.end(), is_vertex)) {
    return "a landmark has no such vertex";
  }
  constexpr int kMostTurns = 1'000;  // poses wind around each other once or twice
  for (const int turns : parts.turns) {
    if (std::abs(turns) > kMostTurns) return "a pose turns too often";
  }
  if (parts.reach.rows() != 2 || !parts.reach.allFinite()) return "its box is none";
  return nullptr;
}

}  // namespace

std::int64_t MemoryBytesOf(const Drawing& drawing) {
  const Outline& outline = drawing.outline;
  std::size_t numbers = outline.outer.size() + outline.colours.size();
  for (const Points& hole : outline.holes) numbers += hole.size();
  const std::size_t packed = drawing.png ? drawing.png->size() : 0;
  return static_cast<std::int64_t>(sizeof drawing + numbers * sizeof(double) + packed +
                                   drawing.texture.image.rgba.size());
}

Drawing Packed(Drawing drawing) {
  if (drawing.texture.image.rgba.empty()) return drawing;
  auto png = EncodePng(drawing.texture.image);
  if (png.empty()) throw std::runtime_error("a picture could not be packed");
  drawing.png = std::make_shared<const std::vector<std::uint8_t>>(std::move(png));
  drawing.texture.image.rgba = {};
  return drawing;
}

Texture TextureOf(const Drawing& drawing) {
  Texture texture = drawing.texture;
  if (drawing.png == nullptr) return texture;
  const std::int64_t pixels = std::int64_t{texture.image.width} * texture.image.height;
  auto image = DecodeImage(*drawing.png, {.max_pixels = pixels});
  if (!image || image->width != texture.image.width || image->height != texture.image.height) {
    throw std::runtime_error("the packed pixels of '" + drawing.id + "' are damaged");
  }
  texture.image = std::move(image).value();
  return texture;
}

std::vector<MatchingShape> MatchingShapesOf(
    std::span<const std::shared_ptr<const Drawing>> drawings) {
  std::vector<MatchingShape> shapes;
  for (const auto& drawing : drawings) {
    shapes.push_back({drawing->id, drawing->outline.outer, drawing->outline.colours});
  }
  return shapes;
}

// What placements do not change; shared by all pose spaces of one mesh.
struct PoseSpace::Body {
  std::vector<std::shared_ptr<const Drawing>> drawings;
  std::string mesh_digest;
  CompatibleMesh mesh;
  MappingReport report;  // of mapping alone
  std::vector<std::string> warnings;
  BatchBlend blend;  // without turns

  // Made for the first picture: most pose spaces are only ever blended, and pixels are large.
  const std::vector<RenderTexture>& Textures() const {
    std::call_once(textures_made, [this] {
      std::vector<RenderTexture> made;
      for (const auto& drawing : drawings) made.emplace_back(TextureOf(*drawing));
      textures = std::move(made);
      have_textures = true;
    });
    return textures;
  }

  mutable std::once_flag textures_made = {};
  mutable std::vector<RenderTexture> textures = {};
  mutable std::atomic<bool> have_textures = false;
};

struct PoseSpace::State {
  std::shared_ptr<const Body> body;
  Points placements;
  std::string revision;
  std::vector<int> turns;
  BatchBlend blend;  // with turns
  PoseWeights weights;
  MappingReport report;
  Box reach;
};

Result<std::shared_ptr<const PoseSpace>> PoseSpace::Build(const BuildInputs& inputs,
                                                          Progress* progress) {
  if (inputs.drawings.empty()) {
    return Error{ErrorCode::kNoShapes, "there is no drawing to build from", {}};
  }
  TRY(CheckPlacements(IdsOf(inputs.drawings), inputs.placements));

  Progress mapping_progress(progress, 0.0, kMappingShare);
  auto mapping = TRY(MapShapes(MatchingShapesOf(inputs.drawings), inputs.landmarks, inputs.options,
                               &mapping_progress));
  auto warnings = BuildWarnings(mapping, inputs);
  constexpr double kMeshShare = kMappingShare + kAlignmentShare;
  if (inputs.align) {
    if (progress != nullptr) progress->EnterStage("alignment", kMappingShare, kMeshShare);
    TRY(AlignMapping(inputs.drawings, &mapping, progress));
  }

  if (progress != nullptr) progress->EnterStage("weights", kMeshShare, 1.0);
  auto blend = TRY(BatchBlend::Prepare(mapping.mesh));
  const std::shared_ptr<const Body> body(
      new Body{inputs.drawings, MeshDigest(inputs), std::move(mapping.mesh),
               std::move(mapping.report), std::move(warnings), std::move(blend)});
  return Place(body, inputs.placements, progress);
}

Result<std::shared_ptr<const PoseSpace>> PoseSpace::WithPlacements(const Points& placements,
                                                                   Progress* progress) const {
  TRY(CheckPlacements(IdsOf(drawings()), placements));
  if (progress != nullptr) progress->EnterStage("weights", 0.0, 1.0);
  return Place(state_->body, placements, progress);
}

Result<std::shared_ptr<const PoseSpace>> PoseSpace::Place(const std::shared_ptr<const Body>& body,
                                                          const Points& placements,
                                                          Progress* progress) {
  const auto start = std::chrono::steady_clock::now();
  auto weights = TRY(PoseWeights::Fit(placements, {}, progress));
  if (IsCancelled(progress)) return Cancelled();

  std::vector<int> turns = TurnsAlongPlacements(body->blend.exact().mean_rotations(), placements);
  auto blend = IsUpright(turns) ? body->blend : TRY(BatchBlend::Prepare(body->mesh, turns));

  const Box reach = ReachOf(body->mesh, blend.exact(), placements, progress);
  if (IsCancelled(progress)) return Cancelled();
  MappingReport report = body->report;
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  report.seconds.emplace_back("weights", spent.count());
  auto state = std::make_shared<const State>(
      State{body, placements, RevisionDigest(body->mesh_digest, placements), std::move(turns),
            std::move(blend), std::move(weights), std::move(report), reach});
  return std::shared_ptr<const PoseSpace>(new PoseSpace(std::move(state)));
}

PoseSpace::Parts PoseSpace::ToParts() const {
  const Body& body = *state_->body;
  Points reach(2, 2);
  reach << state_->reach.low.transpose(), state_->reach.high.transpose();
  return {body.drawings,  body.mesh_digest,   body.mesh,     body.report,
          body.warnings,  state_->placements, state_->turns, state_->weights.fit(),
          state_->report, std::move(reach)};
}

Result<std::shared_ptr<const PoseSpace>> PoseSpace::FromParts(Parts parts) {
  const auto refuse = [](const std::string& why) {
    return Error{ErrorCode::kSnapshotCorrupt, "a stored pose space makes no sense: " + why, {}};
  };
  if (const char* const why = Misfit(parts)) return refuse(why);
  if (FindDefect(parts.mesh)) return refuse("its mesh is not valid in every drawing");
  if (const auto placed = CheckPlacements(IdsOf(parts.drawings), parts.placements); !placed) {
    return refuse(placed.error().message);
  }
  auto weights = PoseWeights::FromFit(parts.placements, std::move(parts.weights));
  if (!weights) return refuse(weights.error().message);
  auto plain = BatchBlend::Prepare(parts.mesh);
  if (!plain) return refuse(plain.error().message);
  auto turned = IsUpright(parts.turns) ? plain : BatchBlend::Prepare(parts.mesh, parts.turns);
  if (!turned) return refuse(turned.error().message);

  const std::shared_ptr<const Body> body(
      new Body{std::move(parts.drawings), std::move(parts.mesh_digest), std::move(parts.mesh),
               std::move(parts.mapping), std::move(parts.warnings), std::move(plain).value()});
  std::string revision = RevisionDigest(body->mesh_digest, parts.placements);
  auto state = std::make_shared<const State>(
      State{body, std::move(parts.placements), std::move(revision), std::move(parts.turns),
            std::move(turned).value(), std::move(weights).value(), std::move(parts.report),
            Box{parts.reach.row(0).transpose(), parts.reach.row(1).transpose()}});
  return std::shared_ptr<const PoseSpace>(new PoseSpace(std::move(state)));
}

Result<Frame> PoseSpace::Weighed(const Query& query) const {
  Frame frame;
  frame.weights.resize(mesh().num_poses());
  TRY(Weigh(query, {frame.weights.data(), static_cast<std::size_t>(frame.weights.size())}));
  frame.texture_weights = TextureWeightsOf(query, frame.weights);
  return frame;
}

Result<void> PoseSpace::Weigh(const Query& query, std::span<double> weights) const {
  if (query.options.refits < 0 || query.options.refits > 3) {
    return Refused(ErrorCode::kInvalidOption, "options.refits",
                   "refits is " + std::to_string(query.options.refits) + ", not 0 to 3");
  }
  const std::optional<MeshPoint>& anchor = query.options.anchor;
  if (anchor && (anchor->triangle < 0 || anchor->triangle >= mesh().num_triangles())) {
    return Refused(ErrorCode::kInvalidOption, "options.anchor.triangle",
                   "the anchor's triangle is " + std::to_string(anchor->triangle) +
                       ", and the mesh has 0 to " + std::to_string(mesh().num_triangles() - 1));
  }
  if (!(query.sigma >= 0.0 && query.sigma <= 1.0)) {
    return Refused(ErrorCode::kInvalidOption, "options.sigma", "sigma is not within 0 to 1");
  }
  if (const Point* at = std::get_if<Point>(&query.position)) {
    if (!at->allFinite()) {
      return Refused(ErrorCode::kPoseNotFinite, "at", "the point of pose space is not finite");
    }
    state_->weights.At(*at, weights);
  } else {
    const Eigen::VectorXd checked =
        TRY(CheckedWeights(std::get<Eigen::VectorXd>(query.position), mesh().num_poses()));
    std::copy(checked.begin(), checked.end(), weights.begin());
  }
  return {};
}

Eigen::VectorXd PoseSpace::TextureWeightsOf(const Query& query,
                                            const Eigen::VectorXd& weights) const {
  // Pixels can only be mixed by weights in [0, 1]: raw ones are limited for them all the same.
  const ShearLimit limit =
      query.options.shear_limit == ShearLimit::kOff ? ShearLimit::kBand : query.options.shear_limit;
  return TextureWeights(LimitedWeights(weights, limit), query.sigma);
}

void PoseSpace::Solve(std::span<BlendJob> jobs, const BlendOptions& options) const {
  state_->blend.Solve(jobs, options);
}

Result<Frame> PoseSpace::Blend(const Query& query, bool weights_only) const {
  return std::move(BlendAll({&query, 1}, weights_only).front());
}

std::vector<Result<Frame>> PoseSpace::BlendAll(std::span<const Query> queries,
                                               bool weights_only) const {
  std::vector<Result<Frame>> frames;
  frames.reserve(queries.size());
  for (const Query& query : queries) frames.push_back(Weighed(query));
  if (weights_only) return frames;

  std::vector<BlendJob> jobs;
  std::vector<Frame*> solved;
  std::vector<bool> done(queries.size(), false);
  for (std::size_t first = 0; first < queries.size(); ++first) {
    jobs.clear();
    solved.clear();
    for (std::size_t k = first; k < queries.size(); ++k) {
      if (done[k] || !(queries[k].options == queries[first].options)) continue;
      done[k] = true;
      if (!frames[k]) continue;
      Frame& frame = *frames[k];
      frame.vertices.resize(mesh().num_vertices(), 2);
      jobs.push_back({{frame.weights.data(), static_cast<std::size_t>(frame.weights.size())},
                      frame.vertices.data()});
      solved.push_back(&frame);
    }
    Solve(jobs, queries[first].options);
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      solved[k]->folds = jobs[k].folds;
      solved[k]->mended = jobs[k].mended;
    }
  }
  return frames;
}

Image PoseSpace::Render(const Frame& frame, const View& view, PaintEdges edges) const {
  if (frame.vertices.rows() != mesh().num_vertices()) {
    Image blank{view.width, view.height, {}};
    blank.rgba.resize(4 * static_cast<std::size_t>(view.width) * view.height);
    return blank;
  }
  const std::vector<RenderTexture>& textures = state_->body->Textures();
  std::vector<RenderLayer> layers;
  for (int i = 0; i < mesh().num_poses(); ++i) {
    layers.push_back({&mesh().poses[i], &textures[i], frame.texture_weights[i]});
  }
  return posespace::Render(mesh().triangles, frame.vertices.cast<double>(), layers, view, edges);
}

View PoseSpace::DefaultView(int width, int height) const {
  const auto& [low, high] = state_->reach;
  const Point margin = kViewMargin * (high - low);
  return FitView(low - margin, high + margin, width, height);
}

const std::string& PoseSpace::revision() const { return state_->revision; }
const std::string& PoseSpace::mesh_digest() const { return state_->body->mesh_digest; }
const Points& PoseSpace::placements() const { return state_->placements; }
const CompatibleMesh& PoseSpace::mesh() const { return state_->body->mesh; }
const std::vector<std::shared_ptr<const Drawing>>& PoseSpace::drawings() const {
  return state_->body->drawings;
}
const std::vector<int>& PoseSpace::turns() const { return state_->turns; }
const PoseWeights& PoseSpace::weight_field() const { return state_->weights; }
const MappingReport& PoseSpace::report() const { return state_->report; }
const std::vector<std::string>& PoseSpace::warnings() const { return state_->body->warnings; }

std::int64_t PoseSpace::MemoryBytes() const {
  // Two blends, each with rotations, stretches and a factor in double for two rest shapes, and in
  // float for one.
  constexpr std::int64_t kPerTriangleAndPose = 2 * 4 * (2 * sizeof(double) + sizeof(float));
  constexpr std::int64_t kPerVertex = 2 * (2 * 40 * sizeof(double) + 160 * sizeof(float));
  constexpr std::int64_t kPerTexel = 25;
  std::int64_t bytes =
      std::int64_t{mesh().num_triangles()} * mesh().num_poses() * kPerTriangleAndPose +
      mesh().num_vertices() * kPerVertex + state_->weights.MemoryBytes();
  if (!state_->body->have_textures) return bytes;
  for (const auto& drawing : drawings()) {
    const Image& image = drawing->texture.image;
    bytes += kPerTexel * image.width * image.height;
  }
  return bytes;
}

BuildSummary PoseSpace::Summary() const {
  return {revision(), mesh().num_vertices(), mesh().num_triangles(), IdsOf(drawings()), report(),
          warnings()};
}

}  // namespace posespace
