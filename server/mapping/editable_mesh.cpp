// SPDX-License-Identifier: Apache-2.0
#include "mapping/editable_mesh.h"

#include <algorithm>

#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr Triangle kRemoved = {-1, -1, -1};

}  // namespace

EditableMesh::EditableMesh(const CompatibleMesh& mesh)
    : around_(mesh.num_vertices()),
      fixed_(mesh.num_vertices(), 0),
      boundary_(mesh.boundary),
      landmarks_(mesh.landmarks) {
  for (const Points& pose : mesh.poses) {
    std::vector<Point>& points = poses_.emplace_back();
    points.reserve(pose.rows());
    for (Eigen::Index v = 0; v < pose.rows(); ++v) points.emplace_back(pose(v, 0), pose(v, 1));
  }
  triangles_.reserve(mesh.num_triangles());
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    AddTriangle({mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)});
  }
  for (const std::vector<int>& loop : boundary_) {
    for (const int v : loop) fixed_[v] = 1;
  }
  for (const int v : landmarks_) fixed_[v] = 1;
}

int EditableMesh::Find(int a, int b) const {
  for (const int t : around_[a]) {
    const Triangle& corners = triangles_[t];
    for (int k = 0; k < 3; ++k) {
      if (corners[k] == a && corners[(k + 1) % 3] == b) return t;
    }
  }
  return -1;
}

int EditableMesh::Opposite(int a, int b) const {
  const int t = Find(a, b);
  if (t < 0) return -1;
  const Triangle& corners = triangles_[t];
  return corners[0] + corners[1] + corners[2] - a - b;
}

std::vector<int> EditableMesh::Link(int vertex) const {
  const Triangle& first = triangles_[around_[vertex].front()];
  int start = first[0];
  for (int k = 0; k < 3; ++k) {
    if (first[k] == vertex) start = first[(k + 1) % 3];
  }
  std::vector<int> link = {start};
  for (int next = Opposite(vertex, start); next != start; next = Opposite(vertex, next)) {
    link.push_back(next);
  }
  return link;
}

std::vector<std::pair<int, int>> EditableMesh::InteriorEdges() const {
  std::vector<std::pair<int, int>> edges;
  for (const auto& [a, b] : AllEdges()) {
    if (a < b && Opposite(b, a) >= 0) edges.emplace_back(a, b);
  }
  return edges;
}

std::vector<std::pair<int, int>> EditableMesh::AllEdges() const {
  std::vector<std::pair<int, int>> edges;
  for (const Triangle& corners : triangles_) {
    if (corners == kRemoved) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = corners[k], b = corners[(k + 1) % 3];
      if (a < b || Opposite(b, a) < 0) edges.emplace_back(a, b);
    }
  }
  return edges;
}

bool EditableMesh::IsPositive(int pose, int a, int b, int c) const {
  const std::vector<Point>& points = poses_[pose];
  return Orientation(points[a], points[b], points[c]) > 0;
}

bool EditableMesh::IsPositiveInAllPoses(int a, int b, int c) const {
  for (int pose = 0; pose < num_poses(); ++pose) {
    if (!IsPositive(pose, a, b, c)) return false;
  }
  return true;
}

void EditableMesh::Flip(int a, int b) {
  const int left = Find(a, b), right = Find(b, a);
  const int c = Opposite(a, b), d = Opposite(b, a);
  DropTriangle(left);
  DropTriangle(right);
  AddTriangle({c, a, d});
  AddTriangle({d, b, c});
}

int EditableMesh::Split(int a, int b, std::span<const Point> positions) {
  const int v = num_vertices();
  for (int pose = 0; pose < num_poses(); ++pose) poses_[pose].push_back(positions[pose]);
  around_.emplace_back();
  const int left = Find(a, b), right = Find(b, a);
  fixed_.push_back(left < 0 || right < 0);
  if (left >= 0) {
    const int c = Opposite(a, b);
    DropTriangle(left);
    AddTriangle({a, v, c});
    AddTriangle({v, b, c});
  }
  if (right >= 0) {
    const int d = Opposite(b, a);
    DropTriangle(right);
    AddTriangle({b, v, d});
    AddTriangle({v, a, d});
  }
  if (!fixed_[v]) return v;
  for (std::vector<int>& loop : boundary_) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const int from = loop[k], to = loop[(k + 1) % loop.size()];
      if ((from == a && to == b) || (from == b && to == a)) {
        loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(k) + 1, v);
        return v;
      }
    }
  }
  return v;
}

void EditableMesh::Refill(std::span<const int> patch, std::span<const Triangle> filling) {
  std::vector<int> touched;
  for (const int t : patch) {
    touched.insert(touched.end(), triangles_[t].begin(), triangles_[t].end());
    DropTriangle(t);
  }
  for (const Triangle& corners : filling) AddTriangle(corners);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  removed_ += static_cast<int>(
      std::count_if(touched.begin(), touched.end(), [&](int v) { return !IsLive(v); }));
}

CompatibleMesh EditableMesh::Finish() const {
  std::vector<int> renumbered(num_vertices(), -1);
  int count = 0;
  for (int v = 0; v < num_vertices(); ++v) {
    if (IsLive(v)) renumbered[v] = count++;
  }
  CompatibleMesh mesh;
  for (const std::vector<Point>& points : poses_) {
    Points& pose = mesh.poses.emplace_back(count, 2);
    for (int v = 0; v < num_vertices(); ++v) {
      if (renumbered[v] >= 0) pose.row(renumbered[v]) = points[v].transpose();
    }
  }
  const auto live = std::count_if(triangles_.begin(), triangles_.end(),
                                  [](const Triangle& t) { return t != kRemoved; });
  mesh.triangles.resize(live, 3);
  Eigen::Index row = 0;
  for (const Triangle& t : triangles_) {
    if (t == kRemoved) continue;
    mesh.triangles.row(row++) << renumbered[t[0]], renumbered[t[1]], renumbered[t[2]];
  }
  mesh.boundary = boundary_;
  for (std::vector<int>& loop : mesh.boundary) {
    for (int& v : loop) v = renumbered[v];
  }
  mesh.landmarks = landmarks_;
  for (int& v : mesh.landmarks) v = renumbered[v];
  return mesh;
}

void EditableMesh::AddTriangle(const Triangle& corners) {
  int triangle = num_triangles();
  if (unused_.empty()) {
    triangles_.push_back(corners);
  } else {
    triangle = unused_.back();
    unused_.pop_back();
    triangles_[triangle] = corners;
  }
  for (const int v : corners) around_[v].push_back(triangle);
}

void EditableMesh::DropTriangle(int triangle) {
  for (const int v : triangles_[triangle]) std::erase(around_[v], triangle);
  triangles_[triangle] = kRemoved;
  unused_.push_back(triangle);
}

}  // namespace posespace
