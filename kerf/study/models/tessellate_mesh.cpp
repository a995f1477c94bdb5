// The triangles of a part, once it is known how often each direction is cut.

#include <algorithm>
#include <cassert>
#include <cmath>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/study/models/tessellate.h"

namespace kerf {
namespace {

constexpr uint64_t kMostTriangles = 0x7FFFFFFF;
constexpr int kTries = 6;
constexpr double kNextTry = 0.95;  // of the largest edge of the last one

double longest_edge(const Mesh& mesh) {
  double square = 0;
  for (const Mesh::Corners& t : mesh.triangles) {
    for (uint32_t i = 0; i < 3; ++i) {
      const Vec3d edge = to_double(mesh.vertices[t[(i + 1) % 3]]) - to_double(mesh.vertices[t[i]]);
      square = std::max(square, dot(edge, edge));
    }
  }
  return std::sqrt(square);
}

}  // namespace

/// Where the vertices of each edge and face and the triangles of each face begin. Corners come first.
struct Tessellator::Layout {
  std::vector<uint64_t> edge_vertices, face_vertices, triangles;
};

uint32_t Tessellator::vertex_on_side(const Layout& layout, const Plan& plan, const Face& face, uint32_t side,
                                     uint32_t k) const {
  const Use use = face.sides[side];
  const Edge& edge = edges_[use.edge];
  if (edge.is_point) return edge.begin;
  const uint32_t segments = plan[edge.direction];
  if (use.reversed) k = segments - k;
  if (k == 0) return edge.begin;
  if (k == segments) return edge.end;
  return static_cast<uint32_t>(layout.edge_vertices[use.edge] + k - 1);
}

/// Sets the inner vertices and the triangles of a face.
void Tessellator::fill_face(const Layout& layout, const Plan& plan, size_t number, Mesh& mesh) const {
  const Face& face = faces_[number];
  const uint32_t along_u = plan[face.directions[0]], along_v = plan[face.directions[1]];
  const auto inner = [&](uint32_t i, uint32_t j) {
    return static_cast<uint32_t>(layout.face_vertices[number] + static_cast<uint64_t>(j - 1) * (along_u - 1) + i - 1);
  };
  const auto vertex = [&](uint32_t i, uint32_t j) {
    if (j == 0) return vertex_on_side(layout, plan, face, 0, i);
    if (i == along_u) return vertex_on_side(layout, plan, face, 1, j);
    if (j == along_v) return vertex_on_side(layout, plan, face, 2, i);
    if (i == 0) return vertex_on_side(layout, plan, face, 3, j);
    return inner(i, j);
  };
  for (uint32_t j = 1; j < along_v; ++j) {
    for (uint32_t i = 1; i < along_u; ++i) {
      mesh.vertices[inner(i, j)] =
          to_float(face.surface(static_cast<double>(i) / along_u, static_cast<double>(j) / along_v));
    }
  }
  Mesh::Corners* to = &mesh.triangles[layout.triangles[number]];
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    if (a != b && b != c && c != a) *to++ = {a, b, c};
  };
  for (uint32_t j = 0; j < along_v; ++j) {
    for (uint32_t i = 0; i < along_u; ++i) {
      const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      if (face.falling) {
        add(a, b, d);
        add(b, c, d);
      } else {
        add(a, b, c);
        add(a, c, d);
      }
    }
  }
  assert(to == mesh.triangles.data() + layout.triangles[number + 1]);
}

Mesh Tessellator::mesh_of(const Plan& plan) const {
  Layout layout;
  uint64_t vertices = corners_.size(), triangles = 0;
  for (const Edge& edge : edges_) {
    layout.edge_vertices.push_back(vertices);
    if (!edge.is_point) vertices += plan[edge.direction] - 1;
  }
  for (const Face& face : faces_) {
    layout.face_vertices.push_back(vertices);
    layout.triangles.push_back(triangles);
    vertices += static_cast<uint64_t>(plan[face.directions[0]] - 1) * (plan[face.directions[1]] - 1);
    triangles += triangles_of(face, plan);
  }
  layout.triangles.push_back(triangles);
  if (triangles > kMostTriangles) {
    throw Error(ErrorCode::too_large, "tessellation", "it has more than 2^31 - 1 triangles");
  }
  Mesh mesh;
  mesh.vertices.resize(vertices);
  mesh.triangles.resize(triangles + 1);  // one to point at where a face has none
  std::transform(corners_.begin(), corners_.end(), mesh.vertices.begin(), to_float);
  for (size_t e = 0; e < edges_.size(); ++e) {
    const uint32_t segments = edges_[e].is_point ? 1 : plan[edges_[e].direction];
    for (uint32_t k = 1; k < segments; ++k) {
      mesh.vertices[layout.edge_vertices[e] + k - 1] =
          to_float(side_point(edges_[e], static_cast<double>(k) / segments));
    }
  }
  parallel_for(faces_.size(), 1, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) fill_face(layout, plan, f, mesh);
  });
  mesh.triangles.pop_back();
  return mesh;
}

Mesh Tessellator::mesh(const Fineness& fineness) const {
  Fineness aim = fineness;
  for (int i = 0; i < kTries; ++i) {
    Mesh mesh = mesh_of(plan(aim));
    if (longest_edge(mesh) <= fineness.max_edge) return mesh;
    aim.max_edge *= kNextTry;  // a tangent between the samples was longer than theirs
  }
  throw Error(ErrorCode::invalid_geometry, "tessellation", "a face is too uneven to be cut to the largest edge");
}

}  // namespace kerf
