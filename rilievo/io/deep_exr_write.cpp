#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <set>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/io/deep_exr.h"
#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_parts.h"

namespace rilievo {
namespace {

// A sample as it lies in the file.
struct Stored {
  half rgba[4];
  float z, z_back;
  std::uint32_t id;
};

Imf::Header header_of(const LayeredDepthImage& layers, const std::string& part_name,
                      const exr::Shared& shared) {
  Imf::Header header = exr::part_header(layers.camera, layers.depth_kind, layers.name, part_name,
                                        shared, Imf::ZIPS_COMPRESSION);
  header.setType(Imf::DEEPSCANLINE);
  for (const char* channel : {"R", "G", "B", "A"})
    header.channels().insert(channel, Imf::Channel(Imf::HALF));
  for (const char* channel : {"Z", "ZBack"})
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  return header;
}

void write_samples(Imf::MultiPartOutputFile& out, int index, const LayeredDepthImage& layers) {
  const std::size_t texels = layers.first.size() - 1, width = std::size_t(layers.camera.width);
  std::vector<Stored> stored(layers.samples.size());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const LayerSample& sample = layers.samples[i];
    for (int c = 0; c < 4; ++c)
      stored[i].rgba[c] = half(std::clamp(sample.color[c], -exr::kHalfMax, exr::kHalfMax));
    stored[i].z = sample.depth;
    stored[i].z_back = sample.back;
    stored[i].id = sample.object;
  }
  std::vector<unsigned> counts(texels);
  for (std::size_t i = 0; i < texels; ++i)
    counts[i] = unsigned(layers.first[i + 1] - layers.first[i]);
  Imf::DeepScanLineOutputPart part(out, index);
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
}

}  // namespace

Result<> save_layers(const std::filesystem::path& path, std::span<const LayeredDepthImage> pictures,
                     const FileAttributes& attributes) {
  RILIEVO_EXPECTS(attributes.pictures.empty() || attributes.pictures.size() == pictures.size());
  const auto error = [&](const std::string& reason) { return Error{path.string(), reason}; };
  if (pictures.empty()) return error("there is no picture to save");
  if (Result<> keys = exr::check_attributes(attributes); !keys) return error(keys.error().reason);
  for (const LayeredDepthImage& layers : pictures)
    if (Result<> valid = validate(layers); !valid) return error(valid.error().reason);
  exr::MemoryOutput stream;
  try {
    std::set<std::string> names;
    std::vector<Camera> cameras;
    for (const LayeredDepthImage& layers : pictures) cameras.push_back(layers.camera);
    const exr::Shared shared = exr::shared_by(cameras);
    std::vector<Imf::Header> headers;
    for (const LayeredDepthImage& layers : pictures)
      headers.push_back(header_of(
          layers, exr::unique_name(layers.name.empty() ? "layers" : layers.name, names), shared));
    exr::insert_attributes(headers, attributes);
    Imf::MultiPartOutputFile out(stream, headers.data(), int(headers.size()), false, 0);
    for (std::size_t i = 0; i < pictures.size(); ++i) write_samples(out, int(i), pictures[i]);
  } catch (const std::exception& failed) {
    return error(failed.what());
  }
  return write_file(path, stream.bytes());
}

Result<> save_layers(const std::filesystem::path& path, const LayeredDepthImage& layers) {
  return save_layers(path, {&layers, 1});
}

}  // namespace rilievo
