#include "rilievo/gl/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstring>

namespace rilievo::gl {
namespace {

EGLDisplay open_display() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto has = [&](const char* name) { return extensions && std::strstr(extensions, name); };
  // A GPU's driver first, then Mesa without any window system.
  if (has("EGL_EXT_platform_device") && has("EGL_EXT_device_enumeration")) {
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (eglQueryDevicesEXT(16, devices, &count)) {
      for (EGLint i = 0; i < count; ++i) {
        const char* of_device = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        if (of_device && std::strstr(of_device, "EGL_MESA_device_software")) continue;
        EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
      }
    }
  }
  if (has("EGL_MESA_platform_surfaceless")) {
    EGLDisplay display =
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  }
  return EGL_NO_DISPLAY;
}

}  // namespace

Result<std::unique_ptr<Context>> Context::create() {
  EGLDisplay display = open_display();
  if (display == EGL_NO_DISPLAY)
    return Error{"EGL", "no display without a window system (is libegl-mesa0 installed?)"};
  if (!eglBindAPI(EGL_OPENGL_API)) return Error{"EGL", "this driver has no desktop OpenGL"};
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) return Error{"EGL", "this driver has no OpenGL 4.5 core context"};
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    eglDestroyContext(display, context);
    return Error{"EGL", "the context cannot be made current without a surface"};
  }
  std::unique_ptr<Context> made(new Context);
  made->display_ = display;
  made->context_ = context;
  return made;
}

Context::~Context() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

std::string renderer_name() {
  const GLubyte* name = glGetString(GL_RENDERER);
  return name ? reinterpret_cast<const char*>(name) : "none";
}

bool is_software() {
  const std::string name = renderer_name();
  return name.starts_with("llvmpipe") || name.starts_with("softpipe") ||
         name.find("SwiftShader") != std::string::npos;
}

void finish() { glFinish(); }

Result<> check_errors(const char* where) {
  GLenum first = glGetError();
  if (first == GL_NO_ERROR) return Done{};
  // Drain the queue, so that the next check speaks of the next step.
  while (glGetError() != GL_NO_ERROR) {
  }
  char code[32];
  std::snprintf(code, sizeof code, "OpenGL error 0x%04x", first);
  return Error{where, code};
}

}  // namespace rilievo::gl
