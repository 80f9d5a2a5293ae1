// SPDX-License-Identifier: Apache-2.0
#include "session/pose_space.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

#include "interpolation/texture_weights.h"
#include "session/placements.h"

namespace posespace {
namespace {

// The share of a build's progress that mapping takes; the weights take the rest.
constexpr double kMappingShare = 0.9;

// Larger weights are refused: they are no drawing, and their sums lose all digits.
constexpr double kMaxWeight = 1e6;

// How far an explicit sum of weights may be from 1.
constexpr double kMaxSumError = 1e-3;

// A drawing whose matching is less clear than this should be checked (MatchedOutlines::confidence).
constexpr double kLeastConfidence = 0.5;

// More Steiner vertices than this mostly come from wrong matches.
constexpr int kManySteinerVertices = 12;

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

// True when a person has said which part of drawing i is which: three marks leave little to find.
bool IsMarked(const BuildInputs& inputs, std::size_t i) {
  constexpr int kEnoughMarks = 3;
  return std::count_if(inputs.landmarks.begin(), inputs.landmarks.end(), [i](const Landmark& each) {
           return each.points[i].has_value();
         }) >= kEnoughMarks;
}

// What a person should check in the pictures before trusting the blends.
std::vector<std::string> WarningsOf(const Mapping& mapping, const BuildInputs& inputs) {
  const MappingReport& report = mapping.report;
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < report.confidence.size(); ++i) {
    if (mapping.proposal.flips[i]) {
      warnings.push_back("drawing '" + inputs.drawings[i]->id +
                         "' seems to face the other way: suggest() shows it; if it does, put it "
                         "again with flip");
      continue;
    }
    if (report.confidence[i] >= kLeastConfidence || IsMarked(inputs, i)) continue;
    warnings.push_back("please check shape '" + inputs.drawings[i]->id +
                       "': it is not clear which part of it is which part of the others; mark "
                       "correspondences");
  }
  if (report.steiner_vertices > kManySteinerVertices) {
    warnings.push_back("please check the matching: the drawings needed " +
                       std::to_string(report.steiner_vertices) +
                       " inner vertices to share one mesh, as wrongly matched drawings do");
  }
  return warnings;
}

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

struct Box {
  Point low, high;
};

// The poses nearest to pose i in pose space, itself left out, at most `count`.
std::vector<int> NeighboursOf(int i, const Points& placements, std::size_t count) {
  std::vector<std::pair<double, int>> others;
  for (int j = 0; j < placements.rows(); ++j) {
    if (j != i) others.emplace_back((placements.row(j) - placements.row(i)).stableNorm(), j);
  }
  std::sort(others.begin(), others.end());
  others.resize(std::min(others.size(), count));
  std::vector<int> neighbours;
  for (const auto& [distance, j] : others) neighbours.push_back(j);
  return neighbours;
}

// What the poses take up, and the blends halfway to their neighbours: turning parts reach beyond
// both.  Incomplete when cancelled.
Box ReachOf(const CompatibleMesh& mesh, const RigidBlend& blend, const Points& placements,
            const Progress* progress) {
  constexpr std::size_t kNeighbours = 4;  // bounds the cost for many poses
  Box box{mesh.poses[0].row(0).transpose(), mesh.poses[0].row(0).transpose()};
  const auto include = [&box](const Points& vertices) {
    box.low = box.low.cwiseMin(vertices.colwise().minCoeff().transpose());
    box.high = box.high.cwiseMax(vertices.colwise().maxCoeff().transpose());
  };
  BlendOptions rough;
  rough.refits = 0;
  for (int i = 0; i < mesh.num_poses(); ++i) {
    include(mesh.poses[i]);
    for (const int j : NeighboursOf(i, placements, kNeighbours)) {
      if (IsCancelled(progress)) return box;
      Eigen::VectorXd halves = Eigen::VectorXd::Zero(mesh.num_poses());
      halves[i] = halves[j] = 0.5;
      include(blend.At(halves, rough));
    }
  }
  return box;
}

}  // namespace

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
  RigidBlend blend;  // without turns
  std::vector<RenderTexture> textures;
};

