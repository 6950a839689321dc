# The public headers: what a program includes, and what the documentation is about. They are installed, with what
# they include themselves (rilievo_needed_headers); all else is private.
set(RILIEVO_PUBLIC_HEADERS
    # What a picture with depth is.
    core/bounds.h
    core/camera.h
    core/camera_path.h
    core/color.h
    core/depth.h
    core/depth_image.h
    core/image.h
    core/picture_geometry.h
    core/result.h
    core/world_space.h
    # Files.
    io/deep_exr.h
    io/exr.h
    io/png.h
    io/rgbd.h
    # Scenes and their files.
    scene/scene.h
    scene/bend.h
    scene/builtin/builtin.h
    scene/files/load_scene.h
    scene/files/save_glb.h
    # Who captures pictures.
    capture/capture_source.h
    capture/callable_source.h
    capture/deep_image_source.h
    capture/photograph_source.h
    capture/ray_source.h
    capture/shaders/exec_source.h
    capture/gl/opengl_source.h
    # Kinds of representation: what they are, baked, loaded, drawn.
    kind/kind.h
    kind/drawable.h
    kind/option.h
    representation/kinds.h
    representation/kind_methods.h
    representation/load_representation.h
    representation/bake_objects.h
    representation/software/software_factories.h
    representation/gl/factories.h
    # Backends, choosers, frames; a host's matrices and framebuffer.
    frame/backend.h
    frame/backend_target.h
    frame/camera_from.h
    frame/frame_chooser.h
    frame/frame_content.h
    frame/frame_source.h
    frame/software/software_backend.h
    frame/gl/opengl_backend.h
    frame/gl/host_frames.h
    # Methods by name, and baked files; the cache.
    method/method.h
    method/open_baked.h
    cache/scene_cache.h
    cache/prices/machine_costs.h
    cache/software/measure_software.h
    cache/gl/measure_opengl.h
    # How right, and how fast.
    measure/psnr.h
    measure/ssim.h
    measure/flip.h
    measure/report.h
    compare/compare.h
    # Where frames are drawn.
    gl/context.h
    render/opengl/frame_target.h
    render/opengl/scene_renderer.h
    render/software/software_target.h
    render/software/frame_tile.h)

# rilievo_needed_headers(OUT HEADERS...): these and all that they include of rilievo/, relative to it.
function(rilievo_needed_headers out)
  set(found)
  set(waiting ${ARGN})
  while(waiting)
    list(POP_FRONT waiting header)
    if(header IN_LIST found)
      continue()
    endif()
    list(APPEND found ${header})
    file(STRINGS ${PROJECT_SOURCE_DIR}/rilievo/${header} includes REGEX "^#include \"rilievo/")
    foreach(include ${includes})
      string(REGEX REPLACE "^#include \"rilievo/([^\"]*)\".*" "\\1" path ${include})
      list(APPEND waiting ${path})
    endforeach()
  endwhile()
  set(${out} ${found} PARENT_SCOPE)
endfunction()
