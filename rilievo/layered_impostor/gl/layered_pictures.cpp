#include "rilievo/layered_impostor/gl/layered_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "rilievo/layered_impostor/gl/silhouette_band.h"
#include "rilievo/layered_impostor/picture_textures.h"

namespace rilievo {
namespace {

// One layer of a texture array from an image, whose row 0 becomes the texture's row 0: shaders
// fetch by raster position.
template <class T>
void upload(GLuint texture, int layer, const Image<T>& image, GLenum format, GLenum type) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage3D(texture, 0, 0, 0, layer, image.width(), image.height(), 1, format, type,
                      image.texels().data());
}

}  // namespace

gl::Texture LayeredPictures::make_array(GLenum format, int width, int height, int texel_bytes) {
  const std::size_t layers = impostor_.pictures.size();
  gl::Texture texture = gl::make_texture_2d_array(format, width, height, int(layers));
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  bytes_ += layers * std::size_t(width) * std::size_t(height) * std::size_t(texel_bytes);
  return texture;
}

Result<LayeredPictures> LayeredPictures::create(LayeredImpostor impostor) {
  LayeredPictures pictures;
  pictures.impostor_ = std::move(impostor);
  const LayeredImpostor& source = pictures.impostor_;
  for (const DepthImage& picture : source.pictures) {
    pictures.width_ = std::max(pictures.width_, picture.camera.width);
    pictures.height_ = std::max(pictures.height_, picture.camera.height);
  }
  GLint max_size = 0, max_layers = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &max_layers);
  if (std::max(pictures.width_, pictures.height_) > max_size ||
      source.pictures.size() > std::size_t(max_layers))
    return Error{source.name, "its pictures are more or larger than this OpenGL's textures"};

  pictures.color_ = pictures.make_array(GL_RGBA8, pictures.width_, pictures.height_, kColorBytes);
  for (std::size_t v = 0; v < source.pictures.size(); ++v)
    upload(pictures.color_, int(v), encoded_colors(source.pictures[v].color), GL_RGBA,
           GL_UNSIGNED_BYTE);
  const ShownObjects objects = shown_objects(source.pictures);
  pictures.only_object_ = objects.only;
  if (objects.several) {
    pictures.object_ = pictures.make_array(GL_R32UI, pictures.width_, pictures.height_, 4);
    for (std::size_t v = 0; v < source.pictures.size(); ++v)
      if (!source.pictures[v].object.empty())
        upload(pictures.object_, int(v), source.pictures[v].object, GL_RED_INTEGER,
               GL_UNSIGNED_INT);
  }
  if (glGetError() == GL_OUT_OF_MEMORY)
    return Error{source.name, "its pictures do not fit the GPU's memory"};
  return pictures;
}

LayeredPictures::SurfaceTextures LayeredPictures::surface_textures() {
  if (!q_) {
    q_ = make_array(GL_R32F, width_, height_, kQBytes);
    // Halves, but fetched as integers: a driver for processors converts each texel of a format
    // of halves by a call.
    slope_ = make_array(GL_RG32UI, width_, height_, kSlopeBytes);
    links_ = make_array(GL_R8UI, width_, height_, kLinksBytes);
    const CellTexture size = cell_texture(width_, height_);
    cells_ = make_array(GL_RG32F, size.columns, size.rows, kCellBytes);
    for (std::size_t v = 0; v < impostor_.surfaces.size(); ++v) {
      const Image<SurfaceTexel>& texels = impostor_.surfaces[v].texels;
      const Image<float> band = silhouette_band(impostor_.surfaces[v]);
      Image<float> q = band;
      Image<glm::uvec2> slope(texels.width(), texels.height());
      Image<std::uint8_t> links(texels.width(), texels.height());
      for (std::size_t i = 0; i < texels.texels().size(); ++i) {
        const SurfaceTexel& t = texels.texels()[i];
        if (t.q != 0) q.texels()[i] = t.q;
        slope.texels()[i] = {glm::packHalf2x16({t.slope[0], t.slope[1]}),
                             glm::packHalf2x16({t.slope[2], t.slope[3]})};
        links.texels()[i] = t.links;
      }
      upload(q_, int(v), q, GL_RED, GL_FLOAT);
      upload(slope_, int(v), slope, GL_RG_INTEGER, GL_UNSIGNED_INT);
      upload(links_, int(v), links, GL_RED_INTEGER, GL_UNSIGNED_BYTE);
      Image<glm::vec2> cells = pyramid_cells(impostor_.surfaces[v], size);
      add_band(band, impostor_.surfaces[v], size, cells);
      upload(cells_, int(v), cells, GL_RG, GL_FLOAT);
    }
  }
  return {q_, slope_, links_, cells_, cell_texture(width_, height_).level_at};
}

GLuint LayeredPictures::interval_texture() {
  if (!interval_) {
    interval_ = make_array(GL_RG16, width_, height_, kIntervalBytes);
    for (std::size_t v = 0; v < impostor_.surfaces.size(); ++v)
      upload(interval_, int(v), slice_codes(impostor_, int(v)), GL_RG, GL_UNSIGNED_SHORT);
    slice_chooser_.emplace(impostor_);
  }
  return interval_;
}

void LayeredPictures::keep_only(LayeredMethod method) {
  if (method == LayeredMethod::surfaces)
    (void)surface_textures();
  else
    (void)interval_texture();
  for (TexelSurface& surface : impostor_.surfaces) surface.texels = {};
  for (DepthImage& picture : impostor_.pictures) {
    picture.color = {};
    picture.depth = {};
    picture.object = {};
  }
}

}  // namespace rilievo
