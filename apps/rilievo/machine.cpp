#include "apps/rilievo/machine.h"

#include <fmt/format.h>

#include <memory>

#include "apps/rilievo/output.h"
#include "rilievo/cache/gl/measure_opengl.h"
#include "rilievo/cache/software/measure_software.h"
#include "rilievo/gl/context.h"
#include "rilievo/measure/machine.h"

namespace rilievo::app {
namespace {

std::string text_of_ns(double ns) {
  return ns < 999.5 ? fmt::format("{:.3g} ns", ns) : fmt::format("{:.3g} us", 1e-3 * ns);
}

void print_draw(const char* name, const DrawTimes& times) {
  print("  {:<12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", name, text_of_ns(times.picture_ns),
        text_of_ns(times.picture_pixel_ns), text_of_ns(times.object_ns),
        text_of_ns(times.triangle_ns), text_of_ns(times.polygon_pixel_ns));
}

void print_capture(const char* name, const CaptureTimes& times) {
  print("  {:<12}{:>12}{:>12}{:>12}\n", name, text_of_ns(times.picture_ns),
        text_of_ns(times.texel_ns), text_of_ns(times.triangle_ns));
}

void print_costs(const MachineCosts& costs) {
  print("{}, {} thread{}; {}\n", costs.cpu, costs.threads, costs.threads == 1 ? "" : "s",
        costs.gl_renderer.empty() ? std::string("no OpenGL") : "OpenGL: " + costs.gl_renderer);
  print("  {:<12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "drawing", "a picture", "its pixel",
        "an object", "a triangle", "its pixel");
  print_draw("software", costs.draw_software);
  if (costs.draw_opengl) print_draw("opengl", *costs.draw_opengl);
  print("  {:<12}{:>12}{:>12}{:>12}\n", "capturing", "a picture", "its texel", "a triangle");
  print_capture("rasterizer", costs.capture_rasterizer);
  if (costs.capture_opengl) print_capture("opengl", *costs.capture_opengl);
  print("  {:<12}{:>12}{:>12}\n", "rays", "", text_of_ns(costs.ray_texel_ns));
}

}  // namespace

Result<> describe_machine(const std::string& json) {
  Result<MachineCosts> costs = measure_software();
  if (!costs) return costs.error();
  if (Result<std::unique_ptr<gl::Context>> context = gl::Context::create(); context)
    if (Result<> measured = measure_opengl(*costs); !measured) return measured;
  const Machine machine = this_machine();
  costs->cpu = machine.cpu, costs->threads = machine.threads;
  if (!json.empty()) return write_text(json, machine_json(*costs));
  print_costs(*costs);
  return Done{};
}

void add_machine_option(CLI::App& command, const std::string& of,
                        std::optional<MachineCosts>& costs) {
  command
      .add_option_function<std::string>(
          "--machine",
          [&costs](const std::string& file) {
            Result<MachineCosts> loaded = load_machine(file);
            if (!loaded) throw CLI::ValidationError("--machine", loaded.error().message());
            costs = std::move(*loaded);
          },
          of +
              ": what drawing and capturing take, as `rilievo info --machine --json FILE` measures "
              "it on a machine (default: the same built-in costs everywhere; with either, frames "
              "are the same on all machines)")
      ->type_name("FILE");
}

}  // namespace rilievo::app
