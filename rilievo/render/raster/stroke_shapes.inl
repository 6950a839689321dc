// The shapes of points and lines in a picture, a template over the number T (several lanes, or one
// float). Included within a namespace that has the numbers and shading_model.inl.
//
// A point of radius r is a disc that faces the eye. With its centre c = w (X, Y, 1) in the camera's
// axes, m = X^2 + Y^2 + 1 = |c|^2 / w^2, and a sample's ray d = (X + u, Y + v, 1):
//
//   tan^2(c, d) = |c x d|^2 / (c.d)^2 <= r^2 / |c|^2
//   u^2 + v^2 + (u Y - v X)^2 <= (r / w)^2 / m (m + u X + v Y)^2
//
// It lies on the plane c.p = |c|^2, where 1 / z = (1 / w) (1 + (u X + v Y) / m): affine over the
// raster, as window_z is. With X = Y = 0 the same is a disc of pixels, or of a parallel camera.
//
// A line covers what is nearer than half its width to the segment between its ends in the raster.
// Where a sample lies halfway between two rows, one of them has it; a 4096th of a texel closes what
// rounding might leave open.

template <class T>
struct Disc {
  T x, y;  // of the centre
  T tilt_x, tilt_y, m, reach2;
  T z, z_per_x, z_per_y;
  float unit_x = 1, unit_y = 1;  // u and v of a texel
  bool clamps = false;           // what lies before the near plane is drawn on it

  [[nodiscard]] auto covers(T at_x, T at_y) const {
    const T u = T(unit_x) * (at_x - x), v = T(unit_y) * (at_y - y);
    const T turned = u * tilt_y - v * tilt_x;
    const T along = max(m + (u * tilt_x + v * tilt_y), T(0.0f));
    const auto within = u * u + v * v + turned * turned <= reach2 * (along * along);
    return within & (T(clamps ? -1e30f : 0.0f) <= plane(at_x, at_y));
  }
  [[nodiscard]] T depth(T at_x, T at_y) const { return max(plane(at_x, at_y), T(0.0f)); }

 private:
  [[nodiscard]] T plane(T at_x, T at_y) const {
    return (z + z_per_y * (at_y - y)) + z_per_x * (at_x - x);
  }
};

template <class T>
struct Line {
  T x, y, along_x, along_y, per_length2;  // from one end to the other
  T z, z_along;
  float radius = 0.5f;

  // How far along, from 0 to 1?
  [[nodiscard]] T share(T at_x, T at_y) const {
    return clamp(per_length2 * ((at_x - x) * along_x + (at_y - y) * along_y), 0.0f, 1.0f);
  }
  [[nodiscard]] auto covers(T at_x, T at_y) const {
    constexpr float kRounding = 1.0f / 4096;
    const T s = share(at_x, at_y);
    const T off_x = (at_x - x) - s * along_x, off_y = (at_y - y) - s * along_y;
    // Any direction that is at right angles to no line that people draw.
    const auto above = T(0.0f) < off_y + T(0.381966f) * off_x;
    const T reach = select(above, T(radius + 2 * kRounding), T(radius - kRounding));
    return off_x * off_x + off_y * off_y <= reach * reach;
  }
  [[nodiscard]] T depth(T at_x, T at_y) const {
    return max(z + share(at_x, at_y) * z_along, T(0.0f));
  }
};

// How far a primitive reaches: its box in the raster, and its nearest depth. `w`: of a point's
// centre; only those beyond RasterInstance::min_w are drawn.
template <class T>
struct StrokeReach {
  T x0, y0, x1, y1, z_min, w;
};

template <class T>
T row_at(const glm::vec4& row, const Vec3<T>& p) {
  return T(row.x) * p.x + T(row.y) * p.y + (T(row.z) * p.z + T(row.w));
}

