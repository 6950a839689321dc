// What keyframes show of surfaces in the frame: looks them up, backward. Part of warp_rows.cpp,
// compiled once for each instruction set.

// What the keyframes show of places in the frame: sums of bytes, weighted; and how much of the
// places it covers, in kTexelWeights: the most of all keyframes, and the sum, weighted as the
// bytes, with those quarters of texels behind that show what is in front.
struct Found {
  VF r, g, b, weight, cover, front;
  VF own;  // of quarters that show the surface: the most of all keyframes
  // A keyframe may show the surface, with texels that are too large by now (kMostMagnified).
  Mask too_near;
};

// The four quarters, or texels, around each place: upper left, upper right, and below; and the
// depths of their texels.
struct Four {
  VF depths[4];
  VU colors[4];
};

// A value and the next one, for each lane. Loaded one by one: where processors gather vectors by
// microcode, that takes half as long.
template <class T>
struct Pairs {
  alignas(64) T values[2 * kMaxLanes];

  HWY_INLINE void load(const T* from, VI at) {
    alignas(64) std::int32_t places[kMaxLanes];
    hn::Store(at, I(), places);
    for (std::size_t lane = 0; lane < hn::Lanes(I()); ++lane)
      std::memcpy(values + 2 * lane, from + places[lane], 2 * sizeof(T));
  }
};

// Of places anywhere. `finer`: 1 where texels have quarters, 0 where not.
HWY_INLINE void load_anywhere(const Keyframe& key, int finer, VI ix, VI iy, Four& four) {
  const F f;
  const I i32;
  const U u32;
  const int width = key.camera.width, columns = width << finer;
  const VI at = hn::Add(hn::Mul(iy, hn::Set(i32, columns)), ix);
  // The texels of two rows and two columns of quarters, some of them the same.
  const VI one_more = hn::Set(i32, 1), stride = hn::Set(i32, width);
  const auto texel = [&](VI of) { return hn::ShiftRightSame(of, finer); };
  const VI left = texel(ix), right_of = texel(hn::Add(ix, one_more)),
           upper = hn::Mul(texel(iy), stride),
           lower = hn::Mul(texel(hn::Add(iy, one_more)), stride);
  // Two columns beside each other, both within the picture.
  const VI pair = hn::Min(left, hn::Set(i32, width - 2));
  const Mask left_first = hn::RebindMask(f, hn::Eq(left, pair)),
             right_first = hn::RebindMask(f, hn::Eq(right_of, pair));
  Pairs<float> depth_pairs[2];
  depth_pairs[0].load(key.inverse_z.texels().data(), hn::Add(upper, pair));
  depth_pairs[1].load(key.inverse_z.texels().data(), hn::Add(lower, pair));
  Pairs<std::uint32_t> color_pairs[2];
  color_pairs[0].load(key.color.texels().data(), at);
  color_pairs[1].load(key.color.texels().data() + columns, at);
  for (int row = 0; row < 2; ++row) {
    VF first, second;
    hn::LoadInterleaved2(f, depth_pairs[row].values, first, second);
    four.depths[2 * row] = select(left_first, first, second);
    four.depths[2 * row + 1] = select(right_first, first, second);
    hn::LoadInterleaved2(u32, color_pairs[row].values, four.colors[2 * row],
                         four.colors[2 * row + 1]);
  }
}

// Some vectors of numbers, one behind the other.
template <class D, int kParts>
struct Run {
  hn::Vec<D> parts[kParts];

  HWY_INLINE void load(const hn::TFromD<D>* from) {
    for (int i = 0; i < kParts; ++i) parts[i] = hn::LoadU(D(), from + i * int(hn::Lanes(D())));
  }
  // The numbers at these places.
  HWY_INLINE hn::Vec<D> at(VI place) const {
    const D d;
    const I i32;
    const int lanes = int(hn::Lanes(d));
    const auto index = hn::IndicesFromVec(d, hn::And(place, hn::Set(i32, lanes - 1)));
    hn::Vec<D> found = hn::TableLookupLanes(parts[kParts - 1], index);
    for (int i = kParts - 1; i-- > 0;)
      found = hn::IfThenElse(hn::RebindMask(d, hn::Lt(place, hn::Set(i32, (i + 1) * lanes))),
                             hn::TableLookupLanes(parts[i], index), found);
    return found;
  }
};

