// first, first + 1, ... in the lanes of a vector. Included once for each instruction set, within
// HWY_NAMESPACE.

// As hn::Iota(d, first), which stores a number that is no constant lane by lane, and waits until
// it can load all of them as a vector.
template <class D>
HWY_INLINE hn::Vec<D> lane_numbers(D d, hn::TFromD<D> first) {
  return hn::Add(hn::Iota(d, 0), hn::Set(d, first));
}
