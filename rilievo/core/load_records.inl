// Fields of records, one record a lane: load_two() and load_four() give what hn::GatherIndex()
// gives of two and four fields that lie together, from the given index of each lane on. Included
// once for each instruction set, within HWY_NAMESPACE.
//
// The fields of a lane are loaded at once, and transposed. Processors load gathered lanes one by
// one, and those of AMD take about ten times as long for it as for a load.

#if HWY_HAVE_SCALABLE || HWY_TARGET == HWY_SCALAR

template <class D, class I>
HWY_INLINE void load_two(D d, const hn::TFromD<D>* from, I, hn::Vec<I> index,
                         hn::Vec<D> (&out)[2]) {
  for (int k = 0; k < 2; ++k) out[k] = hn::GatherIndex(d, from + k, index);
}
template <class D, class I>
HWY_INLINE void load_four(D d, const hn::TFromD<D>* from, I, hn::Vec<I> index,
                          hn::Vec<D> (&out)[4]) {
  for (int k = 0; k < 4; ++k) out[k] = hn::GatherIndex(d, from + k, index);
}

#else

// The four fields at `index`, and in the next block of lanes those at the fourth index after it.
template <class D>
HWY_INLINE hn::Vec<D> load_every_fourth_record(D d, const hn::TFromD<D>* from,
                                               const std::int32_t* index) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, from + *index);
  } else {
    const hn::Half<D> half;
    const auto lower = load_every_fourth_record(half, from, index);
    return hn::Combine(d, load_every_fourth_record(half, from, index + hn::MaxLanes(half)), lower);
  }
}

// The two fields at `index` and those at the second index after it; as above.
template <class D>
HWY_INLINE hn::Vec<D> load_every_second_pair(D d, const hn::TFromD<D>* from,
                                             const std::int32_t* index) {
  const hn::Half<D> half;
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::Combine(d, hn::LoadU(half, from + index[2]), hn::LoadU(half, from + index[0]));
  } else {
    const auto lower = load_every_second_pair(half, from, index);
    return hn::Combine(d, load_every_second_pair(half, from, index + hn::MaxLanes(half)), lower);
  }
}

template <class D, class I>
HWY_INLINE void load_two(D d, const hn::TFromD<D>* from, I i32, hn::Vec<I> index,
                         hn::Vec<D> (&out)[2]) {
  HWY_ALIGN std::int32_t at[hn::MaxLanes(I())];
  hn::Store(index, i32, at);
  const auto even = load_every_second_pair(d, from, at);     // records 0 and 2
  const auto odd = load_every_second_pair(d, from, at + 1);  // 1 and 3
  const auto first = hn::InterleaveLower(d, even, odd), second = hn::InterleaveUpper(d, even, odd);
  const hn::Repartition<double, D> pairs;
  out[0] = hn::BitCast(
      d, hn::InterleaveLower(pairs, hn::BitCast(pairs, first), hn::BitCast(pairs, second)));
  out[1] = hn::BitCast(
      d, hn::InterleaveUpper(pairs, hn::BitCast(pairs, first), hn::BitCast(pairs, second)));
}

template <class D, class I>
HWY_INLINE void load_four(D d, const hn::TFromD<D>* from, I i32, hn::Vec<I> index,
                          hn::Vec<D> (&out)[4]) {
  HWY_ALIGN std::int32_t at[hn::MaxLanes(I())];
  hn::Store(index, i32, at);
  hn::Vec<D> record[4];
  for (int k = 0; k < 4; ++k) record[k] = load_every_fourth_record(d, from, at + k);
  const hn::Repartition<double, D> pairs;
  const auto lower = [&](int k) {
    return hn::BitCast(pairs, hn::InterleaveLower(d, record[k], record[k + 1]));
  };
  const auto upper = [&](int k) {
    return hn::BitCast(pairs, hn::InterleaveUpper(d, record[k], record[k + 1]));
  };
  const auto lower0 = lower(0), lower2 = lower(2), upper0 = upper(0), upper2 = upper(2);
  out[0] = hn::BitCast(d, hn::InterleaveLower(pairs, lower0, lower2));
  out[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, lower0, lower2));
  out[2] = hn::BitCast(d, hn::InterleaveLower(pairs, upper0, upper2));
  out[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, upper0, upper2));
}

#endif
