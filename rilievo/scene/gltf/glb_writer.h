// The pieces of a .glb file while it is being put together. Internal to save_glb.
//
// Arrays of the scene are referred to, not copied: they must outlive the writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/result.h"

namespace rilievo {

struct Scene;

using GlbJson = nlohmann::ordered_json;

class GlbWriter {
 public:
  GlbJson json;  // the document; buffers, bufferViews and accessors are the writer's

  // Appends a bufferView and returns its index.
  int add_view(std::span<const std::byte> bytes, int target = 0);
  // The same for bytes that nobody else keeps.
  int add_owned_view(std::vector<std::byte> bytes, int target = 0);

  // Appends an accessor of floats, `numbers` to an element (1, 2, 3, 4), with the elements' minimum
  // and maximum if `with_bounds`.
  int add_floats(std::span<const float> values, int numbers, int target, bool with_bounds);
  int add_owned_floats(std::vector<float> values, int numbers, bool with_bounds);
  // Indices of `vertices` vertices; 16 bits each where that is enough.
  int add_indices(std::span<const std::uint32_t> indices, std::size_t vertices);

  // Index of `element` in the document's array `array`, appended if it is not there yet.
  int add(const char* array, GlbJson element);
  void use_extension(const std::string& name, bool required = false);

  // Header and chunks, ready to be written one after the other; they refer to the writer.
  [[nodiscard]] Result<std::vector<std::span<const std::byte>>> finish();

 private:
  std::deque<std::vector<std::byte>> owned_;
  std::vector<std::span<const std::byte>> pieces_;  // of the binary chunk
  std::uint64_t size_ = 0;                          // of the binary chunk so far
};

// Targets of buffer views.
inline constexpr int kGlbVertices = 34962, kGlbIndices = 34963;

// Appends the scene's textures and materials, in their order.
void add_glb_materials(GlbWriter& writer, const Scene& scene);

// Appends a mesh for every model that has triangles, and returns its index for each, or -1. What
// has no material gets `default_material`.
[[nodiscard]] std::vector<int> add_glb_meshes(GlbWriter& writer, const Scene& scene,
                                              int default_material);

// Appends the nodes of the hierarchy, those of the objects below them or by themselves, lights and
// cameras; returns the roots.
[[nodiscard]] std::vector<int> add_glb_nodes(GlbWriter& writer, const Scene& scene,
                                             std::span<const int> mesh_of_model);
// Appends the scene's channels, whose nodes come first in the document.
void add_glb_animation(GlbWriter& writer, const Scene& scene);

}  // namespace rilievo
