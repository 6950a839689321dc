#include "rilievo/render/opengl/gpu_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "rilievo/render/mask_coverage.h"
#include "rilievo/render/opengl/scene_shaders.h"

namespace rilievo {
namespace {

// Both streams are as narrow as the eye allows: software rasterisers pay for every byte.
struct Vertex {
  glm::vec3 position;
  std::uint32_t normal;    // signed 10:10:10:2
  std::uint16_t color[4];  // unsigned normalised, linear
};

struct UvVertex {
  glm::vec2 uv0, uv1;
};
static_assert(sizeof(Vertex) == kVertexBytes && sizeof(UvVertex) == kUvBytes);

std::uint32_t pack_normal(const glm::vec3& n) {
  const auto ten_bits = [](float v) {
    return std::uint32_t(std::int32_t(std::lround(std::clamp(v, -1.0f, 1.0f) * 511.0f))) & 1023u;
  };
  return ten_bits(n.x) | ten_bits(n.y) << 10 | ten_bits(n.z) << 20;
}

std::uint16_t pack_unorm16(float v) {
  return std::uint16_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 65535.0f));
}

GLenum gl_wrap(Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return GL_REPEAT;
    case Wrap::mirrored_repeat:
      return GL_MIRRORED_REPEAT;
    case Wrap::clamp_to_edge:
      return GL_CLAMP_TO_EDGE;
  }
  return GL_REPEAT;
}

GLenum gl_format(bool srgb) { return srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8; }

int level_count(const Rgba8Image& image) {
  return 1 + int(std::floor(std::log2(float(std::max(image.width(), image.height())))));
}

// `threshold`: of the mask whose alpha it holds, mask_threshold(); 0: of none.
gl::Texture upload_image(const Rgba8Image& image, bool srgb, float threshold) {
  gl::Texture made =
      gl::make_texture_2d(gl_format(srgb), image.width(), image.height(), level_count(image));
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(made, 0, 0, 0, image.width(), image.height(), GL_RGBA, GL_UNSIGNED_BYTE,
                      image.texels().data());
  if (threshold <= 0) {
    glGenerateTextureMipmap(made);
    return made;
  }
  const MipChain chain = build_mask_mip_chain(image, srgb, threshold);
  for (std::size_t l = 1; l < chain.levels.size(); ++l) {
    const MipChain::Level& level = chain.levels[l];
    glTextureSubImage2D(made, GLint(l), 0, 0, level.width, level.height, GL_RGBA, GL_UNSIGNED_BYTE,
                        chain.texels.data() + level.offset);
  }
  return made;
}

