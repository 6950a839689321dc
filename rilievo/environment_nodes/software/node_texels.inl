// Which colours and identifiers do triangles of nodes have at pixels' centres? For shade_nodes.cpp,
// within its namespace: compiled once for each instruction set. Internal: not a stable interface.

// Where the fields of the wanted triangles lie from those of the first one, in words.
HWY_INLINE VI index_of(VU triangle, MF wanted) {
  const U u32;
  constexpr std::uint32_t kWords = sizeof(NodeTriangle) / sizeof(std::uint32_t);
  const VU of = hn::IfThenElseZero(hn::RebindMask(u32, wanted), triangle);
  return hn::BitCast(I(), hn::Mul(of, hn::Set(u32, kWords)));
}

// Between 0 and `most`; 0 for what is no number.
HWY_INLINE VF limited(VF value, VF most) {
  const F f;
  value = hn::IfThenElseZero(hn::Gt(value, hn::Zero(f)), value);
  return hn::Min(value, most);
}

// Places in a cube's faces: in texels to the right and downwards, from the middle of the corner
// texel of a face's border.
struct TexelPoints {
  VI face;
  VF u, v;
};

// Where triangles have their colours at pixels' centres.
HWY_INLINE TexelPoints find_points(const NodeLayer& layer, VU number, MF wanted, VF x, VF y) {
  const F f;
  const I i32;
  const U u32;
  const NodeTriangle* const triangles = layer.triangles().data();
  const auto along = [&](VF at, VF per_x, VF per_y, VF dx, VF dy) {
    return hn::Add(at, hn::Add(hn::Mul(dx, per_x), hn::Mul(dy, per_y)));
  };
  const VU one = hn::Set(u32, hn::ExtractLane(number, hn::FindKnownFirstTrue(f, wanted)));
  if (hn::AllFalse(f, hn::AndNot(hn::RebindMask(f, hn::Eq(number, one)), wanted))) {
    const NodeTriangle& t = triangles[hn::GetLane(one)];
    const VF dx = hn::Sub(x, hn::Set(f, t.x)), dy = hn::Sub(y, hn::Set(f, t.y));
    const auto axis = [&](int k) {
      return along(hn::Set(f, t.at[k]), hn::Set(f, t.per_x[k]), hn::Set(f, t.per_y[k]), dx, dy);
    };
    const VF w = axis(2);
    return {hn::Set(i32, std::int32_t(t.face)), hn::Div(axis(0), w), hn::Div(axis(1), w)};
  }
  const VI index = index_of(number, wanted);
  // As a NodeTriangle has them: at, per_x, per_y, x, y, face.
  static_assert(offsetof(NodeTriangle, face) == 11 * sizeof(float));
  const float* first = &triangles[0].at.x;
  VF of[3][4];
  for (int k = 0; k < 3; ++k) load_four(f, first + 4 * k, i32, index, of[k]);
  const VF dx = hn::Sub(x, of[2][1]), dy = hn::Sub(y, of[2][2]);
  const VF w = along(of[0][2], of[1][1], of[2][0], dx, dy);
  return {hn::BitCast(i32, of[2][3]), hn::Div(along(of[0][0], of[0][3], of[1][2], dx, dy), w),
          hn::Div(along(of[0][1], of[1][0], of[1][3], dx, dy), w)};
}

// sRGB-encoded, 0 to 255, and the texels' weight, likewise; the least of the four is 0 beside
// silhouettes.
struct Colors {
  VF r, g, b, weight, least;
};

// The colours of a node between four texels; their weight if it is asked for.
template <bool with_weight>
HWY_INLINE Colors find_colors(const SoftwareNode& node, const TexelPoints& at) {
  const F f;
  const I i32;
  const U u32;
  const int wide = node.wide();
  const VF size = hn::Set(f, float(node.mesh.face_size)), one = hn::Set(f, 1.0f);
  const VI x = hn::ConvertTo(i32, limited(at.u, size)), y = hn::ConvertTo(i32, limited(at.v, size));
  const VF fx = limited(hn::Sub(at.u, hn::ConvertTo(f, x)), one),
           fy = limited(hn::Sub(at.v, hn::ConvertTo(f, y)), one);
  const VI row = hn::Add(hn::Mul(at.face, hn::Set(i32, wide)), y);
  const VI index = hn::Add(hn::Mul(row, hn::Set(i32, wide)), x);
  const std::uint32_t* texels = node.color.data();
  VU upper[2], lower[2];
  load_two(u32, texels, i32, index, upper);
  load_two(u32, texels + wide, i32, index, lower);
  const VU t00 = upper[0], t10 = upper[1], t01 = lower[0], t11 = lower[1];
  const auto mix = [](VF a, VF b, VF by) { return hn::Add(a, hn::Mul(by, hn::Sub(b, a))); };
  const auto channel = [&]<int shift>() {
    const auto of = [&](VU texel) {
      return hn::ConvertTo(
          f, hn::BitCast(i32, hn::And(hn::ShiftRight<shift>(texel), hn::Set(u32, 0xffu))));
    };
    return mix(mix(of(t00), of(t10), fx), mix(of(t01), of(t11), fx), fy);
  };
  Colors colors{channel.template operator()<0>(), channel.template operator()<8>(),
                channel.template operator()<16>(), hn::Zero(f), hn::Zero(f)};
  if constexpr (with_weight) {
    colors.weight = channel.template operator()<24>();
    const VU least = hn::Min(hn::Min(t00, t10), hn::Min(t01, t11));
    colors.least = hn::ConvertTo(f, hn::BitCast(i32, hn::ShiftRight<24>(least)));
  }
  return colors;
}

