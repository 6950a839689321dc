#include "rilievo/gl/driver.h"

#include <epoxy/gl.h>

namespace rilievo::gl {

std::string driver_version() {
  const GLubyte* version = glGetString(GL_VERSION);
  return version ? reinterpret_cast<const char*>(version) : "none";
}

}  // namespace rilievo::gl
