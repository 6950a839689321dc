// A multisampled framebuffer whose samples are read one by one.
//
// What each sample of a picture shows: linear colour, window_z and object. Rows from the bottom.
// Needs a current OpenGL context; changes the bound framebuffers, viewport and state of drawing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "rilievo/core/image.h"
#include "rilievo/gl/object.h"

namespace rilievo {

// A target of several samples a texel.
class SampleTarget {
 public:
  // `extract`: make_extract_program()'s, which must outlive the target. Fails if the driver refuses
  // a float framebuffer of this size.
  [[nodiscard]] static Result<SampleTarget> create(int width, int height, int samples,
                                                   GLuint extract);
  // The program that reads samples, for SceneRenderer::kept_program().
  [[nodiscard]] static Result<gl::Program> make_extract_program(std::string_view name);

  // Binds the target for drawing colours, or identifiers (after the colours), and clears it: depth
  // is near for cameras that keep the farthest sample.
  void begin_color(bool keeps_farthest);
  void begin_objects(bool keeps_farthest);

  // As many as the driver has made of those asked for. Where they lie, from the texel's centre.
  [[nodiscard]] std::vector<glm::vec2> places() const;
  // Reads the k-th sample of all texels.
  struct Samples {
    Image<glm::vec4> color;
    Image<float> window_z;
    Image<std::uint32_t> object;
  };
  void read(int sample, Samples& samples);

 private:
  void begin(const gl::Framebuffer& framebuffer, bool keeps_farthest);

  int width_ = 0, height_ = 0;
  gl::Texture color_, object_, depth_;              // multisampled
  gl::Texture one_color_, one_object_, one_depth_;  // of one sample
  gl::Framebuffer color_target_, object_target_, one_;
  GLuint extract_ = 0;
  gl::VertexArray no_vertices_;
};

}  // namespace rilievo
