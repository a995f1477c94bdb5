#include "kerf/study/figures/seen_leaves.h"

#include <algorithm>
#include <cmath>

#include "kerf/render/camera.h"

namespace kerf {
namespace {

/// One place of a leaf: whose it is, and which leaf.
struct Place {
  uint64_t primitive;  ///< geometry, then number in it
  uint32_t leaf;

  friend bool operator<(const Place& a, const Place& b) {
    return a.primitive != b.primitive ? a.primitive < b.primitive : a.leaf < b.leaf;
  }
};

uint64_t key_of(uint32_t geometry, uint32_t primitive) { return (uint64_t{geometry} << 32) | primitive; }

/// Whether a point lies in a box, but for what rounding may have moved it.
bool holds(const Box3f& box, Vec3f point, float slack) {
  const Vec3f by{slack, slack, slack};
  return Box3f{box.lower - by, box.upper + by}.contains(point);
}

}  // namespace

std::vector<TreeBox> seen_leaves(const Scene& scene, const Camera& camera, size_t count, const FigureOptions& options) {
  std::vector<TreeBox> leaves;
  std::vector<Place> places;
  scene.structure().visit_nodes([&](const NodeView& node) {
    if (!node.is_leaf || node.slots.empty()) return;
    const auto leaf = static_cast<uint32_t>(leaves.size());
    for (const LeafSlot& slot : node.slots) places.push_back({key_of(slot.geometry(), slot.primitive), leaf});
    leaves.push_back({node.bounds, node.depth, true, TreeBox::kSeveral});
  });
  std::sort(places.begin(), places.end());
  const double across = std::sqrt(static_cast<double>(count) * options.width / options.height);
  const auto columns = static_cast<uint32_t>(std::max(1.0, std::round(across)));
  const auto rows = static_cast<uint32_t>(std::max<size_t>(1, count / columns));
  const CameraRays rays(camera, columns, rows);
  std::vector<char> is_seen(leaves.size());
  for (uint32_t i = 0; i < columns * rows; ++i) {
    const Ray ray = rays.center(i % columns, i / columns);
    const Hit hit = scene.closest_hit(ray);
    if (!hit) continue;
    const Vec3f point = ray.origin + ray.direction * hit.t;
    constexpr float kSlack = 1e-5F;
    const float slack = kSlack * std::max(largest(abs(point)), hit.t);
    const Place first{key_of(hit.geometry, hit.primitive), 0};
    for (auto at = std::lower_bound(places.begin(), places.end(), first);
         at != places.end() && at->primitive == first.primitive; ++at) {
      if (holds(leaves[at->leaf].bounds, point, slack)) is_seen[at->leaf] = 1;
    }
  }
  std::vector<TreeBox> seen;
  for (size_t i = 0; i < leaves.size(); ++i) {
    if (is_seen[i] != 0) seen.push_back(leaves[i]);
  }
  return seen;
}

}  // namespace kerf