// The same where the places within lie beside each other in at most three rows, as most do: without
// a load for each. False: they do not.
HWY_INLINE bool load_beside(const Keyframe& key, int finer, VI ix, VI iy, Mask within, Four& four) {
  const F f;
  const I i32;
  const U u32;
  const int lanes = int(hn::Lanes(f)), width = key.camera.width, columns = width << finer;
  const auto all = [&](auto which) {
    return hn::AllTrue(f, hn::Or(hn::RebindMask(f, which), hn::Not(within)));
  };
  const auto below = [&](VI of, int end) {
    return hn::Lt(hn::BitCast(u32, of), hn::Set(u32, std::uint32_t(end)));
  };
  // Places of a row that goes back may lie a little before the first one.
  const int x0 = std::max(hn::GetLane(ix) - 2, 0);
  int y0 = hn::GetLane(iy);
  const VI dx = hn::Sub(ix, hn::Set(i32, x0));
  if (!all(below(dx, (finer ? 3 : 2) * lanes - 1))) return false;
  if (!all(below(hn::Sub(iy, hn::Set(i32, y0)), 2))) {
    if (!all(below(hn::Sub(iy, hn::Set(i32, --y0)), 2)) || y0 < 0) return false;
  }
  const int tx0 = x0 >> finer, ty0 = y0 >> finer;
  const std::span<const std::uint32_t> colors = key.color.texels();
  const std::span<const float> depths = key.inverse_z.texels();
  const std::size_t first = std::size_t(y0) * std::size_t(columns) + std::size_t(x0);
  const std::size_t first_depth = std::size_t(ty0) * std::size_t(width) + std::size_t(tx0);
  // Loads go beyond a row's end, and must not beyond the picture's.
  if (first + 2 * std::size_t(columns) + 3 * std::size_t(lanes) > colors.size() ||
      first_depth + 2 * std::size_t(width) + 2 * std::size_t(lanes) > depths.size())
    return false;

  // Rows of pixels are too short for the processor to foresee what comes next.
  constexpr std::size_t kAhead = 128, kOfLine = 16;
  for (int i = 0; i < 3; ++i)
    for (const std::size_t ahead : {kAhead, kAhead + kOfLine})
      hwy::Prefetch(&colors[std::min(first + std::size_t(i * columns) + ahead, colors.size() - 1)]);
  for (int i = 0; i < 2; ++i)
    hwy::Prefetch(
        &depths[std::min(first_depth + std::size_t(i * width) + kAhead / 2, depths.size() - 1)]);

  const VI one_more = hn::Set(i32, 1), right = hn::Add(dx, one_more);
  const auto in_first = hn::Eq(iy, hn::Set(i32, y0));
  Run<U, 3> row;
  row.load(&colors[first]);
  four.colors[0] = row.at(dx), four.colors[1] = row.at(right);
  row.load(&colors[first + std::size_t(columns)]);
  four.colors[2] = row.at(dx), four.colors[3] = row.at(right);
  if (!all(in_first)) {
    row.load(&colors[first + 2 * std::size_t(columns)]);
    const auto upper = hn::RebindMask(u32, in_first);
    const VU third[2] = {row.at(dx), row.at(right)};
    for (int i = 0; i < 2; ++i) {
      four.colors[i] = hn::IfThenElse(upper, four.colors[i], four.colors[2 + i]);
      four.colors[2 + i] = hn::IfThenElse(upper, four.colors[2 + i], third[i]);
    }
  }

  const auto texel = [&](VI of, int from) {
    return hn::Sub(hn::ShiftRightSame(of, finer), hn::Set(i32, from));
  };
  const VI column[2] = {texel(ix, tx0), texel(hn::Add(ix, one_more), tx0)};
  const VI of_row[2] = {texel(iy, ty0), texel(hn::Add(iy, one_more), ty0)};
  Run<F, 2> deep;
  for (int i = 0; i < (finer ? 2 : 3); ++i) {
    deep.load(&depths[first_depth + std::size_t(i) * std::size_t(width)]);
    for (int k = 0; k < 4; ++k) {
      const VF found = deep.at(column[k % 2]);
      const Mask here = hn::RebindMask(f, hn::Eq(of_row[k / 2], hn::Set(i32, i)));
      four.depths[k] = i == 0 ? found : select(here, found, four.depths[k]);
    }
  }
  return true;
}

