// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// Takes some rays at a time through a tree, each on its own way, a node each in turn: while one waits for a node to
/// come from memory or for a comparison, the processor works on the others. No branch of that depends on which children
/// a ray enters, since a wrong guess would throw the others' work away too. Where a ray comes to a leaf it stands aside
/// until several have; where it ends, the next one takes its place. Hits are those of single rays.
template <class Tree, bool kAny>
class RaysInFlight {
  static constexpr uint32_t kWidth = Tree::kWidth;
  using Tracer = WideTracer<typename Tree::Layout>;
  using Child = typename Tree::Child;
  using Boxes = typename Tree::template Boxes<true>;
  using Visits = LeafVisits<Tree, kAny, NoCounts>;

  static constexpr uint32_t kBottom = 2;

  /// A ray on its way, about 4 KB, of which few touch more than a few lines. What box tests need is read anew from the
  /// ray at each node: as registers filled they would be eight times as much to copy and to keep near.
  struct alignas(64) Flight {
    const WideRay* wide;
    float limit;
    uint32_t number;                                                    ///< of the ray
    uint64_t current;                                                   ///< key of where it is
    uint64_t* top;                                                      ///< of those that wait
    uint64_t waiting[kBottom + (kWidth - 1) * kMaxDepth + 2 * kWidth];  // a vector may be written beyond the top

    Flight(uint32_t ray_number, const StreamHit& hit, Child from)
        : wide(&hit.wide),
          limit(hit.nearest.hit.t),
          number(ray_number),
          current(ChildKey::of(from.word, hit.wide.t_min)),
          top(waiting + kBottom) {
      std::fill_n(waiting, kBottom, ChildKey::end<Child>());
    }
  };

 public:
  /// Enough that what a ray asks memory for has come when it is its turn.
  static constexpr uint32_t kMost = 16;

  struct Memory {
    alignas(64) std::byte flights[kMost * sizeof(Flight)];
  };

  RaysInFlight(const Tracer& tracer, StreamHit* hits, Memory& memory)
      : places_(tracer.layout), tracer_(tracer), hits_(hits), memory_(memory) {}

  /// Rays by their numbers, from an inner node on.
  void run(Child from, std::span<const uint32_t> numbers) {
    size_t next = 0;
    const auto start = [&](std::byte* place) {
      if (next == numbers.size()) return;
      const uint32_t number = numbers[next++];
      sort_in(new (place) Flight(number, hits_[number], from), from.is_leaf() ? 1 : 0);
    };
    for (uint32_t i = 0; i < kMost; ++i) start(memory_.flights + i * sizeof(Flight));
    while (inner_count_ + aside_count_ != 0) {
      const uint32_t count = std::exchange(inner_count_, 0);
      for (uint32_t i = 0; i < count; ++i) {
        Flight* const flight = inner_[i];
        sort_in(flight, step(*flight));
      }
      if (aside_count_ < inner_count_) continue;
      const uint32_t leaves = std::exchange(aside_count_, 0);
      for (uint32_t i = 0; i < leaves; ++i) {
        Flight* const flight = aside_[i];
        if (visit(*flight)) {
          sort_in(flight, places_.is_leaf(flight->current));
        } else {
          start(reinterpret_cast<std::byte*>(flight));
        }
      }
    }
  }

 private:
  /// Into one of the lists: `aside` is 0 or 1.
  HWY_INLINE void sort_in(Flight* flight, uint32_t aside) {
    inner_[inner_count_] = flight;
    aside_[aside_count_] = flight;
    inner_count_ += 1 - aside;
    aside_count_ += aside;
  }

  /// Through a node to where the ray goes next: the nearest child, or the nearer of the two on top. 1 if that is a
  /// leaf, the end or too far, else 0.
  HWY_INLINE uint32_t step(Flight& flight) {
    const float limit = flight.limit;
    uint64_t* const old = flight.top;
    // What may be next is read before the children are written: beside what was just written, reading takes its time.
    uint64_t waiting = old[-1];
    if constexpr (!kAny) {
      uint64_t other = old[-2];
      ChildKey::order(other, waiting);
      old[-1] = waiting;
      old[-2] = other;
    }
    uint64_t* top = old;
    const auto& node = tracer_.layout.nodes[child_of(flight.current).number()];
    const uint64_t taken = Boxes(*flight.wide).template take<kAny>(node, limit, top);
    const uint64_t none = taken == ChildKey::kNone ? 1 : 0;
    const uint64_t next = taken ^ ((taken ^ waiting) & (uint64_t{0} - none));
    flight.top = top - none;
    flight.current = next;
    places_.ask(next);
    return places_.is_leaf(next) | (kAny ? 0 : ChildKey::is_beyond(next, limit));
  }

  /// What the ray has come to, if it is not too far. Whether the ray goes on.
  HWY_INLINE bool visit(Flight& flight) {
    const Child child = child_of(flight.current);
    if (child.kind() == Child::kEnd) return false;
    if (ChildKey::entry(flight.current) <= flight.limit) {
      if (!child.is_leaf()) return true;  // a limit of minus zero is one that is_beyond() takes for less than zero
      StreamHit& hit = hits_[flight.number];
      NoCounts counts;
      if (Visits{tracer_, *hit.ray, hit.wide, hit.nearest, counts}.test(child)) return false;
      flight.limit = hit.nearest.hit.t;
    }
    do {
      flight.current = *--flight.top;
    } while (ChildKey::entry(flight.current) > flight.limit);
    places_.ask(flight.current);
    return true;
  }

  static HWY_INLINE Child child_of(uint64_t key) { return {ChildKey::word(key)}; }

  const ChildPlaces<Tree> places_;
  const Tracer& tracer_;
  StreamHit* const hits_;
  Memory& memory_;
  Flight *inner_[kMost + 1], *aside_[kMost + 1];  // at an inner node; at a leaf, the end or what may be too far
  uint32_t inner_count_ = 0, aside_count_ = 0;
};
