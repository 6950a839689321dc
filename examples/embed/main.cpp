// Rilievo inside somebody else's program: a GLFW window with its own loop and its own polygons, and
// a scene drawn from pictures with depth, in one z-buffer.
//
//   rilievo_embed [SCENE [FRAMES SCREENSHOT.png]]    e.g. rilievo_embed builtin:teapots
#include <epoxy/gl.h>
// After epoxy.
#include <GLFW/glfw3.h>

#include <cstdio>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/gl/object.h"
#include "rilievo/io/png.h"
#include "rilievo/method/method.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

using namespace rilievo;

// What is wanted, or the end with a reason.
template <class T>
T take(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message().c_str());
  std::exit(1);
}

// The host's own drawing: a colourful three-sided fan that turns in the middle of the scene.
const char* const kVertex = R"(#version 450
layout(location = 0) uniform mat4 clip_from_fan;
out vec3 color;
void main() {
  float angle = radians(120.0) * float(gl_VertexID / 3) + radians(40.0) * float(gl_VertexID % 3);
  vec2 p = gl_VertexID % 3 == 0 ? vec2(0.0) : vec2(cos(angle), sin(angle));
  gl_Position = clip_from_fan * vec4(p, 0.0, 1.0);
  color = vec3(gl_VertexID / 3 == 0, gl_VertexID / 3 == 1, gl_VertexID / 3 == 2) * 0.8 + 0.2;
}
)";
const char* const kFragment = R"(#version 450
in vec3 color;
out vec4 out_color;
void main() { out_color = vec4(color, 1.0); }
)";

int main(int argc, char** argv) {
  const std::string name = argc > 1 ? argv[1] : "builtin:teapots";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 0;  // 0: until the window is closed
  const Scene scene =
      is_builtin(name) ? take(make_builtin(name)).scene : take(load_scene(name)).scene;

  if (!glfwInit()) return std::fprintf(stderr, "no display\n"), 1;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SAMPLES, 4);
  GLFWwindow* window = glfwCreateWindow(1280, 720, "Rilievo embedded", nullptr, nullptr);
  if (!window) return std::fprintf(stderr, "no OpenGL 4.5\n"), 1;
  glfwMakeContextCurrent(window);
  {
    const auto backend = take(OpenGLBackend::create(scene, 4));
    const Method cache = take(make_method("cache", {}, *backend));
    const gl::Program fan = take(gl::make_program("fan", kVertex, kFragment));
    const gl::VertexArray no_vertices = gl::make_vertex_array();
    const Box bounds = world_bounds(scene);
    const glm::dvec3 center = bounds.center();
    const double radius = std::max(1e-3f, bounds.radius());

    for (int frame = 0; !glfwWindowShouldClose(window) && (frames == 0 || frame < frames);
         ++frame) {
      int width = 0, height = 0;
      glfwGetFramebufferSize(window, &width, &height);
      if (width == 0 || height == 0) width = height = 1;
      const double time = frame / 60.0, around = 0.1 * time;
      const glm::dvec3 eye =
          center + radius * glm::dvec3(1.6 * std::sin(around), 0.5, 1.6 * std::cos(around));
      const Camera camera =
          look_at(eye, center, {0, 1, 0}, 0.8, width, height, 0.01 * radius, 10 * radius);

      glViewport(0, 0, width, height);
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      // Rilievo draws into the framebuffer that is bound, and leaves the state as it was.
      take(cache.frames->draw(camera, time));
      // The host's polygons meet the pictures in the z-buffer.
      const glm::mat4 clip_from_fan =
          glm::mat4(clip_from_world(camera) * glm::translate(glm::dmat4(1), center) *
                    glm::rotate(glm::dmat4(1), time, {0, 1, 0}) *
                    glm::scale(glm::dmat4(1), glm::dvec3(0.5 * radius)));
      glEnable(GL_DEPTH_TEST);
      glUseProgram(fan);
      glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_fan[0][0]);
      glBindVertexArray(no_vertices);
      glDrawArrays(GL_TRIANGLES, 0, 9);

      if (argc > 3 && frame + 1 == frames) {
        Rgba8Image shot(width, height);
        for (int y = 0; y < height; ++y)
          glReadPixels(0, height - 1 - y, width, 1, GL_RGBA, GL_UNSIGNED_BYTE, shot.row(y).data());
        for (glm::u8vec4& pixel : shot.texels()) pixel.a = 255;
        take(save_png(argv[3], shot));
      }
      glfwSwapBuffers(window);
      glfwPollEvents();
    }
  }
  glfwDestroyWindow(window);
  glfwTerminate();
}
