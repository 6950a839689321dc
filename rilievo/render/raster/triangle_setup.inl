// Which triangles can change the picture? Projected and set up, SIMD over triangles. Internal to
// sample_raster.cpp, which includes it once for each instruction set.

#include "rilievo/render/raster/vertex_loads.inl"

struct Corner {
  vfloat x, y, z, w;
};

vfloat dot(const glm::vec4& row, const Vec3<vfloat>& p) {
  return row.x * p.x + vfloat(row.y) * p.y + (row.z * p.z + vfloat(row.w));
}

// A corner of each of the triangles whose indices lie at `at`.
Corner project(const RasterInstance& instance, const std::uint32_t* at, int corner) {
  const Vec3<vfloat> p = load_corners<3>(instance.positions, at, corner);
  const vfloat w = dot(instance.row_w, p), per_w = 1.0f / w;
  return {per_w * dot(instance.row_x, p), per_w * dot(instance.row_y, p),
          per_w * dot(instance.row_z, p), w};
}

// Texels that a triangle can cover: the first and the last column and row.
struct TexelRange {
  hn::Vec<I> x0, y0, x1, y1;
};

// The farthest depth of blocks that cover a triangle's texels; infinite where it is too large.
vfloat farthest_of(const FarthestBlocks::Level& level, const TexelRange& at, Mask wanted) {
  const F f;
  const I i;
  // A power of two.
  const int shift = std::countr_zero(unsigned(level.size));
  const auto block = [&](hn::Vec<I> texel) {
    return hn::IfThenElseZero(hn::RebindMask(i, wanted), hn::ShiftRightSame(texel, shift));
  };
  const auto bx0 = block(at.x0), by0 = block(at.y0), bx1 = block(at.x1), by1 = block(at.y1);
  const auto two = hn::Set(i, 2);
  const auto fits = hn::And(hn::Lt(hn::Sub(bx1, bx0), two), hn::Lt(hn::Sub(by1, by0), two));
  const auto columns = hn::Set(i, level.columns);
  const auto row0 = hn::Mul(by0, columns), row1 = hn::Mul(by1, columns);
  const auto get = [&](hn::Vec<I> row, hn::Vec<I> column) {
    return vfloat(hn::GatherIndex(f, level.depth.data(), hn::Add(row, column)));
  };
  const vfloat farthest =
      max(max(get(row0, bx0), get(row0, bx1)), max(get(row1, bx0), get(row1, bx1)));
  return hn::IfThenElse(hn::RebindMask(f, fits), farthest.v,
                        hn::Set(f, std::numeric_limits<float>::infinity()));
}

// Which triangles lie behind all that their texels show? Their depths are kept in [z_min, z_max].
Mask hidden(const FarthestBlocks& farthest, const TexelRange& at, vfloat z_min, Mask wanted) {
  const vfloat small = farthest_of(farthest.small, at, wanted);
  Mask found = hn::And(wanted, hn::Ge(z_min.v, small.v));
  const Mask large = hn::And(wanted, hn::Gt(small.v, hn::Set(F(), 2.0f)));
  if (!hn::AllFalse(F(), large))
    found =
        hn::Or(found, hn::And(large, hn::Ge(z_min.v, farthest_of(farthest.large, at, large).v)));
  return found;
}

// An edge of each lane's triangle, from its smaller end to its larger one, as Edge has it.
struct LaneEdge {
  vfloat x, y, along_x, along_y;
  Mask turned;

  LaneEdge(vfloat ax, vfloat ay, vfloat bx, vfloat by)
      : turned(hn::Or(hn::Lt(bx.v, ax.v), hn::And(hn::Eq(bx.v, ax.v), hn::Lt(by.v, ay.v)))) {
    const auto smaller = [&](vfloat a, vfloat b) {
      return vfloat(hn::IfThenElse(turned, b.v, a.v));
    };
    x = smaller(ax, bx), y = smaller(ay, by);
    along_x = smaller(bx, ax) - x, along_y = smaller(by, ay) - y;
  }
  [[nodiscard]] Mask inside(vfloat at_x, vfloat at_y) const {
    const vfloat e = along_x * (at_y - y) - along_y * (at_x - x);
    return hn::Xor(hn::Ge(e.v, hn::Zero(F())), turned);
  }
};