// Looks up the surfaces at pixels `px` of row `py`, at 1 / eye_z `w`. Colours are summed two bytes
// at a time, in 16 bits each: weights are whole and make up at most 256. `mixes`: quarters that
// show something else than their texel count, too, a little.
HWY_INLINE Found find(const WarpSource* sources, int count, VF px, float py, VF w, Mask mixes) {
  const F f;
  const I i32;
  const U u32;
  const VF one = number(1);
  const VF zero = hn::Zero(f);
  Found found{zero, zero, zero, zero, zero, zero, zero, hn::Gt(zero, zero)};
  for (int k = 0; k < count; ++k) {
    const WarpSource& source = sources[k];
    const Keyframe& key = *source.keyframe;
    const int width = key.camera.width, height = key.camera.height;
    if (width < 2) continue;  // it has no column beside another one
    const Mask wanted = source.spare ? hn::Lt(found.cover, number(float(kAllShown))) : hn::Eq(w, w);
    if (hn::AllFalse(f, wanted)) continue;
    const Along along_x(source.from_frame.x, py), along_y(source.from_frame.y, py),
        along_z(source.from_frame.z, py);
    const VF z = along_z.at(px, w);
    const VF per_z = hn::Div(one, hn::Max(z, number(1e-6f)));
    // In quarters of texels, if there are any.
    const int finer = key.quarters() ? 1 : 0;
    const int columns = width << finer, rows = height << finer;
    const VF scaled = hn::Mul(per_z, number(float(1 << finer)));
    const VF qx = hn::Sub(hn::Mul(along_x.at(px, w), scaled), number(0.5f));
    const VF qy = hn::Sub(hn::Mul(along_y.at(px, w), scaled), number(0.5f));
    const Mask right = hn::And(hn::Ge(qx, hn::Zero(f)), hn::Lt(qx, number(float(columns - 1))));
    const Mask below = hn::And(hn::Ge(qy, hn::Zero(f)), hn::Lt(qy, number(float(rows - 1))));
    const Mask seen = hn::And(hn::And(wanted, hn::Gt(z, number(1e-6f))), hn::And(right, below));
    const Mask too_near = hn::Gt(z, number(kMostMagnified));
    found.too_near = hn::Or(found.too_near, hn::And(seen, too_near));
    const Mask within = hn::AndNot(too_near, seen);
    if (hn::AllFalse(f, within)) continue;
    const VF magnified = hn::Max(hn::Mul(z, number(source.pixels_per_texel)), one);
    const Mask mixed = hn::And(mixes, hn::Lt(magnified, number(kMostMixed)));
    const VF x_floor = hn::Floor(qx), y_floor = hn::Floor(qy);
    const VF ax = hn::Sub(qx, x_floor), ay = hn::Sub(qy, y_floor);
    const auto whole = [&](VF v) { return hn::ConvertTo(i32, hn::IfThenElseZero(within, v)); };
    const VI ix = whole(x_floor), iy = whole(y_floor);
    Four four;
    if (!load_beside(key, finer, ix, iy, within, four)) load_anywhere(key, finer, ix, iy, four);
    const VF(&depths)[4] = four.depths;
    const VU(&colors)[4] = four.colors;
    const VF there = hn::Mul(w, per_z);
    const VF slack = hn::Mul(number(kSameSurfaceDepth), there);
    const VF left_weight = hn::Mul(hn::Sub(one, ax), number(float(kTexelWeights))),
             right_weight = hn::Mul(ax, number(float(kTexelWeights))), up = hn::Sub(one, ay);
    const VF weights[4] = {hn::Mul(left_weight, up), hn::Mul(right_weight, up),
                           hn::Mul(left_weight, ay), hn::Mul(right_weight, ay)};
    const VU pairs = hn::Set(u32, 0x00ff00ffu);
    VU shown = hn::Zero(u32), sure = hn::Zero(u32), known = hn::Zero(u32), front = hn::Zero(u32);
    VU even = hn::Zero(u32), odd = hn::Zero(u32);  // bytes 0 and 2, 1 and 3
    const auto weight_of = [&](int i, Mask counts) {
      return hn::BitCast(u32, hn::ConvertTo(i32, hn::IfThenElseZero(counts, weights[i])));
    };
    // Mostly all four show the surface and nothing else, or none does.
    VF closest = hn::Abs(hn::Sub(depths[0], there)), farthest = closest;
    VU others = hn::Zero(u32);
    for (int i = 0; i < 4; ++i) {
      const VF off = hn::Abs(hn::Sub(depths[i], there));
      closest = hn::Min(closest, off), farthest = hn::Max(farthest, off);
      others = hn::Or(others, hn::Xor(colors[i], hn::Set(u32, kWholeTexel)));
    }
    const Mask whole_texels = hn::RebindMask(f, hn::Lt(others, hn::Set(u32, 1u << 24)));
    const Mask all_same = hn::And(hn::Le(farthest, slack), whole_texels);
    const Mask none_same = hn::Gt(closest, slack);
    if (hn::AllTrue(f, hn::Or(hn::Or(all_same, none_same), hn::Not(within)))) {
      for (int i = 0; i < 4; ++i) {
        const VU weight = weight_of(i, hn::And(all_same, within));
        shown = hn::Add(shown, weight);
        even = hn::Add(even, hn::Mul(weight, hn::And(colors[i], pairs)));
        odd = hn::Add(odd, hn::Mul(weight, hn::And(hn::ShiftRight<8>(colors[i]), pairs)));
      }
      // Each quarter counts with its four sides.
      sure = known = shown, front = hn::Mul(shown, hn::Set(u32, kQuarterParts));
    } else {
      for (int i = 0; i < 4; ++i) {
        const VF depth = depths[i];
        const VU color = colors[i];
        const auto same = hn::RebindMask(u32, hn::Le(hn::Abs(hn::Sub(depth, there)), slack));
        const auto hidden = hn::RebindMask(u32, hn::Lt(depth, zero));
        const auto before = hn::RebindMask(u32, hn::Lt(depth, hn::Sub(there, slack)));
        const VU shows = hn::ShiftRight<30>(color);
        const auto is = [&](Quarter quarter) {
          return hn::Eq(shows, hn::Set(u32, std::uint32_t(quarter)));
        };
        const auto own = is(Quarter::own), nearer = is(Quarter::nearer);
        const VU all = weight_of(i, within);
        shown = hn::Add(shown, hn::IfThenElseZero(same, all));
        // A quarter of what is looked up, with its sides; or, of one behind, the sides in front. In
        // front of a texel behind there is what is looked up.
        const VU seven = hn::Set(u32, 7);
        const VU of_same =
            hn::Add(hn::And(hn::ShiftRight<27>(color), seven), hn::Set(u32, kOwnParts));
        const VU of_nearer = hn::And(hn::ShiftRight<24>(color), seven);
        const auto in_front = hn::Or(hn::And(same, own), hn::And(before, nearer));
        const auto behind = hn::AndNot(nearer, hn::Or(same, before));
        const VU parts = hn::IfThenElse(in_front, of_same, hn::IfThenElseZero(behind, of_nearer));
        front = hn::Add(front, hn::IfThenZeroElse(hidden, hn::Mul(all, parts)));
        const VU of_other =
            hn::IfThenElseZero(hn::RebindMask(u32, mixed), hn::ShiftRight<kOtherQuarterShift>(all));
        const VU weight = hn::IfThenElseZero(same, hn::IfThenElse(own, all, of_other));
        known = hn::Add(known, hn::IfThenElseZero(hn::And(same, own), all));
        sure = hn::Add(sure, weight);
        even = hn::Add(even, hn::Mul(weight, hn::And(color, pairs)));
        odd = hn::Add(odd, hn::Mul(weight, hn::And(hn::ShiftRight<8>(color), pairs)));
      }
    }
    const auto number_of = [&](VU v) { return hn::ConvertTo(f, hn::BitCast(i32, v)); };
    const VF share = number_of(shown);
    const VF colored = number_of(sure);
    const Mask shows = hn::Gt(colored, hn::Zero(f));
    found.cover = hn::Max(found.cover, share);
    found.own = hn::Max(found.own, number_of(known));
    const VF counts =
        hn::IfThenElseZero(shows, hn::Div(number(source.weight), hn::Mul(magnified, magnified)));
    const VU low = hn::Set(u32, 0xffffu);
    found.r = hn::Add(found.r, hn::Mul(counts, number_of(hn::And(even, low))));
    found.g = hn::Add(found.g, hn::Mul(counts, number_of(hn::And(odd, low))));
    found.b = hn::Add(found.b, hn::Mul(counts, number_of(hn::ShiftRight<16>(even))));
    const VF counted = hn::Mul(counts, colored);
    found.weight = hn::Add(found.weight, counted);
    found.front = hn::Add(found.front, hn::Mul(counted, number_of(front)));
  }
  return found;
}

