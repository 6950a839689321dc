// What benches put into a report: figures of one thing, pictures, how right frames are.
#pragma once

#include <string>
#include <string_view>

#include "rilievo/core/color.h"
#include "rilievo/measure/bench_report.h"

namespace rilievo::bench {

// Letters and digits of a name, with one underscore for all that lies between them.
[[nodiscard]] std::string key_of(std::string_view name);

// Adds figures to a report, each as NAME_FIELD.
class FiguresOf {
 public:
  // `report` must outlive the object.
  FiguresOf(std::string_view name, BenchReport& report) : key_(key_of(name)), report_(&report) {}
  void operator()(std::string_view field, double value) const;

 private:
  std::string key_;
  BenchReport* report_;
};

// Without loss; and as a photograph is kept, for many large ones.
[[nodiscard]] BenchPicture png_picture(std::string caption, const Rgba8Image& picture);
[[nodiscard]] BenchPicture jpeg_picture(std::string caption, const Rgba8Image& picture);

// How right frames are: means, once finish() was called.
struct Rightness {
  double psnr = 0, ssim = 0, flip = 0;  // dB, at most kMaxPsnrDb
  int frames = 0;

  void add(const Rgba8Image& truth, const Rgba8Image& shown);
  void finish();
};

}  // namespace rilievo::bench
