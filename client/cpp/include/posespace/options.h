// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_OPTIONS_H_
#define POSESPACE_OPTIONS_H_

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace posespace {

// What calls take: plain values, each with the service's defaults.
//
// Drawing coordinates are pixels of the source drawing, x right, y down.  Pose-space coordinates
// are unit-free.

// A point, in drawing pixels or in pose space as the call says.
struct Point {
  double x = 0.0;
  double y = 0.0;
  friend bool operator==(const Point&, const Point&) = default;
};

// A closed polygon in drawing pixels, without repeating its first point; either orientation.
using Ring = std::vector<Point>;

// An axis-aligned rectangle in drawing pixels; its sides are greater than 0.
struct Box {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
};

// The bytes of a file.  Throws std::system_error when it cannot be read.
std::string ReadFile(const std::filesystem::path& path);

// Which pixels of a picture are the drawing.
enum class Foreground {
  kAlpha,  // those whose alpha reaches the threshold; plain paper all around is removed first
  kLight,  // a light drawing on a plain dark background, which becomes transparent
  kDark,   // a dark drawing on a plain light background, which becomes transparent
};

// A picture.
struct ImageSource {
  std::string data = {};  // a PNG, JPEG or WebP file
  Foreground foreground = Foreground::kAlpha;
  std::optional<int> threshold =
      {};  // 1 to 255; by default 128, or for light and dark half the range
};

// A vector drawing.  One user unit is one drawing pixel.
struct SvgSource {
  std::string document = {};  // the document, or its gzip
  Foreground foreground = Foreground::kAlpha;
  std::optional<int> threshold = {};
};

// An outline given as polygons.
struct PolygonSource {
  Ring outer = {};
  std::vector<Ring> holes = {};  // filled by the mesh, and reported
  std::string texture =
      {};  // a picture file whose pixels are the drawing pixels; one colour without
};

using ShapeSource = std::variant<ImageSource, SvgSource, PolygonSource>;

// Weights of drawings, by id: finite, summing to 1 within 1e-3; drawings left out weigh 0.  Outside
// [0, 1] they extrapolate.
//
//   session.Blend({{"stand", 0.5}, {"jump", 0.5}});
class Weights {
 public:
  Weights(std::initializer_list<std::pair<const std::string, double>> weights) : map_(weights) {}
  Weights(std::map<std::string, double> weights) : map_(std::move(weights)) {}

  const std::map<std::string, double>& map() const { return map_; }

 private:
  std::map<std::string, double> map_;
};

enum class BlendMethod {
  kRigid,   // limbs turn instead of shrinking
  kLinear,  // weighted mean of the vertices, for comparison
  kPaper,   // as published: the first drawing is the rest shape, no refits
};

// How weights outside [0, 1] act on stretch and texture.
enum class ShearLimit {
  kByMethod,  // band for rigid, Hermite for paper
  kBand,      // rounded off near 0 and 1, ordinary in-betweens unchanged
  kHermite,   // the paper's cubic
  kOff,       // not limited; extrapolation may fold
};

// How stretches of triangles are mixed by BlendMethod::kRigid.
enum class StretchBlend {
  kLinear,  // lengths in the mean
  kLog,     // lengths multiply, and never invert; takes longer
  kMetric,  // squared lengths in the mean; takes longer
};

// A place in a mesh, the same in every drawing and frame; Mesh::At makes it.  It belongs to that
// revision's mesh: a rebuild has other triangles.
struct MeshPoint {
  std::int32_t triangle = 0;  // of Mesh::triangles
  double b = 0.0, c = 0.0;    // weights of its second and third corner; the first has the rest
  friend bool operator==(const MeshPoint&, const MeshPoint&) = default;
};

struct BlendOptions {
  BlendMethod method = BlendMethod::kRigid;
  ShearLimit shear_limit = ShearLimit::kByMethod;
  std::optional<int> refits = {};  // rotation refits of kRigid, 0 to 3; 3 by default
  double sigma = 0.0;              // sharpness of texture transitions, 0 (linear) to 1 (a step)
  StretchBlend stretch = StretchBlend::kLinear;
  bool repair = false;  // unfold what folds over: milliseconds where there is something to mend
  // By which frames are placed: it lies at the weighted mean of its places in the drawings, so that
  // a foot that stands in all of them stands.  By default the centroid of each part of the mesh
  // does.
  std::optional<MeshPoint> anchor = {};
  friend bool operator==(const BlendOptions&, const BlendOptions&) = default;
};

// How drawings may be turned against each other.
enum class Rotation {
  kUpright,  // what lies in the same place of two drawings is probably the same
  kAny,      // at will: only their shapes are compared, and colours
};

struct BuildOptions {
  // Farthest the mesh outline may lie from the drawing's, relative to the square root of its area,
  // 0.001 to 0.2; 0.03 by default.
  std::optional<double> tolerance = {};
  // Of mesh edges, in the same unit, 0.02 to 1; 0.08 by default.
  std::optional<double> target_edge_length = {};
  Rotation rotation = Rotation::kUpright;
  // Most vertices of the mesh, 3 to what the service allows (8,000 unless set otherwise), which is
  // the default: refinement stops there.  Drawings that need more even so are refused.
  std::optional<int> max_vertices = {};
  // Moves inner vertices so that what is drawn inside corresponds, eyes to eyes; by default true.
  std::optional<bool> align = {};
  // Called by the thread that waits, with the stage's name and the fraction done, which never
  // falls. What it throws cancels the build and passes through.
  std::function<void(std::string_view stage, double fraction)> on_progress = {};
  // How long to wait; by default as long as the service lets a build take.
  std::optional<std::chrono::milliseconds> timeout = {};
  // Asked to stop, the wait and the build end as kCancelled.
  std::stop_token stop = {};
};

// What a picture shows where some drawings are painted and others are not.
enum class Edges {
  kCrisp,  // a sharp silhouette, by the weighted mean of the distances from the drawings' edges
  kSoft,   // the mix of paint and transparency
};

struct RenderOptions {
  int width = 512;  // pixels, 1 to 4096
  int height = 512;
  // What to show, fitted with its aspect kept; by default the box of all drawings and of their
  // halves, with a margin; the same always.
  std::optional<Box> view = {};
  Edges edges = Edges::kCrisp;
  BlendOptions blend = {};
};

// A place on a path.
struct Waypoint {
  Point at = {};
  // When the path is there, seconds; growing.  On every waypoint of a path or on none.
  std::optional<double> time = {};
};

enum class Easing {
  kUniform,  // steadily, as the waypoints' times say
  kInOut,    // the path as a whole starts and ends at rest
};

struct AnimateOptions {
  double fps = 60.0;  // frames a second, more than 0 to 1,000
  Easing easing = Easing::kUniform;
  bool loop = false;  // return to the first waypoint and go through it smoothly; one round
  std::optional<double> duration = {};  // seconds, of a path without times; one second a leg
  bool paced = false;                   // each frame at its instant, not as fast as they are read
  BlendOptions blend = {};
};

}  // namespace posespace

#endif  // POSESPACE_OPTIONS_H_
