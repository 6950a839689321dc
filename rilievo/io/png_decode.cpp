#include "rilievo/io/png_decode.h"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace rilievo {
namespace {

// What libpng may hold at a time: two rows of 16384 texels of 8 bytes, zlib's window and tables.
constexpr std::size_t kWorkingBytes = std::size_t(4) << 20;

// The fields of IHDR, which every PNG file begins with.
struct Head {
  std::uint64_t width = 0, height = 0;
  int bits = 0, color_type = 0;  // bits of a channel
};

std::uint32_t big_endian32(Bytes bytes, std::size_t at) {
  return std::uint32_t(bytes[at]) << 24 | std::uint32_t(bytes[at + 1]) << 16 |
         std::uint32_t(bytes[at + 2]) << 8 | std::uint32_t(bytes[at + 3]);
}

Head read_head(Bytes encoded) {
  if (encoded.size() < 33 || std::memcmp(encoded.data() + 12, "IHDR", 4) != 0)
    refuse("is a PNG picture that cannot be decoded: it is cut short");
  return {big_endian32(encoded, 16), big_endian32(encoded, 20), encoded[24], encoded[25]};
}

// DEFLATE makes of one byte at most 1032. Interlaced rows are shorter, but not fewer bits.
void check_plausible(const Head& head, std::size_t encoded_bytes) {
  if (head.width > 1u << 16 || head.height > 1u << 16) return;  // too large for anything
  const std::uint64_t channels = head.color_type == PNG_COLOR_TYPE_RGB_ALPHA    ? 4
                                 : head.color_type == PNG_COLOR_TYPE_RGB        ? 3
                                 : head.color_type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                                                : 1;
  const std::uint64_t row_bits = head.width * channels * std::uint64_t(head.bits);
  if (row_bits / 8 * head.height > 1032 * std::uint64_t(encoded_bytes))
    refuse("is a picture that claims " + std::to_string(head.width) + " x " +
           std::to_string(head.height) + " texels, more than its bytes can hold");
}

// libpng reports a fault by calling error_fn, which must not return: it jumps back to where
// decoding began. Nothing with a destructor may be made between the two.
struct PngDecoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  Bytes left;
  std::size_t held = 0;  // bytes that libpng has allocated
  std::jmp_buf back{};
  char reason[128] = "";

