// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_OUTLINE_CURVE_H_
#define POSESPACE_MAPPING_OUTLINE_CURVE_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"
#include "mapping/outline_map.h"

namespace posespace {

// A closed outline by arc length: position 0 is its first corner, position 1 the same after one
// turn.  Positions may be any number of turns away.  Share freely once its thickness
// is measured or when it is not wanted.
class OutlineCurve {
 public:
  // `colours` as in MatchingShape.
  OutlineCurve(const Points& outline, const Eigen::MatrixXd& colours);

  int num_corners() const { return static_cast<int>(outline_.rows()); }
  Point corner(int k) const { return outline_.row(k).transpose(); }
  double corner_position(int k) const { return positions_[k]; }  // in [0, 1), increasing

  double perimeter() const { return perimeter_; }  // drawing pixels
  double size() const { return size_; }            // square root of the area, drawing pixels
  bool has_colours() const { return colours_.rows() > 0; }

  // Measures the thickness at 512 places.  Cost  O(corners) a place.
  void MeasureThickness();

  Point At(double position) const;

  // The outline's point nearest to p; a corner when it is one, or within 1e-6 turns of one.
  struct Nearest {
    double position;
    Point point;
    double distance;  // drawing pixels
  };
  Nearest NearestTo(const Point& p) const;

  // What the outline looks like at each position, one row each, made so that squared distances
  // between rows of two outlines say how unlike the places are: columns 0-7 the turn and the chord
  // over windows of 1/64 to 1/8 turn either side (the same at every scale, place and rotation),
  // columns 8-9 the place relative to the centroid in spreads of the drawing, times
  // sqrt(position_weight).
  Eigen::MatrixXd Features(const std::vector<double>& positions, double position_weight) const;

  // How thick the drawing is at each position, compared with its own mean: the mean over three
  // directions inward, straight and 0.35 radians to either side, of ln(way through the inside /
  // perimeter), each way from 0.004 to 0.12, less the mean of this along the outline.  Much the
  // same however limbs are bent, and for a thin letter and a bold one.
  //
  // Requires  that it was measured.
  Eigen::VectorXd LogThickness(const std::vector<double>& positions) const;

  // The colour inside the outline at each position, one row each, RGB.
  Eigen::MatrixXd Colours(const std::vector<double>& positions) const;

  // The curve of the drawing seen in a mirror, positively oriented again; thickness is measured
  // when it is here.
  OutlineCurve Mirrored() const;

 private:
  // The edge that `position` lies on and how far along it, in [0, 1].
  struct Place {
    int edge;
    double fraction;
  };
  Place Find(double position) const;

  // From `from`, on the outline, inward to the other side, within the bounds of LogThickness.
  double WayThrough(const Point& from, const Point& direction) const;

  Points outline_;
  Eigen::MatrixXd colours_;
  std::vector<double> positions_;
  double perimeter_;
  double size_;
  Point centroid_;
  double spread_;                      // what positions are measured in, drawing pixels
  std::vector<double> log_thickness_;  // at places spaced evenly; empty: not measured
};

// The map between outlines in correspondence that takes row k to row k.
// Requires  equal numbers of corners.
OutlineMap MapBetween(const OutlineCurve& a, const OutlineCurve& b);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_OUTLINE_CURVE_H_
