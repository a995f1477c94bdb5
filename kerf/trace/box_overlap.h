// No include guard on purpose: a part of trace_wide.cpp, which includes it once for each instruction set, in
// HWY_NAMESPACE.

/// The near ends of a vector of boxes along each axis and of the ray, and the far ones.
template <class V>
struct Ends {
  V x, y, z, ray;
};

/// Which boxes the ray enters, as bits, and where. Of a usual ray all ends are numbers, its own are not negative, and
/// no far one is minus zero: then the order of their bits as integers is theirs as far as it matters, and processors
/// compare integers in a cycle where floats take two to four. That is on the way from each node to the next.
template <bool kUsual, class D, class V>
HWY_INLINE uint32_t overlap(D d, const Ends<V>& nears, const Ends<V>& fars, V& near) {
  if constexpr (kUsual) {
    const hn::RebindToSigned<D> di;
    const auto bits = [&](V v) { return hn::BitCast(di, v); };
    const auto last = hn::Max(hn::Max(bits(nears.x), bits(nears.y)), hn::Max(bits(nears.z), bits(nears.ray)));
    const auto first = hn::Min(hn::Min(bits(fars.x), bits(fars.y)), hn::Min(bits(fars.z), bits(fars.ray)));
    near = hn::BitCast(d, last);
    constexpr uint32_t kAll = (1U << hn::MaxLanes(D())) - 1;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
    // Not into a mask register, which takes longer.
    if constexpr (hn::MaxLanes(D()) == 8) {
      const __m256i missed = _mm256_cmpgt_epi32(last.raw, first.raw);
      return static_cast<uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(missed))) ^ kAll;
    } else {
      const __m128i missed = _mm_cmpgt_epi32(last.raw, first.raw);
      return static_cast<uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(missed))) ^ kAll;
    }
#else
    return bits_of(di, hn::Gt(last, first)) ^ kAll;
#endif
  } else {
    near = hn::Max(hn::Max(nears.x, nears.y), hn::Max(nears.z, nears.ray));
    return bits_of(d, hn::Le(near, hn::Min(hn::Min(fars.x, fars.y), hn::Min(fars.z, fars.ray))));
  }
}
