#include <utility>

#include "kerf/base/parallel.h"
#include "kerf/build/builders.h"
#include "kerf/build/clusters.h"
#include "kerf/build/join_tree.h"
#include "kerf/build/morton_order.h"

namespace kerf {
namespace {

/// Joins clusters that are each other's nearest, all such pairs at once, until one is left (Meister and Bittner 2018).
/// A joined one takes the place of the lower of the two, so that clusters stay near the curve.
class Joining {
 public:
  Joining(JoinTree& tree, uint32_t radius, const WorkLimit& limit)
      : tree_(tree), radius_(radius), limit_(limit), clusters_(tree.references) {
    next_.resize(clusters_.size());
    held_.set(clusters_.size() * (2 * Clusters::kBytes + sizeof(uint32_t)));
  }

  void join_all() {
    limit_.plan(static_cast<double>(clusters_.size()));
    while (clusters_.size() > 1) {
      const size_t before = clusters_.size();
      clusters_.find_partners(radius_, partners_);
      if (count_pairs() < clusters_.size() / kFewest) pair_in_order();
      join_pairs();
      limit_.advance(static_cast<double>(before - clusters_.size()));
    }
    tree_.root = clusters_.number(0);
  }

 private:
  static constexpr size_t kGrain = 4096;
  static constexpr size_t kFewest = 32;  // of how many clusters one pair is enough; scenes measured have five to nine

  /// Of one stretch of clusters: how many pairs have their lower one in it, and how many clusters are left of it.
  struct Block {
    uint32_t pairs = 0, left = 0;
  };

  bool is_paired(size_t i) const { return partners_[i] != i && partners_[partners_[i]] == i; }

  size_t count_pairs() {
    blocks_.assign((clusters_.size() + kGrain - 1) / kGrain, {});
    parallel_for(clusters_.size(), kGrain, [&](size_t begin, size_t end) {
      Block& block = blocks_[begin / kGrain];
      for (size_t i = begin; i < end; ++i) {
        const bool paired = is_paired(i);
        block.pairs += paired && i < partners_[i] ? 1 : 0;
        block.left += paired && i > partners_[i] ? 0 : 1;
      }
    });
    size_t pairs = 0;
    for (const Block& block : blocks_) pairs += block.pairs;
    return pairs;
  }

  /// Where boxes grow along the curve each cluster's nearest is the one before it, and only the first two are each
  /// other's: as many rounds as clusters. So where pairs are few, each cluster in order gets its nearest if neither has
  /// another yet and both stand in one block.
  void pair_in_order() {
    parallel_for(clusters_.size(), kGrain, [&](size_t begin, size_t end) {
      std::vector<bool> taken(end - begin);
      for (size_t i = begin; i < end; ++i) {
        if (taken[i - begin]) continue;
        const size_t other = partners_[i];
        const bool free = other != i && other >= begin && other < end && !taken[other - begin];
        partners_[i] = static_cast<uint32_t>(free ? other : i);
        if (!free) continue;
        partners_[other] = static_cast<uint32_t>(i);
        taken[i - begin] = taken[other - begin] = true;
      }
    });
    count_pairs();
  }

  void join_pairs() {
    Block sum;
    for (Block& block : blocks_) {
      const Block own = std::exchange(block, sum);
      sum = {sum.pairs + own.pairs, sum.left + own.left};
    }
    parallel_for(clusters_.size(), kGrain, [&](size_t begin, size_t end) {
      Block place = blocks_[begin / kGrain];
      for (size_t i = begin; i < end; ++i) {
        const uint32_t other = partners_[i];
        if (!is_paired(i)) {
          next_.set(place.left++, clusters_, i);
        } else if (i < other) {
          const size_t number = joined_ + place.pairs++;
          const uint32_t left = clusters_.number(i), right = clusters_.number(other);
          tree_.joins[number] = {left, right, tree_.reference_count(left) + tree_.reference_count(right), 0};
          next_.set_joined(place.left++, clusters_, i, other, tree_.part(number));
        }
      }
    });
    joined_ += sum.pairs;
    std::swap(clusters_, next_);
    clusters_.resize(sum.left);
  }

  JoinTree& tree_;
  uint32_t radius_;
  const WorkLimit& limit_;
  Clusters clusters_, next_;
  HeldBytes held_;
  std::vector<uint32_t> partners_;
  std::vector<Block> blocks_;
  size_t joined_ = 0;  ///< joins made
};

}  // namespace

Bvh build_ploc(BuildInput input, const OptionValues& options) {
  const TopDownOptions shared = TopDownOptions::from(options);
  const size_t count = input.references.size();
  if (count == 0) return {};
  detail::check_depth(count, shared);
  input.limit.check(count * kJoinTreeBytes);  // clusters took less before
  JoinTree tree;
  {
    const ProgressPart part(input.limit, 0.2);
    tree.take(morton_order(std::move(input.references), input.limit).references);
  }
  const ProgressPart part(input.limit, 0.9);
  Joining(tree, static_cast<uint32_t>(options["radius"]), input.limit).join_all();
  return make_bvh(std::move(tree), shared, input.limit);
}

}  // namespace kerf
