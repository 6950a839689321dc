// How light leaves a surface: the shading model of processors, a template over the number T (float,
// double, or several lanes). render/opengl/scene_shaders.cpp is the same in GLSL, pinned to this
// one by tests, feature by feature.
//
// Metallic-roughness shading after appendix B of the glTF 2.0 specification: GGX distribution,
// Smith visibility, Schlick's Fresnel; ambient light from a two-colour sky, its mirror part by the
// approximation of [Karis 2014, Physically Based Shading on Mobile]. Normal maps after [Schueler
// 2013, Normal Mapping Without Precomputed Tangents]. Texture levels as OpenGL 4.5 has them (8.14).
//
// Included within a namespace that has the numbers (simd_numbers.inl, scalar_numbers.inl).

template <class T>
using IntOf = typename IntOfNumber<T>::type;

template <class T>
struct Vec3 {
  T x, y, z;
  Vec3() = default;
  Vec3(T x, T y, T z) : x(x), y(y), z(z) {}
  Vec3(const glm::vec3& v) : x(v.x), y(v.y), z(v.z) {}
};
template <class T>
Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
Vec3<T> operator*(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T>
Vec3<T> operator*(T a, const Vec3<T>& b) {
  return {a * b.x, a * b.y, a * b.z};
}
template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
Vec3<T> mix(const Vec3<T>& a, const Vec3<T>& b, T t) {
  return a + t * (b - a);
}
template <class T>
Vec3<T> normalize(const Vec3<T>& a) {
  return T(1.0f) / sqrt(dot(a, a)) * a;
}
template <class T, class Mask>
Vec3<T> select(Mask m, const Vec3<T>& yes, const Vec3<T>& no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

template <class T>
struct Vec2 {
  T x, y;
};
template <class T>
struct Vec4 {
  T x, y, z, w;
};
template <class T>
Vec4<T> mix(const Vec4<T>& a, const Vec4<T>& b, T t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z),
          a.w + t * (b.w - a.w)};
}
template <class T>
T mix(T a, T b, T t) {
  return a + t * (b - a);
}

template <class T>
T smoothstep(T from, T to, T x) {
  const T t = clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (T(3.0f) - T(2.0f) * t);
}

// 2^x for x in [-126, 0]: 2 to a whole number times a Taylor series for what is left, which is at
// most a half: to 3e-6.
template <class T>
T exp2(T x) {
  const T whole = round(x), r = x - whole;
  const T series =
      T(1.0f) +
      r * (T(0.69314718f) +
           r * (T(0.24022651f) + r * (T(0.05550411f) + r * (T(0.00961813f) + r * T(0.00133336f)))));
  return series * power_of_two(x, to_int(whole));
}

// The logarithm of x > 0, normal: of m in [1, 2) as 2 artanh((m - 1) / (m + 1)), to 2e-5 at 2; and
// a level of a texture is not asked for more closely.
template <class T>
T log2(T x) {
  IntOf<T> whole;
  const T m = split_power(x, whole);
  const T s = (m - T(1.0f)) / (m + T(1.0f)), s2 = s * s;
  const T series =
      s *
      (T(2.88539008f) +
       s2 * (T(0.96179669f) + s2 * (T(0.57707802f) + s2 * (T(0.41219858f) + s2 * T(0.32059890f)))));
  return series + to_number(x, whole);
}

// As shader::kSrgbFromLinear.
template <class T>
T srgb_from_linear(T c) {
  c = clamp(c, 0.0f, 1.0f);
  const T s = sqrt(c);
  const T curve =
      (((T(-0.30957186f) * s + T(0.84279114f)) * s - T(0.94486092f)) * s + T(1.44789933f)) * s -
      T(0.03700467f);
  return select(c < T(0.0031308f), T(12.92f) * c, curve);
}

// The light of which srgb_from_linear() makes c, 0 <= c <= 1.
template <class T>
T linear_from_srgb(T c) {
  const T base = T(1.0f / 1.055f) * (c + T(0.055f));
  return select(c < T(0.04045f), T(1.0f / 12.92f) * c, exp2(T(2.4f) * log2(base)));
}

// --- Textures -----------------------------------------------------------------------------------

