// Nailboards drawn without OpenGL, beside OpenGL if there is one.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "bench/benches.h"
#include "bench/compose_scene.h"
#include "bench/timing.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/gl/context.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"
#include "rilievo/nailboard/software/nailboard_composer.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo::bench {
namespace {

constexpr int kPictures = 300, kSmall = 10000, kBits = 16;
constexpr double kCover = 3;

// Pictures, ready for both ways of drawing.
struct Composition {
  std::vector<SoftwareNailboard> pictures;
  std::vector<SoftwareNailboardInstance> in_memory;
  std::optional<NailboardAtlas> atlas;
  std::vector<NailboardInstance> on_gpu;
  std::size_t bytes = 0;  // of the texels in memory

  [[nodiscard]] Result<> fill(const std::vector<Nailboard>& boards, bool with_gl) {
    pictures.resize(boards.size());
    if (with_gl) {
      Result<NailboardAtlas> made = NailboardAtlas::create({std::size_t(384) << 20, kBits, 1});
      if (!made) return made.error();
      atlas.emplace(std::move(*made));
    }
    for (std::size_t i = 0; i < boards.size(); ++i) {
      const Nailboard& board = boards[i];
      const auto object = std::uint32_t(i + 1);
      pictures[i].assign(board);
      bytes += pictures[i].bytes();
      in_memory.push_back({&pictures[i], board.geometry, glm::dmat4(1), object});
      if (!with_gl) continue;
      const auto slot = atlas->allocate(board.color.width(), board.color.height());
      if (!slot) return Error{"bench", "no room for the pictures"};
      atlas->write(*slot, board);
      on_gpu.push_back({*slot, board.geometry, glm::dmat4(1), object});
    }
    return Done{};
  }
};

// Copies `bytes` on all cores, in pieces of a megabyte.
class CoresCopy {
 public:
  explicit CoresCopy(std::size_t bytes) : from_(bytes, 1), to_(bytes, 2) {}
  void operator()() {
    constexpr std::size_t kPiece = std::size_t(1) << 20;
    parallel_for(std::size_t(0), (from_.size() + kPiece - 1) / kPiece, [&](std::size_t i) {
      const std::size_t at = i * kPiece;
      std::memcpy(&to_[at], &from_[at], std::min(kPiece, from_.size() - at));
    });
  }

 private:
  std::vector<char> from_, to_;
};

struct ComposeRun {
  RunTimes software, opengl, copy;
  std::uint64_t pixels = 0;  // of the rectangles around the pictures
  double psnr = 0;           // against OpenGL
};

Result<ComposeRun> draw_both(Composition& composition, int samples, int runs, int frames) {
  const Camera frame = compose_frame();
  const bool with_gl = composition.atlas.has_value();
  ComposeRun drawing;
  SoftwareTarget software(frame.width, frame.height, samples);
  NailboardComposer composer;
  CoresCopy copy(composition.bytes + std::size_t(frame.width) * std::size_t(frame.height) * 8);
  std::vector<std::function<void()>> ways{[&] {
                                            composer.place(frame, DepthMode::exact,
                                                           composition.in_memory);
                                            const TileDrawer* drawers[] = {&composer};
                                            software.draw(frame.z_far, drawers);
                                          },
                                          [&] { copy(); }};
  std::optional<FrameTarget> target;
  std::optional<NailboardDrawer> drawer;
  if (with_gl) {
    Result<FrameTarget> made = FrameTarget::create(frame.width, frame.height, samples);
    if (!made) return made.error();
    target.emplace(std::move(*made));
    Result<NailboardDrawer> compiled = NailboardDrawer::create();
    if (!compiled) return compiled.error();
    drawer.emplace(std::move(*compiled));
    ways.emplace_back([&] {
      target->begin();
      drawer->draw(*composition.atlas, frame, DepthMode::exact, composition.on_gpu);
      target->resolve();
      gl::finish();
    });
  }
  const std::vector<RunTimes> times = time_in_turn(runs, frames, ways);
  drawing.software = times[0], drawing.copy = times[1];
  if (with_gl) {
    drawing.opengl = times[2];
    drawing.psnr = psnr_db(target->read(), software.color());
  }
  drawing.pixels = composer.placed_pixels();
  return drawing;
}

}  // namespace

