// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_POSE_SPACE_H_
#define POSESPACE_SESSION_POSE_SPACE_H_

#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "drawing/image.h"
#include "drawing/outline.h"
#include "drawing/render.h"
#include "geometry/progress.h"
#include "geometry/result.h"
#include "interpolation/batch_blend.h"
#include "interpolation/pose_weights.h"
#include "interpolation/rigid_blend.h"
#include "mapping/pipeline.h"

namespace posespace {

// A drawing as it was uploaded and understood.  Immutable.
struct Drawing {
  std::string id;
  std::string digest;    // of the source, its options, and whether it is flipped
  bool flipped = false;  // what follows is the mirror image of what was uploaded
  double width = 0.0;    // drawing pixels
  double height = 0.0;
  Outline outline;
  // Either with its pixels, or, once kept by a session, with their number alone and the pixels as
  // a PNG file beside it: a fiftieth of the memory.  TextureOf has them either way.
  Texture texture;
  std::shared_ptr<const std::vector<std::uint8_t>> png;
};

// About how much memory a drawing takes.
std::int64_t MemoryBytesOf(const Drawing& drawing);

// The same drawing with its pixels packed; empty pictures stay as they are.
Drawing Packed(Drawing drawing);

// The texture with its pixels.  Throws std::runtime_error when packed pixels are damaged, which
// their reader has ruled out by a checksum.
Texture TextureOf(const Drawing& drawing);

// Everything that decides what is built.  Immutable value.
struct BuildInputs {
  std::vector<std::shared_ptr<const Drawing>> drawings;  // in the order of upload
  std::vector<Landmark> landmarks;
  Points placements;  // N x 2, row i the place of drawings[i] in pose space
  MappingOptions options;
  bool align = true;  // inner vertices to what is drawn there (interior_stage.h)
};

// Digest of the inputs and the algorithm version, as lower-case hexadecimal: the mesh's inputs
// alone (without placements), and all of them.  Equal inputs have equal digests; a drawing counts
// by its id and its digest.
std::string MeshDigest(const BuildInputs& inputs);
std::string RevisionDigest(const BuildInputs& inputs);
std::string RevisionDigest(const std::string& mesh_digest, const Points& placements);

// What boundary_matching.h sees of drawings, in their order and under their ids.
std::vector<MatchingShape> MatchingShapesOf(
    std::span<const std::shared_ptr<const Drawing>> drawings);

// What a build came to, in numbers and words: small enough to keep beside every session.
struct BuildSummary {
  std::string revision;
  int vertices = 0;
  int triangles = 0;
  std::vector<std::string> shape_ids;  // in the order of MappingReport::confidence
  MappingReport mapping;
  std::vector<std::string> warnings;
};

// What to blend, and how.
struct Query {
  std::variant<Point, Eigen::VectorXd> position;  // a point of pose space, or explicit weights
  BlendOptions options;
  double sigma = 0.0;  // sharpness of texture transitions, 0 .. 1
};

// A drawing at a place in pose space.
struct Frame {
  Eigen::VectorXd weights;          // N, sum 1
  Eigen::VectorXd texture_weights;  // N, in [0, 1], sum 1
  FloatPoints vertices;             // V x 2; no rows when only weights were wanted
  int folds = 0;                    // triangles that are not positive
  int mended = 0;                   // triangles that repair made positive
};

// What a build makes and everybody shares: the mesh, the blend, the weight field, the textures.
// Immutable; share freely.  A blend takes no lock.
class PoseSpace {
 public:
  // Builds from scratch; reports stages of mapping, "alignment" and "weights" to `progress`.
  //
  // Requires  every landmark has one entry a drawing.
  // Fails     kNoShapes, kSizeMismatch, as CheckPlacements (placements.h) before any work, and as
  //           MapShapes, RigidBlend::Prepare and PoseWeights::Fit do; kCancelled.
  static Result<std::shared_ptr<const PoseSpace>> Build(const BuildInputs& inputs,
                                                        Progress* progress = nullptr);