// A texture coordinate brought to where texels are; from far away a number keeps no fraction.
template <class T>
T wrapped(Wrap wrap, T u) {
  switch (wrap) {
    case Wrap::repeat:
      return u - floor(u);
    case Wrap::mirrored_repeat: {
      const T m = u - T(2.0f) * floor(T(0.5f) * u);
      return min(m, T(2.0f) - m);
    }
    case Wrap::clamp_to_edge:
      break;
  }
  return clamp(u, 0.0f, 1.0f);
}

// An index of a texel beside the texture's edge, whatever it is, brought into [0, size).
template <class I>
I wrapped_index(Wrap wrap, I i, I size) {
  const I last = size - I(1);
  if (wrap != Wrap::repeat) return min(max(i, I(0)), last);
  const I turned = select(i < I(0), last, select(i < size, i, I(0)));
  return min(max(turned, I(0)), last);
}

// linear_from_srgb() of a byte over 255, but for a hundredth of what the next byte has more:
// cheaper than that, and than gathering from linear_of_srgb_bytes().
template <class T>
T linear_from_srgb_byte(T c) {
  const T curve =
      ((((T(0.0855915572f) * c - T(0.303294405f)) * c + T(0.663691183f)) * c + T(0.520620797f)) *
           c +
       T(0.0325712813f)) *
          c +
      T(0.000924244697f);
  return select(c < T(0.04045f), T(1.0f / 12.92f) * c, curve);
}

// What a texel's four bytes say: linear light and alpha ...
template <class T>
struct DecodeColor {
  bool srgb;  // or bytes are linear
  Vec4<T> operator()(IntOf<T> texel) const {
    const auto part = [&](IntOf<T> byte) {
      const T c = to_number(T(0.0f), byte) * T(1.0f / 255.0f);
      return srgb ? linear_from_srgb_byte(c) : c;
    };
    return {part(byte_of<0>(texel)), part(byte_of<1>(texel)), part(byte_of<2>(texel)),
            to_number(T(0.0f), byte_of<3>(texel)) * T(1.0f / 255.0f)};
  }
};
// ... or alpha alone.
template <class T>
struct DecodeAlpha {
  T operator()(IntOf<T> texel) const {
    return to_number(T(0.0f), byte_of<3>(texel)) * T(1.0f / 255.0f);
  }
};

// One level of the texture, by a level for each lane. `u`, `v`: wrapped. `sharp`: not interpolated.
template <class T, class Decode, class Mask>
auto sample_level(const TextureLevels& t, T u, T v, IntOf<T> level, Mask sharp,
                  const Decode& decode) {
  using Int = IntOf<T>;
  const Int width = max(shift_right(Int(t.width), level), Int(1)),
            height = max(shift_right(Int(t.height), level), Int(1));
  const T x = u * to_number(u, width), y = v * to_number(v, height);
  const T left = floor(select(sharp, x, x - T(0.5f))), top = floor(select(sharp, y, y - T(0.5f)));
  const T right_part = select(sharp, T(0.0f), x - T(0.5f) - left);
  const T lower_part = select(sharp, T(0.0f), y - T(0.5f) - top);
  const Int x0 = wrapped_index(t.wrap_u, to_int(left), width),
            x1 = wrapped_index(t.wrap_u, to_int(left) + Int(1), width);
  const Int y0 = wrapped_index(t.wrap_v, to_int(top), height) * width,
            y1 = wrapped_index(t.wrap_v, to_int(top) + Int(1), height) * width;
  // Level 0 lies apart from the others.
  const auto smaller = Int(0) < level;
  const Int offset = gather(t.offset, level);
  const bool any_smaller = any(smaller), all_smaller = all(smaller);
  const auto fetch = [&](Int at) {
    if (!any_smaller) return gather(t.texels, at);
    if (all_smaller) return gather(t.smaller, at + offset);
    return select(smaller, gather(t.smaller, select(smaller, at + offset, Int(0))),
                  gather(t.texels, select(smaller, Int(0), at)));
  };
  const auto upper = mix(decode(fetch(y0 + x0)), decode(fetch(y0 + x1)), right_part);
  const auto lower = mix(decode(fetch(y1 + x0)), decode(fetch(y1 + x1)), right_part);
  return mix(upper, lower, lower_part);
}

