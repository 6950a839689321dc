#include "rilievo/io/jpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdlib>
#include <new>
// jpeglib.h needs FILE and size_t from before it.
#include <cstdio>
//
#include <jpeglib.h>

namespace rilievo {
namespace {

// libjpeg reports a fault by calling error_exit, which must not return: it jumps back to where
// encoding began. Nothing with a destructor may be made between the two.
struct JpegEncoder {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  std::jmp_buf back{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;

  JpegEncoder() = default;
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;
  ~JpegEncoder() {
    jpeg_destroy_compress(&info);
    std::free(bytes);
  }
};

[[noreturn]] void give_up_writing_jpeg(j_common_ptr info) {
  std::longjmp(static_cast<JpegEncoder*>(info->client_data)->back, 1);
}

// False if memory runs out, the only fault there can be.
bool encode(JpegEncoder& encoder, const Rgba8Image& picture, int quality) {
  jpeg_compress_struct& info = encoder.info;
  if (setjmp(encoder.back)) return false;
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &encoder.bytes, &encoder.size);
  info.image_width = JDIMENSION(picture.width());
  info.image_height = JDIMENSION(picture.height());
  info.input_components = 4;
  info.in_color_space = JCS_EXT_RGBX;  // the fourth byte is left out
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  // Colours at half the width and height blur what a fine picture shows.
  if (quality > 90) info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    // libjpeg reads it, in spite of its type.
    auto* row = reinterpret_cast<JSAMPROW>(
        const_cast<glm::u8vec4*>(picture.row(int(info.next_scanline)).data()));
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  return true;
}

}  // namespace

std::vector<std::uint8_t> encode_jpeg(const Rgba8Image& picture, int quality) {
  RILIEVO_EXPECTS(!picture.empty());
  RILIEVO_EXPECTS(picture.width() <= JPEG_MAX_DIMENSION && picture.height() <= JPEG_MAX_DIMENSION);
  RILIEVO_EXPECTS(1 <= quality && quality <= 100);
  JpegEncoder encoder;
  encoder.info.err = jpeg_std_error(&encoder.errors);
  encoder.errors.error_exit = give_up_writing_jpeg;
  // jpeg_create_compress clears all but these two.
  encoder.info.client_data = &encoder;
  if (!encode(encoder, picture, quality)) throw std::bad_alloc();
  return {encoder.bytes, encoder.bytes + encoder.size};
}

}  // namespace rilievo