  // The same mesh, textures and drawings, shared, at other placements: only the weight field and
  // turns are made anew.  Well under a second.
  // Fails  as CheckPlacements, PoseWeights::Fit; kCancelled.
  Result<std::shared_ptr<const PoseSpace>> WithPlacements(const Points& placements,
                                                          Progress* progress = nullptr) const;

  // What is slow to make, as plain values, and the pose space made of it again: it blends as the
  // first one did, to the last bit.
  struct Parts {
    std::vector<std::shared_ptr<const Drawing>> drawings;
    std::string mesh_digest;
    CompatibleMesh mesh;
    MappingReport mapping;  // of the mesh alone
    std::vector<std::string> warnings;
    Points placements;
    std::vector<int> turns;
    PoseWeightsFit weights;
    MappingReport report;
    Points reach;  // 2 x 2: the corners of what blends take up
  };
  Parts ToParts() const;
  // Checks that they fit together: the mesh is valid in every pose, all numbers are finite, indices
  // in range.  Fails with kSnapshotCorrupt.
  static Result<std::shared_ptr<const PoseSpace>> FromParts(Parts parts);

  // Explicit weights are divided by their sum, so a frame's weights sum to 1.
  // Fails  kPoseNotFinite, kWeightsNotFinite, kWeightsCountMismatch, kWeightsSumNotOne (1e-3),
  //        kInvalidOption (refits, sigma, weights beyond 1e6); the field, such as "weights", is the
  //        query's.
  Result<Frame> Blend(const Query& query, bool weights_only = false) const;

  // The blend of each query, solved together where their options agree: several times as fast as
  // one by one, and the same to the last bit.
  std::vector<Result<Frame>> BlendAll(std::span<const Query> queries,
                                      bool weights_only = false) const;

  // The same in memory that the caller keeps, for those who blend all the time: first each query's
  // weights, as many as there are poses, then all that agree in their options, in jobs with these
  // weights.  Allocates as BatchBlend does, and for explicit weights.
  // Fails  as Blend.
  Result<void> Weigh(const Query& query, std::span<double> weights) const;
  void Solve(std::span<BlendJob> jobs, const BlendOptions& options) const;

  // How a query with these weights mixes the poses' pixels.
  Eigen::VectorXd TextureWeightsOf(const Query& query, const Eigen::VectorXd& weights) const;

  // The blend of a query as a picture; transparent when the frame has no vertices.  The first
  // picture makes the textures ready and takes longer, up to some 50 ms a megapixel.
  // Requires  a frame of this pose space; a view whose size is bounded by the caller.
  Image Render(const Frame& frame, const View& view, PaintEdges edges = PaintEdges::kCrisp) const;

  // The view that every picture of this pose space uses unless told otherwise: the box of all poses
  // and of the blends halfway from each to its four nearest in pose space, with a margin of a
  // twentieth of the box on each side.
  View DefaultView(int width, int height) const;

  const std::string& revision() const;     // RevisionDigest of its inputs
  const std::string& mesh_digest() const;  // MeshDigest of its inputs
  const Points& placements() const;        // row i the place of drawings()[i]
  const CompatibleMesh& mesh() const;
  const std::vector<std::shared_ptr<const Drawing>>& drawings() const;
  const std::vector<int>& turns() const;
  const PoseWeights& weight_field() const;
  const MappingReport& report() const;
  const std::vector<std::string>& warnings() const;  // what a person should know of the build
  BuildSummary Summary() const;

  // About how much memory it takes, drawings aside; more once it has drawn a picture.
  std::int64_t MemoryBytes() const;

 private:
  struct Body;
  struct State;
  explicit PoseSpace(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  static Result<std::shared_ptr<const PoseSpace>> Place(const std::shared_ptr<const Body>& body,
                                                        const Points& placements,
                                                        Progress* progress);
  Result<Frame> Weighed(const Query& query) const;  // a frame without vertices
  std::shared_ptr<const State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_POSE_SPACE_H_
