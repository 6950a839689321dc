// How does OpenGL draw points and lines? GLSL for the scene's shaders.
//
// Each point becomes a triangle around its disc, each line three quads around its strip and its
// ends; the fragment shader then decides sample by sample, by the formulae of
// render/raster/stroke_setup.inl. Vertices are read from a storage buffer, in the order of the
// corners.
#pragma once

namespace rilievo::shader {

// Vertices of a point and of a line.
inline constexpr int kDiscVertices = 3, kLineVertices = 18;
// The bindings of their buffers.
inline constexpr unsigned kStrokeVertices = 3, kStrokeUvs = 4;

// `void read_stroke()` sets what the vertex shader otherwise reads as attributes, and
// `place_stroke()` the vertex's place.
extern const char* const kStrokeVertex;
// `int stroke_samples()`: which samples does it cover? A bit each.
extern const char* const kStrokeFragment;

}  // namespace rilievo::shader
