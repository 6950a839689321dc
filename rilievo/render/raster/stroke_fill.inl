// Points and lines, rasterised as fill_rows() does triangles. Internal to sample_raster.cpp, which
// includes it once for each instruction set.

// One of them in all lanes.
LaneDiscs stroke_of(const Triangles& in, std::uint32_t t, const RasterStrokes& strokes, LaneDiscs) {
  const auto get = [&](Triangles::Field field) { return vfloat(in.field[field][t]); };
  LaneDiscs d;
  d.x = get(Triangles::x0), d.y = get(Triangles::y0);
  d.tilt_x = get(Triangles::x1), d.tilt_y = get(Triangles::y1);
  d.m = get(Triangles::x2), d.reach2 = get(Triangles::y2);
  d.z = get(Triangles::z0), d.z_per_x = get(Triangles::z_per_x);
  d.z_per_y = get(Triangles::z_per_y);
  d.clamps = strokes.clamps;
  if (strokes.radius > 0) d.unit_x = 1 / strokes.per_unit.x, d.unit_y = 1 / strokes.per_unit.y;
  return d;
}
LaneLines stroke_of(const Triangles& in, std::uint32_t t, const RasterStrokes& strokes, LaneLines) {
  const auto get = [&](Triangles::Field field) { return vfloat(in.field[field][t]); };
  LaneLines d;
  d.x = get(Triangles::x0), d.y = get(Triangles::y0);
  d.along_x = get(Triangles::x1), d.along_y = get(Triangles::y1);
  d.per_length2 = get(Triangles::x2);
  d.z = get(Triangles::z0), d.z_along = get(Triangles::z_per_x);
  d.radius = strokes.radius_px;
  return d;
}

// The columns of texels that it may cover in a row of them: of a line, those beside what the row
// and half the line's width around it have of the segment.
struct Columns {
  int first, last;
};
Columns columns_of(const Triangles& in, std::uint32_t t, int, const RasterStrokes&, LaneDiscs) {
  return {int(in.field[Triangles::z_min][t]), int(in.field[Triangles::z_max][t])};
}
Columns columns_of(const Triangles& in, std::uint32_t t, int row, const RasterStrokes& strokes,
                   LaneLines) {
  const auto get = [&](Triangles::Field field) { return in.field[field][t]; };
  const float x = get(Triangles::x0), y = get(Triangles::y0), along_x = get(Triangles::x1),
              along_y = get(Triangles::y1), reach = strokes.radius_px + 0.01f;
  Columns all{int(get(Triangles::z_min)), int(get(Triangles::z_max))};
  if (std::abs(along_y) < 1e-3f) return all;
  float s = (float(row) - reach - y) / along_y, e = (float(row + 1) + reach - y) / along_y;
  if (s > e) std::swap(s, e);
  s = std::clamp(s, 0.0f, 1.0f), e = std::clamp(e, 0.0f, 1.0f);
  const float left = x + along_x * (along_x < 0 ? e : s),
              right = x + along_x * (along_x < 0 ? s : e);
  all.first = std::max(all.first, int(std::max(left - reach, 0.0f)));
  all.last = std::min(all.last, int(std::max(right + reach, 0.0f)));
  return all;
}

// Rows [low, high) of what the points or lines [place, place + count) of the instance cover;
// returns how many have any.
template <class Stroke>
std::uint32_t fill_strokes(const Triangles& in, std::uint32_t place, std::uint32_t count,
                           const RasterInstance& instance, int low, int high, SampleBuffer& out) {
  const F f;
  const U u;
  const int samples = out.samples;
  float* const depths = out.depth.data();
  std::uint32_t* const triangles = out.triangle.data();
  const int lanes = int(hn::Lanes(f)), parts = std::max(1, samples / lanes);
  Pattern patterns[kMaxParts];
  for (int part = 0; part < parts; ++part) patterns[part] = make_pattern(part, out, lanes);
  const int texels = std::max(1, lanes / samples);
  const int shift = std::countr_zero(unsigned(texels));
  std::uint32_t found[SampleRaster::kPiece + kMaxLanes];
  const std::uint32_t size = find_in_rows(in, place, count, low, high, found);
  const std::int32_t begin = std::int32_t(out.row(low)), end = std::int32_t(out.row(high));
  const bool fades = is_masked(instance);
  for (std::uint32_t n = 0; n < size; ++n) {
    const std::uint32_t t = found[n], number = instance.first_triangle + in.index[t];
    if (in.sample[0][t] != Triangles::kLarge) {
      for (int k = 0; k < Triangles::kSmallSamples; ++k) {
        const std::int32_t at = in.sample[k][t];
        const float z = in.sample_z[k][t];
        if (at < begin || at >= end || !(z < depths[at])) continue;
        depths[at] = z, triangles[at] = number;
      }
      continue;
    }
    const Stroke stroke = stroke_of(in, t, instance.strokes, Stroke());
    const int from = std::max(in.low[t], low), to = std::min(in.high[t], high - 1);
    for (int row = from; row <= to; ++row) {
      const Columns columns = columns_of(in, t, row, instance.strokes, Stroke());
      for (int group = columns.first >> shift; group <= columns.last >> shift; ++group)
        for (int part = 0; part < parts; ++part) {
          const vfloat x = vfloat(hn::LoadU(f, patterns[part].x)) + beside_pattern(out, row) +
                           float(group << shift);
          vfloat y = vfloat(hn::LoadU(f, patterns[part].y)) + float(row);
          if constexpr (kOneLane)
            if (out.staggered) y = height_in_row(group) + float(row);
          const std::size_t at =
              out.row(row) + std::size_t(group * parts + part) * std::size_t(lanes);
          const vfloat z = stroke.depth(x, y);
          Mask covered = hn::And(stroke.covers(x, y).m, hn::Lt(z.v, hn::LoadU(f, depths + at)));
          if (fades) covered = hn::And(covered, in_share(instance, x, y));
          if (hn::AllFalse(f, covered)) continue;
          store_masked(z.v, covered, f, depths + at);
          store_masked(hn::Set(u, number), hn::RebindMask(u, covered), u, triangles + at);
        }
    }
  }
  return size;
}
