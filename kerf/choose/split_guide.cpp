#include "kerf/choose/split_guide.h"

#include <algorithm>
#include <cmath>

#include "kerf/base/parallel.h"
#include "kerf/choose/guide_planes.h"
#include "kerf/references/middle_cut.h"

namespace kerf {
namespace {

constexpr double kCellWeight = 64;    // references that a cell stands for, about
constexpr size_t kCellWeighty = 8;    // fewer say little about where to cut
constexpr uint32_t kMostLevels = 48;  // of the guide
constexpr size_t kParallel = 2048;    // references that are worth a task
constexpr size_t kStepsPerCheck = 1024;
/// Planes through references are tried where the children of the best plane between them overlap by this share of the
/// node's area.
constexpr double kLeastOverlap = 0.01;
/// A cut in the middle must save this share of a box's area. A right triangle in an axis-aligned plane saves a quarter,
/// whatever its size: it fills a flat box, in which nothing else lies.
constexpr double kLeastSaving = 0.3;
constexpr double kMostSaving = 0.75;  // hardly any cut saves more, so what has less than it should save is not tried

class Guide {
 public:
  Guide(std::span<const Geometry> geometries, const Clipper& clipper, const GuideRules& rules, const WorkLimit& limit)
      : geometries_(geometries), clipper_(clipper), rules_(rules), limit_(limit) {}

  /// `room`: how many pieces these may become by the guide's planes.
  GuidedPieces divide(std::vector<GuidedReference> references, size_t room, uint32_t level) const {
    if (references.size() >= kParallel) limit_.check();
    const GuideNode node(references);
    if (node.weight <= kCellWeight || node.weighty <= kCellWeighty || level == kMostLevels) {
      return cell(std::move(references), node);
    }
    std::vector<GuidedReference> below, above;
    part(references, node, room, below, above);
    if (below.empty() || above.empty()) return cell(std::move(references), node);
    const bool is_large = references.size() >= kParallel;
    const size_t below_room = share_of(room, below.size(), above.size());
    std::vector<GuidedReference>().swap(references);
    GuidedPieces first, second;
    const auto go_below = [&] { first = divide(std::move(below), below_room, level + 1); };
    const auto go_above = [&] { second = divide(std::move(above), room - below_room, level + 1); };
    if (is_large) {
      parallel_invoke(go_below, go_above);
    } else {
      go_below();
      go_above();
    }
    first.cells.insert(first.cells.end(), std::make_move_iterator(second.cells.begin()),
                       std::make_move_iterator(second.cells.end()));
    first.curve.add(second.curve);
    return first;
  }

 private:
  static size_t share_of(size_t room, size_t below, size_t above) {
    const double share = static_cast<double>(below) / static_cast<double>(below + above);
    return std::clamp(static_cast<size_t>(share * static_cast<double>(room)), below, room - above);
  }

  /// Divides a node's references at the better plane; one side stays empty where none divides them.
  void part(std::span<const GuidedReference> references, const GuideNode& node, size_t room,
            std::vector<GuidedReference>& below, std::vector<GuidedReference>& above) const {
    const GuidePlane divider = cheapest_dividing_plane(references, node);
    if (is_worth_cutting(divider, node)) {
      const GuidePlane cutter = cheapest_cutting_plane(references, node, geometries_);
      const double added = cutter.below_weight + cutter.above_weight - node.weight;
      const double toll = rules_.plane_gain * half_area(node.bounds) * added;
      const double otherwise = divider.exists() ? divider.cost : half_area(node.bounds) * node.weight;
      if (cutter.cost + toll < otherwise) {
        cut(references, node, cutter, below, above);
        // Kept whole, all may have gone to one side.
        if (!below.empty() && !above.empty() && below.size() + above.size() <= room) return;
        below.clear();
        above.clear();
      }
    }
    if (divider.exists()) {
      for (const GuidedReference& guided : references) {
        (divider.is_below(guided.reference) ? below : above).push_back(guided);
      }
    }
  }

  static bool is_worth_cutting(const GuidePlane& divider, const GuideNode& node) {
    if (!divider.exists()) return true;
    return half_area(intersected(divider.below, divider.above)) > kLeastOverlap * half_area(node.bounds);
  }

