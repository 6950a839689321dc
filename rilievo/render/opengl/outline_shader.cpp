#include "rilievo/render/opengl/outline_shader.h"

namespace rilievo::shader {

Result<gl::Program> make_outline_program(const std::string& vertex) {
  return gl::make_program("outline", vertex, R"(#version 450
layout(location = 0) out vec4 out_color;
void main() { out_color = vec4(1.0, 0.85, 0.1, 1.0); }  // sRGB
)");
}

}  // namespace rilievo::shader