// The columns and rows of samples in the box of each lane's primitive. A row of texels has as many
// rows of samples as samples.
struct LaneBoxes {
  hn::Vec<I> first_column, first_row, last_column, last_row;
};

// The columns, or rows, of samples in a range of places. A row of texels has as many rows of
// samples as samples, the first one half a step from its edge, or about there.
struct SampleColumns {
  float per_texel, beside;

  explicit SampleColumns(const SampleBuffer& of)
      : per_texel(float(of.samples)), beside(of.staggered ? kStagger : 0.0f) {}
  [[nodiscard]] vfloat first(vfloat low) const {
    return max(vfloat(hn::Ceil((low * per_texel - 0.5f - beside).v)), 0.0f);
  }
  // Of `count`.
  [[nodiscard]] vfloat last(vfloat high, float count) const {
    return vfloat(hn::Floor((min(high * per_texel + beside, count - 0.5f) - 0.5f).v));
  }
};

// One triangle a lane, counter-clockwise, with its depth.
struct LaneTriangles {
  vfloat x[3], y[3];
  vfloat z0, z_per_x, z_per_y, z_min, z_max;
};

// What fill_rows() finds of them, by the same numbers.
struct TriangleSamples {
  const LaneTriangles& t;
  LaneEdge edges[3];

  explicit TriangleSamples(const LaneTriangles& t)
      : t(t),
        edges{{t.x[0], t.y[0], t.x[1], t.y[1]},
              {t.x[1], t.y[1], t.x[2], t.y[2]},
              {t.x[2], t.y[2], t.x[0], t.y[0]}} {}
  [[nodiscard]] HWY_INLINE vmask covers(vfloat x, vfloat y) const {
    return {hn::And(hn::And(edges[0].inside(x, y), edges[1].inside(x, y)), edges[2].inside(x, y))};
  }
  [[nodiscard]] HWY_INLINE vfloat depth(vfloat x, vfloat y) const {
    return min(max((t.z0 + t.z_per_y * (y - t.y[0])) + t.z_per_x * (x - t.x[0]), t.z_min), t.z_max);
  }
};

// Samples that small primitives change: for each of up to four, its place and the depth there.
struct LaneSamples {
  hn::Vec<I> at[Triangles::kSmallSamples];  // kNone: not changed
  vfloat z[Triangles::kSmallSamples];
};

// Which are so small that each row of samples has at most one in their box, and few rows?
Mask is_small(const LaneBoxes& t, int samples) {
  const I i;
  const auto columns = hn::Sub(t.last_column, t.first_column),
             rows = hn::Sub(t.last_row, t.first_row);
  return hn::RebindMask(F(), hn::And(hn::Lt(columns, hn::Set(i, samples)),
                                     hn::Lt(rows, hn::Set(i, Triangles::kSmallSamples))));
}

TexelRange texels_of(const LaneBoxes& box, int shift) {
  return {hn::ShiftRightSame(box.first_column, shift), hn::ShiftRightSame(box.first_row, shift),
          hn::ShiftRightSame(box.last_column, shift), hn::ShiftRightSame(box.last_row, shift)};
}