// Between the two levels around `level`; 0 and below: the texture itself, magnified.
template <class T, class Decode>
auto sample_texture(const TextureLevels& t, const Vec2<T>& uv, T level, const Decode& decode) {
  using Int = IntOf<T>;
  const T u = wrapped(t.wrap_u, uv.x), v = wrapped(t.wrap_v, uv.y);
  const T at = clamp(level, 0.0f, float(t.count - 1));
  // Whole numbers are clamped again: what is no number may come out as any.
  const Int last(t.count - 1), first = min(max(to_int(at), Int(0)), last);
  const T between = at - to_number(at, first);
  const auto never = T(0.0f) < T(0.0f);
  const auto sharp = t.nearest ? level <= T(0.0f) : never;
  const auto nearer = sample_level(t, u, v, first, sharp, decode);
  if (!any(T(0.0f) < between)) return nearer;
  const auto farther = sample_level(t, u, v, min(first + Int(1), last), never, decode);
  return mix(nearer, farther, between);
}

// Texture coordinates at a texel, and how they change from one to the next.
template <class T>
struct Footprint {
  Vec2<T> uv, per_x, per_y;
};

template <class T>
Footprint<T> transformed(const SurfaceTexture& texture, const Footprint<T>& of_mesh) {
  const glm::vec3 &u = texture.row_u, &v = texture.row_v;
  const auto turned = [&](const Vec2<T>& d) {
    return Vec2<T>{T(u.x) * d.x + T(u.y) * d.y, T(v.x) * d.x + T(v.y) * d.y};
  };
  Footprint<T> out{turned(of_mesh.uv), turned(of_mesh.per_x), turned(of_mesh.per_y)};
  out.uv.x = out.uv.x + T(u.z), out.uv.y = out.uv.y + T(v.z);
  return out;
}

// The level whose texels are as large as the picture's, by the longer one of its sides.
template <class T>
T level_of(const TextureLevels& t, const Footprint<T>& at) {
  const T width(float(t.width)), height(float(t.height));
  const auto squared = [&](const Vec2<T>& d) {
    const T x = width * d.x, y = height * d.y;
    return x * x + y * y;
  };
  // Within what a float holds as a normal number.
  const T longest = clamp(max(squared(at.per_x), squared(at.per_y)), 1e-30f, 1e30f);
  return T(0.5f) * log2(longest);
}

template <class T>
Vec4<T> sample_color(const SurfaceTexture& texture, const Footprint<T>& of_mesh) {
  const Footprint<T> at = transformed(texture, of_mesh);
  return sample_texture(texture.levels, at.uv, level_of(texture.levels, at),
                        DecodeColor<T>{texture.levels.srgb});
}

template <class T>
T sample_alpha(const SurfaceTexture& texture, const Footprint<T>& of_mesh) {
  const Footprint<T> at = transformed(texture, of_mesh);
  return sample_texture(texture.levels, at.uv, level_of(texture.levels, at), DecodeAlpha<T>{});
}

// --- A surface ----------------------------------------------------------------------------------

// Where a ray of the picture meets a triangle: its weights of the corners, and how they change from
// texel to texel.
template <class T>
struct Weights {
  T at[3], per_x[3], per_y[3];
};

// A triangle's corners in mesh space, as far as the mesh has them.
template <class T>
struct Corners {
  Vec3<T> position[3], normal[3], color[3];
  T alpha[3] = {};  // of the colours; of materials that blend
  Vec2<T> uv[2][3];
};

// What there is to be shaded.
template <class T>
struct SurfacePoint {
  Vec3<T> base;
  Vec3<T> normal;    // of any length, towards the side that is seen
  Vec3<T> relative;  // position relative to the eye
  Vec3<T> view;      // the way to who sees it, unit
  Vec3<T> emissive;
  T roughness, metallic, occlusion;
  T lit;    // 1; or 0: the base colour as it is
  T alpha;  // 1 unless the material blends
};

