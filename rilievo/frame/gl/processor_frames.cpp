#include "rilievo/frame/gl/processor_frames.h"

#include <utility>

#include "rilievo/gl/object.h"

namespace rilievo {
namespace {

const char* const kPresentVertex = R"(#version 450
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

// Colours are premultiplied by the share of samples that are covered.
const char* const kPresentFragment = R"(#version 450
layout(binding = 1) uniform sampler2D depth_texture;
#if IDENTIFIERS
layout(binding = 0) uniform usampler2D object_texture;
layout(location = 0) out uint out_object;
#else
layout(binding = 0) uniform sampler2D color_texture;
layout(location = 0) uniform int samples;
layout(location = 0) out vec4 out_color;
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
#if IDENTIFIERS
  out_object = texelFetch(object_texture, at, 0).r;
  if (out_object == 0u) discard;
#else
  vec4 color = texelFetch(color_texture, at, 0);
  if (color.a == 0.0) discard;
  if (samples > 1) gl_SampleMask[0] = (1 << int(float(samples) * color.a + 0.5)) - 1;
  out_color = vec4(color.rgb / color.a, 1.0);
#endif
#if DEPTH
  gl_FragDepth = texelFetch(depth_texture, at, 0).r;
#endif
}
)";
static_assert(kNoObject == 0);

struct PresentedTextures {
  int width = 0, height = 0;
  gl::Texture color, object, depth;

  void resize(int new_width, int new_height) {
    if (width == new_width && height == new_height) return;
    width = new_width, height = new_height;
    color = gl::make_texture_2d(GL_RGBA8, width, height);
    object = gl::make_texture_2d(GL_R32UI, width, height);
    depth = gl::make_texture_2d(GL_R32F, width, height);
    // Without filters: integers cannot be read with them.
    for (const GLuint texture : {GLuint(color), GLuint(object), GLuint(depth)}) {
      glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
  }
};

}  // namespace

// The drawable that stands for all objects of a frame.
class ProcessorFrames::Picture final : public Drawable {
 public:
  Picture(FrameRenderer& processor, int samples, bool needs_depth)
      : processor_(processor), samples_(samples), needs_depth_(needs_depth) {}

  Result<> compile() {
    for (const bool identifiers : {false, true}) {
      const std::string defines = std::string("#define IDENTIFIERS ") + (identifiers ? "1" : "0") +
                                  "\n#define DEPTH " + (identifiers || needs_depth_ ? "1" : "0") +
                                  "\n";
      Result<gl::Program> made =
          gl::make_program("presented frame", kPresentVertex, kPresentFragment, defines);
      if (!made) return made.error();
      programs_[identifiers] = std::move(*made);
    }
    no_vertices_ = gl::make_vertex_array();
    return Done{};
  }

  Result<> render(const Camera& camera, double time) {
    if (Result<> set = processor_.set_time(time); !set) return set;
    return processor_.draw(camera, samples_, colors_);
  }

  [[nodiscard]] std::string_view kind() const override { return "direct"; }

  void draw(const Camera& frame, std::span<const Instance>, Output output) override {
    const bool identifiers = output == Output::object_id;
    textures_.resize(frame.width, frame.height);
    // Fails where render() has failed before.
    if (identifiers && !processor_.draw_objects(frame, objects_)) return;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    if (identifiers)
      upload(textures_.object, GL_RED_INTEGER, GL_UNSIGNED_INT, objects_.object.data());
    else
      upload(textures_.color, GL_RGBA, GL_UNSIGNED_BYTE, colors_.color.data());
    if (identifiers || needs_depth_)
      upload(textures_.depth, GL_RED, GL_FLOAT,
             identifiers ? objects_.depth.data() : colors_.depth.data());
    glBindTextureUnit(0, identifiers ? textures_.object : textures_.color);
    glBindTextureUnit(1, textures_.depth);
    glUseProgram(programs_[identifiers]);
    if (!identifiers) glUniform1i(0, samples_);
    glBindVertexArray(no_vertices_);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  void draw_outlines(const Camera&, std::span<const Instance>) override {}

  // Nobody chooses it: it is the frame.
  [[nodiscard]] ErrorModel error_model(std::uint32_t) const override { return {}; }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const override { return {}; }
  [[nodiscard]] std::size_t bytes() const override { return 0; }

 private:
  void upload(const gl::Texture& texture, GLenum format, GLenum type, const void* data) const {
    glTextureSubImage2D(texture, 0, 0, 0, textures_.width, textures_.height, format, type, data);
  }

  FrameRenderer& processor_;
  int samples_;
  bool needs_depth_;  // blended parts follow
  gl::Program programs_[2];
  gl::VertexArray no_vertices_;
  PresentedTextures textures_;
  RasterPicture colors_;
  ObjectPicture objects_;
};

ProcessorFrames::ProcessorFrames(SceneRenderer& renderer, std::unique_ptr<FrameRenderer> processor)
    : SceneFrames(renderer), processor_(std::move(processor)) {}
ProcessorFrames::~ProcessorFrames() = default;

Result<std::unique_ptr<ProcessorFrames>> ProcessorFrames::create(
    SceneRenderer& renderer, std::unique_ptr<FrameRenderer> processor, int samples) {
  if (samples != 1 && samples != 4) return Error{"--samples", "processors draw 1 or 4 samples"};
  std::unique_ptr<ProcessorFrames> frames(new ProcessorFrames(renderer, std::move(processor)));
  bool blends = false;
  for (std::uint32_t i = 0; i < renderer.scene().objects.size(); ++i)
    blends = blends || renderer.has_blended_parts(i);
  frames->picture_ = std::make_unique<Picture>(*frames->processor_, samples, blends);
  if (Result<> compiled = frames->picture_->compile(); !compiled) return compiled.error();
  frames->content().sets.push_back({frames->picture_.get(), {}});
  return {std::move(frames)};
}

Result<> ProcessorFrames::choose(const Camera& camera, FrameContent& content, FrameStats&) {
  if (Result<> drawn = picture_->render(camera, time()); !drawn) return drawn;
  content.sets[0].instances.push_back({});
  return Done{};
}

}  // namespace rilievo
