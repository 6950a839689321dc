// The renderer that captures pictures for an atlas of nailboards.
#pragma once

namespace rilievo {

// The renderer that captures pictures. Numbers of samples that the rasteriser does not support are
// left to OpenGL.
enum class CaptureBy {
  automatic,   // the rasteriser if there is no OpenGL or it runs on the CPU, else OpenGL
  opengl,      // capture/gl/opengl_source.h
  rasterizer,  // capture/raster_source.h
};

}  // namespace rilievo
