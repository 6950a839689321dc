#include "rilievo/nailboard/gl/nailboard_atlas.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "rilievo/gl/context.h"
#include "rilievo/gl/flip_rows.h"

namespace rilievo {
namespace {

constexpr int kSize = AtlasAllocator::kLayerSize;

// One pass from the samples of the capture to colour and Delta.
const char* const kResolveVertex = R"(#version 450
void main() {
  gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0);
}
)";

const char* const kResolveFragment = R"(#version 450
#if SAMPLES > 1
layout(binding = 0) uniform sampler2DMS color_samples;
layout(binding = 1) uniform sampler2DMS depth_samples;
#else
layout(binding = 0) uniform sampler2D color_samples;
layout(binding = 1) uniform sampler2D depth_samples;
#endif
layout(location = 0) uniform ivec2 slot_origin;
layout(location = 1) uniform float delta_steps;
layout(location = 2) uniform float largest_code;  // of the texture's format
layout(location = 3) uniform ivec2 slot_size;
layout(location = 0) out vec4 out_color;
layout(location = 1) out float out_delta;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy) - slot_origin;
  vec3 sum = vec3(0.0);
  float covered = 0.0, nearest = 1.0;
  for (int i = 0; i < SAMPLES; ++i) {
    float depth = texelFetch(depth_samples, texel, i).r;
    if (depth < 1.0) {
      sum += texelFetch(color_samples, texel, i).rgb;
      covered += 1.0;
      nearest = min(nearest, depth);
    }
  }
  out_color = vec4(sum, covered) / float(SAMPLES);
  // Colours reach into the texels around them: those are as deep as the nearest beside.
  if (covered == 0.0)
    for (int k = 0; k < 9; ++k) {
      ivec2 beside = clamp(texel + ivec2(k % 3, k / 3) - 1, ivec2(0), slot_size - 1);
      for (int i = 0; i < SAMPLES; ++i)
        nearest = min(nearest, texelFetch(depth_samples, beside, i).r);
    }
  // The code above the steps is the reserved one: nothing here.
  float code = nearest < 1.0 ? floor(nearest * delta_steps + 0.5) : delta_steps + 1.0;
  out_delta = code / largest_code;
}
)";

// A block (occlusion_tiles.h) from its texels: red holds both Deltas, the nearest in its low byte.
const char* const kReduceFragment = R"(#version 450
layout(binding = 0) uniform sampler2DArray color_texture;
layout(binding = 1) uniform sampler2DArray delta_texture;
layout(location = 0) uniform ivec3 slot_origin;
layout(location = 1) uniform ivec2 slot_size;
layout(location = 2) uniform float largest_code;  // of the texture's format
layout(location = 3) uniform uint steps;  // of Delta; above: nothing
layout(location = 4) uniform int first_row;  // of the picture's blocks
layout(location = 0) out uvec4 out_block;

void main() {
  ivec2 first = 4 * (ivec2(gl_FragCoord.xy) - ivec2(0, first_row));
  uint nearest = steps + 1u, farthest = 0u;
  uint covered = 0u, opaque = 0u;
  for (int i = 0; i < 16; ++i) {
    ivec2 texel = first + ivec2(i & 3, i >> 2);
    bool inside = all(lessThan(texel, slot_size));
    ivec3 at = ivec3(slot_origin.xy + min(texel, slot_size - 1), slot_origin.z);
    uint code = uint(texelFetch(delta_texture, at, 0).r * largest_code + 0.5);
    if (!inside || code > steps) continue;
    nearest = min(nearest, code), farthest = max(farthest, code);
    covered |= 1u << i;
    if (texelFetch(color_texture, at, 0).a == 1.0) opaque |= 1u << i;
  }
  // In whole numbers, as encode_picture.cpp has it: to the same step.
  uint low = covered == 0u ? 255u : nearest * 254u / steps;
  uint high = (farthest * 254u + steps - 1u) / steps;
  out_block = uvec4(low | high << 8, covered, opaque, 0u);
}
)";

gl::Texture make_capture_texture(GLenum format, int size, int samples) {
  return samples > 1 ? gl::make_texture_2d_multisample(format, size, size, samples)
                     : gl::make_texture_2d(format, size, size);
}

}  // namespace

