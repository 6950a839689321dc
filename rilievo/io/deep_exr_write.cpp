#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/io/deep_exr.h"
#include "rilievo/io/exr_header.h"

namespace rilievo {
namespace {

// A sample as it lies in the file.
struct Stored {
  half rgba[4];
  float z, z_back;
  std::uint32_t id;
};

// The largest finite half.
constexpr float kHalfMax = 65504.0f;

Imf::Header header_of(const LayeredDepthImage& layers) {
  const Camera& camera = layers.camera;
  const ImageWindow& w = camera.window;
  Imf::Header header(camera.width, camera.height, 1.0f,
                     {float(0.5 * (w.left + w.right)), float(0.5 * (w.bottom + w.top))},
                     float(w.right - w.left), Imf::INCREASING_Y, Imf::ZIPS_COMPRESSION);
  header.setName(layers.name.empty() ? "layers" : layers.name);
  header.setType(Imf::DEEPSCANLINE);
  for (const char* channel : {"R", "G", "B", "A"})
    header.channels().insert(channel, Imf::Channel(Imf::HALF));
  for (const char* channel : {"Z", "ZBack"})
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  exr::insert_camera(header, camera, camera, layers.depth_kind, layers.name);
  return header;
}

}  // namespace

Result<> save_layers(const std::filesystem::path& path, const LayeredDepthImage& layers) {
  const auto error = [&](const std::string& reason) { return Error{path.string(), reason}; };
  if (Result<> valid = validate(layers); !valid) return error(valid.error().reason);
  const std::size_t texels = layers.first.size() - 1, width = std::size_t(layers.camera.width);
  std::vector<Stored> stored(layers.samples.size());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const LayerSample& sample = layers.samples[i];
    for (int c = 0; c < 4; ++c)
      stored[i].rgba[c] = half(std::clamp(sample.color[c], -kHalfMax, kHalfMax));
    stored[i].z = sample.depth;
    stored[i].z_back = sample.back;
    stored[i].id = sample.object;
  }
  std::vector<unsigned> counts(texels);
  for (std::size_t i = 0; i < texels; ++i)
    counts[i] = unsigned(layers.first[i + 1] - layers.first[i]);

  exr::MemoryOutput stream;
  try {
    const Imf::Header header = header_of(layers);
    Imf::MultiPartOutputFile out(stream, &header, 1, false, 0);
    Imf::DeepScanLineOutputPart part(out, 0);
    Imf::DeepFrameBuffer planes;
    planes.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                             sizeof(unsigned), sizeof(unsigned) * width));
    // For each channel a pointer a texel to its first sample.
    std::vector<std::vector<const void*>> pointers;
    pointers.reserve(7);
    const auto insert = [&](const char* name, Imf::PixelType type, std::size_t offset) {
      std::vector<const void*>& of = pointers.emplace_back(texels);
      const char* base = reinterpret_cast<const char*>(stored.data());
      for (std::size_t i = 0; i < texels; ++i)
        of[i] = base + std::size_t(layers.first[i]) * sizeof(Stored) + offset;
      planes.insert(name, Imf::DeepSlice(type, reinterpret_cast<char*>(of.data()), sizeof(void*),
                                         sizeof(void*) * width, sizeof(Stored)));
    };
    const char* const names[] = {"R", "G", "B", "A"};
    for (std::size_t c = 0; c < 4; ++c)
      insert(names[c], Imf::HALF, offsetof(Stored, rgba) + c * sizeof(half));
    insert("Z", Imf::FLOAT, offsetof(Stored, z));
    insert("ZBack", Imf::FLOAT, offsetof(Stored, z_back));
    insert("id", Imf::UINT, offsetof(Stored, id));
    part.setFrameBuffer(planes);
    part.writePixels(layers.camera.height);
  } catch (const std::exception& failed) {
    return error(failed.what());
  }
  return write_file(path, stream.bytes());
}

}  // namespace rilievo
