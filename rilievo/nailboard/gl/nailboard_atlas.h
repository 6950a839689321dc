// How are many pictures kept on the GPU? Colour and Delta in a few texture arrays.
//
// One draw call reaches all of them. Captures fill them without leaving the GPU. Their memory is
// allocated at creation, so that they never exceed the budget. Only object identifiers, which few
// programs ask for, take memory beside it, with the first of them: 4 bytes a texel of all layers,
// and a depth buffer of a layer. Needs a current OpenGL context.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "rilievo/gl/object.h"
#include "rilievo/nailboard/atlas_allocator.h"
#include "rilievo/nailboard/encode_picture.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/occlusion_tiles.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// The size of an atlas and the encoding of its pictures.
struct AtlasOptions {
  std::size_t max_bytes = 256u << 20;  // capture buffers included, object identifiers not
  int delta_bits = 8;                  // 2, 4, 6, 8 or 16
  int samples = 4;                     // per texel at capture: the antialiasing of frames
  // What who captures without OpenGL takes of the budget, for pictures of up to `size` texels a
  // side; null: the atlas captures, and has the buffers for it.
  std::size_t (*capture_bytes)(int size, int samples) = nullptr;
};

// Pictures in texture arrays.
class NailboardAtlas {
 public:
  // Allocates all memory but that of object identifiers. Fails if the budget does not suffice for
  // one picture or the driver refuses.
  [[nodiscard]] static Result<NailboardAtlas> create(const AtlasOptions& options);

  // Allocates a slot; none if the budget is used up.
  [[nodiscard]] std::optional<AtlasSlot> allocate(int width, int height) {
    return allocator_.allocate(width, height);
  }
  void free(const AtlasSlot& slot) { allocator_.free(slot); }

  // Captures `objects` (opaque parts) into the slot, whose size is the camera's. Coverage becomes
  // alpha; depth is that of the nearest sample. Changes the bound framebuffer and viewport.
  void capture(SceneRenderer& renderer, const Camera& camera,
               std::span<const std::uint32_t> objects, const AtlasSlot& slot);
  // Captures the object identifiers of the same picture. The first call allocates their texture.
  void capture_objects(SceneRenderer& renderer, const Camera& camera,
                       std::span<const std::uint32_t> objects, const AtlasSlot& slot);

  // Copies a picture from or to the GPU, bit for bit.
  [[nodiscard]] Nailboard read(const AtlasSlot& slot, const PictureGeometry& geometry) const;
  void write(const AtlasSlot& slot, const Nailboard& nailboard);
  // A picture captured elsewhere, of the slot's size; perspective.
  void write(const AtlasSlot& slot, const RasterPicture& picture);

  // A picture encoded elsewhere: colours and `picture`, rows from the bottom. Changes only the
  // atlas.
  void write(const AtlasSlot& slot, std::span<const glm::u8vec4> color,
             const AtlasPicture& picture);
  // Its object identifiers, rows from the bottom. The first call allocates their texture.
  void write_objects(const AtlasSlot& slot, std::span<const std::uint32_t> objects);

  // The blocks of the slot's picture (occlusion_tiles.h). The first call after a capture or a write
  // waits for the GPU.
  [[nodiscard]] OcclusionTilesView blocks(const AtlasSlot& slot);
  // Narrows the geometry's slab to the samples of the slot's picture, unless it is empty.
  void narrow(const AtlasSlot& slot, PictureGeometry& geometry);

  [[nodiscard]] int delta_bits() const { return options_.delta_bits; }
  // How shaders decode a value v of the Delta texture: v * delta_scale() is Delta. Values above
  // largest_delta(), which is half a step above 1, are the code for "transparent".
  [[nodiscard]] float largest_code() const { return options_.delta_bits > 8 ? 65535.0f : 255.0f; }
  [[nodiscard]] float delta_scale() const {
    return largest_code() / float(delta_steps(options_.delta_bits));
  }
  [[nodiscard]] float largest_delta() const {
    return 1.0f + 0.5f / float(delta_steps(options_.delta_bits));
  }
  // Texels a side of the largest picture; smaller with a small budget.
  [[nodiscard]] int max_picture_size() const { return capture_size_; }
  [[nodiscard]] const AtlasAllocator& allocator() const { return allocator_; }
  // The memory allocated for textures and blocks, but for object identifiers, bytes.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  [[nodiscard]] GLuint color_texture() const { return color_; }
  [[nodiscard]] GLuint delta_texture() const { return delta_; }
  [[nodiscard]] GLuint object_texture() const { return object_; }

 private:
  explicit NailboardAtlas(int layers) : allocator_(layers), blocks_(layers) {}
  [[nodiscard]] Result<> make_capture_target();
  void upload(const AtlasSlot& slot, const glm::u8vec4* colors, const void* codes);
  void reduce_to_blocks(const AtlasSlot& slot);
  void make_object_texture();
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
  OcclusionTiles blocks_;
  struct Unread {
    AtlasSlot slot;
    int row;  // of block_texture_, its lowest
  };
  std::vector<Unread> unread_;  // whose blocks the GPU has and blocks_ has not
  std::vector<OcclusionTile> read_blocks_;
  gl::VertexArray no_vertices_;
  AtlasPicture encoded_;
};

}  // namespace rilievo
