#include "kerf/choose/split_guide.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kerf/base/parallel.h"
#include "kerf/references/clipper.h"
#include "kerf/references/middle_cut.h"

namespace kerf {
namespace {

constexpr double kCellWeight = 64;    // references that a cell stands for, about
constexpr size_t kCellJudges = 8;     // fewer say little about where to cut
constexpr uint32_t kMostLevels = 48;  // of the guide
constexpr size_t kParallel = 1024;    // judges that are worth a task
/// Planes through references are tried where the children of the best plane between them overlap by this share of the
/// node's area.
constexpr double kLeastOverlap = 0.01;
/// A cut in the middle of a flat box must save this share of its area. A right triangle in an axis-aligned plane saves
/// a quarter, whatever its size, and nothing else lies in its box: so walls and floors of most buildings are left
/// alone.
constexpr double kLeastSaving = 0.3;
constexpr double kFlat = 0.95;        // share of half the area that the largest side of a flat box has
constexpr double kMostSaving = 0.55;  // hardly any cut saves more than half: what has too little for that is not tried

bool is_flat(const Box3f& box) {
  const Vec3d e = to_double(box.upper) - to_double(box.lower);
  return std::max({e.x * e.y, e.y * e.z, e.z * e.x}) > kFlat * half_area(box);
}

/// What a cut in the middle saves of a piece's half area; nothing if it is not worth it.
struct MiddleCut {
  ClippedBoxes parts;
  double saved = 0;

  bool has_both() const { return !parts.below.is_empty() && !parts.above.is_empty(); }
};

std::optional<MiddleCut> worthwhile_cut(const Reference& reference, const Clipper& clipper, double least) {
  const double before = half_area(reference.bounds());
  if (!(kMostSaving * before > least)) return std::nullopt;
  const auto parts = cut_in_the_middle(reference, clipper);
  if (!parts) return std::nullopt;
  const double saved = before - half_area(parts->below) - half_area(parts->above);
  if (!(saved > least) || (saved < kLeastSaving * before && is_flat(reference.bounds()))) return std::nullopt;
  return MiddleCut{*parts, saved};
}

}  // namespace

/// Of the guide: a plane and what lies on its two sides, or a cell.
struct SplitGuide::Node {
  GuidePlane plane;  ///< exists() but in a cell
  std::unique_ptr<const Node> below, above;
  double least_saving = 0;    ///< half area that a cut in the middle must save; above cells: the least of them
  bool cuts = false;          ///< a plane here or below goes through references
  double area = 0;            ///< of a cell: half that of the box around all that it was judged by
  double gain_of_saving = 0;  ///< of a cell: what turns half area saved into a gain, for the curve
};

/// Makes the nodes.
class SplitGuide::Building {
 public:
  Building(const std::span<const Geometry>& geometries, const GuideRules& rules, const WorkLimit& limit)
      : clipper_(rough_clipper(geometries)), rules_(rules), limit_(limit) {}

  /// `room`: how many pieces these may become by the guide's planes.
  std::unique_ptr<const Node> node(Judges judges, size_t room, uint32_t level) const {
    if (judges.size() >= kParallel) limit_.check();
    const JudgedBox box(judges);
    if (box.weight <= kCellWeight || judges.size() <= kCellJudges || level == kMostLevels) {
      return cell(std::move(judges), box);
    }
    Judges below, above;
    auto node = std::make_unique<Node>();
    node->plane = divide(judges, box, room, below, above);
    if (!node->plane.exists()) return cell(std::move(judges), box);
    const bool is_large = judges.size() >= kParallel;
    const size_t below_room = share_of(room, below.size(), above.size());
    judges = {};
    const auto go_below = [&] { node->below = this->node(std::move(below), below_room, level + 1); };
    const auto go_above = [&] { node->above = this->node(std::move(above), room - below_room, level + 1); };
    if (is_large) {
      parallel_invoke(go_below, go_above);
    } else {
      go_below();
      go_above();
    }
    node->least_saving = std::min(node->below->least_saving, node->above->least_saving);
    node->cuts = node->plane.cuts || node->below->cuts || node->above->cuts;
    return node;
  }

 private:
  static size_t share_of(size_t room, size_t below, size_t above) {
    const double share = static_cast<double>(below) / static_cast<double>(below + above);
    return std::clamp(static_cast<size_t>(share * static_cast<double>(room)), below, room - above);
  }

  /// Divides the judges at the better plane; none if none divides them.
  GuidePlane divide(const Judges& judges, const JudgedBox& box, size_t room, Judges& below, Judges& above) const {
    const double area = half_area(box.bounds);
    const GuidePlane divider = cheapest_dividing_plane(judges, box);
    if (is_worth_cutting(divider, area)) {
      const double otherwise = divider.exists() ? divider.cost : area * box.weight;
      GuidePlane cutter = cheapest_cutting_plane(judges, box, clipper_, otherwise);
      cutter.toll = rules_.plane_gain * area;
      const double added = cutter.below_weight + cutter.above_weight - box.weight;
      if (cutter.cost + cutter.toll * added < otherwise) {
        part(judges, cutter, below, above);
        // Kept whole, all may have gone to one side.
        if (!below.empty() && !above.empty() && below.size() + above.size() <= room) return cutter;
        below = above = {};
      }
    }
    if (divider.exists()) part(judges, divider, below, above);
    return divider;
  }

  static bool is_worth_cutting(const GuidePlane& divider, double area) {
    if (!divider.exists()) return true;
    return half_area(intersected(divider.below, divider.above)) > kLeastOverlap * area;
  }

