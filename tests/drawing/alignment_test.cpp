// SPDX-License-Identifier: Apache-2.0
#include "drawing/alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "drawing/interior_moves.h"
#include "geometry/polygon.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

constexpr int kSide = 160;  // pixels of the square drawings
constexpr int kCells = 16;  // of the mesh, along a side
constexpr Colour kSkin = {230, 170, 120, 255}, kInk = {40, 30, 60, 255};

int VertexAt(int column, int row) { return row * (kCells + 1) + column; }

// The same mesh of squares in `count` drawings.
CompatibleMesh SquareMesh(int count) {
  CompatibleMesh mesh;
  Points pose((kCells + 1) * (kCells + 1), 2);
  for (int row = 0; row <= kCells; ++row) {
    for (int column = 0; column <= kCells; ++column) {
      pose.row(VertexAt(column, row)) << column * double{kSide} / kCells,
          row * double{kSide} / kCells;
    }
  }
  mesh.poses.assign(count, pose);
  mesh.triangles.resize(2 * kCells * kCells, 3);
  for (int row = 0, t = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const int a = VertexAt(column, row), b = VertexAt(column + 1, row);
      const int c = VertexAt(column + 1, row + 1), d = VertexAt(column, row + 1);
      mesh.triangles.row(t++) << a, b, c;
      mesh.triangles.row(t++) << a, c, d;
    }
  }
  std::vector<int> loop;
  for (int k = 0; k < kCells; ++k) loop.push_back(VertexAt(k, 0));
  for (int k = 0; k < kCells; ++k) loop.push_back(VertexAt(kCells, k));
  for (int k = 0; k < kCells; ++k) loop.push_back(VertexAt(kCells - k, kCells));
  for (int k = 0; k < kCells; ++k) loop.push_back(VertexAt(0, kCells - k));
  mesh.boundary = {loop};
  return mesh;
}

// Skin all over, with an eye: a white disc with a dark one in it.
Image Face(double eye_x, double eye_y) {
  Image image = PictureOf(kSide, kSide, kSkin);
  PaintDisc(&image, eye_x, eye_y, 18.0, kWhite);
  PaintDisc(&image, eye_x, eye_y, 9.0, kInk);
  return image;
}

// The back of a head: hair, with an ornament, down to a neck.
Image BackOfHead(double ornament_x) {
  Image image = PictureOf(kSide, kSide, kInk);
  PaintBox(&image, 0, 120, kSide, 40, kSkin);
  PaintDisc(&image, ornament_x, 60, 14.0, kRed);
  return image;
}

std::vector<ReducedTexture> Reduced(const std::vector<Image>& images) {
  std::vector<ReducedTexture> textures;
  for (const Image& image : images) {
    textures.push_back(Reduce({image}, AlignmentSize(static_cast<int>(images.size()))));
  }
  return textures;
}

Result<Alignment> Align(const CompatibleMesh& mesh, const std::vector<Image>& images) {
  return AlignInteriors(mesh, mesh.poses[0], Reduced(images));
}

// How far the vertices of drawing `to` that lie in a disc of drawing `from` lie from there, on
// average.
Point MeanWay(const Points& from, const Points& to, const Point& centre, double radius) {
  Point sum = Point::Zero();
  int count = 0;
  for (Eigen::Index v = 0; v < from.rows(); ++v) {
    if ((from.row(v).transpose() - centre).norm() > radius) continue;
    sum += (to.row(v) - from.row(v)).transpose();
    ++count;
  }
  return sum / count;
}

double LongestWay(const Points& from, const Points& to) {
  return (to - from).rowwise().norm().maxCoeff();
}

// By how much the edge that changed its length most is longer, or shorter, than in drawing i.
double MostStretch(const CompatibleMesh& mesh, int i, const Points& pose) {
  const Edges edges = EdgesOf(mesh.triangles);
  double most = 1.0;
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const int a = edges(e, 0), b = edges(e, 1);
    const double ratio =
        (pose.row(a) - pose.row(b)).norm() / (mesh.poses[i].row(a) - mesh.poses[i].row(b)).norm();
    most = std::max({most, ratio, 1.0 / ratio});
  }
  return most;
}

