#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/base/transform.h"
#include "kerf/base/vec3.h"
#include "kerf/io/mesh.h"

namespace kerf {

/// Makes one mesh of the parts of a file, each placed by a transform: positions in double and rounded once, normals by
/// the inverse transpose, triangles turned where the transform mirrors.
///
/// Normals and texture coordinates share the corner numbers of the positions as long as all parts allow it.
class MeshBuilder {
 public:
  static constexpr uint32_t kNone = 0xFFFFFFFFU;

  struct Counts {
    uint64_t vertices = 0, normals = 0, uvs = 0, triangles = 0;
    Counts& operator+=(const Counts& more);
  };

  /// What the triangles that follow have: where their numbers start in each array, kNone for one that they have not.
  struct Part {
    uint32_t vertices = 0, normals = kNone, uvs = kNone, material = 0;
  };

  /// Makes room for all that is to come. Throws Error (too_large) with `place` for more than 2^32 - 2 of any kind or
  /// 2^31 - 1 triangles.
  void reserve(const Counts& counts, const std::string& place);

  /// Places what is set from here on.
  void set_place(const Transform& place);

  /// Adds `count` vertices, all at 0, and returns the number of the first; likewise below. There must be room.
  uint32_t add_vertices(size_t count);
  uint32_t add_normals(size_t count);
  uint32_t add_uvs(size_t count);

  void set_vertex(size_t number, Vec3d local) { mesh_.vertices[number] = to_float(place_.point(local)); }
  /// Of any length; with one of length 0 or not finite the triangles that use it are flat.
  void set_normal(size_t number, Vec3d local);
  void set_uv(size_t number, double u, double v) { mesh_.uvs[number] = {static_cast<float>(u), static_cast<float>(v)}; }

  void begin_part(const Part& part);

  /// Corners counter-clockwise before the transform, counted from the part's first vertex.
  void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t first = parts_.back().part.vertices;
    if (mirrored_) std::swap(b, c);
    mesh_.triangles.push_back({first + a, first + b, first + c});
    mesh_.materials.push_back(parts_.back().part.material);
  }

  size_t triangle_count() const { return mesh_.triangles.size(); }

  /// The mesh; the builder is empty afterwards.
  Mesh finish();

 private:
  struct PartBegin {
    Part part;
    size_t first_triangle;
  };

  /// The corners into another array than vertices; empty where they are those of the triangles.
  std::vector<Mesh::Corners> corners(uint32_t Part::*base, size_t count, bool has_bad) const;
  bool follows_vertices(uint32_t Part::*base) const;
  size_t end_of(size_t part) const;

  Mesh mesh_;
  std::vector<PartBegin> parts_;
  Transform place_;
  Vec3d cofactor_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // columns of the inverse transpose, up to a positive factor
  bool mirrored_ = false;
  bool has_bad_normals_ = false;
};

}  // namespace kerf