struct PoseSpace::State {
  std::shared_ptr<const Body> body;
  Points placements;
  std::string revision;
  std::vector<int> turns;
  RigidBlend blend;  // with turns
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
  auto warnings = WarningsOf(mapping, inputs);

  if (progress != nullptr) progress->EnterStage("weights", kMappingShare, 1.0);
  auto blend = TRY(RigidBlend::Prepare(mapping.mesh));
  std::vector<RenderTexture> textures;
  textures.reserve(inputs.drawings.size());
  for (const auto& drawing : inputs.drawings) {
    if (IsCancelled(progress)) return Cancelled();
    textures.emplace_back(drawing->texture);
  }
  const auto body = std::make_shared<const Body>(
      Body{inputs.drawings, MeshDigest(inputs), std::move(mapping.mesh), std::move(mapping.report),
           std::move(warnings), std::move(blend), std::move(textures)});
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

  std::vector<int> turns = TurnsAlongPlacements(body->blend.mean_rotations(), placements);
  const bool upright = std::all_of(turns.begin(), turns.end(), [](int t) { return t == 0; });
  auto blend = upright ? body->blend : TRY(RigidBlend::Prepare(body->mesh, turns));

  const Box reach = ReachOf(body->mesh, blend, placements, progress);
  if (IsCancelled(progress)) return Cancelled();
  MappingReport report = body->report;
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  report.seconds.emplace_back("weights", spent.count());
  auto state = std::make_shared<const State>(
      State{body, placements, RevisionDigest(body->mesh_digest, placements), std::move(turns),
            std::move(blend), std::move(weights), std::move(report), reach});
  return std::shared_ptr<const PoseSpace>(new PoseSpace(std::move(state)));
}

Result<Frame> PoseSpace::Blend(const Query& query, bool weights_only) const {
  if (query.options.refits < 0 || query.options.refits > 3) {
    return Refused(ErrorCode::kInvalidOption, "options.refits",
                   "refits is " + std::to_string(query.options.refits) + ", not 0 to 3");
  }
  if (!(query.sigma >= 0.0 && query.sigma <= 1.0)) {
    return Refused(ErrorCode::kInvalidOption, "options.sigma", "sigma is not within 0 to 1");
  }

  Frame frame;
  if (const Point* at = std::get_if<Point>(&query.position)) {
    if (!at->allFinite()) {
      return Refused(ErrorCode::kPoseNotFinite, "at", "the point of pose space is not finite");
    }
    frame.weights = state_->weights.At(*at);
  } else {
    frame.weights =
        TRY(CheckedWeights(std::get<Eigen::VectorXd>(query.position), mesh().num_poses()));
  }

  // Pixels can only be mixed by weights in [0, 1]: raw ones are limited for them all the same.
  const ShearLimit limit =
      query.options.shear_limit == ShearLimit::kOff ? ShearLimit::kBand : query.options.shear_limit;
  frame.texture_weights = TextureWeights(LimitedWeights(frame.weights, limit), query.sigma);

  if (weights_only) return frame;
  frame.vertices = state_->blend.At(frame.weights, query.options);
  frame.folds = CountFolds(mesh().triangles, frame.vertices);
  return frame;
}

Image PoseSpace::Render(const Frame& frame, const View& view) const {
  if (frame.vertices.rows() != mesh().num_vertices()) {
    Image blank{view.width, view.height, {}};
    blank.rgba.resize(4 * static_cast<std::size_t>(view.width) * view.height);
    return blank;
  }
  std::vector<RenderLayer> layers;
  for (int i = 0; i < mesh().num_poses(); ++i) {
    layers.push_back({&mesh().poses[i], &state_->body->textures[i], frame.texture_weights[i]});
  }
  return posespace::Render(mesh().triangles, frame.vertices, layers, view);
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
const MappingReport& PoseSpace::report() const { return state_->report; }
const std::vector<std::string>& PoseSpace::warnings() const { return state_->body->warnings; }

}  // namespace posespace
