#include "kerf/io/mesh_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kerf/base/error.h"

namespace kerf {
namespace {

template <class T>
uint32_t grow(std::vector<T>& values, size_t count) {
  const size_t first = values.size();
  values.resize(first + count);
  return static_cast<uint32_t>(first);
}

bool is_zero(Vec3f v) { return v.x == 0 && v.y == 0 && v.z == 0; }

}  // namespace

MeshBuilder::Counts& MeshBuilder::Counts::operator+=(const Counts& more) {
  const auto add = [](uint64_t& sum, uint64_t value) {
    sum = value > std::numeric_limits<uint64_t>::max() - sum ? std::numeric_limits<uint64_t>::max() : sum + value;
  };
  add(vertices, more.vertices);
  add(normals, more.normals);
  add(uvs, more.uvs);
  add(triangles, more.triangles);
  return *this;
}

void MeshBuilder::reserve(const Counts& counts, const std::string& place) {
  constexpr uint64_t kMostVertices = kNone - 1, kMostTriangles = std::numeric_limits<int32_t>::max();
  if (counts.triangles > kMostTriangles) {
    throw Error(ErrorCode::too_large, place,
                fmt::format("{} triangles; at most 2^31 - 1 can be read", counts.triangles));
  }
  const uint64_t most = std::max({counts.vertices, counts.normals, counts.uvs});
  if (most > kMostVertices) {
    throw Error(ErrorCode::too_large, place, fmt::format("{} vertices; at most 2^32 - 2 can be read", most));
  }
  mesh_.vertices.reserve(counts.vertices);
  mesh_.normals.reserve(counts.normals);
  mesh_.uvs.reserve(counts.uvs);
  mesh_.triangles.reserve(counts.triangles);
  mesh_.materials.reserve(counts.triangles);
}

void MeshBuilder::set_place(const Transform& place) {
  place_ = place;
  const Vec3d* column = place.column;
  const double sign = dot(column[0], cross(column[1], column[2])) < 0 ? -1 : 1;
  for (int i = 0; i < 3; ++i) cofactor_[i] = cross(column[(i + 1) % 3], column[(i + 2) % 3]) * sign;
  mirrored_ = sign < 0;
}

uint32_t MeshBuilder::add_vertices(size_t count) { return grow(mesh_.vertices, count); }
uint32_t MeshBuilder::add_normals(size_t count) { return grow(mesh_.normals, count); }
uint32_t MeshBuilder::add_uvs(size_t count) { return grow(mesh_.uvs, count); }

void MeshBuilder::set_normal(size_t number, Vec3d local) {
  const Vec3d normal = cofactor_[0] * local.x + cofactor_[1] * local.y + cofactor_[2] * local.z;
  // Divided by the largest component first, so that squares neither overflow nor vanish.
  const double size = largest(abs(normal));
  if (!(size > 0) || !std::isfinite(size)) {
    has_bad_normals_ = true;
    mesh_.normals[number] = {0, 0, 0};
    return;
  }
  const Vec3d scaled = normal / size;
  mesh_.normals[number] = to_float(scaled / std::sqrt(dot(scaled, scaled)));
}

void MeshBuilder::begin_part(const Part& part) { parts_.push_back({part, mesh_.triangles.size()}); }

size_t MeshBuilder::end_of(size_t part) const {
  return part + 1 < parts_.size() ? parts_[part + 1].first_triangle : mesh_.triangles.size();
}

bool MeshBuilder::follows_vertices(uint32_t Part::*base) const {
  for (size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].part.*base != parts_[i].part.vertices && end_of(i) > parts_[i].first_triangle) return false;
  }
  return true;
}

std::vector<Mesh::Corners> MeshBuilder::corners(uint32_t Part::*base, size_t count, bool has_bad) const {
  if (count == 0 || (!has_bad && count == mesh_.vertices.size() && follows_vertices(base))) return {};
  std::vector<Mesh::Corners> all(mesh_.triangles.size(), {kNone, kNone, kNone});
  for (size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i].part;
    if (part.*base == kNone) continue;
    for (size_t k = parts_[i].first_triangle; k < end_of(i); ++k) {
      for (uint32_t corner = 0; corner < 3; ++corner) {
        all[k][corner] = mesh_.triangles[k][corner] - part.vertices + part.*base;
      }
    }
  }
  return all;
}

Mesh MeshBuilder::finish() {
  const auto has_none = [&](uint32_t Part::*base) {
    return std::all_of(parts_.begin(), parts_.end(), [&](const PartBegin& p) { return p.part.*base == kNone; });
  };
  if (has_none(&Part::normals)) mesh_.normals.clear();
  if (has_none(&Part::uvs)) mesh_.uvs.clear();
  mesh_.uv_corners = corners(&Part::uvs, mesh_.uvs.size(), false);
  mesh_.normal_corners = corners(&Part::normals, mesh_.normals.size(), has_bad_normals_);
  if (has_bad_normals_) {
    for (Mesh::Corners& triangle : mesh_.normal_corners) {
      const auto is_bad = [&](uint32_t corner) { return corner != kNone && is_zero(mesh_.normals[corner]); };
      if (std::any_of(triangle.begin(), triangle.end(), is_bad)) triangle = {kNone, kNone, kNone};
    }
  }
  parts_.clear();
  place_ = {};
  has_bad_normals_ = mirrored_ = false;
  return std::exchange(mesh_, {});
}

}  // namespace kerf
