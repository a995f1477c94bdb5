#include "kerf/build/uniform_grid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 2048;
constexpr size_t kSample = 4096;  // references that a first guess looks at
constexpr size_t kTellEvery = 256;
constexpr double kMostCells = 1 << 28;

/// A reference in a cell.
struct Entry {
  uint32_t cell, reference;
};

class Filling {
 public:
  Filling(const UniformGrid& grid, const Clipper& clipper, bool clipped, const WorkLimit& limit)
      : grid_(grid), clipper_(clipper), clipped_(clipped), limit_(limit) {}

  /// The cells of every `stride`-th reference, by blocks of references, or nothing if they are more than `most`.
  std::vector<std::vector<Entry>> entries(std::span<const Reference> references, size_t stride, double most) const {
    const size_t count = (references.size() + stride - 1) / stride;
    std::vector<std::vector<Entry>> blocks((count + kGrain - 1) / kGrain);
    std::atomic<size_t> total = 0;
    const ProgressPart part(limit_, 0.5);  // for another try may follow
    limit_.plan(static_cast<double>(count));
    parallel_for(count, kGrain, [&](size_t begin, size_t end) {
      std::vector<Entry>& out = blocks[begin / kGrain];
      size_t told = 0;  // entries of `out` that `total` knows of
      for (size_t i = begin; i < end && static_cast<double>(total.load(std::memory_order_relaxed)) <= most; ++i) {
        add_cells(references[i * stride], [&](size_t cell) {
          out.push_back({static_cast<uint32_t>(cell), static_cast<uint32_t>(i * stride)});
          // Told to the others now and then, or each thread might make as many as all together may.
          if (out.size() - told < kTellEvery) return true;
          total += out.size() - std::exchange(told, out.size());
          limit_.check(total * (sizeof(Entry) + sizeof(LeafSlot)));
          return static_cast<double>(total.load(std::memory_order_relaxed)) <= most;
        });
      }
      total += out.size() - told;
      out.shrink_to_fit();
      limit_.check(total * (sizeof(Entry) + sizeof(LeafSlot)));
      limit_.advance(static_cast<double>(end - begin));
    });
    const HeldBytes held(total * sizeof(Entry));
    if (static_cast<double>(total) > most) blocks.clear();
    return blocks;
  }

 private:
  template <class Emit>
  void add_cells(Reference reference, Emit&& emit) const {
    const auto cut = [&](const Box3f& box, uint32_t axis, float position) -> CutBoxes {
      if (!clipped_) return halves(box, axis, position);
      reference.lower = box.lower;
      reference.upper = box.upper;
      const ClippedBoxes boxes = clipper_(reference, axis, position);
      return {boxes.below, boxes.above};
    };
    for_each_cell(grid_, reference.bounds(), cut, emit);
  }

  const UniformGrid& grid_;
  const Clipper& clipper_;
  const bool clipped_;
  const WorkLimit& limit_;
};

/// Sorts the entries by cell, within a cell by reference.
void fill(UniformGrid& grid, std::span<const Reference> references, const std::vector<std::vector<Entry>>& blocks) {
  size_t total = 0;
  for (const std::vector<Entry>& block : blocks) total += block.size();
  const size_t cells = size_t{grid.resolution(kX)} * grid.resolution(kY) * grid.resolution(kZ) + 1;
  const HeldBytes held(total * (sizeof(Entry) + sizeof(LeafSlot)) + cells * sizeof(uint32_t));
  grid.offsets.assign(cells, 0);
  for (const std::vector<Entry>& block : blocks) {
    check_current_limit();
    for (const Entry& entry : block) ++grid.offsets[entry.cell + 1];
  }
  uint32_t sum = 0;
  for (size_t cell = 1; cell < grid.offsets.size(); ++cell) {  // the first place of each cell, one further on
    const uint32_t count = grid.offsets[cell];
    grid.offsets[cell] = sum;
    sum += count;
  }
  grid.slots.resize(sum);
  for (const std::vector<Entry>& block : blocks) {
    check_current_limit();
    for (const Entry& entry : block) {
      const Reference& reference = references[entry.reference];
      grid.slots[grid.offsets[entry.cell + 1]++] = {reference.geometry, reference.primitive};
    }
  }
}

}  // namespace

UniformGrid build_uniform_grid(std::span<const Reference> references, const Clipper& clipper,
                               const UniformGridOptions& options, const WorkLimit& limit) {
  UniformGrid grid;
  if (references.empty()) return grid;
  Box3f bounds;
  for (const Reference& reference : references) bounds.extend(reference.bounds());
  const auto count = static_cast<double>(references.size());
  const double most = std::min(static_cast<double>(kMaxReferences), options.cap * count);
  double cells = std::min(options.density * count, kMostCells);
  // A sample rules out what is far too fine at little cost; at one cell for all every cap holds.
  for (size_t stride = std::max<size_t>(1, references.size() / kSample);;) {
    limit.check(static_cast<size_t>(cells) * sizeof(uint32_t));
    divide(grid, bounds, cells);
    const double allowed = stride == 1 ? most : options.cap * std::ceil(count / static_cast<double>(stride));
    const Filling filling(grid, clipper, options.clipped, limit);
    const std::vector<std::vector<Entry>> blocks = filling.entries(references, stride, allowed);
    if (blocks.empty()) {
      cells /= 2;
    } else if (stride > 1) {
      stride = 1;
    } else {
      fill(grid, references, blocks);
      return grid;
    }
  }
}

}  // namespace kerf