// Does a keyframe see pixels' rays until 1 / eye_z `w`? What is hidden in it blocks the view, too.
HWY_INLINE Mask seen_until(const WarpSource* sources, int count, VF px, float py, VF w) {
  const F f;
  const I i32;
  Mask seen = hn::Gt(hn::Zero(f), hn::Zero(f));
  for (int k = 0; k < count; ++k) {
    const WarpSource& source = sources[k];
    const Keyframe& key = *source.keyframe;
    const int width = key.camera.width, height = key.camera.height;
    const Along along_x(source.from_frame.x, py), along_y(source.from_frame.y, py),
        along_z(source.from_frame.z, py);
    const VF z = along_z.at(px, w);
    const VF per_z = hn::Div(number(1), hn::Max(z, number(1e-6f)));
    const VF x = hn::Mul(along_x.at(px, w), per_z), y = hn::Mul(along_y.at(px, w), per_z);
    const Mask across = hn::And(hn::Ge(x, hn::Zero(f)), hn::Lt(x, number(float(width))));
    const Mask down = hn::And(hn::Ge(y, hn::Zero(f)), hn::Lt(y, number(float(height))));
    const Mask within = hn::And(hn::Gt(z, number(1e-6f)), hn::And(across, down));
    if (hn::AllFalse(f, within)) continue;
    const auto whole = [&](VF v) { return hn::ConvertTo(i32, hn::IfThenElseZero(within, v)); };
    const VI at = hn::Add(hn::Mul(whole(hn::Floor(y)), hn::Set(i32, width)), whole(hn::Floor(x)));
    const VF depth = hn::Abs(hn::GatherIndex(f, key.inverse_z.texels().data(), at));
    const VF there = hn::Mul(hn::Mul(w, per_z), number(1 + kSameSurfaceDepth));
    seen = hn::Or(seen, hn::And(within, hn::Le(depth, there)));
  }
  return seen;
}