template <class T>
T mixed(const Weights<T>& w, const T (&v)[3]) {
  return w.at[0] * v[0] + w.at[1] * v[1] + w.at[2] * v[2];
}
template <class T>
Vec3<T> mixed(const Weights<T>& w, const Vec3<T> (&v)[3]) {
  return w.at[0] * v[0] + w.at[1] * v[1] + w.at[2] * v[2];
}
template <class T>
Footprint<T> footprint(const Weights<T>& w, const Vec2<T> (&uv)[3]) {
  const auto mixed = [&](const T(&w)[3]) {
    return Vec2<T>{w[0] * uv[0].x + w[1] * uv[1].x + w[2] * uv[2].x,
                   w[0] * uv[0].y + w[1] * uv[1].y + w[2] * uv[2].y};
  };
  return {mixed(w.at), mixed(w.per_x), mixed(w.per_y)};
}

// A ray divides the triangle a, b, c (relative to the eye) as the volumes that it spans with two
// corners each; of a ray that passes by, the nearest point of the triangle, nearly. `ray`: of rays
// that meet in the eye, the way; of parallel ones, where it starts.
template <class T>
Weights<T> weights_of(const PictureRays& rays, const Vec3<T>& ray, const Vec3<T>& a,
                      const Vec3<T>& b, const Vec3<T>& c, const Vec3<T>& facing,
                      bool with_changes) {
  Vec3<T> of_a, of_b, of_c, along = ray;
  T u, v, w, sign;
  if (rays.parallel) {
    // From where the ray starts: (b - o) x (c - o) . d = (b - o) . ((c - b) x d).
    along = Vec3<T>(rays.axis);
    of_a = cross(along, c - b), of_b = cross(along, a - c), of_c = cross(along, b - a);
    sign = select(dot(along, facing) < T(0.0f), T(-1.0f), T(1.0f));
    u = max(sign * dot(ray - b, of_a), T(0.0f)), v = max(sign * dot(ray - c, of_b), T(0.0f)),
    w = max(sign * dot(ray - a, of_c), T(0.0f));
  } else {
    of_a = cross(b, c), of_b = cross(c, a), of_c = cross(a, b);
    sign = select(dot(ray, facing) < T(0.0f), T(-1.0f), T(1.0f));
    u = max(sign * dot(ray, of_a), T(0.0f)), v = max(sign * dot(ray, of_b), T(0.0f)),
    w = max(sign * dot(ray, of_c), T(0.0f));
  }
  const T sum = u + v + w;
  const auto meets = T(0.0f) < sum;
  const T per_sum = select(meets, T(1.0f) / sum, T(0.0f));
  Weights<T> out;
  out.at[0] = per_sum * u, out.at[1] = per_sum * v;
  out.at[2] = select(meets, per_sum * w, T(1.0f));
  if (!with_changes) return out;
  // Of U / S: (U' - (U / S) S') / S.
  const auto changes = [&](const glm::vec3& step, T(&to)[3]) {
    const Vec3<T> by = sign * Vec3<T>(rays.footprint * step);
    const T du = dot(by, of_a), dv = dot(by, of_b), dw = dot(by, of_c), ds = du + dv + dw;
    to[0] = per_sum * (du - out.at[0] * ds), to[1] = per_sum * (dv - out.at[1] * ds);
    to[2] = per_sum * (dw - out.at[2] * ds);
  };
  changes(rays.per_x, out.per_x);
  changes(rays.per_y, out.per_y);
  return out;
}

// The map's normal, around `n` (unit). The frame in which the texture's coordinates grow follows
// from any two ways along the triangle: from its first corner to the others where those turn
// counter-clockwise around n, else the other way about (e1, e2).
template <class T>
Vec3<T> mapped_normal(const SurfaceMaterial& material, const Vec3<T>& n, const Vec3<T>& e1,
                      const Vec3<T>& e2, const Vec2<T>& uv1, const Vec2<T>& uv2,
                      const Footprint<T>& of_mesh) {
  const Vec3<T> a = cross(e2, n), b = cross(n, e1);
  const Vec3<T> tangent = uv1.x * a + uv2.x * b, bitangent = uv1.y * a + uv2.y * b;
  const T longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
  const Vec4<T> texel = sample_color(*material.normal, of_mesh);
  const T scale(material.normal_scale);
  const T x = scale * (T(2.0f) * texel.x - T(1.0f)), y = scale * (T(2.0f) * texel.y - T(1.0f));
  const T z = T(2.0f) * texel.z - T(1.0f);
  const auto has_frame = T(0.0f) < longest;
  const T per_longest = T(1.0f) / sqrt(select(has_frame, longest, T(1.0f)));
  // glTF's texture v grows downwards as the bitangent grows upwards.
  const Vec3<T> mapped = per_longest * (x * tangent - y * bitangent) + z * n;
  return select(has_frame, normalize(mapped), n);
}

