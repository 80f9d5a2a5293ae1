// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_ENCLOSING_RING_H_
#define POSESPACE_MAPPING_ENCLOSING_RING_H_

#include <optional>
#include <vector>

#include "geometry/mesh.h"
#include "mapping/edge_grid.h"

namespace posespace {

// Six vertices in a row on the ring around the edge (a, b) that is to become one vertex.  On rings
// of fewer than six vertices the outer ones coincide.
struct EdgeContext {
  int before_p, p, a, b, q, after_q;
};

// How far a vertex that replaces an edge may go.
enum class Freedom { kAnywhere, kStayAtA, kStayAtB };

// What one collapse does to one outline.
struct EdgeCollapse {
  Point vertex;       // replaces the edge
  double added_area;  // drawing pixels squared, >= 0
  double distance;    // bound of the Hausdorff distance of the new chain from what it stands for
};

// One outline of N on its way to fewer vertices, never losing a point it once enclosed.
//
// Why a collapse encloses: with x beyond all three lines p-a, a-b, b-q (E1) the triangles (p, a,
// x), (a, b, x), (b, q, x) are not positive, so the winding number of the new ring is nowhere
// smaller than the old one's.  If the new ring is simple (E2), that number is 0 or 1, hence 1
// wherever it was.
//
// Vertices keep their numbers; the caller knows which vertex follows which, as that is common to
// all N outlines.  One per call; not for concurrent use.
class EnclosingRing {
 public:
  // `tolerance` and `min_corner_angle` as in SimplificationOptions.
  EnclosingRing(const Points& outline, double tolerance, double min_corner_angle);

  // The best place for the vertex that replaces edge (a, b), if there is one beyond the three lines
  // (E1), without new sharp corners (E3) and within tolerance of the original (E4).
  std::optional<EdgeCollapse> Plan(const EdgeContext& at, Freedom freedom) const;

  // True when the collapse would make the ring cross or touch itself, or leave a much narrower gap
  // beside it than there was (E2).  `next[v]` is the vertex after v.
  bool IsObstructed(const EdgeContext& at, const EdgeCollapse& collapse,
                    const std::vector<int>& next) const;

  // Replaces edge (a, b) by vertex `kept`, which is a or b.
  void Apply(const EdgeContext& at, const EdgeCollapse& collapse, int kept);

  double area() const { return area_; }  // of the original
  const Point& vertex(int v) const { return vertices_[v]; }

 private:
  // Sum of squared distances to lines, weighted by length: x'Ax - 2 g'x + const.
  struct Quadric {
    Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
    Point g = Point::Zero();
  };
  // A point of the original ring: on the edge that `position` rounds down to.
  struct Anchor {
    double position;  // edge number + fraction
    Point point;
  };

  std::vector<Point> Candidates(const EdgeContext& at) const;
  std::optional<Point> PushedBeyondLines(const EdgeContext& at, Point x) const;
  bool MakesSharpCorner(const EdgeContext& at, const Point& x) const;
  Anchor NearestAnchor(const Point& x, const Anchor& from, const Anchor& to) const;
  double ChainDistance(const Anchor& from, const Anchor& to, const Point& a, const Point& b) const;

  Points original_;
  double area_;
  double size_;
  double tolerance_;  // drawing pixels
  Point origin_;      // of the quadrics, which lose digits far from it
  double min_corner_angle_;
  std::vector<Point> vertices_;
  std::vector<Quadric> quadrics_;  // of the original edges that the vertex stands for
  std::vector<Anchor> anchors_;    // strictly increasing around the ring
  EdgeGrid grid_;                  // edge v goes from vertex v to next[v]
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_ENCLOSING_RING_H_