Result<NailboardAtlas> NailboardAtlas::create(const AtlasOptions& options) {
  RILIEVO_EXPECTS(2 <= options.delta_bits && options.delta_bits <= 16);
  const std::size_t texels = std::size_t(kSize) * kSize;
  constexpr std::size_t layer_blocks =
      std::size_t(OcclusionTiles::kLayerBlocks) * OcclusionTiles::kLayerBlocks;
  const std::size_t a_layer =
      texels * (4 + (options.delta_bits > 8 ? 2 : 1)) + layer_blocks * sizeof(OcclusionTile);
  // Under a small budget a large capture buffer would leave no room for pictures.
  const bool small = options.max_bytes < (std::size_t(64) << 20);
  const int capture_size = !small ? kSize : options.capture_bytes ? kSize * 7 / 16 : kSize / 2;
  // Two pictures of the largest size, or many small ones.
  const int block_rows = 2 * blocks_across(capture_size);
  const std::size_t capture_texels = std::size_t(capture_size) * std::size_t(capture_size);
  const std::size_t buffers =
      (options.capture_bytes ? options.capture_bytes(capture_size, options.samples) +
                                   capture_texels * (options.delta_bits > 8 ? 2 : 1)
                             : capture_texels * 8 * std::size_t(options.samples)) +
      std::size_t(OcclusionTiles::kLayerBlocks) * std::size_t(block_rows) * 8;
  GLint most_layers = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  if (options.max_bytes < buffers + a_layer)
    return Error{"pictures", "a memory budget of " + std::to_string(options.max_bytes >> 20) +
                                 " MB is too small: at least " +
                                 std::to_string(((buffers + a_layer) >> 20) + 1) +
                                 " MB are needed"};
  const int layers =
      int(std::min((options.max_bytes - buffers) / a_layer, std::size_t(most_layers)));

  NailboardAtlas atlas(layers);
  atlas.options_ = options;
  atlas.capture_size_ = capture_size;
  atlas.bytes_ = buffers + std::size_t(layers) * a_layer;
  while (glGetError() != GL_NO_ERROR) {
  }
  atlas.color_ = gl::make_texture_2d_array(GL_RGBA8, kSize, kSize, layers);
  atlas.delta_ =
      gl::make_texture_2d_array(options.delta_bits > 8 ? GL_R16 : GL_R8, kSize, kSize, layers);
  atlas.block_rows_ = block_rows;
  atlas.block_texture_ = gl::make_texture_2d(GL_RGBA16UI, OcclusionTiles::kLayerBlocks, block_rows);
  // Codes next to each other have nothing to do with each other.
  glTextureParameteri(atlas.delta_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(atlas.delta_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (!options.capture_bytes)
    if (Result<> ok = atlas.make_capture_target(); !ok) return ok.error();
  if (glGetError() == GL_OUT_OF_MEMORY)
    return Error{"pictures", "the GPU has no " + std::to_string(atlas.bytes_ >> 20) + " MB left"};

  Result<gl::Program> reduce = gl::make_program("picture blocks", kResolveVertex, kReduceFragment);
  if (!reduce) return reduce.error();
  atlas.reduce_ = std::move(*reduce);
  atlas.block_framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferTexture(atlas.block_framebuffer_, GL_COLOR_ATTACHMENT0, atlas.block_texture_,
                            0);
  atlas.no_vertices_ = gl::make_vertex_array();
  return atlas;
}

// Where OpenGL captures, and what resolves that into a slot.
Result<> NailboardAtlas::make_capture_target() {
  capture_color_ = make_capture_texture(GL_RGBA8, capture_size_, options_.samples);
  capture_depth_ = make_capture_texture(GL_DEPTH_COMPONENT32F, capture_size_, options_.samples);
  capture_framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferTexture(capture_framebuffer_, GL_COLOR_ATTACHMENT0, capture_color_, 0);
  glNamedFramebufferTexture(capture_framebuffer_, GL_DEPTH_ATTACHMENT, capture_depth_, 0);
  layer_framebuffer_ = gl::make_framebuffer();
  const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(layer_framebuffer_, 2, both);
  Result<gl::Program> resolve =
      gl::make_program("picture resolve", kResolveVertex, kResolveFragment,
                       "#define SAMPLES " + std::to_string(options_.samples) + "\n");
  if (!resolve) return resolve.error();
  resolve_ = std::move(*resolve);
  return Done{};
}

void NailboardAtlas::capture(SceneRenderer& renderer, const Camera& camera,
                             std::span<const std::uint32_t> objects, const AtlasSlot& slot) {
  RILIEVO_EXPECTS_EQ(camera.width, slot.width);
  RILIEVO_EXPECTS_EQ(camera.height, slot.height);
  RILIEVO_EXPECTS(!camera.keeps_farthest());
  RILIEVO_EXPECTS(slot.width <= capture_size_ && slot.height <= capture_size_);
  RILIEVO_EXPECTS(!options_.capture_bytes);
  // Draw, in a corner of the capture buffer ...
  glBindFramebuffer(GL_FRAMEBUFFER, capture_framebuffer_);
  glViewport(0, 0, slot.width, slot.height);
  glScissor(0, 0, slot.width, slot.height);
  glEnable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLfloat transparent[] = {0, 0, 0, 0}, far = 1;
  glClearNamedFramebufferfv(capture_framebuffer_, GL_COLOR, 0, transparent);
  glClearNamedFramebufferfv(capture_framebuffer_, GL_DEPTH, 0, &far);
  glDisable(GL_SCISSOR_TEST);
  renderer.draw_opaque(camera, objects, OutputEncoding::srgb);

  // ... and resolve into the slot.
  glNamedFramebufferTextureLayer(layer_framebuffer_, GL_COLOR_ATTACHMENT0, color_, 0, slot.layer);
  glNamedFramebufferTextureLayer(layer_framebuffer_, GL_COLOR_ATTACHMENT1, delta_, 0, slot.layer);
  glBindFramebuffer(GL_FRAMEBUFFER, layer_framebuffer_);
  glViewport(slot.x, slot.y, slot.width, slot.height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glUseProgram(resolve_);
  glBindTextureUnit(0, capture_color_);
  glBindTextureUnit(1, capture_depth_);
  glUniform2i(0, slot.x, slot.y);
  glUniform1f(1, float(delta_steps(options_.delta_bits)));
  glUniform1f(2, largest_code());
  glUniform2i(3, slot.width, slot.height);
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  reduce_to_blocks(slot);
}

void NailboardAtlas::write(const AtlasSlot& slot, const RasterPicture& picture) {
  RILIEVO_EXPECTS_EQ(picture.width, slot.width);
  RILIEVO_EXPECTS_EQ(picture.height, slot.height);
  encode_picture(picture, options_.delta_bits, encoded_);
  write(slot, picture.color, encoded_);
}

void NailboardAtlas::write(const AtlasSlot& slot, std::span<const glm::u8vec4> color,
                           const AtlasPicture& picture) {
  RILIEVO_EXPECTS_EQ(color.size(), std::size_t(slot.width) * std::size_t(slot.height));
  upload(slot, color.data(),
         options_.delta_bits > 8 ? static_cast<const void*>(picture.codes16.data())
                                 : picture.codes8.data());
  read_blocks();  // what was in the slot before must not come later
  blocks_.assign(slot, picture.blocks);
}

void NailboardAtlas::make_object_texture() {
  if (object_) return;
  object_ = gl::make_texture_2d_array(GL_R32UI, kSize, kSize, allocator_.layers());
  glTextureParameteri(object_, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(object_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void NailboardAtlas::write_objects(const AtlasSlot& slot, std::span<const std::uint32_t> objects) {
  RILIEVO_EXPECTS_EQ(objects.size(), std::size_t(slot.width) * std::size_t(slot.height));
  make_object_texture();
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage3D(object_, 0, slot.x, slot.y, slot.layer, slot.width, slot.height, 1,
                      GL_RED_INTEGER, GL_UNSIGNED_INT, objects.data());
}

// Rows from the bottom; codes of 8 or, for more bits, 16 bits.
void NailboardAtlas::upload(const AtlasSlot& slot, const glm::u8vec4* colors, const void* codes) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const auto send = [&](GLuint texture, GLenum format, GLenum type, const void* texels) {
    glTextureSubImage3D(texture, 0, slot.x, slot.y, slot.layer, slot.width, slot.height, 1, format,
                        type, texels);
  };
  send(color_, GL_RGBA, GL_UNSIGNED_BYTE, colors);
  send(delta_, GL_RED, options_.delta_bits > 8 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_BYTE, codes);
}

void NailboardAtlas::reduce_to_blocks(const AtlasSlot& slot) {
  const int rows = blocks_across(slot.height);
  if (next_block_row_ + rows > block_rows_) read_blocks();
  glBindFramebuffer(GL_FRAMEBUFFER, block_framebuffer_);
  glViewport(0, next_block_row_, blocks_across(slot.width), rows);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glUseProgram(reduce_);
  glBindTextureUnit(0, color_);
  glBindTextureUnit(1, delta_);
  glUniform3i(0, slot.x, slot.y, slot.layer);
  glUniform2i(1, slot.width, slot.height);
  glUniform1f(2, largest_code());
  glUniform1ui(3, delta_steps(options_.delta_bits));
  glUniform1i(4, next_block_row_);
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  unread_.push_back({slot, next_block_row_});
  next_block_row_ += rows;
}

void NailboardAtlas::read_blocks() {
  // Red holds both Deltas, the nearest in its low byte.
  static_assert(std::endian::native == std::endian::little);
  for (const auto& [slot, row] : unread_) {
    const int columns = blocks_across(slot.width), rows = blocks_across(slot.height);
    read_blocks_.resize(std::size_t(columns) * std::size_t(rows));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureSubImage(block_texture_, 0, 0, row, 0, columns, rows, 1, GL_RGB_INTEGER,
                         GL_UNSIGNED_SHORT, GLsizei(read_blocks_.size() * sizeof(OcclusionTile)),
                         read_blocks_.data());
    blocks_.assign(slot, read_blocks_);
  }
  unread_.clear();
  next_block_row_ = 0;
}

OcclusionTilesView NailboardAtlas::blocks(const AtlasSlot& slot) {
  read_blocks();
  return blocks_.view(slot);
}

void NailboardAtlas::narrow(const AtlasSlot& slot, PictureGeometry& geometry) {
  if (const auto range = delta_range(blocks(slot))) narrow_slab(geometry, *range);
}

void NailboardAtlas::capture_objects(SceneRenderer& renderer, const Camera& camera,
                                     std::span<const std::uint32_t> objects,
                                     const AtlasSlot& slot) {
  make_object_texture();
  if (!object_framebuffer_) {
    object_depth_ = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, kSize, kSize);
    object_framebuffer_ = gl::make_framebuffer();
    glNamedFramebufferTexture(object_framebuffer_, GL_DEPTH_ATTACHMENT, object_depth_, 0);
  }
  glNamedFramebufferTextureLayer(object_framebuffer_, GL_COLOR_ATTACHMENT0, object_, 0, slot.layer);
  glBindFramebuffer(GL_FRAMEBUFFER, object_framebuffer_);
  glViewport(slot.x, slot.y, slot.width, slot.height);
  glScissor(slot.x, slot.y, slot.width, slot.height);
  glEnable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  const GLuint nothing[] = {0, 0, 0, 0};
  const GLfloat far = 1;
  glClearNamedFramebufferuiv(object_framebuffer_, GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(object_framebuffer_, GL_DEPTH, 0, &far);
  glDisable(GL_SCISSOR_TEST);
  renderer.draw_objects(camera, objects);
}

Nailboard NailboardAtlas::read(const AtlasSlot& slot, const PictureGeometry& geometry) const {
  Nailboard board;
  board.geometry = geometry;
  board.geometry.delta_bits = options_.delta_bits;
  board.color = Rgba8Image(slot.width, slot.height);
  board.delta = Image<std::uint16_t>(slot.width, slot.height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const std::size_t texels = std::size_t(slot.width) * std::size_t(slot.height);
  glGetTextureSubImage(color_, 0, slot.x, slot.y, slot.layer, slot.width, slot.height, 1, GL_RGBA,
                       GL_UNSIGNED_BYTE, GLsizei(texels * 4), board.color.texels().data());
  if (options_.delta_bits > 8) {
    glGetTextureSubImage(delta_, 0, slot.x, slot.y, slot.layer, slot.width, slot.height, 1, GL_RED,
                         GL_UNSIGNED_SHORT, GLsizei(texels * 2), board.delta.texels().data());
  } else {
    std::vector<std::uint8_t> codes(texels);
    glGetTextureSubImage(delta_, 0, slot.x, slot.y, slot.layer, slot.width, slot.height, 1, GL_RED,
                         GL_UNSIGNED_BYTE, GLsizei(texels), codes.data());
    std::copy(codes.begin(), codes.end(), board.delta.texels().begin());
  }
  gl::flip_rows(board.color);
  gl::flip_rows(board.delta);
  return board;
}

void NailboardAtlas::write(const AtlasSlot& slot, const Nailboard& nailboard) {
  RILIEVO_EXPECTS_EQ(nailboard.geometry.delta_bits, options_.delta_bits);
  RILIEVO_EXPECTS_EQ(nailboard.color.width(), slot.width);
  RILIEVO_EXPECTS_EQ(nailboard.color.height(), slot.height);
  Rgba8Image color = nailboard.color;
  Image<std::uint16_t> delta = nailboard.delta;
  gl::flip_rows(color);
  gl::flip_rows(delta);
  if (options_.delta_bits > 8) {
    upload(slot, color.texels().data(), delta.texels().data());
  } else {
    const std::vector<std::uint8_t> codes(delta.texels().begin(), delta.texels().end());
    upload(slot, color.texels().data(), codes.data());
  }
  // In somebody's frame: where the next draw call goes must not change.
  GLint framebuffer = 0, viewport[4];
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  glGetIntegerv(GL_VIEWPORT, viewport);
  reduce_to_blocks(slot);
  glBindFramebuffer(GL_FRAMEBUFFER, GLuint(framebuffer));
  glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
}

}  // namespace rilievo