std::vector<double> StarAngles(const CompatibleMesh& mesh, const Points& pose) {
  std::vector<double> angles(mesh.num_vertices(), std::numbers::pi);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const auto corners = mesh.triangles.row(t);
    const double angle = MinAngle(Point(pose.row(corners[0])), Point(pose.row(corners[1])),
                                  Point(pose.row(corners[2])));
    for (const int v : corners) angles[v] = std::min(angles[v], angle);
  }
  return angles;
}

// Drawings of dots and bars that have little to do with each other.
std::vector<Image> Scribbles(int count, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int limit) { return static_cast<int>(random() % limit); };
  std::vector<Image> images;
  for (int i = 0; i < count; ++i) {
    Image image = PictureOf(kSide, kSide, kSkin);
    for (int k = 0; k < 12; ++k) {
      const Colour colours[] = {kInk, kWhite, kRed, kBlue};
      PaintDisc(&image, below(kSide), below(kSide), 4 + below(14), colours[below(4)]);
      PaintBox(&image, below(kSide), below(kSide), below(40), below(12), colours[below(4)]);
    }
    images.push_back(std::move(image));
  }
  return images;
}

TEST(AlignInteriors, MovesNothingWhenAllDrawingsAreEqual) {
  const CompatibleMesh mesh = SquareMesh(3);
  const auto aligned = Align(mesh, {Face(80, 80), Face(80, 80), Face(80, 80)});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_EQ(aligned->poses, mesh.poses);
  EXPECT_NEAR(aligned->all.before, 0.0, 1e-5);
  EXPECT_NEAR(aligned->all.after, 0.0, 1e-5);
}

TEST(AlignInteriors, BringsAnEyeThatMovedOntoTheOther) {
  const CompatibleMesh mesh = SquareMesh(2);
  const auto aligned = Align(mesh, {Face(74, 80), Face(86, 84)});
  ASSERT_THAT(aligned, Succeeds());
  const Point way = MeanWay(aligned->poses[0], aligned->poses[1], {74, 80}, 20.0);
  EXPECT_NEAR(way.x(), 12.0, 1.5);
  EXPECT_NEAR(way.y(), 4.0, 1.5);
  EXPECT_GT(aligned->all.before, 0.3);
  EXPECT_LT(aligned->all.after, 0.35 * aligned->all.before);
  for (const GhostChange& each : aligned->each) EXPECT_LT(each.after, each.before);
}

TEST(AlignInteriors, LetsBothDrawingsShareTheWay) {
  const CompatibleMesh mesh = SquareMesh(2);
  const auto aligned = Align(mesh, {Face(74, 80), Face(86, 80)});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_NEAR(MeanWay(mesh.poses[0], aligned->poses[0], {80, 80}, 15.0).x(), -6.0, 1.5);
  EXPECT_NEAR(MeanWay(mesh.poses[1], aligned->poses[1], {80, 80}, 15.0).x(), 6.0, 1.5);
}

TEST(AlignInteriors, AlignsEightDrawings) {
  std::vector<Image> faces;
  for (int i = 0; i < 8; ++i) faces.push_back(Face(80 + 6 * std::cos(i), 80 + 6 * std::sin(i)));
  const auto aligned = Align(SquareMesh(8), faces);
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_LT(aligned->all.after, 0.4 * aligned->all.before);
}

