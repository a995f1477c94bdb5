#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/references/fit_limit.h"
#include "kerf/references/refine.h"
#include "kerf/references/refiner.h"
#include "kerf/references/split_each.h"
#include "kerf/references/welded_sides.h"

namespace kerf {
namespace {

/// A reference for each triangle, those without area too.
std::vector<Reference> all_triangles(const Geometry& geometry) {
  std::vector<Reference> references(primitive_count(geometry));
  for (uint32_t i = 0; i < references.size(); ++i) {
    if (find_defect(geometry, i) != Defect::none) make_references({&geometry, 1});  // names the first
    const Box3f box = primitive_bounds(geometry, i);
    references[i] = {box.lower, 0, box.upper, i};
  }
  return references;
}

/// Gives corners of small triangles the numbers of vertices: one for each place of the original mesh, one for each
/// point that halving of a side made, and those inside a triangle its own.
class VertexNumbers {
 public:
  explicit VertexNumbers(std::vector<Vec3f>& vertices) : vertices_(vertices) {}

  void begin_triangle(const Triangle& triangle) {
    places_ = welded_.add(triangle).places;
    inside_.clear();
  }

  uint32_t number_of(const RefinedCorner& corner) {
    const double weight[3] = {1 - corner.u - corner.v, corner.u, corner.v};
    uint32_t ends[3], count = 0;
    for (uint32_t i = 0; i < 3; ++i) {
      if (weight[i] != 0) ends[count++] = i;
    }
    if (count == 3) return number(inside_, {corner.u, corner.v}, corner);
    if (count == 1 || places_[ends[0]] == places_[ends[1]]) return number(corners_, places_[ends[0]], corner);
    if (places_[ends[0]] > places_[ends[1]]) std::swap(ends[0], ends[1]);
    return number(on_sides_, {{places_[ends[0]], places_[ends[1]]}, weight[ends[1]]}, corner);
  }

 private:
  template <class Map>
  uint32_t number(Map& map, const typename Map::key_type& key, const RefinedCorner& corner) {
    const auto [at, is_new] = map.try_emplace(key, static_cast<uint32_t>(vertices_.size()));
    if (is_new) vertices_.push_back(to_float(corner.position));
    return at->second;
  }

  std::vector<Vec3f>& vertices_;
  WeldedSides welded_;
  std::array<uint32_t, 3> places_{};
  std::map<uint32_t, uint32_t> corners_;
  std::map<std::pair<std::pair<uint32_t, uint32_t>, double>, uint32_t> on_sides_;
  std::map<std::pair<double, double>, uint32_t> inside_;
};

/// How many small triangles there are, or nothing if they are more than `most`.
std::optional<size_t> count_all(const Refiner& refiner, size_t triangles, size_t most) {
  size_t count = 0;
  for (size_t i = 0; i < triangles && count <= most; ++i) {
    refiner.cut(i, [&](const std::array<RefinedCorner, 3>&) { return ++count <= most; });
  }
  return count <= most ? std::optional<size_t>(count) : std::nullopt;
}

}  // namespace

RefinedMesh refine_mesh(const TriangleMesh& mesh, const Refinement& options) {
  check_options(options);
  const Geometry geometry{mesh};
  const std::span<const Geometry> geometries(&geometry, 1);
  const std::vector<Reference> whole = all_triangles(geometry);
  Refiner refiner(geometries, whole, options.measure);
  const size_t most = most_references(whole.size(), options.cap);
  const auto try_limit = [&](double limit) {
    refiner.set_limit(limit);
    return count_all(refiner, whole.size(), most);
  };
  RefinedMesh refined;
  refined.limit = options.limit;
  if (!try_limit(options.limit)) {
    refined.capped = true;
    refined.limit = lower_to_fit(refiner.largest(), options.limit, whole.size(), most, try_limit);
    refiner.set_limit(refined.limit);
  }
  VertexNumbers numbers(refined.vertices);
  for (uint32_t i = 0; i < whole.size(); ++i) {
    numbers.begin_triangle(mesh.triangle(i));
    refiner.cut(i, [&](const std::array<RefinedCorner, 3>& corners) {
      TriangleCorners& triangle = refined.triangles.emplace_back();
      std::array<RefinedMesh::Weights, 3>& weights = refined.weights.emplace_back();
      for (uint32_t k = 0; k < 3; ++k) {
        triangle[k] = numbers.number_of(corners[k]);
        weights[k] = {static_cast<float>(corners[k].u), static_cast<float>(corners[k].v)};
      }
      refined.originals.push_back(i);
      return true;
    });
  }
  return refined;
}

}  // namespace kerf