Result<BenchReport> compose(const BenchOptions& options) {
  const int runs = options.quick ? 1 : 5, frames = options.quick ? 1 : 9;
  const int count = options.quick ? 30 : kPictures, small = options.quick ? 100 : kSmall;
  // Only to compare with: without OpenGL its columns stay empty.
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  const bool with_gl = context.ok();

  BenchReport report;
  if (with_gl) report.machine.gl_renderer = gl::renderer_name();
  const double load_before = machine_load();
  Table table{"A frame of 1280 x 720, milliseconds: least and median of the runs",
              {"pictures", "samples", "software", "", "OpenGL", "", "memcpy", "", "Mpixel/s",
               "OpenGL / software", "software / memcpy", "PSNR to OpenGL, dB"},
              {}};
  int done = 0;
  for (const bool many : {false, true}) {
    Composition composition;
    const Result<> filled = composition.fill(
        many ? compose_balls(small, kBits) : compose_pictures(count, kCover, kBits), with_gl);
    if (!filled) return filled.error();
    for (const int samples : {1, 4}) {
      const Result<ComposeRun> drawing = draw_both(composition, samples, runs, frames);
      if (!drawing) return drawing.error();
      const double ms = drawing->software.median();
      const double mpix_per_s = double(drawing->pixels) / 1e3 / ms;
      const double to_copy = ms / drawing->copy.median();
      const auto number = [](double value) { return fmt::format("{:.2f}", value); };
      std::vector<std::string> row{std::to_string(composition.pictures.size()),
                                   std::to_string(samples),
                                   number(drawing->software.least()),
                                   number(ms),
                                   "",
                                   "",
                                   number(drawing->copy.least()),
                                   number(drawing->copy.median()),
                                   fmt::format("{:.0f}", mpix_per_s),
                                   "",
                                   number(to_copy),
                                   ""};
      const std::string name = (many ? "small_" : "") + std::to_string(samples) +
                               (samples == 1 ? "_sample" : "_samples");
      report.figures.emplace_back("ms_least_" + name, drawing->software.least());
      report.figures.emplace_back("ms_median_" + name, ms);
      report.figures.emplace_back("mpix_per_s_" + name, mpix_per_s);
      report.figures.emplace_back("ratio_to_memcpy_" + name, to_copy);
      if (with_gl) {
        const double ratio = drawing->opengl.median() / ms;
        row[4] = number(drawing->opengl.least()), row[5] = number(drawing->opengl.median());
        row[9] = number(ratio), row[11] = fmt::format("{:.1f}", drawing->psnr);
        report.figures.emplace_back("ratio_to_opengl_" + name, ratio);
        report.figures.emplace_back("psnr_to_opengl_" + name, drawing->psnr);
      }
      if (!many && samples == 4) {
        report.figures.emplace_back("ratio_to_memcpy", to_copy);
        if (with_gl) report.figures.emplace_back("ratio_to_opengl", drawing->opengl.median() / ms);
        report.figures.emplace_back(
            "covers", double(drawing->pixels) / (compose_frame().width * compose_frame().height));
      }
      table.rows.push_back(std::move(row));
      if (options.progress) options.progress(++done, 4);
    }
  }
  report.tables.push_back(std::move(table));
  report.notes = {
      fmt::format("{} runs of {} frames each; a run is the median of its frames. Placing, sorting, "
                  "clearing, averaging and copying out are included.",
                  runs, frames),
      "Mpixel/s are of the rectangles around the pictures. memcpy copies, on all cores, as many "
      "bytes as all pictures and the frame's colour and depth have."};
  report_load(load_before, report);
  if (!with_gl) report.notes.push_back("No OpenGL to compare with: " + context.error().message());
  return report;
}

}  // namespace rilievo::bench