// The disc of a point at p, mesh space.
template <class T>
StrokeReach<T> make_disc(const RasterInstance& instance, const Vec3<T>& p, Disc<T>& out) {
  const RasterStrokes& strokes = instance.strokes;
  const T w = row_at(instance.row_w, p), per_w = T(1.0f) / w;
  out.x = per_w * row_at(instance.row_x, p), out.y = per_w * row_at(instance.row_y, p);
  out.z = per_w * row_at(instance.row_z, p);
  out.tilt_x = out.tilt_y = out.z_per_x = out.z_per_y = T(0.0f), out.m = T(1.0f);
  out.clamps = strokes.clamps;
  T far_x(strokes.radius_px), far_y(strokes.radius_px), drop(0.0f);
  out.reach2 = far_x * far_x;
  if (strokes.radius > 0) {
    out.unit_x = 1 / strokes.per_unit.x, out.unit_y = 1 / strokes.per_unit.y;
    T radius(strokes.radius);
    far_x = T(strokes.radius * strokes.per_unit.x), far_y = T(strokes.radius * strokes.per_unit.y);
    if (!strokes.parallel) {
      radius = radius * per_w;
      out.tilt_x = T(out.unit_x) * out.x + T(strokes.corner.x);
      out.tilt_y = T(out.unit_y) * out.y + T(strokes.corner.y);
      const T x2 = out.tilt_x * out.tilt_x, y2 = out.tilt_y * out.tilt_y;
      out.m = T(1.0f) + x2 + y2;
      const T per_m = T(1.0f) / out.m, slope = T(strokes.z_per_inverse_w) * per_w * per_m;
      out.z_per_x = T(out.unit_x) * (slope * out.tilt_x);
      out.z_per_y = T(out.unit_y) * (slope * out.tilt_y);
      // A point of the rim is c + r e with |e| = 1 at right angles to c: e_z^2 <= 1 - 1 / m.
      const T deep = radius * sqrt(max(T(1.0f) - per_m, T(0.0f)));
      const T nearer = T(1.0f) / max(T(1.0f) - deep, T(0.05f));
      far_x = far_x * per_w * sqrt(T(1.0f) + x2) * nearer;
      far_y = far_y * per_w * sqrt(T(1.0f) + y2) * nearer;
      const T fall_x = out.z_per_x * far_x, fall_y = out.z_per_y * far_y;
      drop = max(fall_x, T(0.0f) - fall_x) + max(fall_y, T(0.0f) - fall_y);
      out.reach2 = radius * radius * per_m;
    } else {
      out.reach2 = radius * radius;
    }
  }
  return {
      out.x - far_x, out.y - far_y, out.x + far_x, out.y + far_y, max(out.z - drop, T(0.0f)), w};
}

// The line between p and q, mesh space, cut at the near plane and some way outside of the frame of
// width x height texels, where single precision would not suffice. Where nothing is left the box is
// empty.
template <class T>
StrokeReach<T> make_line(const RasterInstance& instance, float width, float height,
                         const Vec3<T>& p, const Vec3<T>& q, Line<T>& out) {
  struct End {
    T x, y, z, w;
  };
  const auto place = [&](const Vec3<T>& at) {
    return End{row_at(instance.row_x, at), row_at(instance.row_y, at), row_at(instance.row_z, at),
               row_at(instance.row_w, at)};
  };
  const End a = place(p), b = place(q);
  constexpr float kMargin = 64;  // texels
  T from(0.0f), to(1.0f);
  const auto cut = [&](T of_a, T of_b) {
    const auto a_out = of_a < T(0.0f), b_out = of_b < T(0.0f);
    const T crossing = of_a / (of_a - of_b);
    // Where both are outside, `to` falls below `from`.
    from = select(a_out, select(b_out, T(2.0f), max(from, crossing)), from);
    to = select(a_out, to, select(b_out, min(to, crossing), to));
  };
  const float least_w = std::max(instance.min_w, 1e-30f);
  cut(a.w - T(least_w), b.w - T(least_w));
  cut(a.x + T(kMargin) * a.w, b.x + T(kMargin) * b.w);
  cut(T(width + kMargin) * a.w - a.x, T(width + kMargin) * b.w - b.x);
  cut(a.y + T(kMargin) * a.w, b.y + T(kMargin) * b.w);
  cut(T(height + kMargin) * a.w - a.y, T(height + kMargin) * b.w - b.y);
  const auto end = [&](T share) {
    const auto of = [&](T at_a, T at_b) {
      return select(T(0.0f) < share, select(share < T(1.0f), at_a + share * (at_b - at_a), at_b),
                    at_a);
    };
    const T per_w = T(1.0f) / max(of(a.w, b.w), T(1e-30f));
    return End{per_w * of(a.x, b.x), per_w * of(a.y, b.y), per_w * of(a.z, b.z), per_w};
  };
  const End first = end(from), last = end(to);
  out.x = first.x, out.y = first.y, out.along_x = last.x - first.x, out.along_y = last.y - first.y;
  const T length2 = out.along_x * out.along_x + out.along_y * out.along_y;
  out.per_length2 = select(T(1e-12f) < length2, T(1.0f) / length2, T(0.0f));
  out.z = first.z, out.z_along = last.z - first.z;
  out.radius = instance.strokes.radius_px;
  const T far(out.radius + 0.001f);
  const auto left = from <= to;
  const auto kept = [&](T v, float otherwise) { return select(left, v, T(otherwise)); };
  return {kept(min(first.x, last.x) - far, 1e30f),  kept(min(first.y, last.y) - far, 1e30f),
          kept(max(first.x, last.x) + far, -1e30f), kept(max(first.y, last.y) + far, -1e30f),
          max(min(first.z, last.z), T(0.0f)),       T(1e30f)};
}