  void part(const Judges& judges, const GuidePlane& plane, Judges& below, Judges& above) const {
    for (size_t i = 0; i < judges.size(); ++i) {
      const Reference& reference = judges.references[i];
      const float weight = judges.weights[i];
      switch (plane.side_of(reference.bounds(), weight)) {
        case GuidePlane::Side::below:
          below.add(reference, weight);
          break;
        case GuidePlane::Side::above:
          above.add(reference, weight);
          break;
        case GuidePlane::Side::both:
          const ClippedBoxes parts = clipper_(reference, plane.axis, plane.position);
          if (!parts.below.is_empty()) below.add(with_box(reference, parts.below), weight);
          if (!parts.above.is_empty()) above.add(with_box(reference, parts.above), weight);
      }
    }
    for (Box3f other : judges.others) {
      const GuidePlane::Side side = plane.side_of(other, 1);
      const float upper = other.upper[plane.axis];
      if (side == GuidePlane::Side::both) other.upper[plane.axis] = plane.position;
      if (side != GuidePlane::Side::above) below.others.push_back(other);
      if (side == GuidePlane::Side::both) other.lower[plane.axis] = std::exchange(other.upper[plane.axis], upper);
      if (side != GuidePlane::Side::below) above.others.push_back(other);
    }
  }

  /// The end of the guide: how much a cut must save here. The predicted cost of a cell is the way down a tree over it
  /// and the boxes that a line through it crosses: log2(n) + sum of areas / area. Once judges are cut it is lower, so
  /// the next cuts are worth more of it: some rounds.
  std::unique_ptr<const Node> cell(Judges judges, const JudgedBox& box) const {
    constexpr int kRounds = 3;
    const double area = half_area(box.all);
    double sum = 0, count = box.weight;
    for (size_t i = 0; i < judges.size(); ++i) sum += judges.weights[i] * half_area(judges.references[i].bounds());
    auto cell = std::make_unique<Node>();
    cell->area = area;
    for (int round = 0; round < kRounds; ++round) {
      const double unit = (std::log2(count + 1) * area + sum) / count;
      cell->least_saving = std::min(unit * rules_.cell_gain, rules_.scene_unit * rules_.scene_gain);
      cell->gain_of_saving = 1 / std::min(unit, rules_.scene_unit);
      const size_t before = judges.size();
      cut_in_cell(judges, cell->least_saving, sum, count);
      if (judges.size() == before) break;
    }
    return cell;
  }

  void cut_in_cell(Judges& judges, double least, double& sum, double& count) const {
    for (size_t i = 0; i < judges.size(); ++i) {
      const float weight = judges.weights[i];
      while (const auto cut = worthwhile_cut(judges.references[i], clipper_, least)) {
        sum -= weight * cut->saved;
        count += cut->has_both() ? weight : 0;
        // Parts that wait behind the others get their turn in this round, too.
        if (cut->has_both()) judges.add(with_box(judges.references[i], cut->parts.above), weight);
        judges.references[i] =
            with_box(judges.references[i], united(cut->parts.below, cut->has_both() ? Box3f{} : cut->parts.above));
      }
    }
  }

  Clipper clipper_;
  const GuideRules& rules_;
  const WorkLimit& limit_;
};

SplitGuide::SplitGuide(Judges judges, const std::span<const Geometry>& geometries, const GuideRules& rules,
                       const WorkLimit& limit)
    : scene_saving_(rules.scene_unit * rules.scene_gain) {
  const auto room = static_cast<size_t>(rules.most_growth * static_cast<double>(judges.size()));
  root_ = Building(geometries, rules, limit).node(std::move(judges), room, 0);
}

SplitGuide::~SplitGuide() = default;

std::optional<Reference> SplitGuide::advance(const Waiting& piece, const Clipper& clipper, std::vector<Waiting>& stack,
                                             GainCurve& curve) const {
  const Reference& reference = piece.reference;
  const double most_saved = kMostSaving * half_area(reference.bounds());
  const Node* node = piece.node;
  const auto wait = [&](const ClippedBoxes& parts, const Node* below, const Node* above) {
    if (!parts.above.is_empty()) stack.push_back({with_box(reference, parts.above), above});
    if (!parts.below.is_empty()) stack.push_back({with_box(reference, parts.below), below});
  };
  while (node->plane.exists()) {
    if (!node->cuts && !(most_saved > node->least_saving)) return reference;
    const GuidePlane::Side side = node->plane.side_of(reference.bounds(), 1);
    if (side == GuidePlane::Side::both) {
      const ClippedBoxes parts = clipper(reference, node->plane.axis, node->plane.position);
      // Only rounding can leave nothing on either side: keep what we had.
      if (parts.below.is_empty() && parts.above.is_empty()) return reference;
      wait(parts, node->below.get(), node->above.get());
      return std::nullopt;
    }
    node = side == GuidePlane::Side::below ? node->below.get() : node->above.get();
  }
  // What is larger than all that the cell was judged by was missed: the cell's own cost would be far too low for it.
  const bool is_missed = half_area(reference.bounds()) > node->area;
  const auto cut = worthwhile_cut(reference, clipper, is_missed ? scene_saving_ : node->least_saving);
  if (!cut) return reference;
  curve.add(cut->saved * node->gain_of_saving, cut->saved, cut->has_both() ? 1 : 0);
  wait(cut->parts, node, node);
  return std::nullopt;
}

void GainCurve::add(double gain, double saved, size_t references) {
  const double place = std::clamp(std::floor(std::log2(gain)) - kFirst, 0.0, kBuckets - 1.0);  // a gain may be infinite
  Bucket& bucket = buckets[static_cast<size_t>(place)];
  bucket.references += references;
  bucket.saved += saved;
}

void GainCurve::add(const GainCurve& other) {
  for (size_t i = 0; i < buckets.size(); ++i) {
    buckets[i].references += other.buckets[i].references;
    buckets[i].saved += other.buckets[i].saved;
  }
}

}  // namespace kerf