template <class T>
SurfacePoint<T> surface_at(const PictureRays& rays, const SurfacePlacement& placement,
                           const Vec3<T>& ray, const Corners<T>& in) {
  const SurfaceMaterial& material = *placement.material;
  const glm::mat4& m = placement.relative_from_mesh;
  const glm::mat3& normals = placement.normal_from_mesh;
  const auto place = [&](const Vec3<T>& p) {
    return p.x * Vec3<T>(glm::vec3(m[0])) + p.y * Vec3<T>(glm::vec3(m[1])) +
           (p.z * Vec3<T>(glm::vec3(m[2])) + Vec3<T>(glm::vec3(m[3])));
  };
  const Vec3<T> a = place(in.position[0]), b = place(in.position[1]), c = place(in.position[2]);
  const Vec3<T> facing = cross(b - a, c - a);
  const Weights<T> w = weights_of(rays, ray, a, b, c, facing, material.textured);
  SurfacePoint<T> out;
  out.relative = w.at[0] * a + w.at[1] * b + w.at[2] * c;
  // The way of who sees it: from an apex behind the objects, towards it.
  const Vec3<T> along = rays.parallel       ? Vec3<T>(rays.axis)
                        : rays.towards_apex ? T(-1.0f) * out.relative
                                            : out.relative;
  Vec3<T> n = facing;
  if (placement.has_normals) {
    const Vec3<T> of_mesh = mixed(w, in.normal);
    n = of_mesh.x * Vec3<T>(normals[0]) + of_mesh.y * Vec3<T>(normals[1]) +
        of_mesh.z * Vec3<T>(normals[2]);
    // What the placement flattens has no normal where it stood upright: the triangle's.
    n = select(T(1e-30f) < dot(n, n), n, facing);
  }
  // Both sides of a thin sheet are lit as seen. Which side that is, the triangle says: at a
  // silhouette the smooth normal of a visible face may already point away.
  n = select(T(0.0f) < dot(facing, along) * dot(facing, n), T(-1.0f), T(1.0f)) * n;
  out.base = Vec3<T>(glm::vec3(material.base_color));
  out.alpha = T(material.blended ? material.base_color.a : 1.0f);
  if (placement.has_colors) {
    out.base = out.base * mixed(w, in.color);
    if (material.blended) out.alpha = out.alpha * mixed(w, in.alpha);
  }

  // Seen along its axis, not along its rays, see scene_shaders.cpp.
  if (rays.towards_apex) {
    const Vec3<T> axis(rays.axis), unit = normalize(n);
    out.view = normalize(axis + max(T(0.0f), T(0.17f) - dot(unit, axis)) * unit);
  } else if (rays.parallel) {
    out.view = T(-1.0f) * Vec3<T>(rays.axis);
  } else {
    out.view = T(-1.0f) * normalize(out.relative);
  }
  out.emissive = Vec3<T>(material.emissive);
  out.roughness = T(material.roughness), out.metallic = T(material.metallic);
  out.occlusion = T(1.0f);
  out.lit = T(placement.unlit ? 0.0f : 1.0f);
  if (material.textured) {
    Footprint<T> of_set[2];
    for (int set = 0; set < 2; ++set)
      if (material.uses_uv[set]) of_set[set] = footprint(w, in.uv[set]);
    const auto sample = [&](const SurfaceTexture& texture) {
      return sample_color(texture, of_set[texture.uv_set]);
    };
    if (material.base) {
      const Vec4<T> texel = sample(*material.base);
      out.base = out.base * Vec3<T>(texel.x, texel.y, texel.z);
      if (material.blended) out.alpha = out.alpha * texel.w;
    }
    if (material.metallic_roughness) {
      const Vec4<T> texel = sample(*material.metallic_roughness);
      out.roughness = out.roughness * texel.y, out.metallic = out.metallic * texel.z;
    }
    if (material.occlusion)
      out.occlusion =
          T(1.0f) + T(material.occlusion_strength) * (sample(*material.occlusion).x - T(1.0f));
    if (material.emission) {
      const Vec4<T> texel = sample(*material.emission);
      out.emissive = out.emissive * Vec3<T>(texel.x, texel.y, texel.z);
    }
    if (material.normal) {
      const SurfaceTexture& map = *material.normal;
      const Vec2<T>(&uv)[3] = in.uv[map.uv_set];
      const auto step = [&](int k) {
        const T x = uv[k].x - uv[0].x, y = uv[k].y - uv[0].y;
        return Vec2<T>{T(map.row_u.x) * x + T(map.row_u.y) * y,
                       T(map.row_v.x) * x + T(map.row_v.y) * y};
      };
      // (b - a) x (c - a) is `facing`.
      const T side = select(dot(facing, along) < T(0.0f), T(1.0f), T(-1.0f));
      n = mapped_normal(material, normalize(n), side * (b - a), side * (c - a), step(1), step(2),
                        of_set[map.uv_set]);
    }
  }
  if (placement.code_from_position) {
    // The linear light of the bytes that scene/position_colors.h defines.
    const glm::mat4x3& code = *placement.code_from_position;
    const Vec3<T> p = mixed(w, in.position);
    const Vec3<T> at = p.x * Vec3<T>(code[0]) + p.y * Vec3<T>(code[1]) +
                       (p.z * Vec3<T>(code[2]) + Vec3<T>(code[3]));
    const auto shown = [](T c) { return linear_from_srgb(wrapped(Wrap::mirrored_repeat, c)); };
    out.base = {shown(at.x), shown(at.y), shown(at.z)};
  }
  out.normal = n;
  return out;
}

