// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE, after Walk.

/// Takes many rays through a wide tree together: each node and leaf is looked at once for all rays that enter it, which
/// are listed by number (the idea: Barringer, Akenine-Moeller, Dynamic Ray Stream Traversal, 2014). A list goes on to
/// the node's children, the one first that its rays enter earliest on average. No branch depends on a single ray, nodes
/// and leaves are asked for before they are needed, and the tree does the sorting: rays need none beforehand but by
/// the signs of their directions. Where a list has become short, its rays go on as RaysInFlight. Hits are those of
/// single rays.
template <class Tree, bool kAny>
class Stream {
  static constexpr uint32_t kWidth = Tree::kWidth;
  using Tracer = WideTracer<typename Tree::Layout>;
  using Node = typename Tree::Node;
  using Child = typename Tree::Child;
  using Sides = typename Tree::Sides;
  using Visits = LeafVisits<Tree, kAny, NoCounts>;
  using Flights = RaysInFlight<Tree, kAny>;

 public:
  Stream(const Tracer& tracer, StreamMemory& memory, typename Flights::Memory& flights)
      : tracer_(tracer),
        rays_(memory.rays()),
        hits_(memory.hits()),
        lists_(memory.lists()),
        entries_(memory.entries()),
        entered_(memory.entered()),
        flights_(tracer, memory.hits(), flights) {}

  /// The first `count` lists() are the rays; the directions of all have the same signs.
  void run(uint32_t count) {
    Task waiting[(kWidth - 1) * kMaxDepth + kWidth];  // all children but one of each node above
    Task* top = waiting;
    *top++ = {tracer_.layout.root, 0, count, count, 0};
    const uint32_t octant = hits_[lists_[0]].wide.octant;
    while (top != waiting) {
      const Task task = *--top;
      if (task.child.kind() == Child::kSlots || (!task.child.is_leaf() && !pays(task))) {
        go_alone(task);
      } else if (task.child.is_leaf()) {
        test_leaf(task);
      } else {
        const Node& node = tracer_.layout.nodes[task.child.number()];
        HWY_ALIGN float sums[kWidth];
        const uint32_t entered = enter(node, octant, task, sums);
        top = divide(node, entered, sums, task, top);
      }
    }
  }

 private:
  using Box = hn::CappedTag<float, kWidth>;
  using Numbers = hn::CappedTag<uint32_t, 16>;
  using Floats = hn::Rebind<float, Numbers>;

  /// A child and the rays that enter its box.
  struct Task {
    Child child;
    uint32_t first, count;  ///< in lists_; of a leaf their entries follow
    uint32_t free;          ///< where lists_ that wait end
    float order;            ///< the mean of their entries
  };

  /// Whether a list is long enough, and there is room for what comes of it.
  static bool pays(const Task& task) {
    return task.count >= kFewest &&
           task.free + 2 * kWidth * task.count + StreamMemory::kPadding <= StreamMemory::kListed;
  }

  /// Box tests of all rays; which children any of them enters, and the sums of their entries.
  HWY_INLINE uint32_t enter(const Node& node, uint32_t octant, const Task& task, float* sums) {
    const Box d;
    uint32_t all = 0;
    for (uint32_t part = 0; part < kWidth; part += hn::MaxLanes(d)) {
      const uint32_t side_x = octant & 1, side_y = octant >> 1 & 1, side_z = octant >> 2 & 1;
      const auto x0 = Sides::template load<0>(d, node, side_x, part);
      const auto x1 = Sides::template load<0>(d, node, side_x ^ 1, part);
      const auto y0 = Sides::template load<1>(d, node, side_y, part);
      const auto y1 = Sides::template load<1>(d, node, side_y ^ 1, part);
      const auto z0 = Sides::template load<2>(d, node, side_z, part);
      const auto z1 = Sides::template load<2>(d, node, side_z ^ 1, part);
      auto sum = hn::Zero(d);
      for (uint32_t i = 0; i < task.count; ++i) {
        const StreamRay& ray = rays_[lists_[task.first + i]];
        const Float4 &inverse = ray.inverse, &shift0 = ray.near_offset, &shift1 = ray.far_offset;
        const auto inverse_x = hn::Set(d, inverse[0]), inverse_y = hn::Set(d, inverse[1]);
        const auto inverse_z = hn::Set(d, inverse[2]);
        const auto near_xy =
            hn::Max(hn::MulAdd(x0, inverse_x, hn::Set(d, shift0[0])), hn::MulAdd(y0, inverse_y, hn::Set(d, shift0[1])));
        const auto far_xy =
            hn::Min(hn::MulAdd(x1, inverse_x, hn::Set(d, shift1[0])), hn::MulAdd(y1, inverse_y, hn::Set(d, shift1[1])));
        const auto near_z = hn::Max(hn::MulAdd(z0, inverse_z, hn::Set(d, shift0[2])), hn::Set(d, ray.t_min));
        const auto far_z = hn::Min(hn::MulAdd(z1, inverse_z, hn::Set(d, shift1[2])), hn::Set(d, ray.limit));
        const auto near = hn::Max(near_xy, near_z);
        const auto is_entered = hn::Le(near, hn::Min(far_xy, far_z));
        hn::Store(near, d, entries_ + size_t{i} * kWidth + part);
        sum = hn::Add(sum, hn::IfThenElseZero(is_entered, near));
        const uint32_t bits = bits_of(d, is_entered) << part;
        entered_[i] = static_cast<uint8_t>(part == 0 ? bits : entered_[i] | bits);
        all |= bits;
      }
      hn::Store(sum, d, sums + part);
    }
    return all & Sides::places(node);
  }