  /// References across the plane go to both sides, or whole to one where that is cheaper (Stich et al. 2009, section
  /// 4.4, with the sides as they were judged).
  void cut(std::span<const GuidedReference> references, const GuideNode& node, const GuidePlane& plane,
           std::vector<GuidedReference>& below, std::vector<GuidedReference>& above) const {
    const double below_area = half_area(plane.below), above_area = half_area(plane.above);
    const double both = below_area * plane.below_weight + above_area * plane.above_weight;
    const double toll = rules_.plane_gain * half_area(node.bounds);  // of one more reference
    for (const GuidedReference& guided : references) {
      const Reference& reference = guided.reference;
      const bool reaches_below = reference.lower[plane.axis] < plane.position;
      const bool reaches_above = reference.upper[plane.axis] > plane.position;
      if (!(reaches_below && reaches_above)) {
        (reaches_above ? above : below).push_back(guided);
        continue;
      }
      const double weight = std::max(1.0F, guided.weight);
      const double only_below = half_area(united(plane.below, reference.bounds())) * plane.below_weight +
                                above_area * (plane.above_weight - weight);
      const double only_above = below_area * (plane.below_weight - weight) +
                                half_area(united(plane.above, reference.bounds())) * plane.above_weight;
      if (std::min(only_below, only_above) <= both + toll * weight) {
        (only_below <= only_above ? below : above).push_back(guided);
        continue;
      }
      const ClippedBoxes parts = clipper_(reference, plane.axis, plane.position);
      const bool is_lost = parts.below.is_empty() && parts.above.is_empty();  // only by rounding: keep what we had
      if (is_lost) below.push_back(guided);
      if (!parts.below.is_empty()) below.push_back(piece(guided, parts.below));
      if (!parts.above.is_empty()) above.push_back(piece(guided, parts.above));
    }
  }

  static GuidedReference piece(GuidedReference guided, const Box3f& box) {
    guided.reference = with_box(guided.reference, box);
    return guided;
  }

  /// The end of the guide: what is large for this cell is cut until that does not pay any more. The predicted cost of a
  /// cell is the way down a tree over it and the boxes that a line through it crosses: log2(n) + sum of areas / area.
  GuidedPieces cell(std::vector<GuidedReference> references, const GuideNode& node) const {
    GuidedPieces pieces;
    const double area = half_area(node.bounds);
    double sum = 0, count = 0;
    for (const GuidedReference& guided : references) {
      sum += guided.weight * half_area(guided.reference.bounds());
      count += guided.weight;
    }
    // Each round the cell's cost is lower, so what is left is worth more of it.
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds && count > 0; ++round) {
      const double cell_unit = (std::log2(count + 1) * area + sum) / count;
      const size_t before = references.size();
      references = cut_in_cell(references, cell_unit, sum, count, pieces.curve);
      if (references.size() == before) break;
    }
    if (!references.empty()) pieces.cells.push_back(std::move(references));
    return pieces;
  }

  std::vector<GuidedReference> cut_in_cell(const std::vector<GuidedReference>& references, double cell_unit,
                                           double& sum, double& count, GainCurve& curve) const {
    const double unit = std::min(cell_unit * rules_.cell_gain, rules_.scene_unit * rules_.scene_gain);
    std::vector<GuidedReference> cut, stack;
    cut.reserve(references.size());
    size_t steps = 0;
    for (const GuidedReference& whole : references) {
      stack.assign(1, whole);
      while (!stack.empty()) {
        if (++steps % kStepsPerCheck == 0) limit_.check();
        GuidedReference guided = stack.back();
        stack.pop_back();
        const double before = half_area(guided.reference.bounds());
        const bool is_tried = !guided.is_settled && kMostSaving * before > unit;
        const auto parts = is_tried ? cut_in_the_middle(guided.reference, clipper_) : std::nullopt;
        const double saved = parts ? before - half_area(parts->below) - half_area(parts->above) : 0;
        guided.is_settled = guided.is_settled || (is_tried && saved < kLeastSaving * before);
        if (guided.is_settled || !(saved > unit)) {
          cut.push_back(guided);
          continue;
        }
        const bool has_both = !parts->below.is_empty() && !parts->above.is_empty();
        sum -= guided.weight * saved;
        count += has_both ? guided.weight : 0;
        curve.add(saved / std::min(cell_unit, rules_.scene_unit), saved, has_both ? 1 : 0);
        if (!parts->above.is_empty()) stack.push_back(piece(guided, parts->above));
        if (!parts->below.is_empty()) stack.push_back(piece(guided, parts->below));
      }
    }
    return cut;
  }

  std::span<const Geometry> geometries_;
  const Clipper& clipper_;
  const GuideRules& rules_;
  const WorkLimit& limit_;
};

}  // namespace

void GainCurve::add(double gain, double saved, size_t references) {
  const int bucket = std::clamp(static_cast<int>(std::floor(std::log2(gain))) - kFirst, 0, kBuckets - 1);
  buckets[static_cast<size_t>(bucket)].references += references;
  buckets[static_cast<size_t>(bucket)].saved += saved;
}

void GainCurve::add(const GainCurve& other) {
  for (size_t i = 0; i < buckets.size(); ++i) {
    buckets[i].references += other.buckets[i].references;
    buckets[i].saved += other.buckets[i].saved;
  }
}

GuidedPieces guide_splits(std::vector<GuidedReference> references, std::span<const Geometry> geometries,
                          const Clipper& clipper, const GuideRules& rules, const WorkLimit& limit) {
  if (references.empty()) return {};
  const auto room = static_cast<size_t>(rules.most_growth * static_cast<double>(references.size()));
  return Guide(geometries, clipper, rules, limit).divide(std::move(references), room, 0);
}

}  // namespace kerf