// A node's disparities at two columns of a row of a face, which starts at `row`: both at the same
// texel, or beside each other.
HWY_INLINE void load_disparities(const SoftwareNode& node, VI row, const VI (&column)[2],
                                 VF (&out)[2]) {
  const F f;
  const I i32;
  const VI left = hn::Min(column[0], hn::Set(i32, std::max(node.mesh.face_size - 2, 0)));
  VF pair[2];
  load_two(f, node.disparity.data(), i32, hn::Add(row, left), pair);
  for (int k = 0; k < 2; ++k)
    out[k] = hn::IfThenElse(hn::RebindMask(f, hn::Eq(column[k], left)), pair[0], pair[1]);
}

// The identifiers of a node's nearest texels.
HWY_INLINE VU find_objects(const SoftwareNode& node, const TexelPoints& at) {
  const F f;
  const I i32;
  const U u32;
  const int size = node.mesh.face_size;
  const VF half = hn::Set(f, 0.5f), most = hn::Set(f, float(size - 1));
  const auto texel = [&](VF place) {
    return hn::ConvertTo(i32, limited(hn::Sub(place, half), most));
  };
  const VI row = hn::Add(hn::Mul(at.face, hn::Set(i32, size)), texel(at.v));
  return hn::GatherIndex(u32, node.object.data(),
                         hn::Add(hn::Mul(row, hn::Set(i32, size)), texel(at.u)));
}

// Calls visit(node, mask) for each node of which a wanted lane shows a triangle.
template <class Visit>
HWY_INLINE void for_nodes(const NodeLayer& layer, VU triangle, MF wanted, const Visit& visit) {
  const F f;
  if (layer.nodes() == 1) {
    visit(*layer.drawn(0).node, wanted);
    return;
  }
  const U u32;
  const VU of = hn::GatherIndex(u32, &layer.triangles()[0].node, index_of(triangle, wanted));
  for (std::size_t n = 0; n < layer.nodes(); ++n) {
    const MF its = hn::And(wanted, hn::RebindMask(f, hn::Eq(of, hn::Set(u32, std::uint32_t(n)))));
    if (!hn::AllFalse(f, its)) visit(*layer.drawn(n).node, its);
  }
}

// The colours of the wanted lanes' triangles, at least one.
template <bool with_weight = false>
HWY_INLINE Colors shade(const NodeLayer& layer, VU triangle, MF wanted, const TexelPoints& points) {
  const F f;
  if (layer.nodes() == 1) return find_colors<with_weight>(*layer.drawn(0).node, points);
  Colors colors{hn::Zero(f), hn::Zero(f), hn::Zero(f), hn::Zero(f), hn::Zero(f)};
  for_nodes(layer, triangle, wanted, [&](const SoftwareNode& node, MF its) {
    const Colors found = find_colors<with_weight>(node, points);
    colors.r = hn::IfThenElse(its, found.r, colors.r);
    colors.g = hn::IfThenElse(its, found.g, colors.g);
    colors.b = hn::IfThenElse(its, found.b, colors.b);
    if constexpr (with_weight) {
      colors.weight = hn::IfThenElse(its, found.weight, colors.weight);
      colors.least = hn::IfThenElse(its, found.least, colors.least);
    }
  });
  return colors;
}

HWY_INLINE VU bytes_of(const Colors& colors) {
  const F f;
  const I i32;
  const U u32;
  const auto byte = [&](VF value) {
    return hn::BitCast(
        u32, hn::ConvertTo(i32, hn::Add(limited(value, hn::Set(f, 255.0f)), hn::Set(f, 0.5f))));
  };
  return hn::Or(hn::Or(hn::Set(u32, 0xff000000u), byte(colors.r)),
                hn::Or(hn::ShiftLeft<8>(byte(colors.g)), hn::ShiftLeft<16>(byte(colors.b))));
}

// What a tile holds of the wanted lanes' triangles.
HWY_INLINE VU find_content(const PlacedNodes& placed, const NodeLayer& layer, TileContent of,
                           VU triangle, MF wanted, const TexelPoints& points) {
  const U u32;
  if (of == TileContent::color) return bytes_of(shade(layer, triangle, wanted, points));
  if (placed.object != kNoObject) return hn::Set(u32, placed.object);
  VU content = hn::Set(u32, 1u);
  for_nodes(layer, triangle, wanted, [&](const SoftwareNode& node, MF its) {
    if (!node.object.empty())
      content = hn::IfThenElse(hn::RebindMask(u32, its), find_objects(node, points), content);
  });
  return content;
}