// The texels of `uploaded`, sampled in another way.
gl::Texture view_of(const gl::Texture& uploaded, const Texture& texture, const Rgba8Image& image,
                    bool srgb) {
  gl::Texture made = gl::make_texture_view(uploaded, gl_format(srgb), level_count(image));
  glTextureParameteri(made, GL_TEXTURE_WRAP_S, GLint(gl_wrap(texture.wrap_u)));
  glTextureParameteri(made, GL_TEXTURE_WRAP_T, GLint(gl_wrap(texture.wrap_v)));
  if (texture.nearest) glTextureParameteri(made, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return made;
}

// Uploads each image once for each way it is read, and makes a view of it for each texture.
class TextureStore {
 public:
  TextureStore(const Scene& scene, std::vector<gl::Texture>& textures)
      : scene_(scene), textures_(textures) {
    textures_.push_back(gl::make_texture_2d(GL_RGBA8, 1, 1));
    const glm::u8vec4 white(255);
    glTextureSubImage2D(textures_[0], 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, &white);
  }
  int get(const TextureUse& use, bool srgb, float threshold) {
    if (use.texture < 0) return 0;
    auto [found, is_new] =
        known_.try_emplace({use.texture, srgb, threshold}, int(textures_.size()));
    if (is_new) {
      const Texture& texture = scene_.textures[std::size_t(use.texture)];
      const Rgba8Image& image = scene_.images[std::size_t(texture.image)];
      auto [uploaded, is_new_image] = images_.try_emplace({texture.image, srgb, threshold});
      if (is_new_image) uploaded->second = upload_image(image, srgb, threshold);
      textures_.push_back(view_of(uploaded->second, texture, image, srgb));
    }
    return found->second;
  }

 private:
  const Scene& scene_;
  std::vector<gl::Texture>& textures_;
  // A texture or an image, and how it is read.
  using Reading = std::tuple<int, bool, float>;
  std::map<Reading, int> known_;
  std::map<Reading, gl::Texture> images_;  // the views keep their texels alive
};

GpuMaterial convert(const Material& m, TextureStore& store, GpuMaterialBlock& block) {
  GpuMaterial out;
  block.base_color = m.base_color;
  block.emissive_normal_scale = glm::vec4(m.emissive, m.normal_scale);
  block.metallic_roughness_occlusion_cutoff = {m.metallic, m.roughness, m.occlusion_strength,
                                               m.alpha_cutoff};
  const TextureUse* uses[kMaterialUnits] = {&m.base_color_texture, &m.metallic_roughness_texture,
                                            &m.normal_texture, &m.occlusion_texture,
                                            &m.emissive_texture};
  const bool srgb[kMaterialUnits] = {true, false, false, false, true};
  bool textured = false;
  for (std::size_t unit = 0; unit < kMaterialUnits; ++unit) {
    const float threshold = unit == kBaseColorUnit ? mask_threshold(m) : 0;
    out.textures[unit] = store.get(*uses[unit], srgb[unit], threshold);
    textured |= out.textures[unit] != 0;
    const glm::mat3 rows = glm::transpose(uses[unit]->texture_from_uv);
    block.uv_rows[2 * unit] = glm::vec4(rows[0], float(uses[unit]->uv_set));
    block.uv_rows[2 * unit + 1] = glm::vec4(rows[1], 0);
  }
  if (m.code_from_mesh) {
    out.features |= shader::kPositionCode;
    const glm::mat3x4 rows = glm::transpose(*m.code_from_mesh);
    for (int k = 0; k < 3; ++k) block.code_rows[k] = rows[k];
  }
  if (textured) out.features |= shader::kTextures;
  if (out.textures[kNormalUnit]) out.features |= shader::kNormalMap;
  if (m.unlit) out.features |= shader::kUnlit;
  if (m.metallic > 0) out.features |= shader::kMetallic;
  if (m.emissive != glm::vec3(0)) out.features |= shader::kEmissive;
  if (m.alpha_mode == AlphaMode::mask) out.features |= shader::kMask;
  if (m.alpha_mode == AlphaMode::blend) out.features |= shader::kBlend;
  out.alpha_mode = m.alpha_mode;
  out.double_sided = m.double_sided;
  return out;
}

void upload_materials(const Scene& scene, GpuScene& gpu) {
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  const std::size_t stride = (sizeof(GpuMaterialBlock) + std::size_t(alignment) - 1) /
                             std::size_t(alignment) * std::size_t(alignment);
  TextureStore store(scene, gpu.textures);
  std::vector<std::byte> blocks(stride * (scene.materials.size() + 1));
  const Material fallback;
  for (std::size_t i = 0; i <= scene.materials.size(); ++i) {
    GpuMaterialBlock block;
    gpu.materials.push_back(
        convert(i < scene.materials.size() ? scene.materials[i] : fallback, store, block));
    gpu.materials.back().block_offset = GLintptr(i * stride);
    std::memcpy(blocks.data() + i * stride, &block, sizeof block);
  }
  gpu.material_blocks = gl::make_buffer(blocks.size(), blocks.data());
}

void upload_meshes(const Scene& scene, GpuScene& gpu) {
  std::size_t vertex_count = 0, index_count = 0;
  bool any_uv = false;
  for (const Mesh& mesh : scene.meshes) {
    const bool strokes = mesh.primitive != Primitive::triangles;
    vertex_count += strokes ? mesh.indices.size() + kStrokeAlignment : mesh.positions.size();
    index_count += strokes ? 0 : mesh.indices.size();
  }
  for (const GpuMaterial& material : gpu.materials)
    any_uv |= (material.features & shader::kTextures) != 0;
  std::vector<Vertex> vertices;
  std::vector<UvVertex> uvs;
  std::vector<std::uint32_t> indices;
  vertices.reserve(vertex_count);
  indices.reserve(index_count);
  const auto add_vertex = [&](const Mesh& mesh, std::size_t i) {
    Vertex v;
    v.position = mesh.positions[i];
    v.normal = pack_normal(i < mesh.normals.size() ? mesh.normals[i] : glm::vec3(0, 1, 0));
    const glm::vec4 color = i < mesh.colors.size() ? mesh.colors[i] : glm::vec4(1.0f);
    for (int k = 0; k < 4; ++k) v.color[k] = pack_unorm16(color[k]);
    vertices.push_back(v);
    if (!any_uv) return;
    const auto uv = [&](int set) {
      return i < mesh.uv[set].size() ? mesh.uv[set][i] : glm::vec2(0.0f);
    };
    uvs.push_back({uv(0), uv(1)});
  };
  for (const Mesh& mesh : scene.meshes) {
    const bool strokes = mesh.primitive != Primitive::triangles;
    while (strokes && vertices.size() % kStrokeAlignment != 0) {
      vertices.emplace_back();
      if (any_uv) uvs.emplace_back();
    }
    GpuMesh out;
    out.primitive = mesh.primitive;
    out.primitives = GLsizei(mesh.primitives());
    out.width = mesh.width, out.width_px = mesh.width_px;
    out.base_vertex = GLint(vertices.size());
    out.first_index = GLuint(indices.size());
    out.index_count = strokes ? 0 : GLsizei(mesh.indices.size());
    out.material = mesh.material < 0 ? int(scene.materials.size()) : mesh.material;
    if (strokes)
      out.features = (mesh.primitive == Primitive::points ? shader::kDiscs : shader::kLines) |
                     (mesh.normals.empty() ? unsigned(shader::kUnlit) : 0u);
    gpu.meshes.push_back(out);
    if (strokes) {
      for (const std::uint32_t i : mesh.indices) add_vertex(mesh, i);
    } else {
      for (std::size_t i = 0; i < mesh.positions.size(); ++i) add_vertex(mesh, i);
      indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
    }
  }
  gpu.vertices = gl::make_buffer(vertices.size() * sizeof(Vertex), vertices.data());
  gpu.uvs = gl::make_buffer(uvs.size() * sizeof(UvVertex), uvs.data());
  gpu.indices = gl::make_buffer(indices.size() * sizeof(std::uint32_t), indices.data());
}

void describe_attribute(GLuint array, GLuint index, GLuint binding, GLint size, GLenum type,
                        GLboolean normalized, GLuint offset) {
  glEnableVertexArrayAttrib(array, index);
  glVertexArrayAttribFormat(array, index, size, type, normalized, offset);
  glVertexArrayAttribBinding(array, index, binding);
}

void describe_instances(GLuint array) {
  for (GLuint row = 0; row < 3; ++row)
    describe_attribute(array, kInstanceRow0 + row, kInstanceBinding, 4, GL_FLOAT, GL_FALSE,
                       GLuint(row * sizeof(glm::vec4)));
  glEnableVertexArrayAttrib(array, kInstanceObject);
  glVertexArrayAttribIFormat(array, kInstanceObject, 1, GL_UNSIGNED_INT,
                             offsetof(GpuInstance, object));
  glVertexArrayAttribBinding(array, kInstanceObject, kInstanceBinding);
  describe_attribute(array, kInstanceShare, kInstanceBinding, 2, GL_FLOAT, GL_FALSE,
                     offsetof(GpuInstance, share_from));
  describe_attribute(array, kInstanceRadius, kInstanceBinding, 1, GL_FLOAT, GL_FALSE,
                     offsetof(GpuInstance, radius));
  glVertexArrayBindingDivisor(array, kInstanceBinding, 1);
}

void describe_attributes(GpuScene& gpu) {
  gpu.vertex_array = gl::make_vertex_array();
  gpu.stroke_array = gl::make_vertex_array();
  const GLuint vao = gpu.vertex_array;
  describe_attribute(vao, kPosition, 0, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
  describe_attribute(vao, kNormal, 0, 4, GL_INT_2_10_10_10_REV, GL_TRUE, offsetof(Vertex, normal));
  describe_attribute(vao, kColor, 0, 4, GL_UNSIGNED_SHORT, GL_TRUE, offsetof(Vertex, color));
  describe_attribute(vao, kUv0, 1, 2, GL_FLOAT, GL_FALSE, offsetof(UvVertex, uv0));
  describe_attribute(vao, kUv1, 1, 2, GL_FLOAT, GL_FALSE, offsetof(UvVertex, uv1));
  describe_instances(vao);
  describe_instances(gpu.stroke_array);
  glVertexArrayVertexBuffer(vao, 0, gpu.vertices, 0, sizeof(Vertex));
  glVertexArrayVertexBuffer(vao, 1, gpu.uvs, 0, sizeof(UvVertex));
  glVertexArrayElementBuffer(vao, gpu.indices);
}

}  // namespace

Result<GpuScene> upload(const Scene& scene) {
  if (Result<> ok = validate(scene); !ok) return ok.error();
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  for (const Texture& texture : scene.textures)
    if (const Rgba8Image& image = scene.images[std::size_t(texture.image)];
        image.width() > limit || image.height() > limit)
      return Error{scene.name, "texture '" + texture.name +
                                   "' is larger than this GPU's limit of " + std::to_string(limit) +
                                   " texels"};
  while (glGetError() != GL_NO_ERROR) {
  }
  GpuScene gpu;
  upload_materials(scene, gpu);
  for (const Mesh& mesh : scene.meshes)
    if (!mesh.colors.empty())
      gpu.materials[std::size_t(mesh.material < 0 ? int(scene.materials.size()) : mesh.material)]
          .features |= shader::kColors;
  upload_meshes(scene, gpu);
  describe_attributes(gpu);
  if (glGetError() == GL_OUT_OF_MEMORY)
    return Error{scene.name, "its meshes and textures do not fit into GPU memory"};
  return gpu;
}

}  // namespace rilievo
