// Colours and identifiers of surfaces beside silhouettes: a pixel takes them from texels of its own
// surface alone. Part of shade_nodes.cpp, compiled once for each instruction set.

// Directions in node space.
struct Directions {
  VF x, y, z;
};

// Pixels that a layer shows: the triangle in each, of the `wanted` ones, their centres and depths,
// and where the triangles have their colours there.
struct LayerPixels {
  VU triangle;
  MF wanted;
  VF x, y, inverse_z;
  TexelPoints points;
};

// Where node `k` sees points of the frame's eye space.
HWY_INLINE Directions seen_by(const PlacedNodes& placed, std::size_t k, VF x, VF y, VF z) {
  const F f;
  const glm::mat4& m = placed.node_from_eye[k];
  const auto axis = [&](int row) {
    const auto column = [&](int c) { return hn::Set(f, m[c][row]); };
    return hn::Add(hn::Add(hn::Mul(column(0), x), hn::Mul(column(1), y)),
                   hn::Add(hn::Mul(column(2), z), column(3)));
  };
  return {axis(0), axis(1), axis(2)};
}
HWY_INLINE VF ahead_of(const Directions& seen) {
  return hn::Max(hn::Abs(seen.x), hn::Max(hn::Abs(seen.y), hn::Abs(seen.z)));
}

// The four texels around what pixels show of a surface, of which those alone count that lie about
// as deep: the others show what is beside a silhouette.
struct SurfaceTexels {
  MF beside;     // a silhouette
  VI color[2];   // where the left ones are in the node's colours: upper, lower
  VI object[4];  // in its identifiers and disparities
  VF weight[4];  // 0: of another surface
};

// The texels of pixels beside silhouettes, where the least weight of colours is 0, of a layer's
// node; `k` is its number among all. See gl/node_shaders.cpp.
HWY_INLINE SurfaceTexels find_surface_texels(const PlacedNodes& placed, const NodeLayer& layer,
                                             const SoftwareNode& node, std::size_t k,
                                             const LayerPixels& at, float nothing,
                                             VF least_weight) {
  const F f;
  const I i32;
  const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  SurfaceTexels out;
  out.beside =
      hn::And(at.wanted, hn::AndNot(are_skins(layer, at.triangle), hn::Eq(least_weight, zero)));
  if (hn::AllFalse(f, out.beside)) return out;
  const glm::vec4& rays = placed.rays;
  const VF ahead = hn::Div(
      one, hn::Max(hn::Mul(at.inverse_z, hn::Set(f, float(placed.scale))), hn::Set(f, 1e-30f)));
  const VF x = hn::Mul(hn::Add(hn::Set(f, rays.x), hn::Mul(hn::Set(f, rays.z), at.x)), ahead);
  const VF y = hn::Mul(hn::Add(hn::Set(f, rays.y), hn::Mul(hn::Set(f, rays.w), at.y)), ahead);
  VF own =
      hn::Div(one, hn::Max(ahead_of(seen_by(placed, k, x, y, hn::Neg(ahead))), hn::Set(f, 1e-9f)));
  own = hn::IfThenZeroElse(hn::Le(at.inverse_z, hn::Set(f, nothing * (2 * kBeforeFar - 1))), own);

  const TexelPoints& point = at.points;
  const int face = node.mesh.face_size, wide = node.wide();
  const VF size = hn::Set(f, float(face)), u = point.u, v = point.v;
  const VI left = hn::ConvertTo(i32, limited(u, size)), top = hn::ConvertTo(i32, limited(v, size));
  const VF fx = limited(hn::Sub(u, hn::ConvertTo(f, left)), one),
           fy = limited(hn::Sub(v, hn::ConvertTo(f, top)), one);
  const VI last = hn::Set(i32, face - 1), none = hn::Zero(i32);
  VF off[4];
  VF least = hn::Set(f, 1e30f);
  // Disparities and identifiers have no border.
  const auto inside = [&](VI index) {
    return hn::Min(hn::Max(hn::Sub(index, hn::Set(i32, 1)), none), last);
  };
  const VI one_more = hn::Set(i32, 1);
  const VI columns[2] = {inside(left), inside(hn::Add(left, one_more))};
  for (int r = 0; r < 2; ++r) {
    const VI row = r == 0 ? top : hn::Add(top, one_more);
    const VI first =
        hn::Mul(hn::Add(hn::Mul(point.face, hn::Set(i32, wide)), row), hn::Set(i32, wide));
    const VI of_row =
        hn::Mul(hn::Add(hn::Mul(point.face, hn::Set(i32, face)), inside(row)), hn::Set(i32, face));
    out.color[r] = hn::Add(first, left);
    VF disparity[2];
    load_disparities(node, of_row, columns, disparity);
    for (int column = 0; column < 2; ++column) {
      const int c = 2 * r + column;
      out.object[c] = hn::Add(of_row, columns[column]);
      out.weight[c] =
          hn::Max(hn::Mul(column == 0 ? hn::Sub(one, fx) : fx, r == 0 ? hn::Sub(one, fy) : fy),
                  hn::Set(f, 1e-3f));
      off[c] = hn::Abs(hn::Sub(disparity[column], own));
      least = hn::Min(least, off[c]);
    }
  }
  const VF most = hn::Add(least, hn::Mul(hn::Set(f, placed.options.tolerance), own));
  for (int c = 0; c < 4; ++c)
    out.weight[c] = hn::IfThenElseZero(hn::Le(off[c], most), out.weight[c]);
  return out;
}

