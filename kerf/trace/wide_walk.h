// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// A ray on its way through such a tree.
template <class Tree, bool kUsual, bool kAny, class Counts>
class Walk {
  static constexpr uint32_t kWidth = Tree::kWidth;
  using Tracer = WideTracer<typename Tree::Layout>;
  using Node = typename Tree::Node;
  using Child = typename Tree::Child;
  using Visits = LeafVisits<Tree, kAny, Counts>;

 public:
  Walk(const Tracer& tracer, const Ray& ray, const WideRay& wide, NearestHit& nearest, Counts& counts)
      : visits_{tracer, ray, wide, nearest, counts} {}

  void run(Child from) {
    constexpr uint32_t kMostWaiting = (kWidth - 1) * kMaxDepth;  // all children but one of each node above
    uint64_t waiting[1 + kMostWaiting + kWidth];
    waiting[0] = ChildKey::end<Child>();
    top_ = waiting + 1;
    uint64_t current = ChildKey::of(from.word, visits_.ray.t_min);
    while (true) {
      current = go(current);
      const Child leaf = child_of(current);
      if (leaf.kind() == Child::kEnd || visits_.finish(leaf, maybe_)) return;
      current = next(top_, visits_.nearest.hit.t);
    }
  }

 private:
  /// On to the end or to a leaf that is to be tested exactly. Calls nothing, so that what nodes and leaves need of the
  /// ray stays in registers.
  HWY_INLINE uint64_t go(uint64_t current) {
    const Node* const nodes = visits_.tracer.layout.nodes.data();
    const typename Tree::template Boxes<kUsual> boxes(visits_.wide);
    const ChildPlaces<Tree> places(visits_.tracer.layout);
    uint64_t* top = top_;
    float limit = visits_.nearest.hit.t;
    while (true) {
      while (!child_of(current).is_leaf()) {
        visits_.counts.count_nodes(1);
        visits_.counts.count_boxes(kWidth);
        const Node& node = nodes[child_of(current).number()];
        HWY_ALIGN float entry[kWidth];
        const uint32_t entered = boxes.enter(node, limit, entry);
        if (entered == 0) {
          current = next(top, limit);
        } else {
          current =
              kAny ? largest_of(node, entry, entered, places, top) : nearest_of(node, entry, entered, places, top);
        }
      }
      const Child leaf = child_of(current);
      if (leaf.kind() == Child::kEnd) return current;
      visits_.counts.count_nodes(1);
      const Look seen = visits_.template look<kUsual>(leaf, maybe_);
      if (kAny && seen == Look::kOver) return ChildKey::end<Child>();
      if (seen == Look::kUnsure) {
        if (leaf.kind() == Child::kSlots || visits_.nearest.leaf != 0) {
          top_ = top;
          return current;
        }
        if (Visits::test_settled(visits_.tracer, visits_.ray, visits_.wide, visits_.nearest,
                                 visits_.tracer.layout.triangles(leaf), maybe_))
          return ChildKey::end<Child>();
      }
      limit = visits_.nearest.hit.t;
      current = next(top, limit);
    }
  }

  static HWY_INLINE Child child_of(uint64_t key) { return {ChildKey::word(key)}; }

  /// The one on top that is not beyond the limit. The one at the bottom is not.
  static HWY_INLINE uint64_t next(uint64_t*& top, float limit) {
    do {
      --top;
    } while (ChildKey::entry(*top) > limit);
    return *top;
  }

  /// Puts all children that are entered on top but the one to go on with, which it returns: the nearest, and below it
  /// the others in order. What is compared decides no branch: it would be mispredicted every other time. Memory is
  /// asked for those that wait.
  static HWY_INLINE uint64_t nearest_of(const Node& node, const float* entry, uint32_t entered,
                                        const ChildPlaces<Tree>& places, uint64_t*& top) {
    const auto first = static_cast<uint32_t>(std::countr_zero(entered));
    if ((entered & (entered - 1)) == 0) return node.child[first].word;  // nobody asks where
    uint64_t a = take(node, entry, entered);
    uint64_t b = take(node, entry, entered);
    ChildKey::order(b, a);
    places.ask(b);
    if (entered == 0) {
      *top++ = b;
      return a;
    }
    uint64_t c = take(node, entry, entered);
    places.ask(c);
    if (entered == 0) {
      ChildKey::order(c, a);
      ChildKey::order(c, b);
      *top++ = c;
      *top++ = b;
      return a;
    }
    uint64_t d = take(node, entry, entered);
    places.ask(d);
    ChildKey::order(d, c);
    ChildKey::order(d, b);
    ChildKey::order(c, a);
    ChildKey::order(c, b);
    uint64_t* const base = top;
    *top++ = d;
    *top++ = c;
    *top++ = b;
    if (entered == 0) return a;
    *top++ = a;
    do {
      *top++ = take(node, entry, entered);
    } while (entered != 0);
    sort(base, top);
    return *--top;
  }

  /// The same where any hit is enough: the largest, which stands first, then the second and so on.
  static HWY_INLINE uint64_t largest_of(const Node& node, const float* entry, uint32_t entered,
                                        const ChildPlaces<Tree>& places, uint64_t*& top) {
    const uint64_t first = node.child[std::countr_zero(entered)].word;
    entered &= entered - 1;
    if (entered == 0) return first;
    const uint64_t second = take(node, entry, entered);
    places.ask(second);
    if (entered != 0) {
      const auto others = static_cast<uint32_t>(std::popcount(entered));
      top[0] = take_last(node, entry, entered);
      top[1] = take_last(node, entry, entered |= 1);  // some child if there is no other; it is not kept
      for (uint32_t i = 2; i < others; ++i) top[i] = take_last(node, entry, entered);
      top += others;
    }
    *top++ = second;
    return first;
  }

  static HWY_INLINE uint64_t take(const Node& node, const float* entry, uint32_t& entered) {
    const auto i = static_cast<uint32_t>(std::countr_zero(entered));
    entered &= entered - 1;
    return ChildKey::of(node.child[i].word, entry[i]);
  }

  static HWY_INLINE uint64_t take_last(const Node& node, const float* entry, uint32_t& entered) {
    const auto i = static_cast<uint32_t>(std::bit_width(entered) - 1);
    entered ^= 1U << i;
    return ChildKey::of(node.child[i].word, entry[i]);
  }

  /// The nearest last.
  static HWY_INLINE void sort(uint64_t* begin, uint64_t* end) {
    for (uint64_t* i = begin + 1; i < end; ++i) {
      const uint64_t moved = *i;
      uint64_t* j = i;
      for (; j > begin && j[-1] < moved; --j) *j = j[-1];
      *j = moved;
    }
  }

  Visits visits_;
  uint64_t* top_ = nullptr;  // of what waits
  uint32_t maybe_ = 0;       // the triangles of a leaf to be tested exactly
};
