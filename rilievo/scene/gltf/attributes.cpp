#include "rilievo/scene/gltf/attributes.h"

#include <algorithm>
#include <numeric>

#include "rilievo/core/expects.h"

namespace rilievo::gltf {
namespace {

enum Mode { points = 0, lines = 1, line_loop = 2, line_strip = 3, list = 4, strip = 5, fan = 6 };

// Section 3.7.2.1: triangle i of a strip is (i, i + 1 + i % 2, i + 2 - i % 2), of a fan (i + 1,
// i + 2, 0). Triangles that name a vertex twice are how strips are joined; they show nothing.
std::vector<std::uint32_t> triangles_of(const std::vector<std::uint32_t>& v, bool is_strip) {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 2 < v.size(); ++i) {
    const std::uint32_t a = is_strip ? v[i] : v[i + 1];
    const std::uint32_t b = is_strip ? v[i + 1 + i % 2] : v[i + 2];
    const std::uint32_t c = is_strip ? v[i + 2 - i % 2] : v[0];
    if (a == b || b == c || c == a) continue;
    out.insert(out.end(), {a, b, c});
  }
  return out;
}

// Pairs of a strip of lines, which a loop closes.
std::vector<std::uint32_t> lines_of(const std::vector<std::uint32_t>& v, bool closed) {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 1 < v.size(); ++i) out.insert(out.end(), {v[i], v[i + 1]});
  if (closed && v.size() > 2) out.insert(out.end(), {v.back(), v.front()});
  return out;
}

// The indices as the file has them, or 0 1 2 ... if it has none.
std::vector<std::uint32_t> read_indices(AttributeSource& source, const JsonValue& primitive) {
  Document& document = source.document;
  const JsonValue indices = primitive["indices"];
  if (!indices) {
    document.context->budget.take(source.vertices, sizeof(std::uint32_t));
    std::vector<std::uint32_t> all(source.vertices);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  const Accessor accessor =
      describe_accessor(document, indices.required_index(document.count("accessors")));
  expect_numbers(document, accessor, std::array{1});
  return read_integers(document, accessor);
}

}  // namespace

std::vector<std::uint32_t> read_corners(AttributeSource& source, const JsonValue& primitive,
                                        Primitive& kind) {
  LoadContext& context = *source.document.context;
  const std::uint64_t mode = primitive["mode"].whole(list);
  if (mode > fan) primitive["mode"].fail("is not a kind of primitive");
  kind = mode == points ? Primitive::points : mode < list ? Primitive::lines : Primitive::triangles;
  if (source.packed) return std::move(source.packed->indices);

  std::vector<std::uint32_t> indices = read_indices(source, primitive);
  for (std::uint32_t i : indices)
    if (i >= source.vertices)
      primitive["indices"].fail("refer to vertex " + std::to_string(i) +
                                but_there_are(source.vertices));
  if (mode == list || mode == lines || mode == points) {
    const std::uint32_t corners = corners_of(kind);
    if (indices.size() % corners != 0)
      context.warn(primitive.path() + " has corners left over that make no whole " +
                   (mode == list ? "triangle" : "line"));
    indices.resize(indices.size() / corners * corners);
    return indices;
  }
  if (kind == Primitive::lines) {
    context.budget.take(indices.size(), 2 * sizeof(std::uint32_t));
    return lines_of(indices, mode == line_loop);
  }
  context.budget.take(indices.size(), 3 * sizeof(std::uint32_t));
  return triangles_of(indices, mode == strip);
}

void use_only(AttributeSource& source, std::vector<std::uint32_t>& indices) {
  RILIEVO_EXPECTS(source.used.empty());
  source.document.context->budget.borrow(indices.size(), 2 * sizeof(std::uint32_t));
  std::vector<std::uint32_t> used = indices;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  if (used.size() == source.vertices) return;
  for (std::uint32_t& i : indices)
    i = std::uint32_t(std::lower_bound(used.begin(), used.end(), i) - used.begin());
  source.used = std::move(used);
}

Attribute read_attribute(const AttributeSource& source, const char* name,
                         std::span<const int> allowed) {
  Document& document = source.document;
  const JsonValue at = source.attributes[name];
  Attribute out;
  if (!at) return out;
  const Accessor accessor =
      describe_accessor(document, at.required_index(document.count("accessors")));
  out.component = accessor.component;
  out.normalized = accessor.normalized;

  if (source.packed) {
    const auto packed = source.packed->attributes.find(name);
    if (packed != source.packed->attributes.end()) {
      const DracoAttribute& from = packed->second;
      out.numbers = from.numbers;
      if (std::find(allowed.begin(), allowed.end(), from.numbers) == allowed.end())
        at.fail("has a number of components that does not fit its use");
      document.context->budget.take(source.count(), from.numbers * sizeof(float));
      if (source.used.empty()) out.values = from.values;
      for (std::uint32_t v : source.used)
        for (int c = 0; c < from.numbers; ++c)
          out.values.push_back(from.values[std::size_t(v) * from.numbers + c]);
      return out;
    }
  }
  expect_numbers(document, accessor, allowed);
  out.numbers = accessor.numbers;
  if (accessor.count != source.vertices)
    at.fail("has " + std::to_string(accessor.count) + " vertices where another attribute has " +
            std::to_string(source.vertices));
  out.values = read_floats(document, accessor, {source.used.empty(), source.used});
  return out;
}

}  // namespace rilievo::gltf
