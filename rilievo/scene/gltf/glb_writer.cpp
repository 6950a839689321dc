#include "rilievo/scene/gltf/glb_writer.h"

#include <algorithm>
#include <cstring>

namespace rilievo {
namespace {

constexpr std::byte kZeros[4] = {};

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

GlbJson accessor_of_floats(int view, std::span<const float> values, int numbers, bool with_bounds) {
  constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  GlbJson accessor{{"bufferView", view},
                   {"componentType", 5126},
                   {"count", values.size() / std::size_t(numbers)},
                   {"type", kTypes[numbers - 1]}};
  if (!with_bounds) return accessor;
  std::vector<float> low(values.begin(), values.begin() + numbers), high = low;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t k = i % std::size_t(numbers);
    low[k] = std::min(low[k], values[i]), high[k] = std::max(high[k], values[i]);
  }
  accessor["min"] = low, accessor["max"] = high;
  return accessor;
}

}  // namespace

int GlbWriter::add_view(std::span<const std::byte> bytes, int target) {
  GlbJson view{{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes.size()}};
  if (target) view["target"] = target;
  pieces_.push_back(bytes);
  size_ += bytes.size();
  // Every view begins at a multiple of four, as accessors of floats must.
  if (const std::size_t rest = size_ % 4) {
    pieces_.push_back(std::span(kZeros).first(4 - rest));
    size_ += 4 - rest;
  }
  return add("bufferViews", std::move(view));
}

int GlbWriter::add_owned_view(std::vector<std::byte> bytes, int target) {
  owned_.push_back(std::move(bytes));
  return add_view(owned_.back(), target);
}

int GlbWriter::add_floats(std::span<const float> values, int numbers, int target,
                          bool with_bounds) {
  const int view = add_view(std::as_bytes(values), target);
  return add("accessors", accessor_of_floats(view, values, numbers, with_bounds));
}

int GlbWriter::add_owned_floats(std::vector<float> values, int numbers, bool with_bounds) {
  const int view = add_owned_view(bytes_of(values));
  return add("accessors", accessor_of_floats(view, values, numbers, with_bounds));
}

int GlbWriter::add_indices(std::span<const std::uint32_t> indices, std::size_t vertices) {
  // 65535 would restart a primitive.
  const bool narrow = vertices < 65535;
  const int view =
      narrow ? add_owned_view(bytes_of(std::vector<std::uint16_t>(indices.begin(), indices.end())),
                              kGlbIndices)
             : add_view(std::as_bytes(indices), kGlbIndices);
  return add("accessors", {{"bufferView", view},
                           {"componentType", narrow ? 5123 : 5125},
                           {"count", indices.size()},
                           {"type", "SCALAR"}});
}

int GlbWriter::add(const char* array, GlbJson element) {
  GlbJson& list = json[array];
  list.push_back(std::move(element));
  return int(list.size()) - 1;
}

void GlbWriter::use_extension(const std::string& name, bool required) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (list[10] == 'R' && !required) continue;
    GlbJson& names = json[list];
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

Result<std::vector<std::span<const std::byte>>> GlbWriter::finish() {
  if (size_ > 0) json["buffers"] = GlbJson::array({{{"byteLength", size_}}});
  // Names are whatever bytes a file brought along; JSON is UTF-8.
  std::string text = json.dump(-1, ' ', false, GlbJson::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t total = 12 + 8 + text.size() + (size_ > 0 ? 8 + size_ : 0);
  if (total > 0xffffffffu)
    return Error{"", "the scene takes " + std::to_string(total) +
                         " bytes, more than the 4294967295 of a .glb file"};

  // Little-endian, as is every machine that this runs on.
  const std::uint32_t header[] = {0x46546c67, 2, std::uint32_t(total), std::uint32_t(text.size()),
                                  0x4e4f534a};
  std::vector<std::byte> head(sizeof header + text.size());
  std::memcpy(head.data(), header, sizeof header);
  std::memcpy(head.data() + sizeof header, text.data(), text.size());
  owned_.push_back(std::move(head));
  std::vector<std::span<const std::byte>> out{owned_.back()};
  if (size_ > 0) {
    owned_.push_back(bytes_of(std::vector<std::uint32_t>{std::uint32_t(size_), 0x004e4942}));
    out.push_back(owned_.back());
    out.insert(out.end(), pieces_.begin(), pieces_.end());
  }
  return out;
}

}  // namespace rilievo