// Which of the small primitives change a sample, as the picture is now, and which samples?
template <class Samples>
Mask find_changed(const Samples& primitive, const LaneBoxes& t, const SampleBuffer& seen,
                  Mask small, LaneSamples& changed) {
  const F f;
  const I i;
  const int shift = seen.samples == 4 ? 2 : 0;
  const auto mask = hn::Set(i, seen.samples - 1);
  const float step = 1.0f / float(seen.samples);
  Mask changes = hn::MaskFromVec(hn::Zero(f));
  for (int k = 0; k < Triangles::kSmallSamples; ++k) {
    changed.at[k] = hn::Set(i, Triangles::kNone), changed.z[k] = 0.0f;
    const auto row = hn::Add(t.first_row, hn::Set(i, k));
    const auto sample = hn::And(row, mask);
    // The column of the row's samples, sample_position(): 1, 3, 0, 2 of four.
    const auto of_row = hn::And(hn::Shr(hn::Set(i, 0x8D), hn::Add(sample, sample)), mask);
    const auto column = hn::Add(t.first_column, hn::And(hn::Sub(of_row, t.first_column), mask));
    Mask active = hn::AndNot(hn::RebindMask(f, hn::Gt(row, t.last_row)), small);
    active = hn::AndNot(hn::RebindMask(f, hn::Gt(column, t.last_column)), active);
    if (hn::AllFalse(f, active)) continue;
    vfloat x = step * (vfloat(hn::ConvertTo(f, column)) + 0.5f),
           y = step * (vfloat(hn::ConvertTo(f, row)) + 0.5f);
    if (seen.staggered) {
      // As staggered_position() has it.
      const auto signed_by = [&](hn::Vec<I> parity, float even) {
        const auto odd = hn::Ne(hn::And(parity, hn::Set(i, 1)), hn::Zero(i));
        return vfloat(hn::IfThenElse(hn::RebindMask(f, odd), hn::Set(f, -even), hn::Set(f, even)));
      };
      x = x + signed_by(row, kStagger), y = y + signed_by(column, -kStagger);
    }
    active = hn::And(active, primitive.covers(x, y).m);
    if (hn::AllFalse(f, active)) continue;
    const vfloat z = primitive.depth(x, y);
    const auto at =
        hn::Add(hn::Mul(hn::ShiftRightSame(row, shift), hn::Set(i, std::int32_t(seen.stride))),
                hn::Add(hn::ShiftLeftSame(hn::ShiftRightSame(column, shift), shift), sample));
    const auto now =
        hn::GatherIndex(f, seen.depth.data(), hn::IfThenElseZero(hn::RebindMask(i, active), at));
    active = hn::And(active, hn::Lt(z.v, now));
    changed.at[k] = hn::IfThenElse(hn::RebindMask(i, active), at, changed.at[k]);
    changed.z[k] = z;
    changes = hn::Or(changes, active);
  }
  return changes;
}

// Stores what the mask keeps, and overwrites up to a whole vector. CompressStore() would not
// overwrite, but take more than a hundred cycles on AMD's Zen 4.
template <class D, class Lanes>
void store_compressed(hn::Vec<D> v, Lanes kept, D d, hn::TFromD<D>* to) {
  hn::StoreU(hn::Compress(v, kept), d, to);
}

// Has it holes, or a cross-fade?
bool is_masked(const RasterInstance& instance) {
  return instance.mask || instance.share_from > 0 || instance.share_to < 1;
}

