// Software shaders by name.
//
//   raytrace      the scene, ray-traced (ray_tracer.h)
//   sdf:NAME      a field of signed distances (field_shader.h): torus, gyroid, menger
//   exec:PROGRAM  a renderer in another process (exec_source.h): only for a user who names it,
//                 never for a file that does
#pragma once

#include <memory>
#include <string_view>

#include "rilievo/capture/capture_source.h"
#include "rilievo/capture/shaders/exec_source.h"
#include "rilievo/capture/shaders/field_shader.h"
#include "rilievo/capture/shaders/trace_light.h"

namespace rilievo {

// What shaders are made from.
struct ShaderInput {
  const RayScene* rays = nullptr;  // for raytrace; must outlive the shader
  TraceOptions trace = {};
  FieldLook look = {};
  ExecOptions exec = {};
};

// The program of exec:PROGRAM; empty: the text names none.
[[nodiscard]] std::string_view program_named(std::string_view text);

// Who shows a scene: raster, rays, raytrace or exec:PROGRAM. Fails for other texts.
[[nodiscard]] Result<> check_source(std::string_view text);
// Does such a source take long for a picture? The last two do.
[[nodiscard]] bool is_slow_source(std::string_view text);

// Does the text name a shader, as far as that can be said before it is made?
[[nodiscard]] Result<> check_shader(std::string_view text);

// A slow source of this scene whose depths are those of rays: a program's light is put on what rays
// see (lit_source.h), as its own depths are of one sample somewhere in a texel. Fails as
// make_shader().
[[nodiscard]] Result<std::unique_ptr<CaptureSource>> make_slow_source(std::string_view text,
                                                                      const ShaderInput& input);

// Makes the shader. The error says which there are, or what it lacks.
[[nodiscard]] Result<std::unique_ptr<CaptureSource>> make_shader(std::string_view text,
                                                                 const ShaderInput& input);

}  // namespace rilievo
