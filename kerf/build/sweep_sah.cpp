#include <array>
#include <cmath>
#include <limits>

#include "kerf/build/builders.h"
#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

/// Three orders of the references, each sorted along one axis once and kept sorted by stable partition ever after,
/// which makes the whole build O(N log N) (Wald, Boulos, Shirley 2007; the idea for kd-trees: Wald and Havran 2006).
class SweepSah {
 public:
  explicit SweepSah(std::vector<Reference> references)
      : references_(std::move(references)), goes_right_(references_.size()) {
    held_.set(references_.size() * (sizeof(Reference) + 3 * kLineBytes + 1));
    parallel_for(3, 1, [&](size_t begin, size_t end) {
      for (size_t axis = begin; axis < end; ++axis) sort(static_cast<uint32_t>(axis));
    });
  }

  Subset whole() const {
    Subset subset{0, static_cast<uint32_t>(references_.size()), {}, {}};
    for (const Reference& reference : references_) subset.bounds.extend(reference.bounds());
    return subset;
  }

  const Reference& reference(uint32_t i) const { return references_[lines_[0].order[i]]; }
  void free_references() {
    std::vector<Reference>().swap(references_);
    lines_ = {};
    std::vector<uint8_t>().swap(goes_right_);
    held_.release();
  }

  /// The plane between two different centres with the least area times count, both sides added. References with equal
  /// centres stay together: a cut among them is no plane, and would depend on the order of the primitives.
  std::optional<Halves> split(const Subset& subset) {
    std::array<Cut, 3> cuts;
    for_each_axis(subset, [&](uint32_t axis) { cuts[axis] = cheapest_cut(subset, axis); });
    uint32_t best = 0;
    for (uint32_t axis = 1; axis < 3; ++axis) {
      if (cuts[axis].cost < cuts[best].cost) best = axis;
    }
    if (std::isinf(cuts[best].cost)) return std::nullopt;
    return divide(subset, best, cuts[best].middle);
  }

  Halves halve(const Subset& subset) {
    return divide(subset, largest_axis(subset.bounds.extent()), subset.begin + subset.count() / 2);
  }

 private:
  struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    uint32_t middle = 0;
  };
  /// One axis: the order, and scratch of the same length; a subset uses only its own stretch of either.
  struct Line {
    std::vector<uint32_t> order, scratch;
    std::vector<double> right_area;
  };
  static constexpr size_t kLineBytes = 2 * sizeof(uint32_t) + sizeof(double);

  void sort(uint32_t axis) {
    Line& line = lines_[axis];
    line.order.resize(references_.size());
    line.scratch.resize(references_.size());
    line.right_area.resize(references_.size());
    for (uint32_t i = 0; i < line.order.size(); ++i) line.order[i] = i;
    // References come in the order of the caller's primitives, so the number is the tie-break by primitive.
    LimitWatch watch;
    std::sort(line.order.begin(), line.order.end(), [&](uint32_t a, uint32_t b) {
      watch.step();
      const float ca = center2(references_[a], axis), cb = center2(references_[b], axis);
      return ca != cb ? ca < cb : a < b;
    });
  }

  template <class F>
  void for_each_axis(const Subset& subset, F&& f) {
    constexpr uint32_t kParallelCount = 16384;
    parallel_for(3, subset.count() >= kParallelCount ? 1 : 3, [&](size_t begin, size_t end) {
      for (size_t axis = begin; axis < end; ++axis) f(static_cast<uint32_t>(axis));
    });
  }

  Cut cheapest_cut(const Subset& subset, uint32_t axis) {
    Line& line = lines_[axis];
    Box3f box;
    for (uint32_t i = subset.end - 1; i > subset.begin; --i) {
      box.extend(references_[line.order[i]].bounds());
      line.right_area[i] = half_area(box);
    }
    box = {};
    Cut best;
    for (uint32_t i = subset.begin + 1; i < subset.end; ++i) {
      const Reference &previous = references_[line.order[i - 1]], &next = references_[line.order[i]];
      box.extend(previous.bounds());
      if (center2(previous, axis) == center2(next, axis)) continue;
      const double cost = half_area(box) * (i - subset.begin) + line.right_area[i] * (subset.end - i);
      if (cost < best.cost) best = {cost, i};
    }
    return best;
  }

  Halves divide(const Subset& subset, uint32_t axis, uint32_t middle) {
    Halves halves{{subset.begin, middle, {}, {}}, {middle, subset.end, {}, {}}};
    for (uint32_t i = subset.begin; i < subset.end; ++i) {
      const uint32_t number = lines_[axis].order[i];
      goes_right_[number] = i >= middle ? 1 : 0;
      (i < middle ? halves.left : halves.right).bounds.extend(references_[number].bounds());
    }
    for_each_axis(subset, [&](uint32_t other) {
      if (other != axis) stable_partition(subset, lines_[other]);
    });
    return halves;
  }

  void stable_partition(const Subset& subset, Line& line) {
    uint32_t left = subset.begin, right = 0;
    for (uint32_t i = subset.begin; i < subset.end; ++i) {
      const uint32_t number = line.order[i];
      if (goes_right_[number] != 0) {
        line.scratch[subset.begin + right++] = number;
      } else {
        line.order[left++] = number;
      }
    }
    std::copy_n(line.scratch.begin() + subset.begin, right, line.order.begin() + left);
  }

  std::vector<Reference> references_;
  std::array<Line, 3> lines_;
  std::vector<uint8_t> goes_right_;
  HeldBytes held_;
};

}  // namespace

Bvh build_sweep_sah(BuildInput input, const OptionValues& options) {
  SweepSah partition(std::move(input.references));
  return build_top_down(partition, TopDownOptions::from(options), input.limit);
}

}  // namespace kerf
