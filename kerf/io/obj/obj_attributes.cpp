#include "kerf/io/obj/obj_attributes.h"

#include <fmt/format.h>

#include <cmath>

#include "kerf/geometry/hit.h"

namespace kerf {
namespace {

/// Whether the normal can be used; brings it to a length that can.
bool repair(Vec3f& normal) {
  const Vec3d wide{normal.x, normal.y, normal.z};
  const double square = dot(wide, wide);  // of floats: neither too large nor too small for a double
  if (!(square > 0) || !std::isfinite(square)) return false;
  if (square > 1e-24 && square < 1e24) return true;
  const double length = std::sqrt(square);
  normal = {static_cast<float>(wide.x / length), static_cast<float>(wide.y / length),
            static_cast<float>(wide.z / length)};
  return true;
}

bool repair(std::array<float, 2>& uv) { return std::isfinite(uv[0]) && std::isfinite(uv[1]); }

/// Whether a corner of the triangle has a value that cannot be used.
bool is_unusable(const Mesh::Corners& corners, const std::vector<bool>& usable) {
  for (const uint32_t corner : corners) {
    if (corner != kNone && !usable[corner]) return true;
  }
  return false;
}

/// Returns how many triangles have lost the attribute.
template <class T>
size_t drop_unusable(std::vector<T>& values, const std::vector<Mesh::Corners>& triangles,
                     std::vector<Mesh::Corners>& corners) {
  std::vector<bool> usable;  // empty while all are
  for (size_t i = 0; i < values.size(); ++i) {
    if (repair(values[i])) continue;
    if (usable.empty()) usable.assign(values.size(), true);
    usable[i] = false;
  }
  size_t dropped = 0;
  if (usable.empty()) return dropped;
  for (size_t i = 0; i < triangles.size(); ++i) {
    if (!is_unusable(corners.empty() ? triangles[i] : corners[i], usable)) continue;
    if (corners.empty()) corners = triangles;
    corners[i] = {kNone, kNone, kNone};
    ++dropped;
  }
  return dropped;
}

}  // namespace

void drop_unusable_attributes(Mesh& mesh, std::vector<std::string>& notes) {
  const auto note = [&](size_t dropped, const char* what) {
    if (dropped > 0) notes.push_back(fmt::format("{} triangle{} {}", dropped, dropped == 1 ? " has" : "s have", what));
  };
  note(drop_unusable(mesh.normals, mesh.triangles, mesh.normal_corners),
       "a normal that is zero or not finite; they are shown flat");
  note(drop_unusable(mesh.uvs, mesh.triangles, mesh.uv_corners),
       "a texture coordinate that is not finite; they are shown without a texture");
}

}  // namespace kerf