TEST(AlignInteriors, KeepsEveryTrianglePositiveEveryStarsAngleAndAllInShape) {
  constexpr double kSharp = 8.0 * std::numbers::pi / 180.0;
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    CompatibleMesh mesh = SquareMesh(3);
    mesh.poses[1](VertexAt(8, 8), 0) += 9.4;  // a star that is sharp from the start
    const CompatibleMesh given = mesh;
    const auto aligned = Align(mesh, Scribbles(3, seed));
    ASSERT_THAT(aligned, Succeeds());
    mesh.poses = aligned->poses;
    EXPECT_FALSE(FindDefect(mesh).has_value());
    for (int i = 0; i < 3; ++i) {
      const auto before = StarAngles(given, given.poses[i]);
      const auto after = StarAngles(mesh, mesh.poses[i]);
      for (int v = 0; v < mesh.num_vertices(); ++v) {
        ASSERT_GE(after[v], std::min(before[v], kSharp)) << "vertex " << v;
      }
      EXPECT_LE(MostStretch(given, i, mesh.poses[i]), 2.5 + 1e-9);
    }
  }
}

TEST(AlignInteriors, LeavesBoundaryAndLandmarksWhereTheyAre) {
  CompatibleMesh mesh = SquareMesh(2);
  mesh.landmarks = {VertexAt(8, 8), VertexAt(5, 9)};
  const auto aligned = Align(mesh, {Face(70, 80), Face(90, 80)});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_NE(aligned->poses, mesh.poses);
  std::vector<int> fixed = mesh.boundary[0];
  fixed.insert(fixed.end(), mesh.landmarks.begin(), mesh.landmarks.end());
  for (int i = 0; i < 2; ++i) {
    for (const int v : fixed) EXPECT_EQ(aligned->poses[i].row(v), mesh.poses[i].row(v));
  }
}

TEST(AlignInteriors, NeverRaisesTheGhostLoss) {
  for (const unsigned seed : {5u, 6u, 7u, 8u}) {
    const auto aligned = Align(SquareMesh(4), Scribbles(4, seed));
    ASSERT_THAT(aligned, Succeeds());
    EXPECT_LE(aligned->all.after, aligned->all.before);
  }
}

TEST(AlignInteriors, KeepsAFaceFromTheBackOfAHead) {
  const CompatibleMesh mesh = SquareMesh(2);
  const auto aligned = Align(mesh, {Face(72, 66), BackOfHead(88)});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_EQ(aligned->poses, mesh.poses);
  EXPECT_EQ(aligned->all.after, aligned->all.before);
}

TEST(AlignInteriors, BringsEyesTogetherWhereCoatsHaveNothingInCommon) {
  Image left = Face(40, 80), right = Face(48, 80);
  for (int k = 0; k < 4; ++k) {
    PaintBox(&left, 100 + 10 * k, 50, 5, 50, kInk);
    PaintBox(&right, 100, 50 + 10 * k, 50, 5, kInk);
  }
  const CompatibleMesh mesh = SquareMesh(2);
  const auto aligned = Align(mesh, {left, right});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_NEAR(MeanWay(aligned->poses[0], aligned->poses[1], {40, 80}, 15.0).x(), 8.0, 2.0);
  for (int i = 0; i < 2; ++i)
    EXPECT_LE(MostStretch(mesh, i, aligned->poses[i]), InteriorMoves::kMostStretch + 1e-9);
}

TEST(AlignInteriors, AlignsFrontsWithFrontsAndBacksWithBacks) {
  const CompatibleMesh mesh = SquareMesh(4);
  const auto aligned = Align(mesh, {Face(74, 80), BackOfHead(86), Face(86, 80), BackOfHead(74)});
  ASSERT_THAT(aligned, Succeeds());
  const std::vector<Points>& poses = aligned->poses;
  EXPECT_NEAR(MeanWay(poses[0], poses[2], {74, 80}, 15.0).x(), 12.0, 2.0);
  EXPECT_NEAR(MeanWay(poses[3], poses[1], {74, 60}, 12.0).x(), 12.0, 2.0);
  EXPECT_LT(aligned->all.after, aligned->all.before);
}

