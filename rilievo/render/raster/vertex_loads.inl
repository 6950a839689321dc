// Positions of vertices, one a lane, of primitives whose indices lie at `at`, kCorners for each
// lane: three of a triangle, two of a line, one of a point. Internal to triangle_setup.inl.

#if HWY_HAVE_SCALABLE || HWY_TARGET == HWY_SCALAR

// Of one corner of each primitive.
template <int kCorners>
Vec3<vfloat> load_corners(const glm::vec3* positions, const std::uint32_t* at, int corner) {
  const F f;
  const U u;
  hn::Vec<U> first, second, third;
  if constexpr (kCorners == 3)
    hn::LoadInterleaved3(u, at, first, second, third);
  else if constexpr (kCorners == 2)
    hn::LoadInterleaved2(u, at, first, second), third = second;
  else
    third = second = first = hn::LoadU(u, at);
  const auto index = corner == 0 ? first : corner == 1 ? second : third;
  const auto offset = hn::BitCast(I(), hn::Add(hn::Add(index, index), index));  // three floats each
  const float* x = &positions[0].x;
  return {hn::GatherIndex(f, x, offset), hn::GatherIndex(f, x + 1, offset),
          hn::GatherIndex(f, x + 2, offset)};
}

#else

using Four = hn::CappedTag<float, 4>;

// (x, y, z, 0); nothing beyond is read.
HWY_INLINE hn::Vec<Four> load_position(const glm::vec3& p) {
  using Two = hn::Half<Four>;
  const hn::CappedTag<float, 1> one;
  return hn::Combine(Four(), hn::ZeroExtendVector(Two(), hn::LoadU(one, &p.z)),
                     hn::LoadU(Two(), &p.x));
}

// Of primitive 0 in the first block of four lanes, 4 in the next one, and so on.
template <int kCorners, class D>
HWY_INLINE hn::Vec<D> load_every_fourth(D d, const glm::vec3* positions, const std::uint32_t* at) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return load_position(positions[*at]);
  } else {
    const hn::Half<D> half;
    const auto lower = load_every_fourth<kCorners>(half, positions, at);
    return hn::Combine(
        d, load_every_fourth<kCorners>(half, positions, at + kCorners * hn::MaxLanes(half)), lower);
  }
}

// Of one corner of each primitive. Whole positions are loaded and transposed, which takes half
// of what gathering three floats a lane does.
template <int kCorners>
HWY_INLINE Vec3<vfloat> load_corners(const glm::vec3* positions, const std::uint32_t* at,
                                     int corner) {
  const F f;
  const hn::Repartition<double, F> pairs;
  hn::Vec<F> vertex[4];
  for (int k = 0; k < 4; ++k)
    vertex[k] = load_every_fourth<kCorners>(f, positions, at + kCorners * k + corner);
  const auto lower = [&](int k) {
    return hn::BitCast(pairs, hn::InterleaveLower(f, vertex[k], vertex[k + 1]));
  };
  const auto upper = [&](int k) {
    return hn::BitCast(pairs, hn::InterleaveUpper(f, vertex[k], vertex[k + 1]));
  };
  const auto xy01 = lower(0), xy23 = lower(2), z01 = upper(0), z23 = upper(2);
  return {hn::BitCast(f, hn::InterleaveLower(pairs, xy01, xy23)),
          hn::BitCast(f, hn::InterleaveUpper(pairs, xy01, xy23)),
          hn::BitCast(f, hn::InterleaveLower(pairs, z01, z23))};
}

#endif
