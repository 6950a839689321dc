#include "rilievo/web_walk/webp.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace rilievo {
namespace {

constexpr int kNearLossless = 101;
// Steps of about 1.5 dB.
constexpr std::array kWebpQualities{50, 65, 75, 82, 88, 92, 95, 97, 99, kNearLossless};
// Lowest bits may change by at most 1 in pictures of many colours.
constexpr int kNearLosslessLevel = 80;

// Texels as libwebp takes them: R, G, B and, if there is alpha, A.
struct WebpTexels {
  std::vector<std::uint8_t> bytes;
  int width = 0, height = 0, channels = 3;
  [[nodiscard]] int stride() const { return channels * width; }
};

WebpTexels webp_texels(const Rgba8Image& picture, bool alpha) {
  WebpTexels texels{{}, picture.width(), picture.height(), alpha ? 4 : 3};
  texels.bytes.reserve(picture.texels().size() * std::size_t(texels.channels));
  for (const glm::u8vec4& texel : picture.texels())
    for (int c = 0; c < texels.channels; ++c) texels.bytes.push_back(texel[c]);
  return texels;
}

// Empty if libwebp fails, which it does for lack of memory alone.
std::vector<std::uint8_t> encode_texels(const WebpTexels& texels, int quality) {
  WebPConfig config;
  WebPPicture picture;
  WebPMemoryWriter writer;
  if (!WebPConfigInit(&config) || !WebPPictureInit(&picture)) return {};
  config.method = 4;
  // Colours stay where nothing shows: edges are interpolated with them.
  config.exact = 1;
  if (quality == kNearLossless) {
    config.lossless = 1;
    config.near_lossless = kNearLosslessLevel;
    config.quality = 50;
  } else {
    config.quality = float(quality);
    config.use_sharp_yuv = 1;
  }
  picture.use_argb = 1;
  picture.width = texels.width;
  picture.height = texels.height;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  std::vector<std::uint8_t> bytes;
  const auto import = texels.channels == 4 ? WebPPictureImportRGBA : WebPPictureImportRGB;
  if (import(&picture, texels.bytes.data(), texels.stride()) && WebPEncode(&config, &picture))
    bytes.assign(writer.mem, writer.mem + writer.size);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  return bytes;
}

double psnr_of(const std::vector<std::uint8_t>& file, const WebpTexels& texels) {
  std::vector<std::uint8_t> decoded(texels.bytes.size());
  const auto decode = texels.channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  if (!decode(file.data(), file.size(), decoded.data(), decoded.size(), texels.stride())) return 0;
  double sum = 0;
  const auto channels = std::size_t(texels.channels);
  for (std::size_t i = 0; i < decoded.size(); i += channels) {
    const double alpha = channels == 4 ? texels.bytes[i + 3] / 255.0 : 1.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double off = alpha * (double(decoded[i + c]) - double(texels.bytes[i + c]));
      sum += off * off;
    }
  }
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * 3.0 * texels.width * texels.height / sum);
}

}  // namespace

Result<WebpFile> encode_webp(const Rgba8Image& picture, const WebpOptions& options) {
  const int width = picture.width(), height = picture.height();
  if (picture.empty() || width > WEBP_MAX_DIMENSION || height > WEBP_MAX_DIMENSION)
    return Error{"WebP", "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                             " texels does not fit"};
  const WebpTexels texels = webp_texels(picture, options.alpha);
  // The first of the qualities that is good enough, by halving: PSNR grows with quality.
  std::size_t low = 0, high = kWebpQualities.size() - 1;
  WebpFile best;
  while (low < high || best.bytes.empty()) {
    const std::size_t middle = (low + high) / 2;
    WebpFile file;
    file.quality = kWebpQualities[middle];
    file.bytes = encode_texels(texels, file.quality);
    if (file.bytes.empty()) return Error{"WebP", "there is no memory to encode a picture"};
    file.psnr_db = psnr_of(file.bytes, texels);
    if (file.psnr_db >= options.least_psnr_db || middle + 1 == kWebpQualities.size()) {
      high = middle;
      best = std::move(file);
      if (low >= high) break;
    } else {
      low = middle + 1;
    }
  }
  return best;
}

}  // namespace rilievo
