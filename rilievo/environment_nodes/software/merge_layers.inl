// Merges the first `count` layers, one of each node: the share that each has in a pixel's colour,
// and the pixel's depth. As gl/node_shaders.cpp does. Part of shade_nodes.cpp, compiled once for
// each instruction set.

// What pixels show of the layers: the share of each in the colour, and 1 / eye_z (0: nothing).
struct Merged {
  VF share[kMaxDrawnNodes];
  VF inverse_z;
};

// The layers that pixels may show, before they are weighed.
struct Candidates {
  VF z[kMaxDrawnNodes], share[kMaxDrawnNodes];
  MF counts[kMaxDrawnNodes];
  MF only_skins;
  VF nearest;  // 1 / eye_z; 0: nothing
};

// Where directions meet a cube's faces: u to the right and v downwards, each from 0 to 1.
struct FacePoints {
  VI face;
  VF u, v;
};

// As face_axes() has them: what lies to the right and above on the faces of each axis is
//
//     +x -z, -y    +y x,  z    +z  x, -y
//     -x  z, -y    -y x, -z    -z -x, -y
HWY_INLINE FacePoints find_face_points(const Directions& d) {
  const F f;
  const I i32;
  const VF ax = hn::Abs(d.x), ay = hn::Abs(d.y), az = hn::Abs(d.z);
  const MF is_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
  const MF is_y = hn::AndNot(is_x, hn::Ge(ay, az));
  const auto by_axis = [&](VF x, VF y, VF z) {
    return hn::IfThenElse(is_x, x, hn::IfThenElse(is_y, y, z));
  };
  const VF depth = by_axis(ax, ay, az);
  const MF back = hn::Lt(by_axis(d.x, d.y, d.z), hn::Zero(f));
  const auto turned = [&](VF value) { return hn::IfThenElse(back, hn::Neg(value), value); };
  const VF right = by_axis(turned(hn::Neg(d.z)), d.x, turned(d.x));
  const VF down = by_axis(d.y, turned(hn::Neg(d.z)), d.y);
  const VF half = hn::Set(f, 0.5f);
  const VI axis =
      hn::IfThenElse(hn::RebindMask(i32, is_x), hn::Zero(i32),
                     hn::IfThenElse(hn::RebindMask(i32, is_y), hn::Set(i32, 2), hn::Set(i32, 4)));
  const VI side = hn::IfThenElseZero(hn::RebindMask(i32, back), hn::Set(i32, 1));
  return {hn::Add(axis, side), hn::Add(half, hn::Div(hn::Mul(half, right), depth)),
          hn::Add(half, hn::Div(hn::Mul(half, down), depth))};
}

// What node `k` leaves of what lies at points of the frame's eye space: see gl/node_shaders.cpp.
HWY_INLINE VF find_share(const PlacedNodes& placed, std::size_t k, VF x, VF y, VF z) {
  const F f;
  const I i32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const Directions seen = seen_by(placed, k, x, y, z);
  const VF ahead = ahead_of(seen);
  const FacePoints at = find_face_points(seen);
  const SoftwareNode& node = *placed.layers[k].drawn(0).node;
  const int size = node.mesh.face_size;
  const VF scale = hn::Set(f, float(size)), half = hn::Set(f, 0.5f),
           most = hn::Set(f, float(size - 1));
  const auto texels = [&](VF share, VI(&out)[2]) {
    const VF low = limited(hn::Sub(hn::Mul(share, scale), half), most);
    out[0] = hn::ConvertTo(i32, low);
    out[1] = hn::Min(hn::Add(out[0], hn::Set(i32, 1)), hn::Set(i32, size - 1));
  };
  VI u[2], v[2];
  texels(at.u, u), texels(at.v, v);
  VF nearest = hn::Set(f, kNothing);
  for (const VI row : v) {
    const VI first =
        hn::Mul(hn::Add(hn::Mul(at.face, hn::Set(i32, size)), row), hn::Set(i32, size));
    VF beside[2];
    load_disparities(node, first, u, beside);
    nearest = hn::Max(nearest, hn::Max(beside[0], beside[1]));
  }
  const VF farther =
      hn::Sub(hn::Div(one, hn::Max(hn::Mul(nearest, ahead), hn::Set(f, 1e-9f))), one);
  const VF two = hn::Set(f, 2.0f);
  const VF share =
      hn::Sub(two, hn::Div(hn::Mul(two, farther), hn::Set(f, placed.options.tolerance)));
  return hn::IfThenElse(hn::Lt(nearest, zero), one, hn::Min(hn::Max(share, zero), one));
}

