// Pictures on the GPU: colour and Delta of many nailboards in a few texture arrays, so that one
// draw call reaches them all; filled by a capture that never leaves the GPU, or with pictures that
// others captured.
//
// All memory is taken at once: a budget, once granted, is never passed. Needs a current OpenGL
// context.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "rilievo/gl/object.h"
#include "rilievo/nailboard/atlas_allocator.h"
#include "rilievo/nailboard/encode_picture.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/picture_blocks.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

struct AtlasOptions {
  std::size_t max_bytes = 256u << 20;  // capture buffers included
  int delta_bits = 8;                  // 2, 4, 6, 8 or 16
  int samples = 4;                     // samples a texel at capture: the frame's antialiasing
  // What who captures without OpenGL takes of the budget, for pictures of up to `size` texels a
  // side; null: the atlas captures, and has the buffers for it.
  std::size_t (*capture_bytes)(int size, int samples) = nullptr;
};

class PictureAtlas {
 public:
  [[nodiscard]] static Result<PictureAtlas> create(const AtlasOptions& options);

  // Room for a picture; nothing when the budget is full.
  [[nodiscard]] std::optional<AtlasSlot> allocate(int width, int height) {
    return allocator_.allocate(width, height);
  }
  void free(const AtlasSlot& slot) { allocator_.free(slot); }

  // Captures `objects` (opaque parts) into the slot, whose size is the camera's. Coverage becomes
  // alpha; depth is the nearest sample's. Changes the bound framebuffer and viewport. Requires an
  // atlas without AtlasOptions::capture_bytes.
  void capture(SceneRenderer& renderer, const Camera& camera,
               std::span<const std::uint32_t> objects, const AtlasSlot& slot);
  // Object identifiers of the same picture, for probes. Allocates their texture at the first call.
  void capture_objects(SceneRenderer& renderer, const Camera& camera,
                       std::span<const std::uint32_t> objects, const AtlasSlot& slot);

  // Between the GPU and memory, bit for bit.
  [[nodiscard]] Nailboard read(const AtlasSlot& slot, const PictureGeometry& geometry) const;
  void write(const AtlasSlot& slot, const Nailboard& nailboard);
  // A picture captured elsewhere, of the slot's size; perspective.
  void write(const AtlasSlot& slot, const RasterPicture& picture);

  // What the slot's picture shows, block by block. Waits for the GPU the first time after a capture
  // or a write.
  [[nodiscard]] PictureBlocksView blocks(const AtlasSlot& slot);
  // Narrows the geometry's slab to what the slot's picture shows; an empty one keeps it.
  void narrow(const AtlasSlot& slot, PictureGeometry& geometry);

  [[nodiscard]] int delta_bits() const { return options_.delta_bits; }
  // What a shader makes of the Delta texture's values: times delta_scale() they are Delta; above
  // largest_delta(), half a step above 1, is the reserved code, a whole step above.
  [[nodiscard]] float largest_code() const { return options_.delta_bits > 8 ? 65535.0f : 255.0f; }
  [[nodiscard]] float delta_scale() const {
    return largest_code() / float(delta_steps(options_.delta_bits));
  }
  [[nodiscard]] float largest_delta() const {
    return 1.0f + 0.5f / float(delta_steps(options_.delta_bits));
  }
  // Texels a side of the largest picture; smaller under a small budget.
  [[nodiscard]] int max_picture_size() const { return capture_size_; }
  [[nodiscard]] const AtlasAllocator& allocator() const { return allocator_; }
  // Memory taken: of textures, and of what is known of their blocks.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] GLuint color_texture() const { return color_; }
  [[nodiscard]] GLuint delta_texture() const { return delta_; }
  [[nodiscard]] GLuint object_texture() const { return object_; }

 private:
  explicit PictureAtlas(int layers) : allocator_(layers), blocks_(layers) {}
  [[nodiscard]] Result<> make_capture_target();
  void upload(const AtlasSlot& slot, const glm::u8vec4* colors, const void* codes);
  void reduce_to_blocks(const AtlasSlot& slot);
  void read_blocks();

  AtlasOptions options_;
  AtlasAllocator allocator_;
  int capture_size_ = 0;
  std::size_t bytes_ = 0;
  gl::Texture color_, delta_, object_;
  gl::Texture capture_color_, capture_depth_, object_depth_;
  gl::Texture block_texture_;
  int block_rows_ = 0, next_block_row_ = 0;  // of the texture; from here on nothing unread
  gl::Framebuffer capture_framebuffer_, layer_framebuffer_, object_framebuffer_, block_framebuffer_;
  gl::Program resolve_, reduce_;
  PictureBlocks blocks_;
  struct Unread {
    AtlasSlot slot;
    int row;  // of block_texture_, its lowest
  };
  std::vector<Unread> unread_;  // whose blocks the GPU has and blocks_ has not
  std::vector<PictureBlock> read_blocks_;
  gl::VertexArray no_vertices_;
  AtlasPicture encoded_;
};

}  // namespace rilievo
