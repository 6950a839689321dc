// Any bytes as a deep OpenEXR file: a valid layered picture or an Error, within the bound on
// memory.
//
//   load_layers_fuzz -rss_limit_mb=2048 -max_len=65536 CORPUS
//
// CORPUS is a folder of small deep .exr files.
#include <cstdlib>
#include <string_view>

#include "rilievo/io/deep_exr.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rilievo::DeepLoadOptions options;
  options.camera = rilievo::deep_camera(0.9, 64, 64);
  const auto loaded =
      rilievo::load_layers({reinterpret_cast<const char*>(data), size}, "fuzz", options);
  if (loaded && !rilievo::validate(*loaded)) std::abort();
  return 0;
}