// Beside silhouettes surfaces keep their own colours.
HWY_INLINE void keep_colors(const SoftwareNode& node, const SurfaceTexels& of, Colors& colors) {
  const F f;
  const I i32;
  const U u32;
  if (hn::AllFalse(f, of.beside)) return;
  VU texel[2][2];
  VF sum = hn::Zero(f);
  for (int c = 0; c < 4; ++c) sum = hn::Add(sum, of.weight[c]);
  for (int r = 0; r < 2; ++r) load_two(u32, node.color.data(), i32, of.color[r], texel[r]);
  const auto mean = [&]<int shift>(VF& channel) {
    VF total = hn::Zero(f);
    for (int c = 0; c < 4; ++c) {
      const VF value = hn::ConvertTo(
          f, hn::BitCast(i32,
                         hn::And(hn::ShiftRight<shift>(texel[c / 2][c % 2]), hn::Set(u32, 0xffu))));
      total = hn::Add(total, hn::Mul(of.weight[c], value));
    }
    channel = hn::IfThenElse(of.beside, hn::Div(total, sum), channel);
  };
  mean.template operator()<0>(colors.r);
  mean.template operator()<8>(colors.g);
  mean.template operator()<16>(colors.b);
}

// Beside silhouettes surfaces have the identifier of the nearest of their own texels.
HWY_INLINE VU keep_object(const SoftwareNode& node, const SurfaceTexels& of, VU object) {
  const F f;
  const U u32;
  if (hn::AllFalse(f, of.beside)) return object;
  VF most = hn::Zero(f);
  for (int c = 0; c < 4; ++c) {
    const MF nearer = hn::And(of.beside, hn::Gt(of.weight[c], most));
    most = hn::IfThenElse(nearer, of.weight[c], most);
    object = hn::IfThenElse(hn::RebindMask(u32, nearer),
                            hn::GatherIndex(u32, node.object.data(), of.object[c]), object);
  }
  return object;
}

// The colours or identifiers, as the tile holds, of a layer's nodes, which are numbers `first`,
// first + 1, ... among all. `colors`: shade<true>()'s.
HWY_INLINE VU keep_to_surfaces(const PlacedNodes& placed, const NodeLayer& layer,
                               const FrameTile& tile, std::size_t first, const LayerPixels& at,
                               Colors& colors) {
  const U u32;
  const bool of_objects = tile.of != TileContent::color && placed.object == kNoObject;
  VU object = of_objects ? find_content(placed, layer, tile.of, at.triangle, at.wanted, at.points)
                         : hn::Set(u32, placed.object);
  // As nearly everywhere: no silhouette.
  if (hn::AllFalse(F(), hn::And(at.wanted, hn::Eq(colors.least, hn::Zero(F()))))) return object;
  std::size_t n = 0;
  for_nodes(layer, at.triangle, at.wanted, [&](const SoftwareNode& node, MF its) {
    while (layer.drawn(n).node != &node) ++n;
    if (tile.of != TileContent::color && (!of_objects || node.object.empty())) return;
    const LayerPixels own{at.triangle, its, at.x, at.y, at.inverse_z, at.points};
    const SurfaceTexels texels =
        find_surface_texels(placed, layer, node, first + n, own, tile.nothing, colors.least);
    if (of_objects)
      object = keep_object(node, texels, object);
    else
      keep_colors(node, texels, colors);
  });
  return object;
}
