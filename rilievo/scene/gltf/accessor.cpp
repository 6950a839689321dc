#include "rilievo/scene/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "rilievo/core/expects.h"

namespace rilievo::gltf {
namespace {

struct Named {
  const char* name;
  int numbers;
};
constexpr Named kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};

JsonValue value_of(const Document& document, const Accessor& a) {
  return document.root()["accessors"][std::size_t(a.index)];
}

template <class T>
T load(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);  // accessors need not be aligned in a broken file
  return value;
}

double load_component(Component component, const std::uint8_t* from) {
  switch (component) {
    case Component::int8:
      return load<std::int8_t>(from);
    case Component::uint8:
      return load<std::uint8_t>(from);
    case Component::int16:
      return load<std::int16_t>(from);
    case Component::uint16:
      return load<std::uint16_t>(from);
    case Component::uint32:
      return load<std::uint32_t>(from);
    case Component::float32:
      return load<float>(from);
  }
  return 0;
}

// Elements in memory: `stride` bytes from one to the next.
struct Elements {
  const std::uint8_t* data = nullptr;  // null: all zero
  std::size_t stride = 0;
  std::vector<std::uint8_t> owned;
};

// `count` elements of `element` bytes from `offset` of a view, the last one wholly inside it.
Elements in_view(Document& document, const JsonValue& user, const JsonValue& view_index,
                 std::uint64_t offset, std::uint64_t count, std::size_t element, bool strided) {
  const std::size_t view = view_index.required_index(document.count("bufferViews"));
  const Bytes bytes = read_view(document, view);
  std::size_t stride = strided ? view_stride(document, view) : 0;
  if (stride == 0) stride = element;
  const bool inside = count == 0 || (offset <= bytes.size() && element <= bytes.size() - offset &&
                                     count - 1 <= (bytes.size() - offset - element) / stride);
  if (!inside) user.fail("reaches behind the end of bufferViews[" + std::to_string(view) + "]");
  return {count == 0 ? nullptr : bytes.data() + offset, stride, {}};
}

// Section 3.6.2.3: some elements replaced by others.
void apply_sparse(Document& document, const Accessor& a, const JsonValue& sparse,
                  Elements& elements) {
  const std::size_t element = a.element_bytes();
  const std::uint64_t replaced = sparse["count"].whole();
  if (replaced > a.count) sparse["count"].fail("is more than the accessor has");

  document.context->budget.take(a.count, element);
  std::vector<std::uint8_t> dense(a.count * element, 0);
  if (elements.data)
    for (std::uint64_t i = 0; i < a.count; ++i)
      std::memcpy(&dense[i * element], elements.data + i * elements.stride, element);

  const JsonValue indices = sparse["indices"], values = sparse["values"];
  const std::uint64_t kind = indices["componentType"].whole();
  const Component component = Component(kind);
  if (kind != 5121 && kind != 5123 && kind != 5125)
    indices["componentType"].fail("is not an unsigned integer type");
  const Elements at =
      in_view(document, indices, indices["bufferView"], indices["byteOffset"].whole(0), replaced,
              bytes_each(component), false);
  const Elements with = in_view(document, values, values["bufferView"],
                                values["byteOffset"].whole(0), replaced, element, false);
  for (std::uint64_t i = 0; i < replaced; ++i) {
    const std::uint64_t target = std::uint64_t(load_component(component, at.data + i * at.stride));
    if (target >= a.count)
      indices.fail("refer to element " + std::to_string(target) + but_there_are(a.count));
    std::memcpy(&dense[target * element], with.data + i * with.stride, element);
  }
  elements.owned = std::move(dense);
  elements.data = elements.owned.data();
  elements.stride = element;
}

Elements locate(Document& document, const Accessor& a) {
  const JsonValue value = value_of(document, a);
  Elements elements;
  if (value["bufferView"])
    elements = in_view(document, value, value["bufferView"], value["byteOffset"].whole(0), a.count,
                       a.element_bytes(), true);
  if (const JsonValue sparse = value["sparse"]) apply_sparse(document, a, sparse, elements);
  return elements;
}

