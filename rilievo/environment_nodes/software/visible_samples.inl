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
// Of merged nodes, which have one sample, skins lie behind all surfaces, and are shown
// `with_skins`.
template <int samples, bool merged = false>
float find_shown(const NodeLayer& layer, double scale, const FrameTile& tile, int x, int y,
                 Shown (&out)[samples], bool with_skins = true) {
  const F f;
  const U u32;
  const VF sky = hn::Set(f, NodeLayer::kSkyDepth), one = hn::Set(f, 1.0f), zero = hn::Zero(f);
  const VF per_depth = hn::Set(f, float(1 / (layer.nearest() * scale)));
  // What is infinitely far is not nothing; what lies beyond the far plane is drawn there.
  const VF something = hn::Set(f, 1e-30f), least = hn::Set(f, tile.nothing * kBeforeFar);
  const std::array<NodeLayer::Seen, 3> parts = layer.seen();
  VF nearest = zero;
  for (int first = 0; first < kPixels; first += int(hn::Lanes(f))) {
    const int row = y + first / kBlock;
    VF z[samples];
    VU shown[samples];
    std::fill_n(z, samples, zero);
    std::fill_n(shown, samples, hn::Zero(u32));
    MF surface = hn::Lt(zero, zero);
    const std::size_t count = row >= tile.height ? 0 : with_skins ? parts.size() : 1;
    for (std::size_t p = 0; p < count; ++p) {
      if (!parts[p].samples) continue;
      const RowLoad<samples> from(*parts[p].samples, x, tile.height - 1 - row);
      VF depth[samples];
      VU triangle[samples];
      from.load(first % kBlock, depth, triangle);
      // Of the block after the next one, which lies in the same lines of the cache.
      if (samples == 1 && x + 3 * kBlock <= tile.width) {
        __builtin_prefetch(from.depth + 2 * kBlock);
        __builtin_prefetch(from.triangle + 2 * kBlock);
      }
      for (int s = 0; s < samples; ++s) {
        const VF own = hn::Max(hn::Mul(hn::Sub(sky, depth[s]), per_depth), something);
        MF seen = hn::And(hn::Lt(depth[s], one), hn::Ge(own, z[s]));
        if (merged) seen = hn::AndNot(surface, seen);
        z[s] = hn::IfThenElse(seen, own, z[s]);
        shown[s] = hn::IfThenElse(hn::RebindMask(u32, seen),
                                  hn::Add(triangle[s], hn::Set(u32, parts[p].first)), shown[s]);
      }
      if (!merged || p > 0) continue;
      surface = hn::Gt(z[0], zero);
      if (hn::AllTrue(f, surface)) break;  // as nearly everywhere: skins are not asked
    }
    for (int s = 0; s < samples; ++s) {
      z[s] = hn::IfThenElseZero(hn::Gt(z[s], zero), hn::Max(z[s], least));
      hn::Store(z[s], f, out[s].inverse_z + first);
      hn::Store(shown[s], u32, out[s].triangle + first);
      nearest = hn::Max(nearest, z[s]);
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
