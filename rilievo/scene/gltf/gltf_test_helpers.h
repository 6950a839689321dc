// Makes glTF files for tests, piece by piece; what is not set is as in the smallest valid file.
#pragma once

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rilievo::test {

struct GltfBuilder {
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};
  std::string bin;

  template <class T>
  static std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  }

  // A buffer view of these bytes, aligned to 4.
  int view(const std::string& bytes, int stride = 0) {
    bin.resize((bin.size() + 3) / 4 * 4);
    nlohmann::json v = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
    if (stride) v["byteStride"] = stride;
    bin += bytes;
    json["bufferViews"].push_back(v);
    return int(json["bufferViews"].size()) - 1;
  }

  int accessor(nlohmann::json a) {
    json["accessors"].push_back(std::move(a));
    return int(json["accessors"].size()) - 1;
  }

  // Packed values; `type` is "VEC3" and the like, `component` glTF's number.
  template <class T>
  int packed(const std::vector<T>& values, const char* type, int component,
             bool normalized = false) {
    static const std::map<std::string, int> kNumbers = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    return accessor({{"bufferView", view(bytes_of(values))},
                     {"componentType", component},
                     {"normalized", normalized},
                     {"count", values.size() / kNumbers.at(type)},
                     {"type", type}});
  }
  int floats(const std::vector<float>& values, const char* type) {
    return packed(values, type, 5126);
  }

  int mesh(nlohmann::json primitive) {
    json["meshes"].push_back({{"primitives", {std::move(primitive)}}});
    return int(json["meshes"].size()) - 1;
  }

  int node(nlohmann::json n) {
    json["nodes"].push_back(std::move(n));
    return int(json["nodes"].size()) - 1;
  }

  [[nodiscard]] std::string glb() const {
    nlohmann::json complete = json;
    if (!bin.empty()) complete["buffers"] = {{{"byteLength", bin.size()}}};
    std::string text = complete.dump(), binary = bin;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto word = [](std::size_t v) {
      return std::string{char(v), char(v >> 8), char(v >> 16), char(v >> 24)};
    };
    std::string chunks = word(text.size()) + "JSON" + text;
    if (!bin.empty()) chunks += word(binary.size()) + std::string("BIN\0", 4) + binary;
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
  }
};

// One triangle (0 0 0, 1 0 0, 0 1 0) in a mesh on a node.
inline GltfBuilder triangle() {
  GltfBuilder b;
  const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", positions}}}})}});
  return b;
}

}  // namespace rilievo::test
