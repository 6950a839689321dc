// A number for each of several lanes, so that formulas can be read. Nothing is fused: the same
// bytes on every machine. Included once for each instruction set, within HWY_NAMESPACE.

using F = hn::CappedTag<float, 16>;

struct N {
  hn::Vec<F> v;
  HWY_INLINE N(hn::Vec<F> v) : v(v) {}
  HWY_INLINE N(float x) : v(hn::Set(F(), x)) {}
};
HWY_INLINE N operator+(N a, N b) { return hn::Add(a.v, b.v); }
HWY_INLINE N operator-(N a, N b) { return hn::Sub(a.v, b.v); }
HWY_INLINE N operator*(N a, N b) { return hn::Mul(a.v, b.v); }
HWY_INLINE N operator/(N a, N b) { return hn::Div(a.v, b.v); }
HWY_INLINE N min(N a, N b) { return hn::Min(a.v, b.v); }
HWY_INLINE N max(N a, N b) { return hn::Max(a.v, b.v); }
HWY_INLINE N clamp(N a, float low, float high) { return min(max(a, low), high); }
HWY_INLINE N sqrt(N a) { return hn::Sqrt(a.v); }
HWY_INLINE N less_then(N a, N b, N yes, N no) {
  return hn::IfThenElse(hn::Lt(a.v, b.v), yes.v, no.v);
}

struct N3 {
  N x, y, z;
  HWY_INLINE N3(N x, N y, N z) : x(x), y(y), z(z) {}
  HWY_INLINE N3(const glm::vec3& v) : x(v.x), y(v.y), z(v.z) {}
};
HWY_INLINE N3 operator+(const N3& a, const N3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE N3 operator-(const N3& a, const N3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE N3 operator*(const N3& a, const N3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
HWY_INLINE N3 operator*(N a, const N3& b) { return {a * b.x, a * b.y, a * b.z}; }
HWY_INLINE N dot(const N3& a, const N3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE N3 cross(const N3& a, const N3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE N3 mix(const N3& a, const N3& b, N t) { return a + t * (b - a); }
HWY_INLINE N3 normalize(const N3& a) { return N(1.0f) / sqrt(dot(a, a)) * a; }