  /// Lists each child's rays and puts the children upon the stack, the earliest entered on top, for any hit the
  /// largest.
  HWY_INLINE Task* divide(const Node& node, uint32_t entered, const float* sums, const Task& task, Task* top) {
    Task* const base = top;
    uint32_t end = task.free;
    for (; entered != 0; entered &= entered - 1) {
      const auto i = static_cast<uint32_t>(std::countr_zero(entered));
      const Child child = node.child[i];
      prefetch(child);
      Task made{child, end, 0, 0, 0};
      made.count = list(task, i, lists_ + end);
      end += made.count;
      if (child.is_leaf()) end += list_entries(task, i, lists_ + end);
      made.order = sums[i] / static_cast<float>(made.count);
      Task* place = top++;
      if constexpr (!kAny) {
        for (; place > base && place[-1].order < made.order; --place) *place = place[-1];
      }
      *place = made;
    }
    if constexpr (kAny) std::reverse(base, top);  // larger children stand first, and are more likely to be hit
    for (Task* made = base; made < top; ++made) made->free = end;
    return top;
  }

  /// The rays of `task`, 16 or fewer from number `first` on, that enter child `i`.
  HWY_INLINE hn::Mask<Numbers> entering(const Task& task, uint32_t i, uint32_t first) const {
    const Numbers d;
    const hn::Rebind<uint8_t, Numbers> bytes;
    const auto bits = hn::PromoteTo(d, hn::LoadU(bytes, entered_ + first));
    return hn::And(hn::TestBit(bits, hn::Set(d, 1U << i)), hn::FirstN(d, task.count - first));
  }

  /// Those whose mask is set, and how many; what follows them is of no meaning. Not CompressStore(): writing through a
  /// mask takes some processors a hundred cycles.
  static HWY_INLINE size_t put(hn::Vec<Numbers> values, hn::Mask<Numbers> which, uint32_t* to) {
    hn::StoreU(hn::Compress(values, which), Numbers(), to);
    return hn::CountTrue(Numbers(), which);
  }

  HWY_INLINE uint32_t list(const Task& task, uint32_t i, uint32_t* to) const {
    const Numbers d;
    const uint32_t* const begin = to;
    for (uint32_t first = 0; first < task.count; first += hn::MaxLanes(d)) {
      to += put(hn::LoadU(d, lists_ + task.first + first), entering(task, i, first), to);
    }
    return static_cast<uint32_t>(to - begin);
  }

  /// Of the same rays as list().
  HWY_INLINE uint32_t list_entries(const Task& task, uint32_t i, uint32_t* to) const {
    const Numbers d;
    const hn::RebindToSigned<Numbers> places;
    const uint32_t* const begin = to;
    const auto steps = hn::Mul(hn::Iota(places, 0), hn::Set(places, int32_t{kWidth}));
    for (uint32_t first = 0; first < task.count; first += hn::MaxLanes(d)) {
      const auto entries = hn::GatherIndex(Floats(), entries_ + size_t{first} * kWidth + i, steps);
      to += put(hn::BitCast(d, entries), entering(task, i, first), to);
    }
    return static_cast<uint32_t>(to - begin);
  }

  void prefetch(Child child) const {
    const void* at = child.is_leaf() ? static_cast<const void*>(tracer_.layout.leaves[child.number()].floats())
                                     : &tracer_.layout.nodes[child.number()];
    for (uint32_t line = 0; line < kLines; ++line) __builtin_prefetch(static_cast<const char*>(at) + size_t{64} * line);
  }

  /// First all filters, then what they let pass: so it is known early which rays that is.
  HWY_NOINLINE void test_leaf(const Task& task) {
    const typename Tree::Leaf triangles = tracer_.layout.triangles(task.child);
    uint32_t* const numbers = lists_ + task.first;
    const uint32_t* const entries = numbers + task.count;
    uint32_t passed = 0;
    for (uint32_t i = 0; i < task.count; ++i) {
      const uint32_t number = numbers[i];
      numbers[passed] = number;
      passed += std::bit_cast<float>(entries[i]) <= rays_[number].limit ? 1 : 0;
    }
    uint32_t candidates = 0;
    for (uint32_t i = 0; i < passed; ++i) {
      const uint32_t number = numbers[i];
      const uint32_t found = typename Tree::Leaves{hits_[number].wide}.may_hit(triangles);
      numbers[candidates] = number;
      entered_[candidates] = static_cast<uint8_t>(found);
      candidates += found != 0 ? 1 : 0;
    }
    for (uint32_t i = 0; i < candidates; ++i) {
      StreamHit& hit = hits_[numbers[i]];
      const bool is_over = Visits::test_triangles(tracer_, *hit.ray, hit.wide, hit.nearest, triangles, entered_[i]);
      rays_[numbers[i]].limit = is_over ? -kInfinity : hit.nearest.hit.t;
    }
  }

