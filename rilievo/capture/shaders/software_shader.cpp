#include "rilievo/capture/shaders/software_shader.h"

#include <string>
#include <utility>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shaders/lit_source.h"
#include "rilievo/capture/shaders/ray_tracer.h"

namespace rilievo {
namespace {

constexpr std::string_view kField = "sdf:", kProgram = "exec:", kTracer = "raytrace";

Error unknown_shader(std::string_view text) {
  std::string names;
  for (const DistanceField& field : distance_fields()) names += ", sdf:" + std::string(field.name);
  return {"shader '" + std::string(text) + "'",
          "is unknown; there are raytrace" + names + " and exec:PROGRAM"};
}

// A program's light on what rays see.
class ProgramOnRays final : public CaptureSource {
 public:
  ProgramOnRays(const RayScene& rays, std::unique_ptr<CaptureSource> program)
      : rays_(rays),
        program_(std::move(program)),
        lit_(rays_, *program_, {.light = LightOf::program}),
        rest_(rays_, *program_, {.light = LightOf::program, .may_miss = true}) {}

  [[nodiscard]] std::string_view name() const override { return program_->name(); }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override {
    return lit_.bounds(objects);
  }
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    if (is_of_this_scene_) return rest_.capture(request);
    Result<CapturedPicture> first = lit_.capture(request);
    is_of_this_scene_ = first.ok();
    return first;
  }
  [[nodiscard]] const Scene* scene() const override { return lit_.scene(); }

 private:
  RaySource rays_;
  std::unique_ptr<CaptureSource> program_;
  // The first picture tells whether the program shows this scene. Later ones may look at what it
  // does not show.
  LitSource lit_, rest_;
  bool is_of_this_scene_ = false;
};

}  // namespace

std::string_view program_named(std::string_view text) {
  return text.starts_with(kProgram) ? text.substr(kProgram.size()) : std::string_view();
}

bool is_slow_source(std::string_view text) {
  return text == kTracer || !program_named(text).empty();
}

Result<> check_source(std::string_view text) {
  if (text == "raster" || text == "rays" || is_slow_source(text)) return Done{};
  return Error{"source '" + std::string(text) + "'",
               "is unknown; there are raster, rays, raytrace and exec:PROGRAM"};
}

Result<> check_shader(std::string_view text) {
  const bool known =
      text == kTracer ||
      (text.starts_with(kField) && find_distance_field(text.substr(kField.size()))) ||
      !program_named(text).empty();
  if (!known) return unknown_shader(text);
  return Done{};
}

Result<std::unique_ptr<CaptureSource>> make_shader(std::string_view text,
                                                   const ShaderInput& input) {
  using Made = std::unique_ptr<CaptureSource>;
  if (Result<> known = check_shader(text); !known) return known.error();
  if (text.starts_with(kField))
    return Made(std::make_unique<FieldShader>(*find_distance_field(text.substr(kField.size())),
                                              input.look));
  if (const std::string_view program = program_named(text); !program.empty()) {
    Result<std::unique_ptr<ExecSource>> started =
        ExecSource::create(std::string(program), input.exec);
    if (!started) return started.error();
    return Made(*std::move(started));
  }
  if (!input.rays) return Error{"shader 'raytrace'", "needs a scene"};
  return Made(std::make_unique<RayTracer>(*input.rays, input.trace));
}

Result<std::unique_ptr<CaptureSource>> make_slow_source(std::string_view text,
                                                        const ShaderInput& input) {
  Result<std::unique_ptr<CaptureSource>> made = make_shader(text, input);
  if (!made || program_named(text).empty()) return made;
  if (!input.rays) return Error{"source '" + std::string(text) + "'", "needs a scene"};
  return {std::make_unique<ProgramOnRays>(*input.rays, *std::move(made))};
}

}  // namespace rilievo