// Where surfaces do not agree: their shares, and the nearest that is left.
HWY_INLINE void settle(const PlacedNodes& placed, std::size_t count,
                       const MF (&surface)[kMaxDrawnNodes], VF px, VF py, float nothing, MF differ,
                       Candidates& out) {
  const F f;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const glm::vec4& rays = placed.rays;
  const VF x = hn::Add(hn::Set(f, rays.x), hn::Mul(hn::Set(f, rays.z), px));
  const VF y = hn::Add(hn::Set(f, rays.y), hn::Mul(hn::Set(f, rays.w), py));
  const VF sky = hn::Set(f, nothing / 0.999f);
  // What lies farther behind an accepted surface is not merged with it: its share is not asked.
  const VF reach = hn::Set(f, 1 + 1.5f * placed.options.tolerance);
  VF accepted = zero;
  for (std::size_t k = 0; k < count; ++k) {
    const MF wanted = hn::And(differ, surface[k]);
    if (hn::AllFalse(f, wanted)) continue;
    const VF ahead = hn::Div(
        one, hn::Max(hn::Mul(out.z[k], hn::Set(f, float(placed.scale))), hn::Set(f, 1e-30f)));
    MF near =
        hn::And(hn::And(wanted, hn::Gt(out.z[k], sky)), hn::Ge(hn::Mul(out.z[k], reach), accepted));
    for (std::size_t j = 0; j < count; ++j) {
      if (k == 0 || j == k || hn::AllFalse(f, near)) continue;
      const VF share = find_share(placed, j, hn::Mul(x, ahead), hn::Mul(y, ahead), hn::Neg(ahead));
      out.share[k] = hn::IfThenElse(near, hn::Min(out.share[k], share), out.share[k]);
      near = hn::And(near, hn::Gt(out.share[k], zero));
    }
    const MF left = hn::And(wanted, hn::Ge(out.share[k], hn::Set(f, 0.5f)));
    accepted = hn::IfThenElse(left, hn::Max(accepted, out.z[k]), accepted);
  }
  const MF some = hn::And(differ, hn::Gt(accepted, zero));
  out.nearest = hn::IfThenElse(some, accepted, out.nearest);
  for (std::size_t k = 0; k < count; ++k)
    out.share[k] = hn::IfThenElse(hn::AndNot(some, differ), one, out.share[k]);
}