  PngDecoder() = default;
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;
  ~PngDecoder() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void give_up_reading_png(png_structp png, png_const_charp message) {
  PngDecoder& decoder = *static_cast<PngDecoder*>(png_get_error_ptr(png));
  std::snprintf(decoder.reason, sizeof decoder.reason, "%s", message);
  std::longjmp(decoder.back, 1);
}

// The size stands before each block, so that it can be given back.
constexpr std::size_t kBlockHead = alignof(std::max_align_t);

png_voidp allocate(png_structp png, png_alloc_size_t size) {
  PngDecoder& decoder = *static_cast<PngDecoder*>(png_get_mem_ptr(png));
  if (size > kWorkingBytes || decoder.held + size > kWorkingBytes) return nullptr;
  auto* const block = static_cast<std::uint8_t*>(std::malloc(kBlockHead + size));
  if (!block) return nullptr;
  std::memcpy(block, &size, sizeof size);
  decoder.held += size;
  return block + kBlockHead;
}

void release(png_structp png, png_voidp at) {
  if (!at) return;
  PngDecoder& decoder = *static_cast<PngDecoder*>(png_get_mem_ptr(png));
  auto* const block = static_cast<std::uint8_t*>(at) - kBlockHead;
  png_alloc_size_t size = 0;
  std::memcpy(&size, block, sizeof size);
  decoder.held -= size;
  std::free(block);
}

void read_bytes(png_structp png, png_bytep to, std::size_t size) {
  PngDecoder& decoder = *static_cast<PngDecoder*>(png_get_io_ptr(png));
  if (size > decoder.left.size()) png_error(png, "it is cut short");
  std::memcpy(to, decoder.left.data(), size);
  decoder.left = decoder.left.subspan(size);
}

// Up to the first texel; false with a reason if that fails.
bool begin(PngDecoder& decoder) {
  if (setjmp(decoder.back)) return false;
  // Warnings are about chunks that do not matter.
  decoder.png = png_create_read_struct_2(
      PNG_LIBPNG_VER_STRING, &decoder, give_up_reading_png, [](png_structp, png_const_charp) {},
      &decoder, allocate, release);
  if (decoder.png) decoder.info = png_create_info_struct(decoder.png);
  if (!decoder.info) return false;
  png_set_read_fn(decoder.png, &decoder, read_bytes);
  png_set_user_limits(decoder.png, 1 << 16, 1 << 16);
  png_set_chunk_malloc_max(decoder.png, 0);  // allocate() bounds them all
  png_set_keep_unknown_chunks(decoder.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  // A fuzzer cannot guess checksums; what lies behind them must be sound without.
  png_set_crc_action(decoder.png, PNG_CRC_QUIET_USE, PNG_CRC_QUIET_USE);
  png_set_option(decoder.png, PNG_IGNORE_ADLER32, PNG_OPTION_ON);
#endif
  png_read_info(decoder.png, decoder.info);
  return true;
}

void to_rgba8(png_structp png) {
  png_set_expand(png);  // palettes, fewer than 8 bits, one transparent colour
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
}

void to_native16(png_structp png) {
  if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
}

// Rows of `row_bytes` into `texels`, in as many passes as the picture has.
bool read_rows(PngDecoder& decoder, void (*transform)(png_structp), std::uint8_t* texels,
               std::size_t row_bytes, std::size_t rows) {
  if (setjmp(decoder.back)) return false;
  transform(decoder.png);
  const int passes = png_set_interlace_handling(decoder.png);
  png_read_update_info(decoder.png, decoder.info);
  if (png_get_rowbytes(decoder.png, decoder.info) != row_bytes ||
      png_get_image_height(decoder.png, decoder.info) != rows)
    png_error(decoder.png, "its header contradicts itself");
  for (int pass = 0; pass < passes; ++pass)
    for (std::size_t y = 0; y < rows; ++y)
      png_read_row(decoder.png, texels + y * row_bytes, nullptr);
  return true;
}

[[noreturn]] void fail(const PngDecoder& decoder) {
  refuse(std::string("is a PNG picture that cannot be decoded: ") +
         (decoder.reason[0] ? decoder.reason : "there is not enough memory"));
}

template <class Picture>
Picture decode(Bytes encoded, MemoryBudget& budget, Picture (*make)(int, int, MemoryBudget&),
               void (*transform)(png_structp)) {
  const Head head = read_head(encoded);
  check_plausible(head, encoded.size());
  PngDecoder decoder;
  decoder.left = encoded;
  if (!begin(decoder)) fail(decoder);
  Picture out = make(int(head.width), int(head.height), budget);
  budget.borrow_pixels(kWorkingBytes, 1);
  const auto bytes = std::as_writable_bytes(out.texels());
  const std::size_t rows = std::size_t(out.height());
  if (!read_rows(decoder, transform, reinterpret_cast<std::uint8_t*>(bytes.data()),
                 bytes.size() / rows, rows))
    fail(decoder);
  return out;
}

}  // namespace

bool is_png(Bytes encoded) {
  return encoded.size() >= 8 && std::memcmp(encoded.data(), "\x89PNG\r\n\x1A\n", 8) == 0;
}

Rgba8Image decode_png(Bytes encoded, MemoryBudget& budget,
                      Rgba8Image (*make)(int, int, MemoryBudget&)) {
  return decode<Rgba8Image>(encoded, budget, make, to_rgba8);
}

Image<std::uint16_t> decode_png_grey16(Bytes encoded, MemoryBudget& budget,
                                       Image<std::uint16_t> (*make)(int, int, MemoryBudget&)) {
  if (is_png(encoded)) {
    const Head head = read_head(encoded);
    if (head.bits == 16 && head.color_type == PNG_COLOR_TYPE_GRAY)
      return decode<Image<std::uint16_t>>(encoded, budget, make, to_native16);
  }
  refuse("is not a PNG picture of 16-bit grey");
}

}  // namespace rilievo
