#include "kerf/references/reference.h"

#include <algorithm>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 8192;

/// What came of one block of primitives.
struct Block {
  size_t kept = 0, invalid = 0, degenerate = 0;
  uint32_t first_invalid = 0;
};

std::string describe(const Geometry& geometry, uint32_t primitive) {
  switch (find_defect(geometry, primitive)) {
    case Defect::bad_index: {
      const auto& mesh = std::get<TriangleMesh>(geometry.shapes);
      const TriangleCorners corners = mesh.triangles[primitive];
      const uint32_t worst = *std::max_element(corners.begin(), corners.end());
      return "vertex number " + std::to_string(worst) + " of " + std::to_string(mesh.vertices.size()) + " vertices";
    }
    case Defect::bad_coordinate:
      return "a coordinate that is not finite or beyond 1.3e36";
    case Defect::bad_radius:
      return "a radius that is negative, not finite or beyond 1.3e36";
    case Defect::none:
      break;
  }
  return "no defect";
}

/// A triangle with a vertex twice has no area wherever its vertices go.
bool is_flat_for_ever(const Geometry& geometry, uint32_t primitive) {
  const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes);
  if (mesh == nullptr) return false;
  const auto [a, b, c] = mesh->triangles[primitive];
  return a == b || b == c || c == a;
}

/// Fills the block's part of `out` from its front with the references of valid primitives.
Block fill(const Geometry& geometry, uint32_t number, size_t begin, size_t end, bool movable, Reference* out) {
  Block block;
  for (size_t i = begin; i < end; ++i) {
    const auto primitive = static_cast<uint32_t>(i);
    if (find_defect(geometry, primitive) != Defect::none) {
      if (block.invalid++ == 0) block.first_invalid = primitive;
      continue;
    }
    const bool degenerate = is_degenerate(geometry, primitive);
    block.degenerate += degenerate ? 1 : 0;
    if (!degenerate || (movable && !is_flat_for_ever(geometry, primitive))) {
      const Box3f box = primitive_bounds(geometry, primitive);
      out[begin + block.kept++] = {box.lower, number, box.upper, primitive};
    }
  }
  return block;
}

void check_memory(const Geometry& geometry, size_t number) {
  const auto check = [number](const auto& values, const char* what) {
    if (values.data() == nullptr && values.size() > 0) {
      throw Error(ErrorCode::invalid_argument, "geometry " + std::to_string(number),
                  std::string("the pointer to its ") + what + " is null");
    }
  };
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    check(mesh->vertices, "vertices");
    check(mesh->triangles, "triangles");
  } else if (const auto* spheres = std::get_if<Strided<Sphere>>(&geometry.shapes)) {
    check(*spheres, "spheres");
  } else {
    check(std::get<Strided<Parallelogram>>(geometry.shapes), "parallelograms");
  }
}

bool is_invalid(const Geometry& geometry, uint32_t primitive) {
  return find_defect(geometry, primitive) != Defect::none;
}

/// Those for which is_wanted(geometry, primitive), in order.
template <class Predicate>
std::vector<PrimitiveNumber> find_primitives(std::span<const Geometry> geometries, const Predicate& is_wanted) {
  std::vector<PrimitiveNumber> all;
  for (uint32_t number = 0; number < geometries.size(); ++number) {
    const Geometry& geometry = geometries[number];
    check_memory(geometry, number);
    const size_t count = primitive_count(geometry);
    std::vector<std::vector<PrimitiveNumber>> blocks((count + kGrain - 1) / kGrain);
    parallel_for(count, kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto primitive = static_cast<uint32_t>(i);
        if (is_wanted(geometry, primitive)) blocks[begin / kGrain].push_back({number, primitive});
      }
    });
    for (const auto& block : blocks) all.insert(all.end(), block.begin(), block.end());
  }
  return all;
}

}  // namespace

void refuse_invalid(std::span<const Geometry> geometries, PrimitiveNumber first, size_t count,
                    std::string_view consequence) {
  const Geometry& geometry = geometries[first.geometry];
  throw Error(ErrorCode::invalid_geometry,
              "geometry " + std::to_string(first.geometry) + ", " + std::string(kind_name(geometry)) + " " +
                  std::to_string(first.primitive),
              describe(geometry, first.primitive) + "; " + std::to_string(count) + " such primitives in all (" +
                  std::string(consequence) + ")");
}

std::vector<PrimitiveNumber> find_invalid(std::span<const Geometry> geometries) {
  return find_primitives(geometries, is_invalid);
}

std::vector<PrimitiveNumber> find_left_out(std::span<const Geometry> geometries) {
  return find_primitives(geometries, [](const Geometry& geometry, uint32_t primitive) {
    return is_invalid(geometry, primitive) || is_flat_for_ever(geometry, primitive);
  });
}

PrimitiveReferences make_references(std::span<const Geometry> geometries, bool skip_invalid, bool movable) {
  size_t total = 0;
  for (size_t number = 0; number < geometries.size(); ++number) {
    check_memory(geometries[number], number);
    const size_t count = primitive_count(geometries[number]);
    if (count > kMaxReferences - total || number > kMaxReferences) {
      throw Error(ErrorCode::too_large, "geometry " + std::to_string(number),
                  std::to_string(count) + " primitives more; a scene can hold 2147483647");
    }
    total += count;
  }
  PrimitiveReferences result;
  result.references.resize(total);
  size_t kept = 0, first = 0;
  PrimitiveNumber first_invalid;
  for (uint32_t number = 0; number < geometries.size(); ++number) {
    const Geometry& geometry = geometries[number];
    const size_t count = primitive_count(geometry);
    std::vector<Block> blocks((count + kGrain - 1) / kGrain);
    Reference* out = result.references.data() + first;
    parallel_for(count, kGrain, [&](size_t begin, size_t end) {
      blocks[begin / kGrain] = fill(geometry, number, begin, end, movable, out);
    });
    for (size_t b = 0; b < blocks.size(); ++b) {
      if (blocks[b].invalid > 0 && result.invalid == 0) {
        first_invalid = {number, blocks[b].first_invalid};
      }
      result.invalid += blocks[b].invalid;
      result.degenerate += blocks[b].degenerate;
      const Reference* from = out + b * kGrain;
      Reference* to = result.references.data() + kept;
      if (from != to) std::move(from, from + blocks[b].kept, to);
      kept += blocks[b].kept;
    }
    first += count;
  }
  if (result.invalid > 0 && !skip_invalid) {
    refuse_invalid(geometries, first_invalid, result.invalid, "skip_invalid drops them");
  }
  result.references.resize(kept);
  return result;
}

}  // namespace kerf
