// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_EDITABLE_MESH_H_
#define POSESPACE_MAPPING_EDITABLE_MESH_H_

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "mapping/ring_programme.h"

namespace posespace {

// A compatible mesh whose connectivity and interior vertices change, one connectivity for all
// poses.
//
// It keeps the books and judges nothing: callers test positions (IsPositive) before they change
// anything.  Vertices keep their numbers until Finish().  One owner; not shared.
class EditableMesh {
 public:
  explicit EditableMesh(const CompatibleMesh& mesh);

  int num_poses() const { return static_cast<int>(poses_.size()); }
  int num_vertices() const { return static_cast<int>(around_.size()); }  // removed ones included
  int num_live_vertices() const { return num_vertices() - removed_; }
  int num_triangles() const { return static_cast<int>(triangles_.size()); }  // removed ones too

  const Point& At(int pose, int vertex) const { return poses_[pose][vertex]; }
  void Move(int pose, int vertex, const Point& to) { poses_[pose][vertex] = to; }

  // True for vertices of the boundary and landmarks: they are never moved or removed.
  bool IsFixed(int vertex) const { return fixed_[vertex] != 0; }
  // False for removed vertices.
  bool IsLive(int vertex) const { return !around_[vertex].empty(); }

  // {-1, -1, -1} when removed.
  const Triangle& At(int triangle) const { return triangles_[triangle]; }
  std::span<const int> TrianglesAt(int vertex) const { return around_[vertex]; }

  // The triangle with the side a -> b, or -1.
  int Find(int a, int b) const;
  // c of the triangle (a, b, c), or -1 when no triangle has the side a -> b.
  int Opposite(int a, int b) const;
  bool HasEdge(int a, int b) const { return Opposite(a, b) >= 0 || Opposite(b, a) >= 0; }

  // The neighbours of an interior vertex in positive order.
  std::vector<int> Link(int vertex) const;

  // Live interior edges as (a, b), a < b, in order of their triangles; EdgesAll includes the sides
  // of the boundary, directed as their triangle has them.
  std::vector<std::pair<int, int>> InteriorEdges() const;
  std::vector<std::pair<int, int>> AllEdges() const;

  bool IsPositive(int pose, int a, int b, int c) const;  // exact
  bool IsPositiveInAllPoses(int a, int b, int c) const;  // exact

  // Replaces the edge ab by the other diagonal of its two triangles.
  void Flip(int a, int b);

  // Puts a new vertex on the edge ab, at `positions` (one per pose), and returns it.  It is fixed
  // and part of its boundary loop when the edge is.
  int Split(int a, int b, std::span<const Point> positions);

  // Puts `filling` in the place of the triangles `patch`.  Vertices left without a triangle are
  // gone.
  void Refill(std::span<const int> patch, std::span<const Triangle> filling);

  // The mesh with removed vertices left out; the others keep their order.
  CompatibleMesh Finish() const;

 private:
  void AddTriangle(const Triangle& corners);
  void DropTriangle(int triangle);

  std::vector<std::vector<Point>> poses_;
  std::vector<Triangle> triangles_;
  std::vector<int> unused_;               // slots of removed triangles
  std::vector<std::vector<int>> around_;  // triangles at each vertex
  std::vector<char> fixed_;
  std::vector<std::vector<int>> boundary_;
  std::vector<int> landmarks_;
  int removed_ = 0;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_EDITABLE_MESH_H_
