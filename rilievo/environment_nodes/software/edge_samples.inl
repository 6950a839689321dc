// The samples of a block's pixels that silhouettes cross. A surface has one colour in a pixel, that
// at the centre if it is seen there: samples that show what the centre shows are drawn with the
// block's other pixels, and of the others those alike together. Part of shade_nodes.cpp, compiled
// once for each instruction set.

struct EdgeSamples {
  // Not 0: the sample of the pixel is one of these.
  HWY_ALIGN std::uint32_t own[NodeLayer::kEdgeSamples][kPixels];
  // What is drawn, a sample for all alike: of every layer, as of a block's pixels, and where.
  Shown shown[NodeLayer::kEdgeSamples][kMaxDrawnNodes][1];
  HWY_ALIGN float x[NodeLayer::kEdgeSamples * kPixels], y[NodeLayer::kEdgeSamples * kPixels];
  int count = 0;
  // Which samples of which pixels show it.
  struct Use {
    std::uint8_t pixel, sample, drawn;
  };
  Use uses[NodeLayer::kEdgeSamples * kPixels];
  int used = 0;
};

// What a sample shows of each layer.
struct EdgeLook {
  float inverse_z[kMaxDrawnNodes];  // 0: nothing
  std::uint32_t triangle[kMaxDrawnNodes];
  bool only_skins = true;
};

HWY_INLINE void find_only_skins(const PlacedNodes& placed, std::size_t count, EdgeLook& look) {
  look.only_skins = true;
  for (std::size_t k = 0; k < count; ++k)
    look.only_skins = look.only_skins &&
                      (look.inverse_z[k] == 0 || look.triangle[k] >= placed.layers[k].first_skin());
}

// Do two samples show the same surfaces? Skins count where there is nothing else.
HWY_INLINE bool are_alike(const PlacedNodes& placed, std::size_t count, const EdgeLook& a,
                          const EdgeLook& b) {
  if (a.only_skins != b.only_skins) return false;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t skins = placed.layers[k].first_skin();
    const auto depth = [&](const EdgeLook& of) {
      return !a.only_skins && of.triangle[k] >= skins ? 0.0f : of.inverse_z[k];
    };
    const float at_a = depth(a), at_b = depth(b);
    if ((at_a == 0) != (at_b == 0)) return false;
    if (a.only_skins) continue;
    if (std::max(at_a, at_b) > (1 + 0.5f * placed.options.tolerance) * std::min(at_a, at_b))
      return false;
  }
  return true;
}

// `shown`: at the centres of the block's pixels.
void find_edge_samples(const PlacedNodes& placed, std::size_t count, const FrameTile& tile, int x,
                       int y, std::uint64_t marked, const Shown (&shown)[kMaxDrawnNodes][1],
                       EdgeSamples& out) {
  for (auto& plane : out.own) std::fill_n(plane, kPixels, 0u);
  out.count = out.used = 0;
  const float least = tile.nothing * kBeforeFar;
  float per_depth[kMaxDrawnNodes];
  for (std::size_t k = 0; k < count; ++k)
    per_depth[k] = float(1 / (placed.layers[k].nearest() * placed.scale));
  for (; marked != 0; marked &= marked - 1) {
    const int pixel = std::countr_zero(marked);
    const std::uint32_t number = placed.edges.number_of(x, y, pixel);
    EdgeLook center;
    for (std::size_t k = 0; k < count; ++k) {
      center.inverse_z[k] = shown[k][0].inverse_z[pixel];
      center.triangle[k] = shown[k][0].triangle[pixel];
    }
    find_only_skins(placed, count, center);
    EdgeLook looks[NodeLayer::kEdgeSamples];
    int drawn[NodeLayer::kEdgeSamples], different = 0;
    for (int s = 0; s < NodeLayer::kEdgeSamples; ++s) {
      EdgeLook& look = looks[different];
      for (std::size_t k = 0; k < count; ++k) {
        const float depth = placed.layers[k].edge_depths(number)[s];
        const bool any = depth < 1;
        look.inverse_z[k] =
            any ? std::max((NodeLayer::kSkyDepth - depth) * per_depth[k], least) : 0.0f;
        look.triangle[k] = any ? placed.layers[k].edge_triangles(number)[s] : 0;
      }
      find_only_skins(placed, count, look);
      if (are_alike(placed, count, look, center)) continue;
      out.own[s][pixel] = 1;
      int same = 0;
      while (same < different && !are_alike(placed, count, look, looks[same])) ++same;
      if (same == different) {
        const int i = out.count % kPixels;
        for (std::size_t k = 0; k < count; ++k) {
          Shown& to = out.shown[out.count / kPixels][k][0];
          to.inverse_z[i] = look.inverse_z[k], to.triangle[i] = look.triangle[k];
        }
        out.x[out.count] = float(x + pixel % kBlock) + FrameTile::kSampleX[s];
        out.y[out.count] = float(y + pixel / kBlock) + FrameTile::kSampleY[s];
        drawn[different++] = out.count++;
      }
      out.uses[out.used++] = {std::uint8_t(pixel), std::uint8_t(s), std::uint8_t(drawn[same])};
    }
  }
  // Of the last vector, nothing.
  for (int n = out.count; n % int(hn::Lanes(F())) != 0; ++n) {
    out.x[n] = out.y[n] = 0;
    for (std::size_t k = 0; k < count; ++k) {
      Shown& to = out.shown[n / kPixels][k][0];
      to.inverse_z[n % kPixels] = 0, to.triangle[n % kPixels] = 0;
    }
  }
}

void draw_edge_samples(const PlacedNodes& placed, std::size_t count, FrameTile& tile, int block,
                       const EdgeSamples& edges) {
  const F f;
  const U u32;
  HWY_ALIGN float inverse_z[NodeLayer::kEdgeSamples * kPixels];
  HWY_ALIGN std::uint32_t content[NodeLayer::kEdgeSamples * kPixels];
  const VF zero = hn::Zero(f);
  for (int n = 0; n < edges.count; n += int(hn::Lanes(f))) {
    MergedPixels merged{hn::Lt(zero, zero), zero, hn::Zero(u32)};
    const bool any = merge_pixels(placed, count, tile, edges.shown[n / kPixels], n % kPixels,
                                  hn::Load(f, edges.x + n), hn::Load(f, edges.y + n), zero, merged);
    hn::Store(any ? merged.inverse_z : zero, f, inverse_z + n);
    hn::Store(any ? merged.content : hn::Zero(u32), u32, content + n);
  }
  for (int u = 0; u < edges.used; ++u) {
    const EdgeSamples::Use& use = edges.uses[u];
    FrameTile::Plane& plane = tile.plane(block, use.sample);
    if (!(inverse_z[use.drawn] > plane.inverse_z[use.pixel])) continue;
    plane.inverse_z[use.pixel] = inverse_z[use.drawn];
    plane.content[use.pixel] = content[use.drawn];
    tile.changed[block] = true;
  }
}
