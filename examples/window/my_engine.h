// Stands for a host program's engine: its own window, camera and polygons, and a reversed z-buffer
// in which nearer is larger and there is no far plane. Knows nothing of Rilievo.
#pragma once

#include <epoxy/gl.h>
// After epoxy.
#include <GLFW/glfw3.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/ext.hpp>
#include <vector>

// A window and one triangle.
struct MyEngine {
  int width = 640, height = 360, samples = 4;
  glm::mat4 view{1.0f}, projection{1.0f};

  // Shows some frames and saves the last as PPM if `shot` is given; else until it is closed.
  explicit MyEngine(const char* shot) : shot_(shot) {
    if (!glfwInit()) fail("no display");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SAMPLES, samples);
    window_ = glfwCreateWindow(width, height, "Rilievo in a window", nullptr, nullptr);
    if (!window_) fail("no OpenGL 4.5");
    glfwMakeContextCurrent(window_);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glClearDepth(0);
    glClearColor(0.15f, 0.2f, 0.3f, 1);
    program_ = glCreateProgram();
    const auto add = [&](GLenum type, const char* text) {
      const GLuint shader = glCreateShader(type);
      glShaderSource(shader, 1, &text, nullptr);
      glCompileShader(shader);
      glAttachShader(program_, shader);
    };
    add(GL_VERTEX_SHADER,
        "#version 450\nlayout(location = 0) uniform mat4 clip_from_world;\n"
        "layout(location = 1) uniform vec4 ball;\nout vec3 color;\nvoid main() {\n"
        "  vec2 p = vec2[](vec2(-1.1, -0.6), vec2(1.1, -0.6), vec2(0, 1.3))[gl_VertexID];\n"
        "  gl_Position = clip_from_world * vec4(ball.xyz + ball.w * vec3(p, 0), 1);\n"
        "  color = vec3[](vec3(1, 0.3, 0.2), vec3(0.2, 0.9, 0.3), vec3(0.3, 0.4, "
        "1))[gl_VertexID];\n}");
    add(GL_FRAGMENT_SHADER,
        "#version 450\nin vec3 color;\nout vec4 out_color;\nvoid main() { out_color = vec4(color, "
        "1); }");
    glLinkProgram(program_);
    glCreateVertexArrays(1, &no_vertices_);
  }
  ~MyEngine() { glfwTerminate(); }

  // Looks at a ball; false when all is shown.
  bool begin_frame(const glm::vec3& center, float radius) {
    if (frame_ > 0) end_frame();
    if (glfwWindowShouldClose(window_) || (shot_ && frame_ == 3)) return false;
    glfwGetFramebufferSize(window_, &width, &height);
    const float angle = 0.4f + 0.01f * float(frame_++), n = 0.05f * radius;
    const glm::vec3 eye =
        center + 2.6f * radius * glm::vec3(std::sin(angle), 0.35f, std::cos(angle));
    view = glm::lookAt(eye, center, glm::vec3(0, 1, 0));
    // Reversed, without a far plane: depth = n / distance.
    const float f = 1 / std::tan(0.4f);
    projection =
        glm::mat4(f * float(height) / float(width), 0, 0, 0, 0, f, 0, 0, 0, 0, 0, -1, 0, 0, n, 0);
    ball_ = glm::vec4(center, radius);
    glViewport(0, 0, width, height);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    return true;
  }

  void draw_triangle() const {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glUseProgram(program_);
    const glm::mat4 clip_from_world = projection * view;
    glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_world[0][0]);
    glUniform4fv(1, 1, &ball_[0]);
    glBindVertexArray(no_vertices_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

 private:
  static void fail(const char* why) { std::fprintf(stderr, "%s\n", why), std::exit(1); }
  void end_frame() {
    if (shot_ && frame_ == 3) save();
    glfwSwapBuffers(window_);
    glfwPollEvents();
  }
  void save() const {
    std::vector<unsigned char> rgb(std::size_t(width) * std::size_t(height) * 3);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
    std::FILE* file = std::fopen(shot_, "wb");
    if (!file) fail("cannot write the picture");
    std::fprintf(file, "P6 %d %d 255\n", width, height);
    for (int y = height; y-- > 0;)
      std::fwrite(&rgb[std::size_t(y) * std::size_t(width) * 3], 3, std::size_t(width), file);
    std::fclose(file);
  }

  const char* shot_;
  GLFWwindow* window_ = nullptr;
  GLuint program_ = 0, no_vertices_ = 0;
  glm::vec4 ball_{0.0f};
  int frame_ = 0;
};
