// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// What waits to be visited: where its box is entered above, the word of the child below. So nearer ones are smaller
/// numbers while entries are not negative; below that only the order suffers.
struct ChildKey {
  static constexpr uint64_t kNone = ~uint64_t{0};

  static HWY_INLINE uint64_t of(uint32_t word, float entry) {
    return uint64_t{std::bit_cast<uint32_t>(entry)} << 32 | word;
  }
  /// Where nothing waits any more: no limit is before it, and it is farther than all others.
  template <class Child>
  static HWY_INLINE uint64_t end() {
    return uint64_t{0xFFFFFFFF} << 32 | Child::kEnd;
  }
  static HWY_INLINE float entry(uint64_t key) { return std::bit_cast<float>(static_cast<uint32_t>(key >> 32)); }
  static HWY_INLINE uint32_t word(uint64_t key) { return static_cast<uint32_t>(key); }

  /// The greater one first. What is compared decides no branch: it would be mispredicted every other time.
  static HWY_INLINE void order(uint64_t& first, uint64_t& second) {
    const uint64_t change = (first ^ second) & (uint64_t{0} - uint64_t{first < second});
    first ^= change;
    second ^= change;
  }

  /// 1 or 0; of a comparison compilers make a branch. No limit is negative.
  static HWY_INLINE uint32_t is_beyond(uint64_t key, float limit) {
    const auto entry = static_cast<int64_t>(static_cast<int32_t>(key >> 32));
    return static_cast<uint32_t>(static_cast<uint64_t>(std::bit_cast<int32_t>(limit) - entry) >> 63);
  }
};

/// Where the nodes and leaves of a tree are in memory.
template <class Tree>
class ChildPlaces {
  using Child = typename Tree::Child;

 public:
  explicit ChildPlaces(const typename Tree::Layout& layout)
      : starts_{reinterpret_cast<const char*>(layout.nodes.data()),
                reinterpret_cast<const char*>(layout.leaves.data())} {}

  /// 1 for a leaf or the end, else 0; of a comparison compilers make a branch.
  static HWY_INLINE uint32_t is_leaf(uint64_t key) {
    constexpr uint32_t kKinds = (1U << Child::kKindBits) - 1;
    return ((ChildKey::word(key) & kKinds) + kKinds) >> Child::kKindBits;
  }

  /// Asks memory for as much of it as a node has.
  HWY_INLINE void ask(uint64_t key) const {
    const uint32_t leaf = is_leaf(key);
    const char* const from = starts_[leaf] + (size_t{Child{ChildKey::word(key)}.number()} << kShifts[leaf]);
    for (size_t line = 0; line < sizeof(typename Tree::Node); line += 64) __builtin_prefetch(from + line);
  }

 private:
  static constexpr uint32_t kShifts[2] = {std::countr_zero(sizeof(typename Tree::Node)),
                                          std::countr_zero(sizeof(LeafUnit))};
  const char* starts_[2];  // of nodes, of leaves
};

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3

/// The keys of eight or four children, of which those whose bits are set are entered.
template <uint32_t kWidth>
class VectorKeys {
  using D = hn::CappedTag<uint64_t, kWidth>;

 public:
  HWY_INLINE VectorKeys(const uint32_t* words, hn::Vec<hn::CappedTag<float, kWidth>> entries, uint32_t entered)
      : entered_(entered) {
    const hn::Rebind<uint32_t, D> d32;
    const auto above = hn::ShiftLeft<32>(hn::PromoteTo(D(), hn::BitCast(d32, entries)));
    keys_ = hn::Or(above, hn::PromoteTo(D(), hn::Load(d32, words)));
  }

  /// Of the nearest child; ChildKey::kNone if none is entered. The others' are put on top, in any order.
  HWY_INLINE uint64_t take_nearest(uint64_t*& top) const {
    const auto keys = hn::IfThenElse(mask(entered_), keys_, hn::Set(D(), ChildKey::kNone));
    const uint64_t nearest = hn::GetLane(hn::MinOfLanes(D(), keys));
    put(keys_, entered_ & ~bits_of(D(), hn::Eq(keys, hn::Set(D(), nearest))), top);
    return nearest;
  }

  /// Of the first child; ChildKey::kNone if none is entered. The others' are put on top, the second on top of all.
  HWY_INLINE uint64_t take_first(const uint32_t* words, uint64_t*& top) const {
    const uint32_t others = entered_ & (entered_ - 1);
    put(hn::Reverse(D(), keys_), kMirrored.bits[others] >> (8 - kWidth), top);
    const uint32_t first = words[std::countr_zero(entered_ | 1U << (kWidth - 1))];
    return first | (uint64_t{0} - uint64_t{entered_ == 0 ? 1U : 0U});
  }

 private:
  struct Mirrored {
    uint8_t bits[256];
    constexpr Mirrored() : bits() {
      for (uint32_t i = 0; i < 256; ++i) {
        for (uint32_t bit = 0; bit < 8; ++bit) bits[i] |= static_cast<uint8_t>((i >> bit & 1) << (7 - bit));
      }
    }
  };
  static constexpr Mirrored kMirrored{};

  static HWY_INLINE hn::Mask<D> mask(uint32_t bits) { return {static_cast<uint8_t>(bits)}; }

  static HWY_INLINE void put(hn::Vec<D> keys, uint32_t which, uint64_t*& top) {
    // Not Highway's Compress(): of 64-bit lanes it makes a look-up in a table.
    if constexpr (kWidth == 8) {
      _mm512_storeu_si512(top, _mm512_maskz_compress_epi64(static_cast<uint8_t>(which), keys.raw));
    } else {
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(top),
                          _mm256_maskz_compress_epi64(static_cast<uint8_t>(which), keys.raw));
    }
    top += std::popcount(which);
  }

  hn::Vec<D> keys_;
  uint32_t entered_;
};
#endif

/// The same, child by child.
HWY_INLINE uint64_t take_nearest(const uint32_t* words, const float* entries, uint32_t entered, uint64_t*& top) {
  if (entered == 0) return ChildKey::kNone;
  const auto first = static_cast<uint32_t>(std::countr_zero(entered));
  uint64_t nearest = ChildKey::of(words[first], entries[first]);
  for (entered &= entered - 1; entered != 0; entered &= entered - 1) {
    const auto i = static_cast<uint32_t>(std::countr_zero(entered));
    uint64_t key = ChildKey::of(words[i], entries[i]);
    ChildKey::order(key, nearest);
    *top++ = key;
  }
  return nearest;
}
HWY_INLINE uint64_t take_first(const uint32_t* words, const float* entries, uint32_t entered, uint64_t*& top) {
  if (entered == 0) return ChildKey::kNone;
  const auto first = static_cast<uint32_t>(std::countr_zero(entered));
  for (uint32_t left = entered & (entered - 1); left != 0;) {
    const auto i = static_cast<uint32_t>(std::bit_width(left) - 1);
    left ^= 1U << i;
    *top++ = ChildKey::of(words[i], entries[i]);
  }
  return ChildKey::of(words[first], entries[first]);
}