TEST(AlignInteriors, MovesNothingWhereNothingCorrespondsWhileAnEyeIsAligned) {
  Image left = Face(40, 80), right = Face(48, 80);
  PaintBox(&left, 110, 40, 8, 30, kInk);   // a scar
  PaintDisc(&right, 128, 110, 8, kWhite);  // a button
  const CompatibleMesh mesh = SquareMesh(2);
  const auto aligned = Align(mesh, {left, right});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_NEAR(MeanWay(aligned->poses[0], aligned->poses[1], {40, 80}, 15.0).x(), 8.0, 1.5);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(MeanWay(mesh.poses[i], aligned->poses[i], {114, 55}, 15.0).norm(), 1.0);
    EXPECT_LT(MeanWay(mesh.poses[i], aligned->poses[i], {128, 110}, 15.0).norm(), 1.0);
  }
}

TEST(AlignInteriors, DoesNotTakeTheEdgeOfThePaintingForAFeature) {
  Image cut = Face(80, 80);
  PaintBox(&cut, 0, 0, 14, kSide, kClear);
  const CompatibleMesh mesh = SquareMesh(2);
  const auto aligned = Align(mesh, {Face(80, 80), cut});
  ASSERT_THAT(aligned, Succeeds());
  for (int i = 0; i < 2; ++i) EXPECT_LT(LongestWay(mesh.poses[i], aligned->poses[i]), 0.5);
}

TEST(AlignInteriors, GivesTheSameWhateverTheOrderOfTheDrawings) {
  const std::vector<Image> faces = {Face(72, 80), Face(80, 84), Face(90, 78)};
  const CompatibleMesh mesh = SquareMesh(3);
  const auto aligned = Align(mesh, faces);
  const auto turned = Align(mesh, {faces[2], faces[0], faces[1]});
  ASSERT_THAT(aligned, Succeeds());
  ASSERT_THAT(turned, Succeeds());
  EXPECT_NEAR(turned->all.after, aligned->all.after, 1e-6);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(LongestWay(aligned->poses[i], turned->poses[(i + 1) % 3]), 1e-3);
  }
}

TEST(AlignInteriors, GivesEqualOutputForEqualInput) {
  const CompatibleMesh mesh = SquareMesh(2);
  const auto first = Align(mesh, {Face(74, 80), Face(86, 80)});
  const auto second = Align(mesh, {Face(74, 80), Face(86, 80)});
  ASSERT_THAT(first, Succeeds());
  ASSERT_THAT(second, Succeeds());
  EXPECT_EQ(first->poses, second->poses);
}

TEST(AlignInteriors, LeavesOneDrawingAlone) {
  const CompatibleMesh mesh = SquareMesh(1);
  const auto aligned = Align(mesh, {Face(74, 80)});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_EQ(aligned->poses, mesh.poses);
}

TEST(AlignInteriors, LeavesDrawingsWithoutColoursAlone) {
  const CompatibleMesh mesh = SquareMesh(2);
  Image blot = PictureOf(kSide, kSide);
  PaintDisc(&blot, 80, 80, 60, kInk);
  for (const Image& other : {blot, PictureOf(kSide, kSide), PictureOf(kSide, kSide, kSkin)}) {
    const auto aligned = Align(mesh, {blot, other});
    ASSERT_THAT(aligned, Succeeds());
    EXPECT_EQ(aligned->poses, mesh.poses);
    EXPECT_EQ(aligned->all.before, 0.0);
  }
}

TEST(AlignInteriors, AlignsDrawingsBesideOneInOneColour) {
  const CompatibleMesh mesh = SquareMesh(3);
  const auto aligned = Align(mesh, {Face(74, 80), Face(86, 80), PictureOf(kSide, kSide, kSkin)});
  ASSERT_THAT(aligned, Succeeds());
  EXPECT_NEAR(MeanWay(aligned->poses[0], aligned->poses[1], {74, 80}, 15.0).x(), 12.0, 2.0);
}

TEST(AlignInteriors, StaysFiniteWhenOneDrawingIsEmptyOrInOneColour) {
  const CompatibleMesh mesh = SquareMesh(2);
  for (const Image& other : {PictureOf(kSide, kSide), PictureOf(kSide, kSide, kInk)}) {
    const auto aligned = Align(mesh, {Face(74, 80), other});
    ASSERT_THAT(aligned, Succeeds());
    for (const Points& pose : aligned->poses) EXPECT_TRUE(pose.allFinite());
    EXPECT_TRUE(std::isfinite(aligned->all.after));
  }
}

