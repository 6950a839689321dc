#include "bench/report.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "rilievo/io/jpeg.h"
#include "rilievo/io/png.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/report.h"
#include "rilievo/measure/ssim.h"

namespace rilievo::bench {

std::string key_of(std::string_view name) {
  std::string key;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)))
      key += c;
    else if (!key.empty() && key.back() != '_')
      key += '_';
  return key;
}

void FiguresOf::operator()(std::string_view field, double value) const {
  report_->figures.emplace_back(key_ + '_' + key_of(field), value);
}

BenchPicture png_picture(std::string caption, const Rgba8Image& picture) {
  return {std::move(caption), {"image/png", encode_png(picture)}};
}

BenchPicture jpeg_picture(std::string caption, const Rgba8Image& picture) {
  return {std::move(caption), {"image/jpeg", encode_jpeg(picture)}};
}

void Rightness::add(const Rgba8Image& truth, const Rgba8Image& shown) {
  psnr += std::min(psnr_db(truth, shown), kMaxPsnrDb);
  ssim += rilievo::ssim(truth, shown);
  flip += rilievo::flip(truth, shown);
  ++frames;
}

void Rightness::finish() {
  for (double* sum : {&psnr, &ssim, &flip}) *sum /= std::max(frames, 1);
}

}  // namespace rilievo::bench
