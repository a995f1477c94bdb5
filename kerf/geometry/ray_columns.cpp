#include "kerf/geometry/ray_columns.h"

#include <string_view>

namespace kerf {
namespace {

struct Length {
  std::string_view name;
  size_t length;
  bool may_be_empty;
};

std::optional<std::string> find_odd(std::span<const Length> columns, size_t rays) {
  for (const Length& column : columns) {
    if (column.length == rays || (column.may_be_empty && column.length == 0)) continue;
    return std::to_string(rays) + " rays, but " + std::to_string(column.length) + " of " + std::string(column.name);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> find_odd_length(const RayColumns& rays) {
  const Length columns[] = {{"origin y", rays.origin[1].size(), false},
                            {"origin z", rays.origin[2].size(), false},
                            {"direction x", rays.direction[0].size(), false},
                            {"direction y", rays.direction[1].size(), false},
                            {"direction z", rays.direction[2].size(), false},
                            {"t_min", rays.t_min.size(), true},
                            {"t_max", rays.t_max.size(), true},
                            {"time", rays.time.size(), true},
                            {"mask", rays.mask.size(), true}};
  return find_odd(columns, rays.size());
}

std::optional<std::string> find_odd_length(const HitColumns& hits, size_t rays) {
  const Length columns[] = {{"t", hits.t.size(), true},
                            {"u", hits.u.size(), true},
                            {"v", hits.v.size(), true},
                            {"primitive", hits.primitive.size(), true},
                            {"geometry", hits.geometry.size(), true},
                            {"instance", hits.instance.size(), true}};
  return find_odd(columns, rays);
}

}  // namespace kerf
