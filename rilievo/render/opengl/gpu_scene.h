// How is a Scene stored on the GPU? Meshes, materials and textures; placements change and are not
// part of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rilievo/gl/object.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The indices of vertex attributes.
enum VertexAttribute : GLuint {
  kPosition = 0,
  kNormal = 1,
  kColor = 2,
  kUv0 = 3,
  kUv1 = 4,
  kInstanceRow0 = 5,  // three rows of eye_relative_from_mesh; then the object's
                      // identifier and its cross-fade range
  kInstanceObject = 8,
  kInstanceShare = 9,
  kInstanceRadius = 10,  // of points, metres of the world
};

// The texture units of a material's textures.
enum TextureUnit : GLuint {
  kBaseColorUnit = 0,
  kMetallicRoughnessUnit = 1,
  kNormalUnit = 2,
  kOcclusionUnit = 3,
  kEmissiveUnit = 4,
  kMaterialUnits = 5,
};

// A mesh's range in the index buffer. Points and lines have none: their vertices follow each other
// in the order of their corners.
struct GpuMesh {
  Primitive primitive = Primitive::triangles;
  GLsizei primitives = 0;
  float width = 0, width_px = 1;  // of Mesh
  unsigned features = 0;          // bits of shader::Feature beside its material's
  GLsizei index_count = 0;
  GLuint first_index = 0;
  GLint base_vertex = 0;
  int material = 0;  // index into GpuScene::materials
};

// The Material block of the shaders (std140).
struct GpuMaterialBlock {
  glm::vec4 base_color;
  glm::vec4 emissive_normal_scale;
  glm::vec4 metallic_roughness_occlusion_cutoff;
  // For each texture unit, two rows of texture_from_uv; w of the first is the UV set.
  glm::vec4 uv_rows[kMaterialUnits * 2];
  glm::vec4 code_rows[3];  // of code_from_mesh
};

// A material's textures and state.
struct GpuMaterial {
  std::array<int, kMaterialUnits> textures;  // index into GpuScene::textures; 0 is plain white
  unsigned features = 0;                     // bits of shader::Feature
  GLintptr block_offset = 0;
  AlphaMode alpha_mode = AlphaMode::opaque;
  bool double_sided = false;
};

// A scene on the GPU.
struct GpuScene {
  std::vector<GpuMesh> meshes;         // as Scene::meshes
  std::vector<GpuMaterial> materials;  // as Scene::materials, then the default material
  std::vector<gl::Texture> textures;
  gl::Buffer vertices, uvs, indices, material_blocks;
  // Instances come from binding kInstanceBinding. Strokes have no other attributes.
  gl::VertexArray vertex_array, stroke_array;
};

// The vertex buffer binding of instances.
inline constexpr GLuint kInstanceBinding = 2;

// An instance of a mesh, as the vertex shader reads it.
struct GpuInstance {
  glm::vec4 rows[3];
  std::uint32_t object;
  float share_from, share_to;  // see shader::kPixelHash
  float radius;
};

// Bytes of a vertex and of its texture coordinates. Points and lines read them from a storage
// buffer, which has 128 MiB at least, at aligned offsets.
inline constexpr GLsizeiptr kVertexBytes = 24, kUvBytes = 16;
// The most vertices of a draw, and what the first one's number is a multiple of.
inline constexpr GLsizei kStrokeChunk = 1 << 22, kStrokeAlignment = 32;

// Uploads a scene. Fails where a texture exceeds the driver's limits.
[[nodiscard]] Result<GpuScene> upload(const Scene& scene);

}  // namespace rilievo