// Sets up triangles [first, first + count) of the instance, those that can be seen from `place` on;
// returns how many they are.
std::uint32_t set_up(const RasterInstance& instance, std::uint32_t first, std::uint32_t count,
                     const SampleBuffer& seen, const FarthestBlocks& farthest, Triangles& out,
                     std::uint32_t place) {
  const int samples = seen.samples, shift = samples == 4 ? 2 : 0;
  const bool masked = is_masked(instance);
  const F f;
  const I i;
  const U u;
  const auto lanes = std::uint32_t(hn::Lanes(f));
  const float columns = float(seen.width * samples), rows = float(seen.height * samples);
  std::uint32_t kept = place;
  for (std::uint32_t t = 0; t < count; t += lanes) {
    const std::uint32_t* at = instance.indices + 3 * std::size_t(first + t);
    std::uint32_t padded[3 * kMaxLanes];
    if (count - t < lanes) {
      // Its first corner over and over: triangles without an area.
      std::fill(std::begin(padded), std::end(padded), at[0]);
      std::copy(at, at + 3 * std::size_t(count - t), padded);
      at = padded;
    }
    const Corner a = project(instance, at, 0), b = project(instance, at, 1),
                 c = project(instance, at, 2);

    // Which way round? Nothing that is behind, flat, or not a number.
    const vfloat bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const vfloat area = bx * cy - cx * by;
    const Mask turned = hn::Lt(area.v, hn::Zero(f));
    const auto above = [&](vfloat x, float low) { return hn::Gt(x.v, hn::Set(f, low)); };
    const float min_w = instance.min_w;
    Mask keep = hn::And(above(a.w, min_w), hn::And(above(b.w, min_w), above(c.w, min_w)));
    const vfloat sized =
        instance.back ? instance.front ? vfloat(hn::Abs(area.v)) : 0.0f - area : area;
    constexpr float kTooLarge = 1e30f;
    keep = hn::And(keep, hn::And(above(sized, 0), above(kTooLarge - sized, 0)));

    // Is there a column and a row of samples in its box?
    const SampleColumns around(seen);
    const vfloat first_column = around.first(min(min(a.x, b.x), c.x));
    const vfloat last_column = around.last(max(max(a.x, b.x), c.x), columns);
    const vfloat first_row = around.first(min(min(a.y, b.y), c.y));
    const vfloat last_row = around.last(max(max(a.y, b.y), c.y), rows);
    keep = hn::And(keep,
                   hn::And(hn::Le(first_column.v, last_column.v), hn::Le(first_row.v, last_row.v)));
    if (hn::AllFalse(f, keep)) continue;

    // Counter-clockwise from here on. Depth is affine over the raster.
    const auto other = [&](vfloat yes, vfloat no) {
      return vfloat(hn::IfThenElse(turned, yes.v, no.v));
    };
    const vfloat bz = b.z - a.z, cz = c.z - a.z, per_area = 1.0f / area;
    const auto whole_number = [&](vfloat v) { return hn::ConvertTo(i, v.v); };
    const LaneTriangles all{{a.x, other(c.x, b.x), other(b.x, c.x)},
                            {a.y, other(c.y, b.y), other(b.y, c.y)},
                            a.z,
                            (bz * cy - cz * by) * per_area,
                            (cz * bx - bz * cx) * per_area,
                            max(min(min(a.z, b.z), c.z), 0.0f),
                            max(max(max(a.z, b.z), c.z), 0.0f)};
    const LaneBoxes box{whole_number(first_column), whole_number(first_row),
                        whole_number(last_column), whole_number(last_row)};
    const TexelRange at_texels = texels_of(box, shift);
    const Mask small = hn::And(keep, is_small(box, samples)), others = hn::AndNot(small, keep);
    LaneSamples changed;
    keep = hn::Or(others, find_changed(TriangleSamples(all), box, seen, small, changed));
    if (farthest.any && !hn::AllFalse(f, others))
      keep = hn::AndNot(hidden(farthest, at_texels, all.z_min, others), keep);
    if (hn::AllFalse(f, keep)) continue;

    const auto store = [&](Triangles::Field field, vfloat x) {
      store_compressed(x.v, keep, f, &out.field[field][kept]);
    };
    const auto kept_whole = hn::RebindMask(i, keep);
    const auto store_whole = [&](hn::Vec<I> v, std::vector<std::int32_t>& to) {
      store_compressed(v, kept_whole, i, &to[kept]);
    };
    const auto done = [&] {
      store_whole(at_texels.y0, out.low), store_whole(at_texels.y1, out.high);
      store_compressed(lane_numbers(u, first + t), hn::RebindMask(u, keep), u, &out.index[kept]);
      kept += std::uint32_t(hn::CountTrue(f, keep));
    };
    if (!masked) {
      const auto is_other = hn::RebindMask(i, others);
      store_whole(hn::IfThenElse(is_other, hn::Set(i, Triangles::kLarge), changed.at[0]),
                  out.sample[0]);
      store_compressed(changed.z[0].v, keep, f, &out.sample_z[0][kept]);
      if (!hn::AllFalse(f, hn::AndNot(others, keep)))
        for (int k = 1; k < Triangles::kSmallSamples; ++k) {
          store_whole(changed.at[k], out.sample[k]);
          store_compressed(changed.z[k].v, keep, f, &out.sample_z[k][kept]);
        }
      if (hn::AllFalse(f, hn::And(others, keep))) {
        done();
        continue;
      }
    }
    store(Triangles::x0, all.x[0]), store(Triangles::y0, all.y[0]);
    store(Triangles::x1, all.x[1]), store(Triangles::y1, all.y[1]);
    store(Triangles::x2, all.x[2]), store(Triangles::y2, all.y[2]);
    store(Triangles::z0, all.z0);
    store(Triangles::z_per_x, all.z_per_x);
    store(Triangles::z_per_y, all.z_per_y);
    store(Triangles::z_min, all.z_min);
    store(Triangles::z_max, all.z_max);
    if (instance.mask) {
      store(Triangles::per_w0, 1.0f / a.w);
      store(Triangles::per_w1, other(1.0f / c.w, 1.0f / b.w));
      store(Triangles::per_w2, other(1.0f / b.w, 1.0f / c.w));
      store(Triangles::exchanged, other(1.0f, 0.0f));
    }
    done();
  }
  return kept - place;
}