// --- Light --------------------------------------------------------------------------------------

template <class T>
Vec3<T> sky_radiance(const Sky& sky, T elevation) {
  const Vec3<T> above =
      mix(Vec3<T>(sky.horizon), Vec3<T>(sky.zenith), sqrt(clamp(elevation, 0.0f, 1.0f)));
  return mix(above, Vec3<T>(sky.ground), smoothstep(T(0.0f), T(-0.08f), elevation));
}

// How much of the light's intensity arrives at a position relative to the eye, and the way to it.
template <class T>
T arrives(const Light& light, const glm::dvec3& eye, const Vec3<T>& relative, Vec3<T>& l) {
  l = Vec3<T>(-light.direction);
  if (light.kind == Light::Kind::directional) return T(1.0f);
  const Vec3<T> to = Vec3<T>(glm::vec3(glm::dvec3(light.position) - eye)) - relative;
  const T distance2 = max(dot(to, to), T(1e-6f));
  l = T(1.0f) / sqrt(distance2) * to;
  T strength(1.0f);
  if (light.kind == Light::Kind::spot)
    strength = smoothstep(T(std::cos(light.outer_cone)), T(std::cos(light.inner_cone)),
                          T(-1.0f) * dot(l, Vec3<T>(light.direction)));
  strength = strength / distance2;
  if (light.range > 0.0f) {
    const T r = distance2 / T(light.range * light.range);
    strength = strength * clamp(T(1.0f) - r * r, 0.0f, 1.0f);
  }
  return strength;
}

