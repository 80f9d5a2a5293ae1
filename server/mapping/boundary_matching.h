// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_BOUNDARY_MATCHING_H_
#define POSESPACE_MAPPING_BOUNDARY_MATCHING_H_

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

// One drawing's outer outline as matching sees it.
struct MatchingShape {
  std::string name;         // for messages
  Points outline;           // K x 2, simple, positively oriented, drawing pixels
  Eigen::MatrixXd colours;  // K x 3, the colour just inside row k, RGB in [0, 1]; 0 rows: no colour
};

// One place of the character, marked in some of the drawings: entry i is its point in drawing i.
struct Landmark {
  std::vector<std::optional<Point>> points;  // N entries, drawing pixels
};

struct MatchingOptions {
  // Weights of |position difference|^2 (from the centroids, in spreads of the drawings: the root of
  // the area of a disc whose area is spread as widely), of |colour difference|^2, and of
  // ln(slope)^2 against uneven stretching.  Position says that drawings are upright; it is left out
  // between drawings whose common landmarks lie turned by more than 45 degrees, and between
  // unmarked ones that match clearly better when limbs may lie anywhere (moved_limbs.h).
  double position_weight = 0.15;
  double colour_weight = 0.3;
  double stretch_weight = 0.05;
  // Weight of ln(thickness ratio)^2.  Thickness tells limbs apart however they are bent and turned,
  // where position must not.
  double thickness_weight = 0.0;
  // Colour is used only between drawings whose mean colour difference along the map found with it
  // is below this (RGB in [0, 1]): drawings painted in other colours say nothing by them.  One
  // character's drawings have 0.04 to 0.17, different animals 0.2 to 0.8.
  double max_colour_difference = 0.15;
  // Farthest a landmark may lie from the outline it marks, / size of the drawing.
  double max_landmark_distance = 0.05;
};

// For drawings that may be turned at will: their shapes, thickness and colours are compared, and
// position only decides between starts that are all but as good.
inline MatchingOptions ForAnyRotation() {
  MatchingOptions options;
  options.position_weight = 0.0;
  options.thickness_weight = 0.1;
  return options;
}

// Drawings that would fit their group better seen in a mirror, left and right exchanged.
struct FlipProposal {
  std::vector<bool> flips;  // one a drawing; at most half of them
  double gain = 1.0;        // cost of all pairs' matches as they are / with the flips, >= 1
};

// Two drawings of which much has no counterpart in the other, as where limbs cross: then they
// follow each other in another order, and no map between the outlines fits.
struct Mismatch {
  int first;
  int second;
  double share;                // of both outlines, that is squeezed or stretched by more than 4.5
  std::vector<int> landmarks;  // those at the ends of the arc where most of it lies
};

// Two drawings with sharp corners that are alike but lie beside each other: each meets a straight
// run of the other drawing up to 0.06 turns from its like, and in between both are bevelled.
struct MissedCorners {
  int first;
  int second;
  int count;        // of the corners; more than a third of those of the drawing that has fewer
  Point on_first;   // one of them, drawing pixels
  Point on_second;  // its like
};

// Outlines in correspondence.
struct MatchedOutlines {
  std::vector<Points> outlines;    // N of n x 2: row k is the same place on every outline
  std::vector<int> landmark_rows;  // the row of each landmark, in the caller's order
  // Per drawing, in (0, 1]: how clear its matching is; below 0.5 a person should look at it.  1
  // when N = 1.
  std::vector<double> confidence;
  // Never applied here: a flip mirrors the artwork, and only a person knows.  None is proposed when
  // its gain is below 1.05 or there are landmarks, which say which way round a drawing is.
  FlipProposal proposal;
  // The worst of them with a share above 0.15, or above 0.12 when there are landmarks to doubt.
  std::optional<Mismatch> mismatch;
  // Of the pairs of drawings that miss each other's corners, the one that misses most.
  std::optional<MissedCorners> missed_corners;
};

// Checks marks by themselves: what MatchBoundaries would refuse is refused here, all faults at
// once, each with a field "tuples[L].points['shape']".
//
// Fails     kLandmarkNotFinite, kLandmarkOffOutline, kLandmarksOutOfOrder as MatchBoundaries does.
Result<void> CheckLandmarks(std::span<const MatchingShape> shapes,
                            std::span<const Landmark> landmarks,
                            const MatchingOptions& options = {});

// Finds which point of each outline is which point of every other: the paper's boundary matching,
// for N drawings at once and with no drawing privileged.
//
// Every corner of every outline becomes a row, so each output ring follows its outline exactly;
// corners of different outlines share a row when they are closer than 0.25 % of the perimeter on
// all of them.  Each ring is simple and positively oriented.  Every landmark is a row: in the
// drawings that it marks, that row is the outline point nearest to the mark.  Mirror-symmetric
// drawings match symmetrically where that costs little and the landmarks allow it (see
// symmetric_matching.h).  The result depends on the order of the drawings only in the order of its
// rings.
//
// Requires  N >= 1 shapes; each landmark has N entries, at least one of them set.
// Fails     kLandmarkNotFinite, kLandmarkOffOutline (names landmark, drawing, distance and limit),
//           kLandmarksOutOfOrder (names every contradicting pair of landmarks with two drawings),
//           kOutlineNotSimple (an outline that passes itself as closely as numbers round),
//           kOutlineTooLong (more than 100,000 corners together), kCancelled.
// Cost      O(N^2 M^3) with M = 64 samples to compare all pairs from every start, O(N M^2) with
//           M = 256 to match.
// Follows   Baxter, Barla, Anjyo 2009, section 3.1, "Boundary matching", with a multi-scale elastic
//           cost and composition along a minimum spanning tree instead of a privileged drawing.
Result<MatchedOutlines> MatchBoundaries(std::span<const MatchingShape> shapes,
                                        std::span<const Landmark> landmarks = {},
                                        const MatchingOptions& options = {},
                                        Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_BOUNDARY_MATCHING_H_
