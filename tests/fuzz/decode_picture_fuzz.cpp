// Any bytes as a picture: texels within the bound on memory, or a refusal.
//
//   decode_picture_fuzz -rss_limit_mb=1024 -max_len=65536 CORPUS
//
// CORPUS is a folder of small pictures: PNG, JPEG, WebP, BMP, TGA.
#include "rilievo/io/picture_decode.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rilievo::MemoryBudget budget(64u << 20);
  try {
    (void)rilievo::decode_picture({data, size}, budget);
  } catch (const rilievo::LoadFault&) {
  }
  return 0;
}