// See gl/node_shaders.cpp.
HWY_INLINE void find_candidates(const PlacedNodes& placed, std::size_t count,
                                const Shown (&shown)[kMaxDrawnNodes][1], int i, VF px, VF py,
                                float nothing, Candidates& out) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f), tiny = hn::Set(f, 1e-30f);
  MF surface[kMaxDrawnNodes];
  VF nearest = zero, nearest_skin = zero, farthest = hn::Set(f, 1e30f);
  for (std::size_t k = 0; k < count; ++k) {
    out.z[k] = hn::Load(f, shown[k][0].inverse_z + i);
    out.share[k] = one;
    const MF skin = are_skins(placed.layers[k], hn::Load(u32, shown[k][0].triangle + i));
    surface[k] = hn::AndNot(skin, hn::Gt(out.z[k], zero));
    nearest = hn::IfThenElse(skin, nearest, hn::Max(nearest, out.z[k]));
    farthest = hn::IfThenElse(surface[k], hn::Min(farthest, out.z[k]), farthest);
    nearest_skin = hn::IfThenElse(skin, hn::Max(nearest_skin, out.z[k]), nearest_skin);
  }
  out.only_skins = hn::Eq(nearest, zero);
  out.nearest = hn::IfThenElse(out.only_skins, nearest_skin, nearest);
  const MF differ =
      hn::And(hn::Gt(nearest, zero),
              hn::Gt(nearest, hn::Mul(farthest, hn::Set(f, 1 + 0.5f * placed.options.tolerance))));
  if (!hn::AllFalse(f, differ)) settle(placed, count, surface, px, py, nothing, differ, out);
  const VF limit = hn::Div(hn::Set(f, 1 + placed.options.tolerance), hn::Max(out.nearest, tiny));
  for (std::size_t k = 0; k < count; ++k) {
    const MF skin =
        hn::And(out.only_skins, hn::And(hn::Gt(out.z[k], zero), hn::Eq(out.z[k], nearest_skin)));
    const MF near = hn::And(surface[k], hn::Le(hn::Div(one, hn::Max(out.z[k], tiny)), limit));
    out.counts[k] = hn::Or(skin, near);
  }
}

// `weights`: of the texels that layers show, 0 to 255.
HWY_INLINE void merge(const PlacedNodes& placed, std::size_t count, const Candidates& from,
                      const VF (&weights)[kMaxDrawnNodes], Merged& out) {
  const F f;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const bool binary = placed.options.merge == NodeMerge::binary;
  VF most = hn::Set(f, -1.0f), sum = zero;
  out.inverse_z = from.nearest;
  for (std::size_t k = 0; k < count; ++k) {
    out.share[k] = zero;
    const MF counts = from.counts[k];
    if (hn::AllFalse(f, counts)) continue;
    // In the steps that a byte of alpha has above a skin's.
    const VF steps =
        hn::Floor(hn::Add(hn::Mul(weights[k], hn::Set(f, 253.0f / 255.0f)), hn::Set(f, 0.5f)));
    VF weight = hn::IfThenElse(from.only_skins, one,
                               hn::Mul(from.share[k], hn::Add(steps, hn::Set(f, 0.25f))));
    if (placed.options.merge == NodeMerge::positional)
      weight = hn::Mul(weight, hn::Set(f, placed.nearness[k]));
    const MF best = hn::And(counts, hn::Gt(weight, most));
    most = hn::IfThenElse(best, weight, most);
    out.inverse_z = hn::IfThenElse(best, from.z[k], out.inverse_z);
    if (binary)
      for (std::size_t before = 0; before < k; ++before)
        out.share[before] = hn::IfThenZeroElse(best, out.share[before]);
    out.share[k] = binary ? hn::IfThenElseZero(best, one) : hn::IfThenElseZero(counts, weight);
    sum = hn::Add(sum, hn::IfThenElseZero(counts, weight));
  }
  if (binary) return;
  sum = hn::Max(sum, hn::Set(f, 1e-20f));
  for (std::size_t k = 0; k < count; ++k) out.share[k] = hn::Div(out.share[k], sum);
}

// Others only in the gaps of the first.
HWY_INLINE void merge_first(const PlacedNodes& placed, const Shown (&shown)[kMaxDrawnNodes][1],
                            int i, Merged& out) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const auto skin = [&](std::size_t k) {
    return are_skins(placed.layers[k], hn::Load(u32, shown[k][0].triangle + i));
  };
  const VF first = hn::Load(f, shown[0][0].inverse_z + i),
           others = hn::Load(f, shown[1][0].inverse_z + i);
  const MF gap = hn::Or(hn::Eq(first, zero), skin(0));
  const MF fills = hn::Or(hn::Not(skin(1)), hn::Gt(others, first));
  const MF second = hn::And(gap, hn::And(hn::Gt(others, zero), fills));
  out.inverse_z = hn::IfThenElse(second, others, first);
  out.share[0] = hn::IfThenZeroElse(second, one);
  out.share[1] = hn::IfThenElseZero(second, one);
}
