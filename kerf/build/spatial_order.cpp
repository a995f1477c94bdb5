#include "kerf/build/spatial_order.h"

#include <cmath>
#include <numeric>

#include "kerf/base/parallel.h"
#include "kerf/references/middle_cut.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 512;           // references that one task cuts
constexpr size_t kLengthsGrain = 16384;  // and whose lengths one adds up

enum class Fate : uint8_t { cut, below, above };

/// Where each reference across a plane goes, one after another: cut, or whole to the side where that is cheaper.
class Unsplitting {
 public:
  explicit Unsplitting(const SpatialPlane& plane)
      : below_(plane.below), above_(plane.above), below_count_(plane.below_count), above_count_(plane.above_count) {}

  Fate decide(const Reference& reference) {
    const Box3f wider_below = united(below_, reference.bounds()), wider_above = united(above_, reference.bounds());
    const double below_area = half_area(below_), above_area = half_area(above_);
    const double cut = below_area * below_count_ + above_area * above_count_;
    const double to_below = half_area(wider_below) * below_count_ + above_area * (above_count_ - 1);
    const double to_above = below_area * (below_count_ - 1) + half_area(wider_above) * above_count_;
    // No side may become empty.
    if (above_count_ > 1 && to_below <= cut && (to_below <= to_above || below_count_ == 1)) {
      below_ = wider_below;
      --above_count_;
      return Fate::below;
    }
    if (below_count_ > 1 && to_above <= cut) {
      above_ = wider_above;
      --below_count_;
      return Fate::above;
    }
    return Fate::cut;
  }

 private:
  Box3f below_, above_;
  double below_count_, above_count_;
};

/// The boxes of the parts of a reference; at least one is not empty.
ClippedBoxes cut_at(const Reference& reference, const SpatialPlane& plane, const Clipper& clipper) {
  ClippedBoxes parts = clipper(reference, plane.axis, plane.position);
  if (parts.below.is_empty() && parts.above.is_empty()) {  // only rounding can do that: cut the box
    parts = {reference.bounds(), reference.bounds()};
    parts.below.upper[plane.axis] = plane.position;
    parts.above.lower[plane.axis] = plane.position;
  }
  return parts;
}

struct Pieces {
  std::vector<Reference> below, above;
};

Pieces cut_all(std::span<const Reference> across, const SpatialPlane& plane, const Clipper& clipper) {
  std::vector<Fate> fates(across.size());
  std::vector<ClippedBoxes> parts(across.size());
  Unsplitting unsplitting(plane);
  for (size_t i = 0; i < across.size(); ++i) fates[i] = unsplitting.decide(across[i]);
  const auto cut_some = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (fates[i] == Fate::cut) parts[i] = cut_at(across[i], plane, clipper);
    }
  };
  if (across.size() <= kGrain) {  // most often: not worth asking for tasks
    cut_some(0, across.size());
  } else {
    parallel_for(across.size(), kGrain, cut_some);
  }
  Pieces pieces;
  for (size_t i = 0; i < across.size(); ++i) {
    if (fates[i] != Fate::cut) {
      (fates[i] == Fate::below ? pieces.below : pieces.above).push_back(across[i]);
      continue;
    }
    if (!parts[i].below.is_empty()) pieces.below.push_back(with_box(across[i], parts[i].below));
    if (!parts[i].above.is_empty()) pieces.above.push_back(with_box(across[i], parts[i].above));
  }
  return pieces;
}

}  // namespace

SpatialOrder::SpatialOrder(std::vector<Reference> references, size_t room)
    : ReferenceOrder(std::move(references)), whole_(ReferenceOrder::whole()) {
  whole_.spare = static_cast<uint32_t>(room - references_.size());
  const HeldBytes old(references_.capacity() * sizeof(Reference));  // while they are copied
  held_.set(room * sizeof(Reference));
  references_.resize(room);
}

Subset SpatialOrder::measured(uint32_t begin, uint32_t end) const { return detail::measured(references_, begin, end); }

Halves SpatialOrder::cut(const Subset& subset, const SpatialPlane& plane, const Clipper& clipper) {
  // First those below, then those above, last those across.
  const auto begin = references_.begin();
  uint32_t below_end = subset.begin, across_begin = subset.end;
  for (uint32_t i = subset.begin; i < across_begin;) {
    if (references_[i].upper[plane.axis] <= plane.position) {
      std::swap(references_[i++], references_[below_end++]);
    } else if (references_[i].lower[plane.axis] >= plane.position) {
      ++i;
    } else {
      std::swap(references_[i], references_[--across_begin]);
    }
  }
  const std::vector<Reference> across(begin + across_begin, begin + subset.end);
  const Pieces pieces = cut_all(across, plane, clipper);
  const auto below_more = static_cast<uint32_t>(pieces.below.size());
  const auto above_more = static_cast<uint32_t>(pieces.above.size());
  if (below_more > 0) std::copy_backward(begin + below_end, begin + across_begin, begin + across_begin + below_more);
  std::copy(pieces.below.begin(), pieces.below.end(), begin + below_end);
  std::copy(pieces.above.begin(), pieces.above.end(), begin + across_begin + below_more);
  const uint32_t middle = below_end + below_more, end = across_begin + below_more + above_more;
  Halves halves{measured(subset.begin, middle), measured(middle, end)};
  // Only rounding can leave a side empty; then nothing was cut in two.
  if (halves.left.count() == 0 || halves.right.count() == 0) return halve(measured(subset.begin, end));
  return halves;
}

double SpatialOrder::lengths(const Subset& subset) const {
  const std::span<const Reference> all = references(subset);
  const auto sum_of = [&](size_t begin, size_t end) {
    double sum = 0;
    for (const Reference& reference : all.subspan(begin, end - begin)) {
      sum += std::sqrt(Box4::of(reference).half_area());
    }
    return sum;
  };
  if (all.size() < 2 * kLengthsGrain) return sum_of(0, all.size());
  std::vector<double> sums((all.size() + kLengthsGrain - 1) / kLengthsGrain);
  parallel_for(all.size(), kLengthsGrain,
               [&](size_t begin, size_t end) { sums[begin / kLengthsGrain] = sum_of(begin, end); });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

void SpatialOrder::make_room(const Subset& subset, Halves& halves) {
  const uint32_t spare = subset.room() - halves.left.count() - halves.right.count();
  const uint32_t wanted = spare + subset.lost;
  if (wanted == 0) return;
  const double left = lengths(halves.left), right = lengths(halves.right);
  const double share = left + right > 0 ? left / (left + right) : 0.5;
  halves.left.spare = std::min(static_cast<uint32_t>(share * spare), spare);
  halves.right.spare = spare - halves.left.spare;
  const uint32_t left_wanted = std::clamp(static_cast<uint32_t>(share * wanted), halves.left.spare, wanted);
  halves.left.lost = std::min(left_wanted - halves.left.spare, subset.lost);
  halves.right.lost = subset.lost - halves.left.lost;
  const auto from = references_.begin();
  if (halves.left.spare > 0) {
    std::copy_backward(from + halves.right.begin, from + halves.right.end, from + halves.right.end + halves.left.spare);
  }
  halves.right.begin += halves.left.spare;
  halves.right.end += halves.left.spare;
}

}  // namespace kerf