// Calls put(k, component index, address or null) for every number of the selection.
template <class Put>
void each_number(const Accessor& a, const Elements& elements, const Selection& selection,
                 Put&& put) {
  const std::size_t step = bytes_each(a.component);
  const std::uint64_t n = selection.size(a);
  std::size_t out = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    const std::uint64_t element = selection.all ? k : selection.listed[k];
    RILIEVO_EXPECTS_LT(element, a.count);
    const std::uint8_t* at = elements.data ? elements.data + element * elements.stride : nullptr;
    for (int c = 0; c < a.numbers; ++c) put(out++, at ? at + c * step : nullptr);
  }
}

}  // namespace

std::size_t bytes_each(Component component) {
  switch (component) {
    case Component::int8:
    case Component::uint8:
      return 1;
    case Component::int16:
    case Component::uint16:
      return 2;
    default:
      return 4;
  }
}

Accessor describe_accessor(const Document& document, int index) {
  Accessor a;
  a.index = index;
  const JsonValue value = value_of(document, a);
  a.count = value["count"].whole();
  if (a.count > std::numeric_limits<std::uint32_t>::max())
    value["count"].fail("is more than an index can reach");
  const std::uint64_t component = value["componentType"].whole();
  if (component < 5120 || component > 5126 || component == 5124)
    value["componentType"].fail("is not a type of glTF 2.0");
  a.component = Component(component);
  const std::string type = value["type"].text();
  const Named* named = std::find_if(std::begin(kTypes), std::end(kTypes),
                                    [&](const Named& t) { return type == t.name; });
  if (named == std::end(kTypes)) value["type"].fail("is '" + type + "', which cannot be read");
  a.numbers = named->numbers;
  a.normalized = value["normalized"].boolean(false);
  return a;
}

float normalized_from(Component component, double integer) {
  switch (component) {
    case Component::int8:
      return std::max(float(integer) / 127.0f, -1.0f);
    case Component::uint8:
      return float(integer) / 255.0f;
    case Component::int16:
      return std::max(float(integer) / 32767.0f, -1.0f);
    case Component::uint16:
      return float(integer) / 65535.0f;
    case Component::uint32:
      return float(integer / 4294967295.0);
    case Component::float32:
      break;
  }
  return float(integer);
}

std::vector<float> read_floats(Document& document, const Accessor& a, const Selection& selection) {
  const Elements elements = locate(document, a);
  document.context->budget.take(selection.size(a), a.numbers * sizeof(float));
  std::vector<float> out(selection.size(a) * a.numbers);
  if (a.component == Component::float32)
    each_number(a, elements, selection, [&](std::size_t k, const std::uint8_t* at) {
      if (at) out[k] = load<float>(at);
    });
  else
    each_number(a, elements, selection, [&](std::size_t k, const std::uint8_t* at) {
      if (!at) return;
      const double value = load_component(a.component, at);
      out[k] = a.normalized ? normalized_from(a.component, value) : float(value);
    });
  return out;
}

std::vector<std::uint32_t> read_integers(Document& document, const Accessor& a,
                                         const Selection& selection) {
  if (a.component != Component::uint8 && a.component != Component::uint16 &&
      a.component != Component::uint32)
    value_of(document, a).fail("does not hold unsigned integers");
  const Elements elements = locate(document, a);
  document.context->budget.take(selection.size(a), a.numbers * sizeof(std::uint32_t));
  std::vector<std::uint32_t> out(selection.size(a) * a.numbers);
  each_number(a, elements, selection, [&](std::size_t k, const std::uint8_t* at) {
    if (at) out[k] = std::uint32_t(load_component(a.component, at));
  });
  return out;
}

void expect_numbers(const Document& document, const Accessor& a, std::span<const int> allowed) {
  if (std::find(allowed.begin(), allowed.end(), a.numbers) == allowed.end())
    value_of(document, a)["type"].fail("does not fit its use");
}

}  // namespace rilievo::gltf
