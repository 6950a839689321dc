// Which points and lines can change the picture? Set up as triangles are (triangle_setup.inl), SIMD
// over points or lines. Internal to sample_raster.cpp, which includes it once for each instruction
// set.

#include "rilievo/render/raster/stroke_shapes.inl"

using LaneDiscs = Disc<vfloat>;
using LaneLines = Line<vfloat>;

// The numbers that stroke_fill.inl needs of one, by Triangles::Field.
void store_stroke(const LaneDiscs& d, Mask keep, Triangles& out, std::uint32_t kept) {
  const std::pair<Triangles::Field, vfloat> fields[] = {
      {Triangles::x0, d.x},           {Triangles::y0, d.y},
      {Triangles::x1, d.tilt_x},      {Triangles::y1, d.tilt_y},
      {Triangles::x2, d.m},           {Triangles::y2, d.reach2},
      {Triangles::z0, d.z},           {Triangles::z_per_x, d.z_per_x},
      {Triangles::z_per_y, d.z_per_y}};
  for (const auto& [field, value] : fields)
    store_compressed(value.v, keep, F(), &out.field[field][kept]);
}
void store_stroke(const LaneLines& d, Mask keep, Triangles& out, std::uint32_t kept) {
  const std::pair<Triangles::Field, vfloat> fields[] = {
      {Triangles::x0, d.x},           {Triangles::y0, d.y}, {Triangles::x1, d.along_x},
      {Triangles::y1, d.along_y},     {Triangles::z0, d.z}, {Triangles::x2, d.per_length2},
      {Triangles::z_per_x, d.z_along}};
  for (const auto& [field, value] : fields)
    store_compressed(value.v, keep, F(), &out.field[field][kept]);
}

// Sets up points or lines [first, first + count) of the instance, as set_up() does triangles.
template <int kCorners>
std::uint32_t set_up_strokes(const RasterInstance& instance, std::uint32_t first,
                             std::uint32_t count, const SampleBuffer& seen,
                             const FarthestBlocks& farthest, Triangles& out, std::uint32_t place) {
  const int samples = seen.samples, shift = samples == 4 ? 2 : 0;
  const bool masked = is_masked(instance);
  const F f;
  const I i;
  const U u;
  const auto lanes = std::uint32_t(hn::Lanes(f));
  const float columns = float(seen.width * samples), rows = float(seen.height * samples);
  std::uint32_t kept = place;
  for (std::uint32_t t = 0; t < count; t += lanes) {
    const std::uint32_t* at = instance.indices + kCorners * std::size_t(first + t);
    std::uint32_t padded[kCorners * kMaxLanes];
    if (count - t < lanes) {
      std::fill(std::begin(padded), std::end(padded), at[0]);
      std::copy(at, at + kCorners * std::size_t(count - t), padded);
      at = padded;
    }
    std::conditional_t<kCorners == 1, LaneDiscs, LaneLines> all;
    StrokeReach<vfloat> reach;
    if constexpr (kCorners == 1)
      reach = make_disc(instance, load_corners<1>(instance.positions, at, 0), all);
    else
      reach = make_line(instance, float(seen.width), float(seen.height),
                        load_corners<2>(instance.positions, at, 0),
                        load_corners<2>(instance.positions, at, 1), all);
    Mask keep = hn::Gt(reach.w.v, hn::Set(f, instance.min_w));
    if (count - t < lanes) keep = hn::And(keep, hn::FirstN(f, count - t));
    const SampleColumns around(seen);
    const vfloat first_column = around.first(reach.x0),
                 last_column = around.last(reach.x1, columns);
    const vfloat first_row = around.first(reach.y0), last_row = around.last(reach.y1, rows);
    keep = hn::And(keep,
                   hn::And(hn::Le(first_column.v, last_column.v), hn::Le(first_row.v, last_row.v)));
    if (hn::AllFalse(f, keep)) continue;
    // Where nothing is kept, numbers may be none.
    const auto whole = [&](vfloat v) {
      return hn::IfThenElseZero(hn::RebindMask(i, keep), hn::ConvertTo(i, v.v));
    };
    const LaneBoxes box{whole(first_column), whole(first_row), whole(last_column), whole(last_row)};
    const TexelRange at_texels = texels_of(box, shift);
    const Mask small =
        masked ? hn::MaskFromVec(hn::Zero(f)) : hn::And(keep, is_small(box, samples));
    const Mask others = hn::AndNot(small, keep);
    LaneSamples changed;
    keep = hn::Or(others, find_changed(all, box, seen, small, changed));
    if (farthest.any && !hn::AllFalse(f, others))
      keep = hn::AndNot(hidden(farthest, at_texels, reach.z_min, others), keep);
    if (hn::AllFalse(f, keep)) continue;

    const auto kept_whole = hn::RebindMask(i, keep);
    const auto store_whole = [&](hn::Vec<I> v, std::vector<std::int32_t>& to) {
      store_compressed(v, kept_whole, i, &to[kept]);
    };
    store_whole(
        hn::IfThenElse(hn::RebindMask(i, others), hn::Set(i, Triangles::kLarge), changed.at[0]),
        out.sample[0]);
    store_compressed(changed.z[0].v, keep, f, &out.sample_z[0][kept]);
    if (!hn::AllFalse(f, hn::AndNot(others, keep)))
      for (int k = 1; k < Triangles::kSmallSamples; ++k) {
        store_whole(changed.at[k], out.sample[k]);
        store_compressed(changed.z[k].v, keep, f, &out.sample_z[k][kept]);
      }
    if (!hn::AllFalse(f, hn::And(others, keep))) {
      store_stroke(all, keep, out, kept);
      // The columns of texels.
      store_compressed(hn::ConvertTo(f, at_texels.x0), keep, f, &out.field[Triangles::z_min][kept]);
      store_compressed(hn::ConvertTo(f, at_texels.x1), keep, f, &out.field[Triangles::z_max][kept]);
    }
    store_whole(at_texels.y0, out.low), store_whole(at_texels.y1, out.high);
    store_compressed(lane_numbers(u, first + t), hn::RebindMask(u, keep), u, &out.index[kept]);
    kept += std::uint32_t(hn::CountTrue(f, keep));
  }
  return kept - place;
}