TEST(AlignInteriors, TakesTinyAndThinDrawings) {
  for (const auto& [width, height] : {std::pair(5, 5), std::pair(300, 3), std::pair(3, 300)}) {
    CompatibleMesh mesh = SquareMesh(2);
    for (Points& pose : mesh.poses) {
      pose.col(0) *= width / double{kSide};
      pose.col(1) *= height / double{kSide};
    }
    Image left = PictureOf(width, height, kSkin), right = left;
    PaintBox(&left, 1, 1, std::max(1, width / 4), 1, kInk);
    PaintBox(&right, width / 2, height / 2, 2, std::max(1, height / 4), kInk);
    const auto aligned = Align(mesh, {left, right});
    ASSERT_THAT(aligned, Succeeds());
    mesh.poses = aligned->poses;
    EXPECT_FALSE(FindDefect(mesh).has_value());
  }
}

TEST(AlignInteriors, StopsWhenItIsCancelled) {
  const CompatibleMesh mesh = SquareMesh(2);
  const auto textures = Reduced({Face(74, 80), Face(86, 80)});
  int reports = 0;
  Progress* running = nullptr;
  Progress progress([&](std::string_view, double) {
    if (++reports == 2) running->Cancel();
  });
  running = &progress;
  EXPECT_THAT(AlignInteriors(mesh, mesh.poses[0], textures, &progress),
              FailsWith(ErrorCode::kCancelled));
}

TEST(AlignInteriors, RefusesTexturesThatAreNotThoseOfTheMesh) {
  const CompatibleMesh mesh = SquareMesh(2);
  EXPECT_THAT(AlignInteriors(mesh, mesh.poses[0], Reduced({Face(74, 80)})),
              FailsWith(ErrorCode::kSizeMismatch));
  EXPECT_THAT(AlignInteriors(mesh, Points::Zero(3, 2), Reduced({Face(74, 80), Face(80, 80)})),
              FailsWith(ErrorCode::kSizeMismatch));
}

TEST(Reduce, AveragesBlocksThatAreNoLargerThanNeeded) {
  Image image = PictureOf(8, 4, kClear);
  PaintBox(&image, 0, 0, 1, 2, kWhite);
  PaintBox(&image, 4, 0, 4, 4, kRed);
  const ReducedTexture reduced = Reduce({image, Point(3, 5), 2.0}, 4);
  EXPECT_EQ(reduced.width, 4);
  EXPECT_EQ(reduced.height, 2);
  EXPECT_EQ(reduced.scale, 1.0);
  EXPECT_EQ(reduced.origin, Point(3, 5));
  EXPECT_FALSE(reduced.plain);
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(reduced.rgba[c], 0.5, 1e-6);
  EXPECT_NEAR(reduced.rgba[8], 1.0, 1e-6);
  EXPECT_EQ(reduced.rgba[9], 0.0f);
}

TEST(Reduce, CallsPlainWhatIsPaintedInOneColour) {
  Image image = PictureOf(8, 8, kClear);
  EXPECT_TRUE(Reduce({image}, 8).plain);
  PaintDisc(&image, 4, 4, 3, kInk);
  PaintPixel(&image, 0, 0, {kInk[0], kInk[1], kInk[2], 7});
  EXPECT_TRUE(Reduce({image}, 8).plain);
  PaintPixel(&image, 4, 4, kWhite);
  EXPECT_FALSE(Reduce({image}, 8).plain);
}

TEST(AlignmentSize, KeepsAllPicturesTogetherWithinBounds) {
  EXPECT_EQ(AlignmentSize(1), 512);
  EXPECT_EQ(AlignmentSize(8), 512);
  EXPECT_LT(AlignmentSize(9), 512);
  EXPECT_LE(64.0 * AlignmentSize(64) * AlignmentSize(64), 8.0 * 512 * 512);
}

}  // namespace
}  // namespace posespace
