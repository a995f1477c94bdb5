#include "kerf/study/figures/tree_boxes.h"

#include <algorithm>
#include <numeric>

#include "kerf/scene/pipeline.h"

namespace kerf {
namespace {

/// Where each geometry's primitives begin when all are numbered in one row.
std::vector<uint32_t> first_numbers(const Scene& scene) {
  std::vector<uint32_t> first;
  size_t count = 0;
  for (const Geometry& geometry : scene.geometries()) {
    first.push_back(static_cast<uint32_t>(count));
    count += primitive_count(geometry);
  }
  return first;
}

uint32_t owner_of_both(uint32_t a, uint32_t b) {
  if (a == TreeBox::kNobody || a == b) return b;
  return TreeBox::kSeveral;
}

}  // namespace

std::vector<TreeBox> tree_boxes(const Scene& scene) {
  const std::vector<uint32_t> first = first_numbers(scene);
  std::vector<TreeBox> boxes;
  std::vector<size_t> path;  // from the root to the node that is visited
  scene.structure().visit_nodes([&](const NodeView& node) {
    path.resize(std::min<size_t>(path.size(), node.depth));
    path.push_back(boxes.size());
    boxes.push_back({node.bounds, node.depth, node.is_leaf, TreeBox::kNobody});
    for (const LeafSlot& slot : node.slots) {
      const uint32_t owner = first[slot.geometry()] + slot.primitive;
      for (const size_t i : path) boxes[i].owner = owner_of_both(boxes[i].owner, owner);
    }
  });
  return boxes;
}

std::vector<TreeBox> input_boxes(const Scene& scene, const std::string& pipeline) {
  const std::vector<uint32_t> first = first_numbers(scene);
  const std::span<const Geometry> geometries = scene.geometries();
  const bool drops_invalid = true;  // a scene that was built has none, or was to drop them
  std::vector<Reference> references = make_references(geometries, drops_invalid).references;
  const Pipeline parsed = parse_pipeline(pipeline);
  const Stage& stage = parsed.stages.front();
  if (const auto* splitter = std::get_if<const SplitterEntry*>(&stage.entry->entry)) {
    references =
        (*splitter)->split({geometries, references, geometry_clipper(geometries), {}}, stage.options).references;
  }
  std::vector<TreeBox> boxes;
  boxes.reserve(references.size());
  for (const Reference& r : references) boxes.push_back({r.bounds(), 0, true, first[r.geometry] + r.primitive});
  return boxes;
}

std::vector<TreeBox> level_of(const std::vector<TreeBox>& boxes, uint32_t depth) {
  std::vector<TreeBox> level;
  std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(level),
               [&](const TreeBox& box) { return box.depth == depth || (box.is_leaf && box.depth < depth); });
  return level;
}

std::vector<TreeBox> filled_leaves(const std::vector<TreeBox>& boxes) {
  std::vector<TreeBox> leaves;
  std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(leaves),
               [](const TreeBox& box) { return box.is_leaf && box.owner != TreeBox::kNobody; });
  return leaves;
}

std::vector<TreeBox> largest_boxes(std::vector<TreeBox> boxes, size_t count) {
  if (boxes.size() <= count) return boxes;
  std::vector<size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<double> areas;
  areas.reserve(boxes.size());
  for (const TreeBox& box : boxes) areas.push_back(half_area(box.bounds));
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return areas[a] != areas[b] ? areas[a] > areas[b] : a < b; });
  order.resize(count);
  std::sort(order.begin(), order.end());
  std::vector<TreeBox> largest;
  largest.reserve(count);
  for (const size_t i : order) largest.push_back(boxes[i]);
  return largest;
}

}  // namespace kerf
