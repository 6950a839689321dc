// What kernels share that draw into tiles. Included once for each instruction set, within
// HWY_NAMESPACE. Internal: not a stable interface.

// The least 1 / eye_z of a block's samples.
HWY_INLINE float farthest(FrameTile& tile, int block) {
  if (!tile.changed[block]) return tile.farthest[block];
  const hn::CappedTag<float, 16> f;
  auto least = hn::Load(f, tile.first[block].inverse_z);
  for (int s = 0; s < tile.planes(block); ++s)
    for (int i = 0; i < FrameTile::kBlockPixels; i += int(hn::Lanes(f)))
      least = hn::Min(least, hn::Load(f, tile.plane(block, s).inverse_z + i));
  tile.changed[block] = false;
  return tile.farthest[block] = hn::GetLane(hn::MinOfLanes(f, least));
}

// In [0, 1): shader::kPixelHash, of pixels at offsets from the pixel (x, y), those of their
// centres. Rows count from the bottom there.
template <class D>
HWY_INLINE hn::Vec<D> pixel_hash(D f, const FrameTile& tile, int x, int y, hn::Vec<D> dx,
                                 hn::Vec<D> dy) {
  const auto column = hn::Floor(hn::Add(hn::Set(f, float(x)), dx));
  const auto row = hn::Floor(hn::Sub(hn::Set(f, float(tile.height - y)), dy));
  const auto fract = [](hn::Vec<D> a) { return hn::Sub(a, hn::Floor(a)); };
  const auto dot =
      hn::Add(hn::Mul(column, hn::Set(f, 0.06711056f)), hn::Mul(row, hn::Set(f, 0.00583715f)));
  return fract(hn::Mul(hn::Set(f, 52.9829189f), fract(dot)));
}

// Replaces what a plane holds of the pixels from the i-th on, where `drawn`.
template <class D>
HWY_INLINE void put(D f, FrameTile::Plane& plane, int i, hn::Mask<D> drawn, hn::Vec<D> inverse_z,
                    hn::Vec<hn::RebindToUnsigned<D>> content) {
  const hn::RebindToUnsigned<D> u32;
  const auto z = hn::Load(f, plane.inverse_z + i);
  const auto before = hn::Load(u32, plane.content + i);
  hn::Store(hn::IfThenElse(drawn, inverse_z, z), f, plane.inverse_z + i);
  hn::Store(hn::IfThenElse(hn::RebindMask(u32, drawn), content, before), u32, plane.content + i);
}