// Light that leaves the surface towards `v`, per unit of light that arrives from `l`, times n.l.
template <class T>
Vec3<T> reflected(const Vec3<T>& n, const Vec3<T>& v, const Vec3<T>& l, const Vec3<T>& diffuse,
                  const Vec3<T>& f0, T alpha2) {
  const T towards_l = dot(n, l), towards_v = dot(n, v);
  const T n_l = clamp(towards_l, 0.0f, 1.0f), n_v = clamp(towards_v, 1e-4f, 1.0f);
  // With h halfway between l and v, |l + v|^2 = 2 (1 + l.v) = 4 (v.h)^2, and n.h follows.
  const T v_h2 = clamp(T(0.5f) + T(0.5f) * dot(l, v), 1e-6f, 1.0f);
  const T up = max(towards_l + towards_v, T(0.0f));
  const T n_h2 = min(T(0.25f) * up * up / v_h2, T(1.0f));
  const T d = n_h2 * (alpha2 - T(1.0f)) + T(1.0f);
  const T masked = n_l * sqrt(n_v * n_v * (T(1.0f) - alpha2) + alpha2) +
                   n_v * sqrt(n_l * n_l * (T(1.0f) - alpha2) + alpha2) + T(1e-5f);
  constexpr float kPerPi = std::numbers::inv_pi_v<float>;
  const T distribution_visibility = T(0.5f * kPerPi) * alpha2 / (d * d * masked);
  const T m = T(1.0f) - sqrt(v_h2), m2 = m * m;
  const Vec3<T> one(glm::vec3(1.0f));
  const Vec3<T> fresnel = f0 + (m2 * m2 * m) * (one - f0);
  return n_l * (T(kPerPi) * (diffuse * (one - fresnel)) + distribution_visibility * fresnel);
}

// How a point's material answers light: unit normal, view, and the terms of reflected().
template <class T>
struct Response {
  Vec3<T> n, v, diffuse, f0;
  T roughness, alpha2;
};
template <class T>
Response<T> response_of(const SurfacePoint<T>& in) {
  Response<T> out;
  out.n = normalize(in.normal);
  out.v = in.view;
  out.roughness = clamp(in.roughness, 0.045f, 1.0f);
  out.diffuse = (T(1.0f) - in.metallic) * in.base;
  out.f0 = mix(Vec3<T>(glm::vec3(0.04f)), in.base, in.metallic);
  const T alpha = out.roughness * out.roughness;
  out.alpha2 = alpha * alpha;
  return out;
}

// The sky's light from the hemisphere around n.
template <class T>
Vec3<T> hemisphere_of(const Sky& sky, const Vec3<T>& n) {
  return mix(Vec3<T>(sky.ground), Vec3<T>(0.5f * (sky.zenith + sky.horizon)),
             T(0.5f) + T(0.5f) * n.y);
}

// The share of the light from all around that leaves towards the view as from a mirror.
template <class T>
Vec3<T> mirror_share(const Response<T>& s, T n_v) {
  const T rx = T(1.0f) - s.roughness, ry = T(0.0425f) - T(0.0275f) * s.roughness;
  const T rz = T(1.04f) - T(0.572f) * s.roughness, rw = T(0.022f) * s.roughness - T(0.04f);
  const T a004 = min(rx * rx, exp2(T(-9.28f) * n_v)) * rx + ry;
  const T scale = T(-1.04f) * a004 + rz, bias = T(1.04f) * a004 + rw;
  // The approximation falls below 0 for rough black metals.
  return {max(scale * s.f0.x + bias, T(0.0f)), max(scale * s.f0.y + bias, T(0.0f)),
          max(scale * s.f0.z + bias, T(0.0f))};
}

// Linear light towards the view.
template <class T>
Vec3<T> shade_point(const SurfaceLights& lights, const SurfacePoint<T>& in) {
  const Sky& sky = lights.sky;
  const Response<T> s = response_of(in);
  Vec3<T> light = in.emissive;
  for (const Light& each : lights.lights) {
    Vec3<T> l;
    const T strength = arrives(each, lights.eye, in.relative, l);
    light = light + strength * (Vec3<T>(each.intensity) *
                                reflected(s.n, s.v, l, s.diffuse, s.f0, s.alpha2));
  }

  // The sky as ambient light: diffuse from the hemisphere around n, mirrored part by roughness.
  const Vec3<T> hemisphere = hemisphere_of(sky, s.n);
  const T towards_v = dot(s.n, s.v), n_v = clamp(towards_v, 0.0f, 1.0f);
  const Vec3<T> mirrored =
      mix(sky_radiance(sky, T(2.0f) * towards_v * s.n.y - s.v.y), hemisphere, s.roughness);
  const Vec3<T> ambient = T(0.6f) * (s.diffuse * hemisphere) + mirror_share(s, n_v) * mirrored;
  light = light + in.occlusion * ambient;
  return select(T(0.0f) < in.lit, light, in.base);
}
