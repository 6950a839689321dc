// float and double as numbers of the shading model (shading_model.inl): what simd_numbers.inl has
// for several lanes. float gives the same bytes as a lane.

template <class T>
struct IntOfNumber {
  using type = std::int32_t;
};

inline float min(float a, float b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }
inline float clamp(float a, float low, float high) { return min(max(a, low), high); }
inline float sqrt(float a) { return std::sqrt(a); }
inline float floor(float a) { return std::floor(a); }
inline float round(float a) { return std::nearbyint(a); }
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline double clamp(double a, float low, float high) {
  return min(max(a, double(low)), double(high));
}
inline double sqrt(double a) { return std::sqrt(a); }
inline double floor(double a) { return std::floor(a); }
inline double round(double a) { return std::nearbyint(a); }
inline std::int32_t min(std::int32_t a, std::int32_t b) { return a < b ? a : b; }
inline std::int32_t max(std::int32_t a, std::int32_t b) { return a > b ? a : b; }
inline bool any(bool a) { return a; }
inline bool all(bool a) { return a; }
inline float select(bool m, float yes, float no) { return m ? yes : no; }
inline double select(bool m, double yes, double no) { return m ? yes : no; }
inline std::int32_t select(bool m, std::int32_t yes, std::int32_t no) { return m ? yes : no; }
inline std::int32_t shift_right(std::int32_t a, std::int32_t by) { return a >> by; }
template <int k>
std::int32_t byte_of(std::int32_t a) {
  return std::int32_t(std::uint32_t(a) >> (8 * k) & 255u);
}
// Towards zero; what no integer holds becomes the least one, as on processors with SSE.
template <class T>
std::int32_t to_int(T a) {
  return a > T(-2147483648.0) && a < T(2147483648.0) ? std::int32_t(a) : INT32_MIN;
}
template <class T>
T to_number(T, std::int32_t a) {
  return T(a);
}
inline std::int32_t gather(const std::int32_t* base, std::int32_t at) {
  std::int32_t out;  // texels are bytes
  std::memcpy(&out, base + at, sizeof out);
  return out;
}
template <class T>
T power_of_two(T, std::int32_t whole) {
  return std::ldexp(T(1), whole);
}
template <class T>
T split_power(T a, std::int32_t& whole) {
  const T half = std::frexp(a, &whole);
  --whole;
  return 2 * half;
}
