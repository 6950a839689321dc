// The samples of a block of 8 x 8 pixels: which triangle of a layer each shows, and how deep. Of
// the layer's visibility buffers the nearest counts. Part of shade_nodes.cpp, compiled once for
// each instruction set.

// What one sample of each pixel of a block shows of a layer.
struct Shown {
  HWY_ALIGN float inverse_z[kPixels];  // of the frame; 0: nothing
  HWY_ALIGN std::uint32_t triangle[kPixels];
};

// The samples of a row of a block, as a visibility buffer has them.
template <int samples>
struct RowLoad {
  const float* depth;
  const std::uint32_t* triangle;
  // At the right edge of the frame: a copy, with nothing beyond it.
  HWY_ALIGN float depths[kBlock * samples];
  HWY_ALIGN std::uint32_t triangles[kBlock * samples];

  RowLoad(const SampleBuffer& from, int x, int row) {
    depth = from.depths(row) + std::size_t(x) * samples;
    triangle = from.triangles(row) + std::size_t(x) * samples;
    if (x + kBlock <= from.width) return;
    std::fill_n(depths, kBlock * samples, 1.0f);
    std::fill_n(triangles, kBlock * samples, 0u);
    std::copy_n(depth, (from.width - x) * samples, depths);
    std::copy_n(triangle, (from.width - x) * samples, triangles);
    depth = depths, triangle = triangles;
  }
  // Of the pixels from `i` on.
  HWY_INLINE void load(int i, VF (&z)[samples], VU (&t)[samples]) const {
    const F f;
    const U u32;
    if constexpr (samples == 1) {
      z[0] = hn::LoadU(f, depth + i), t[0] = hn::LoadU(u32, triangle + i);
    } else {
      hn::LoadInterleaved4(f, depth + 4 * i, z[0], z[1], z[2], z[3]);
      hn::LoadInterleaved4(u32, triangle + 4 * i, t[0], t[1], t[2], t[3]);
    }
  }
};

// What all samples of a block show of a layer. Returns the nearest one's 1 / eye_z, 0 for nothing.
// Of merged nodes skins lie behind all surfaces.
template <int samples, bool merged = false>
float find_shown(const NodeLayer& layer, double scale, const FrameTile& tile, int x, int y,
                 Shown (&out)[samples]) {
  const F f;
  const U u32;
  const VF sky = hn::Set(f, NodeLayer::kSkyDepth), one = hn::Set(f, 1.0f), zero = hn::Zero(f);
  const VF per_depth = hn::Set(f, float(1 / (layer.nearest() * scale)));
  // What is infinitely far is not nothing; what lies beyond the far plane is drawn there.
  const VF something = hn::Set(f, 1e-30f), least = hn::Set(f, tile.nothing * kBeforeFar);
  const std::array<NodeLayer::Seen, 3> parts = layer.seen();
  VF nearest = zero;
  for (int row = 0; row < kBlock; ++row) {
    const int first = row * kBlock;
    for (int i = 0; i < kBlock; i += int(hn::Lanes(f)))
      for (Shown& s : out) {
        hn::Store(zero, f, s.inverse_z + first + i);
        hn::Store(hn::Zero(u32), u32, s.triangle + first + i);
      }
    if (y + row >= tile.height) continue;
    for (const NodeLayer::Seen& part : parts) {
      if (!part.samples) continue;
      const RowLoad<samples> from(*part.samples, x, tile.height - 1 - (y + row));
      for (int i = 0; i < kBlock; i += int(hn::Lanes(f))) {
        VF depth[samples];
        VU triangle[samples];
        from.load(i, depth, triangle);
        for (int s = 0; s < samples; ++s) {
          const VF z = hn::Max(hn::Mul(hn::Sub(sky, depth[s]), per_depth), something);
          const VF before = hn::Load(f, out[s].inverse_z + first + i);
          MF seen = hn::And(hn::Lt(depth[s], one), hn::Ge(z, before));
          if (merged && part.first > 0) {
            const MF surface =
                hn::And(hn::Gt(before, zero),
                        hn::RebindMask(f, hn::Lt(hn::Load(u32, out[s].triangle + first + i),
                                                 hn::Set(u32, layer.first_skin()))));
            seen = hn::AndNot(surface, seen);
          }
          hn::Store(hn::IfThenElse(seen, z, before), f, out[s].inverse_z + first + i);
          hn::Store(hn::IfThenElse(hn::RebindMask(u32, seen),
                                   hn::Add(triangle[s], hn::Set(u32, part.first)),
                                   hn::Load(u32, out[s].triangle + first + i)),
                    u32, out[s].triangle + first + i);
        }
      }
    }
    for (int i = 0; i < kBlock; i += int(hn::Lanes(f)))
      for (Shown& s : out) {
        VF z = hn::Load(f, s.inverse_z + first + i);
        z = hn::IfThenElseZero(hn::Gt(z, zero), hn::Max(z, least));
        hn::Store(z, f, s.inverse_z + first + i);
        nearest = hn::Max(nearest, z);
      }
  }
  return hn::GetLane(hn::MaxOfLanes(f, nearest));
}

// The centres of a block's pixels from the i-th on.
HWY_INLINE VF center_x(int x, int i) {
  const F f;
  return hn::Add(hn::Iota(f, 0), hn::Set(f, float(x + i % kBlock) + 0.5f));
}
HWY_INLINE VF center_y(int y, int i) { return hn::Set(F(), float(y + i / kBlock) + 0.5f); }

// Are the triangles skins?
HWY_INLINE MF are_skins(const NodeLayer& layer, VU triangle) {
  const I i32;
  const VI first = hn::Set(i32, std::int32_t(layer.first_skin()));
  return hn::RebindMask(F(), hn::Not(hn::Lt(hn::BitCast(i32, triangle), first)));
}
