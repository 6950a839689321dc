// Numbers out of accessors: typed, strided, normalised, sparse. Internal; throws LoadError.
//
// Everything that a file says about counts, offsets and strides is checked against the bytes that
// are there before one of them is touched.
#pragma once

#include <vector>

#include "rilievo/scene/gltf/document.h"

namespace rilievo::gltf {

enum class Component : std::uint16_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126,
};

[[nodiscard]] std::size_t bytes_each(Component component);

struct Accessor {
  int index = 0;
  std::uint64_t count = 0;  // elements
  int numbers = 1;          // in an element: 1 to 4, or 16
  Component component = Component::float32;
  bool normalized = false;  // integers stand for [0, 1] or [-1, 1]

  [[nodiscard]] std::size_t element_bytes() const { return bytes_each(component) * numbers; }
};

[[nodiscard]] Accessor describe_accessor(const Document& document, int index);

// Which elements to read: all, or those listed.
struct Selection {
  bool all = true;
  std::span<const std::uint32_t> listed;

  [[nodiscard]] std::uint64_t size(const Accessor& a) const {
    return all ? a.count : listed.size();
  }
};

// a.numbers floats an element; integers as they are, or normalised if the accessor says so.
// Requires every listed element to be less than a.count.
[[nodiscard]] std::vector<float> read_floats(Document& document, const Accessor& a,
                                             const Selection& selection = {});

// a.numbers integers an element; the accessor's components must be unsigned integers.
[[nodiscard]] std::vector<std::uint32_t> read_integers(Document& document, const Accessor& a,
                                                       const Selection& selection = {});

// Integers to [-1, 1] or [0, 1] as the component's type says (glTF 2.0, section 3.11).
[[nodiscard]] float normalized_from(Component component, double integer);

// Fails where an accessor has none of the shapes a reader can take.
void expect_numbers(const Document& document, const Accessor& a, std::span<const int> allowed);

}  // namespace rilievo::gltf
