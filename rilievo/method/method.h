// Drawing methods by name: one call makes the frames of any of them, by any backend.
//
//   direct, direct-raster, direct-rays    polygons; by the backend, our rasteriser, or rays
//   lod                                   levels of detail
//   flat, nailboard                       a picture for each heavy object
//   cache                                 pictures of groups, within an error in pixels
//   relief-impostor                       objects that are rendered beside the frames
//   keyframes                             whole frames, warped from pictures of the whole view
//   auto                                  each frame by the cheapest of these that is good enough
//   and the kinds of representation, which are baked before the first frame
//
// A method is one file with a chooser (frame/frame_chooser.h), and one line in methods.cpp.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/cache/plan/policy.h"
#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/capture/shaders/exec_source.h"
#include "rilievo/frame/backend.h"
#include "rilievo/representation/kind_methods.h"

namespace rilievo {

struct ImpostorStatus;  // method/relief_impostors.h

// The options of relief impostors.
struct ReliefImpostorOptions {
  std::string shader = "raytrace";
  std::vector<std::string> objects;  // names, #INDEX; empty: all
  int workers = 1;
  std::string store;  // a file; empty: none
  int store_mb = 4096;
  int texels = 1024;  // of a picture's longer side, at most
  int samples = 4;    // of a texel
  bool background = false;
};

// The options of all methods; each takes those that it has.
struct MethodOptions {
  int delta_bits = 8;
  DepthMode depth_mode = DepthMode::exact;  // nailboard, cache
  bool outlines = false;
  bool sky = true;             // draw the sky of the backend's scene behind what a file holds
  double angle_degrees = 0.7;  // flat, nailboard
  int memory_mb = 256;
  double error_px = 1;               // cache, lod
  double gap_px = 0;                 // cache, keyframes; 0: twice error_px, or 4
  bool levels = false;               // cache, without OpenGL: levels of detail
  double capture_ms = 0;             // cache; 0: a budget by triangles
  double late = SpikePolicy{}.late;  // cache, with capture_ms
  double max_spike = 0;              // cache; 0: no limit
  bool fade = true;                  // cache
  int bake_mb = 0;                   // cache; 0: bakes nothing
  std::vector<std::string> bake_as{
      std::string(default_kind().name)};  // cache: kinds that are baked
  std::optional<double> bake_beyond;      // cache: metres
  bool bake_together = false;             // cache: all that stands still as one
  double texel_px = 4;                    // kinds drawn for objects
  std::string source = "raster";          // keyframes: raster, rays, raytrace, exec:PROGRAM
  double keyframe_ms = 0;                 // keyframes: time a frame; 0: the usual share
  std::string program_scene;              // keyframes: what exec:PROGRAM opens: its argument
  int keyframe_samples = 4;               // keyframes: of a texel: 1, 4 or 16
  double fps = 0;      // auto: frames a second that are enough; 0: as many as can be
  double loss_db = 4;  // auto: how much worse than direct drawing keyframes may look
  // auto: decide by the time that frames take; else by counts of work. keyframes by raytrace and
  // exec: are made beside the frames; else frames wait for them, and runs are alike.
  bool by_clock = false;
  KindOptions kinds;
  ReliefImpostorOptions impostors;
  Box eyes = {};                                      // where eyes will be; empty: not known
  std::vector<glm::vec3> eye_path = {};               // their places there; empty: not known
  std::optional<MachineCosts> machine = {};           // cache; none: the costs built in
  Progress progress = {};                             // of what is baked before the first frame
  std::function<void(const std::string&)> warn = {};  // of programs and stores; a line each
  std::function<void(const std::string&)> note = {};  // of what was baked; a line each
  ExecWaits waits = {};                               // of keyframes' exec:PROGRAM
};

// A method, made.
struct Method {
  std::unique_ptr<FrameSource> frames;
  // Takes over those options that can change between frames; empty: there are none.
  std::function<void(const MethodOptions&)> follow = {};
  // The state of the last frame's impostors, for a panel; empty: there are none.
  std::function<std::span<const ImpostorStatus>()> impostors = {};
};

// A line of the list of methods.
struct MethodRow {
  std::string_view name;
  // Errors about an option name it as the command line does.
  Result<Method> (*make)(const MethodOptions& options, Backend& backend) = nullptr;
  // Where either may draw, software draws if that is faster.
  bool software_first = true;
  // It shows skins and morph targets by time (Backend::deformations).
  bool bends = false;
};

// All methods but those of the kinds.
[[nodiscard]] std::span<const MethodRow> methods();
// The row of that name; null: there is none.
[[nodiscard]] const MethodRow* find_method(std::span<const MethodRow> rows, std::string_view name);
// The names of all methods, those of the kinds last.
[[nodiscard]] std::vector<std::string> method_names();

// Why a method does not draw a scene whose skins and morph targets move; it names those that do.
[[nodiscard]] std::string cannot_bend(std::string_view name);

// Makes a method's frames of the backend's scene, which must outlive them, as must the backend.
// Fails for an unknown name, where the backend cannot draw the method, where something bends that
// the method cannot bend, and where a bake fails.
[[nodiscard]] Result<Method> make_method(std::string_view name, const MethodOptions& options,
                                         Backend& backend);
// The same with another list; kinds are always known.
[[nodiscard]] Result<Method> make_method(std::span<const MethodRow> rows, std::string_view name,
                                         const MethodOptions& options, Backend& backend);

// The content of another file.
struct StoredBeside {
  const Kind* kind = nullptr;
  std::unique_ptr<Representation> representation;
};
// Frames of a file's content, drawn by a method of its kind, under its own sky, or that of the
// backend's scene. Its own kind draws each content `beside` it, such as an object that stands
// between nodes, into the same z-buffer. A drawable takes the representation for itself: each needs
// a load.
[[nodiscard]] Result<Method> make_stored_method(std::string_view name, const MethodOptions& options,
                                                Backend& backend,
                                                std::unique_ptr<Representation> representation,
                                                std::vector<StoredBeside> beside = {});
// Frames of pictures with depth, drawn as nailboards.
[[nodiscard]] Result<Method> make_stored_method(std::span<const DepthImage> pictures,
                                                int delta_bits, const MethodOptions& options,
                                                Backend& backend);

}  // namespace rilievo
