#include "rilievo/io/jpeg_decode.h"

#include <csetjmp>
// jpeglib.h needs FILE and size_t from before it.
#include <cstdio>
//
#include <jpeglib.h>

namespace rilievo {
namespace {

// libjpeg reports a fault by calling error_exit, which must not return: it jumps back to where
// decoding began. Nothing with a destructor may be made between the two.
struct JpegDecoder {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf back{};
  char reason[JMSG_LENGTH_MAX] = "";

  ~JpegDecoder() { jpeg_destroy_decompress(&info); }
};

[[noreturn]] void give_up_reading_jpeg(j_common_ptr info) {
  JpegDecoder& decoder = *static_cast<JpegDecoder*>(info->client_data);
  info->err->format_message(info, decoder.reason);
  std::longjmp(decoder.back, 1);
}

// A few kilobytes can hold thousands of scans, each of which goes over the whole picture; pictures
// have about ten.
void limit_scans(j_common_ptr info) {
  constexpr int kMaxScans = 100;
  JpegDecoder& decoder = *static_cast<JpegDecoder*>(info->client_data);
  if (decoder.info.input_scan_number > kMaxScans) {
    std::snprintf(decoder.reason, sizeof decoder.reason, "it has too many scans");
    std::longjmp(decoder.back, 1);
  }
}

bool begin(JpegDecoder& decoder, Bytes encoded) {
  if (setjmp(decoder.back)) return false;
  jpeg_create_decompress(&decoder.info);
  decoder.info.progress = &decoder.progress;
  jpeg_mem_src(&decoder.info, encoded.data(), encoded.size());
  jpeg_read_header(&decoder.info, TRUE);
  const bool inks =
      decoder.info.jpeg_color_space == JCS_CMYK || decoder.info.jpeg_color_space == JCS_YCCK;
  decoder.info.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
  return true;
}

// With Huffman's codes a block of 64 texels takes at least one bit. Pictures that are cut short are
// filled up with grey: a few bytes would stand for any size.
void check_plausible(const jpeg_decompress_struct& info, std::size_t encoded_bytes) {
  const std::uint64_t texels = std::uint64_t(info.image_width) * info.image_height;
  if (!info.arith_code && texels > 512 * std::uint64_t(encoded_bytes))
    refuse("is a picture that claims " + std::to_string(info.image_width) + " x " +
           std::to_string(info.image_height) + " texels, more than its bytes can hold");
}

// A picture in several scans is kept as coefficients of two bytes, in whole blocks, until the last
// one; another one a few rows at a time.
std::uint64_t working_bytes(jpeg_decompress_struct& info) {
  std::uint64_t bytes = (1 << 20) + 128 * std::uint64_t(info.image_width);
  if (!jpeg_has_multiple_scans(&info)) return bytes;
  for (int c = 0; c < info.num_components; ++c) {
    const jpeg_component_info& channel = info.comp_info[c];
    bytes += (std::uint64_t(channel.width_in_blocks) + 4) *
             (std::uint64_t(channel.height_in_blocks) + 4) * sizeof(JBLOCK);
  }
  return bytes;
}

// Rows of four bytes a texel into `texels`.
bool read_rows(JpegDecoder& decoder, std::uint8_t* texels, std::size_t row_bytes) {
  if (setjmp(decoder.back)) return false;
  jpeg_start_decompress(&decoder.info);
  while (decoder.info.output_scanline < decoder.info.output_height) {
    JSAMPROW row = texels + decoder.info.output_scanline * row_bytes;
    jpeg_read_scanlines(&decoder.info, &row, 1);
  }
  return true;
}

}  // namespace

Rgba8Image decode_jpeg(Bytes encoded, MemoryBudget& budget,
                       Rgba8Image (*make)(int width, int height, MemoryBudget&)) {
  JpegDecoder decoder;
  decoder.info.err = jpeg_std_error(&decoder.errors);
  decoder.errors.error_exit = give_up_reading_jpeg;
  // Warnings (a picture that is cut short is grey at its end) are not worth a word.
  decoder.errors.emit_message = [](j_common_ptr, int) {};
  decoder.progress.progress_monitor = limit_scans;
  // jpeg_create_decompress clears all but these two.
  decoder.info.client_data = &decoder;
  if (!begin(decoder, encoded))
    refuse(std::string("is a JPEG picture that cannot be decoded: ") + decoder.reason);
  if (decoder.info.image_width > 1u << 16 || decoder.info.image_height > 1u << 16)
    refuse("is a JPEG picture of an impossible size");

  check_plausible(decoder.info, encoded.size());

  Rgba8Image out = make(int(decoder.info.image_width), int(decoder.info.image_height), budget);
  budget.borrow_pixels(working_bytes(decoder.info), 1);
  const std::size_t row_bytes = 4 * std::size_t(out.width());
  if (!read_rows(decoder, reinterpret_cast<std::uint8_t*>(out.texels().data()), row_bytes))
    refuse(std::string("is a JPEG picture that cannot be decoded: ") + decoder.reason);
  if (decoder.info.out_color_space == JCS_CMYK)
    for (glm::u8vec4& t : out.texels()) {
      // Adobe's inks are upside down: 255 is none.
      const int k = t.a;
      t = {std::uint8_t(t.r * k / 255), std::uint8_t(t.g * k / 255), std::uint8_t(t.b * k / 255),
           255};
    }
  return out;
}

}  // namespace rilievo