  /// Each ray by itself.
  HWY_NOINLINE void go_alone(const Task& task) {
    uint32_t* const numbers = lists_ + task.first;
    const auto is_over = [&](uint32_t number) { return kAny && hits_[number].nearest.hit; };
    uint32_t* const end = kAny ? std::remove_if(numbers, numbers + task.count, is_over) : numbers + task.count;
    flights_.run(task.child, {numbers, end});
    for (const uint32_t* i = numbers; i < end; ++i) {
      rays_[*i].limit = is_over(*i) ? -kInfinity : hits_[*i].nearest.hit.t;
    }
  }

  /// Narrower vectors compress by tables, which takes longer than lists save.
  static constexpr uint32_t kFewest = hn::MaxLanes(Numbers()) == 16 ? 64 : ~0U;
  static constexpr uint32_t kLines = 4;  // of a node, and what most leaves have at most
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  const Tracer& tracer_;
  StreamRay* const rays_;
  StreamHit* const hits_;
  uint32_t* const lists_;
  float* const entries_;    // of each ray of the list at hand into each child
  uint8_t* const entered_;  // which children that is, as bits
  Flights flights_;
};

/// What a batch asks of a hit: the hit, or whether there is one.
template <class Result>
Result result_of(const Hit& hit) {
  if constexpr (std::is_same_v<Result, Hit>) {
    return finished(hit);
  } else {
    return static_cast<Result>(hit ? 1 : 0);
  }
}

/// As many rays as memory holds at most. `single` traces one that streams cannot take.
template <class Tree, class Result, class Single>
void trace_some(const WideTracer<typename Tree::Layout>& tracer, std::span<const Ray> rays, std::span<Result> results,
                StreamMemory& memory, typename RaysInFlight<Tree, !std::is_same_v<Result, Hit>>::Memory& flights,
                const Single& single) {
  constexpr uint8_t kOctants = 8, kOut = kOctants;
  uint32_t counts[kOctants + 1] = {};
  for (size_t i = 0; i < rays.size(); ++i) {
    const WideRay& ray = memory.make_ray(i, rays[i], tracer.largest_coordinate);
    uint8_t octant = kOut;
    if (ray.valid && !ray.is_usual) {
      results[i] = result_of<Result>(single(rays[i]));
    } else if (ray.valid && ray.enters(tracer.layout.bounds)) {
      octant = static_cast<uint8_t>(ray.octant);
    } else {
      results[i] = Result{};
    }
    memory.octants()[i] = octant;
    ++counts[octant];
  }
  uint32_t places[kOctants + 1] = {};
  for (uint32_t octant = 0; octant < kOctants; ++octant) places[octant + 1] = places[octant] + counts[octant];
  for (size_t i = 0; i < rays.size(); ++i) {
    memory.numbers()[places[memory.octants()[i]]++] = static_cast<uint32_t>(i);
  }
  for (uint32_t octant = 0; octant < kOctants; ++octant) {
    if (counts[octant] == 0) continue;
    const uint32_t* const end = memory.numbers() + places[octant];
    std::copy(end - counts[octant], end, memory.lists());
    Stream<Tree, !std::is_same_v<Result, Hit>>(tracer, memory, flights).run(counts[octant]);
  }
  for (size_t i = 0; i < rays.size(); ++i) {
    if (memory.octants()[i] == kOut) continue;
    StreamHit& hit = memory.hits()[i];
    if constexpr (std::is_same_v<Result, Hit>) {
      LeafVisits<Tree, false, NoCounts>::resolve(tracer, rays[i], hit.wide, hit.nearest);
    }
    results[i] = result_of<Result>(hit.nearest.hit);
  }
}

/// False, and nothing is done, where single rays are as good.
template <class Tree, class Result, class Single>
bool trace_streams(const WideTracer<typename Tree::Layout>& tracer, std::span<const Ray> rays,
                   std::span<Result> results, const Single& single) {
  constexpr size_t kFewest = 16;
  if (rays.size() < kFewest || tracer.layout.root.is_leaf() || tracer.layout.is_empty()) return false;
  using Flights = typename RaysInFlight<Tree, !std::is_same_v<Result, Hit>>::Memory;
  StreamMemory memory;
  const std::unique_ptr<Flights> flights(new (std::nothrow) Flights);
  if (!memory.is_there() || flights == nullptr) return false;
  const StandardFloat standard;
  constexpr size_t kMost = StreamMemory::kMostRays;
  for (size_t begin = 0; begin < rays.size(); begin += kMost) {
    const size_t count = std::min(kMost, rays.size() - begin);
    trace_some<Tree>(tracer, rays.subspan(begin, count), results.subspan(begin, count), memory, *flights, single);
  }
  return true;
}
