#include <algorithm>
#include <bit>

#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/build/join_tree.h"
#include "kerf/build/morton_order.h"

namespace kerf {
namespace {

/// Cuts references along the curve where the highest bit in which their codes differ changes (Lauterbach et al. 2009).
/// The join of a cut has the number of the first reference behind it, less one, so that all can be made at once in one
/// array (the idea: Karras 2012).
class HighestBit {
 public:
  HighestBit(JoinTree& tree, std::span<const uint64_t> codes, const WorkLimit& limit)
      : tree_(tree), codes_(codes), limit_(limit) {}

  /// The part with the references [begin, end).
  uint32_t join(uint32_t begin, uint32_t end) {
    if (end - begin == 1) return begin;
    const uint32_t middle = cut(begin, end);
    Join& made = tree_.joins[middle - 1];
    made.references = end - begin;
    const auto join_left = [&] { made.left = join(begin, middle); };
    const auto join_right = [&] { made.right = join(middle, end); };
    if (made.references >= kParallelCount) {
      limit_.check();
      parallel_invoke(join_left, join_right);
    } else {
      join_left();
      join_right();
    }
    return tree_.part(middle - 1);
  }

 private:
  static constexpr uint32_t kParallelCount = 8192;  // fewer references are not worth a task

  /// Equal codes are halved, so that a hundred thousand of them take seventeen levels.
  uint32_t cut(uint32_t begin, uint32_t end) const {
    const uint64_t differing = codes_[begin] ^ codes_[end - 1];
    if (differing == 0) return begin + (end - begin) / 2;
    const uint64_t bit = std::bit_floor(differing);
    const auto first = codes_.begin() + begin;
    return begin + static_cast<uint32_t>(std::partition_point(first, codes_.begin() + end,
                                                              [bit](uint64_t code) { return (code & bit) == 0; }) -
                                         first);
  }

  JoinTree& tree_;
  std::span<const uint64_t> codes_;
  const WorkLimit& limit_;
};

}  // namespace

Bvh build_lbvh(BuildInput input, const OptionValues& options) {
  const TopDownOptions shared = TopDownOptions::from(options);
  const auto count = static_cast<uint32_t>(input.references.size());
  if (count == 0) return {};
  detail::check_depth(count, shared);
  input.limit.check(count * kJoinTreeBytes);  // codes and their sort took less before
  constexpr double kSteps = 3;
  input.limit.plan(kSteps);
  JoinTree tree;
  {
    MortonOrder order = morton_order(std::move(input.references), input.limit);
    input.limit.advance(1);
    tree.take(std::move(order.references));
    const HeldBytes codes(order.codes.size() * sizeof(uint64_t));
    tree.root = HighestBit(tree, order.codes, input.limit).join(0, count);
    input.limit.advance(1);
  }
  return make_bvh(std::move(tree), shared, input.limit);
}

}  // namespace kerf
