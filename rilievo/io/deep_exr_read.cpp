#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/core/file.h"
#include "rilievo/io/deep_exr_parts.h"
#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_names.h"
#include "rilievo/io/exr_sizes.h"

namespace rilievo {

using namespace exr;

namespace {

Result<> check_deep(const Imf::Header& header) {
  if (!header.hasType() || !Imf::isDeepData(header.type())) return because("is not a deep image");
  if (header.type() != Imf::DEEPSCANLINE)
    return because("is a deep image of tiles; only scan lines are read");
  for (const char* name : {"R", "G", "B", "A", "Z", "ZBack", "id"}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    const bool color = name[1] == '\0' && name[0] != 'A';  // R G B, and Z
    if (!channel && color) return because(std::string("has no channel ") + name);
    if (channel && channel->type == Imf::UINT && std::string_view(name) != "id")
      return because(std::string("channel ") + name + " holds integers");
    if (channel && (channel->xSampling != 1 || channel->ySampling != 1))
      return because(std::string("channel ") + name + " is sub-sampled");
  }
  return Done{};
}

Result<Camera> camera_of(const Imf::Header& header, const DeepLoadOptions& options) {
  if (header.find(kVersionName) != header.end()) return own_camera(header);
  if (header.find("worldToCamera") != header.end() || header.find("worldToNDC") != header.end())
    return standard_camera(header);
  const Size display = size_of(header.displayWindow());
  if (options.fov && display.width > 0 && display.height > 0)
    return cropped_camera(
        header, deep_camera(*options.fov, int(std::min<std::int64_t>(display.width, 1 << 24)),
                            int(std::min<std::int64_t>(display.height, 1 << 24))));
  if (!options.camera)
    return because("has no camera: neither worldToCamera and worldToNDC, nor one given beside it");
  return cropped_camera(header, *options.camera);
}

// OpenEXR wants the address that column 0 of its raster would have.
char* at_column_0(void* first, const Imath::Box2i& window, std::size_t stride) {
  const auto offset = std::int64_t(stride) * window.min.x;
  return reinterpret_cast<char*>(std::intptr_t(first) - offset);
}

// OpenEXR reserves what a chunk says of its own size before it reads it: of one flipped bit, 1 GiB.
bool chunks_fit(Imf::DeepScanLineInputPart& part, double file_bytes) {
  const Imath::Box2i window = part.header().dataWindow();
  for (int y = window.min.y; y <= window.max.y; y = part.lastScanLineInChunk(y) + 1) {
    std::uint64_t bytes = 0;  // too few for any chunk: nothing is read but the size
    part.rawPixelData(y, nullptr, bytes);
    if (double(bytes) > file_bytes) return false;
  }
  return true;
}

Result<> read_samples(Imf::DeepScanLineInputPart& part, double file_bytes,
                      LayeredDepthImage& layers) {
  const Imath::Box2i window = part.header().dataWindow();
  const Size size = size_of(window);
  const std::size_t width = std::size_t(size.width), texels = width * std::size_t(size.height);
  // One row of counts and of pointers, 0 bytes from the next: a texel may have no sample at all,
  // but would take 60 bytes.
  std::vector<unsigned> counts(width);
  Imf::DeepFrameBuffer planes;
  planes.insertSampleCountSlice(Imf::Slice(
      Imf::UINT, at_column_0(counts.data(), window, sizeof(unsigned)), sizeof(unsigned), 0));
  struct Plane {
    const char* name;
    Imf::PixelType type;
    std::size_t offset;
    double fill;
  };
  const std::size_t color = offsetof(LayerSample, color);
  const Plane all[] = {{"R", Imf::FLOAT, color, 0},
                       {"G", Imf::FLOAT, color + 4, 0},
                       {"B", Imf::FLOAT, color + 8, 0},
                       {"A", Imf::FLOAT, color + 12, 1},
                       {"Z", Imf::FLOAT, offsetof(LayerSample, depth), 0},
                       {"ZBack", Imf::FLOAT, offsetof(LayerSample, back), 0},
                       {"id", Imf::UINT, offsetof(LayerSample, object), 0}};
  const Imf::ChannelList& channels = part.header().channels();
  std::vector<std::vector<char*>> pointers(std::size(all));
  for (std::size_t i = 0; i < std::size(all); ++i) {
    const Imf::Channel* channel = channels.findChannel(all[i].name);
    if (!channel || (channel->type == Imf::UINT) != (all[i].type == Imf::UINT)) continue;
    pointers[i].resize(width);
    planes.insert(
        all[i].name,
        Imf::DeepSlice(all[i].type, at_column_0(pointers[i].data(), window, sizeof(char*)),
                       sizeof(char*), 0, sizeof(LayerSample), 1, 1, all[i].fill));
  }
  part.setFrameBuffer(planes);

  layers.first.assign(1, 0);
  layers.first.reserve(texels + 1);
  for (int y = window.min.y; y <= window.max.y; ++y) {
    part.readPixelSampleCounts(y, y);
    for (const unsigned count : counts) layers.first.push_back(layers.first.back() + count);
  }
  // DEFLATE makes of one byte at most 1032; a sample has 8 bytes at least.
  if (double(layers.first.back()) * 8 > 1100.0 * file_bytes + double(4 << 20))
    return because("claims " + std::to_string(layers.first.back()) +
                   " samples, more than its bytes can hold");
  if (layers.first.back() == 0) return Done{};  // no sample anywhere
  LayerSample empty;
  empty.color.a = 1;
  layers.samples.assign(layers.first.back(), empty);
  char* const base = reinterpret_cast<char*>(layers.samples.data());
  const std::uint64_t* first = layers.first.data();  // of the row's texels
  for (int y = window.min.y; y <= window.max.y; ++y, first += width) {
    for (std::size_t i = 0; i < std::size(all); ++i)
      for (std::size_t x = 0; x < pointers[i].size(); ++x)
        pointers[i][x] = base + std::size_t(first[x]) * sizeof(LayerSample) + all[i].offset;
    part.readPixels(y, y);
  }
  if (!channels.findChannel("ZBack"))
    for (LayerSample& sample : layers.samples) sample.back = sample.depth;
  return Done{};
}

// Foreign samples to ours: those that show something, sorted; and the depth range from them.
Result<> adopt_foreign_samples(LayeredDepthImage& layers) {
  std::vector<LayerSample> kept;
  std::vector<std::uint64_t> first{0};
  first.reserve(layers.first.size());
  float nearest = kNoDepth, farthest = 0;
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
    for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
      LayerSample sample = layers.samples[s];
      if (std::isnan(sample.depth)) return because("a depth is not a number");
      if (!(sample.depth > 0) || sample.depth >= kForeignFar) continue;
      if (!(sample.back >= sample.depth) || sample.back >= kForeignFar) sample.back = sample.depth;
      sample.color = finite_color(sample.color);
      kept.push_back(sample);
      nearest = std::min(nearest, sample.depth);
      farthest = std::max(farthest, sample.back);
    }
    std::stable_sort(kept.begin() + std::ptrdiff_t(first.back()), kept.end(),
                     [](const LayerSample& a, const LayerSample& b) { return a.depth < b.depth; });
    first.push_back(kept.size());
  }
  layers.samples = std::move(kept);
  layers.first = std::move(first);
  if (farthest > 0) {
    layers.camera.z_near = double(nearest) * 0.999;
    layers.camera.z_far = double(farthest) * 1.001;
  }
  return Done{};
}

}  // namespace

bool exr::is_own_deep_part(const Imf::Header& header) {
  return header.hasType() && Imf::isDeepData(header.type()) &&
         header.find(kVersionName) != header.end();
}

Result<LayeredDepthImage> exr::read_layers(Imf::MultiPartInputFile& file, int index,
                                           double file_bytes, const DeepLoadOptions& options,
                                           bool with_samples) {
  const Imf::Header& header = file.header(index);
  if (Result<> deep = check_deep(header); !deep) return deep.error();
  if (Result<> claims = check_claims(header, file_bytes); !claims) return claims.error();
  const bool ours = header.find(kVersionName) != header.end();
  const Result<Camera> camera = camera_of(header, options);
  if (!camera) return camera.error();
  LayeredDepthImage layers;
  layers.camera = *camera;
  layers.depth_kind = options.depth_kind;
  if (ours) {
    const auto kind = index_of(kDepthKinds, attribute<std::string>(header, kDepthKind));
    if (!kind) return because("some of its rilievo attributes are missing or damaged");
    layers.depth_kind = DepthKind(*kind);
  }
  layers.name = attribute<std::string>(header, kName)
                    .value_or(header.hasName() ? header.name() : std::string());
  if (!with_samples) return layers;
  Imf::DeepScanLineInputPart part(file, index);
  if (!chunks_fit(part, file_bytes)) return because("has a chunk that is larger than the file");
  if (Result<> read = read_samples(part, file_bytes, layers); !read) return read.error();
  if (!ours)
    if (Result<> adopted = adopt_foreign_samples(layers); !adopted) return adopted.error();
  if (Result<> valid = validate(layers); !valid) return because(valid.error().reason);
  return layers;
}

Camera deep_camera(double horizontal_fov, int width, int height) {
  const double right = std::tan(0.5 * horizontal_fov), top = right * height / width;
  Camera camera;
  camera.window = {-right, right, -top, top};
  camera.width = width;
  camera.height = height;
  return camera;
}

Result<LayeredDepthImage> load_layers(std::string_view bytes, const std::string& where,
                                      const DeepLoadOptions& options) {
  if (Result<> sizes = check_exr_sizes(bytes); !sizes) return Error{where, sizes.error().reason};
  try {
    MemoryStream stream(bytes);
    Imf::MultiPartInputFile file(stream, 0);
    if (file.parts() != 1) return Error{where, "has several parts; a deep picture is one"};
    Result<LayeredDepthImage> read = read_layers(file, 0, double(bytes.size()), options);
    if (!read) return Error{where, read.error().reason};
    return read;
  } catch (const std::exception& failed) {
    return Error{where, "is not a readable OpenEXR file: " + one_line(failed.what())};
  }
}

Result<LayeredDepthImage> load_layers(const std::filesystem::path& path,
                                      const DeepLoadOptions& options) {
  const Result<std::string> bytes = read_file(path, kMaxBytes);
  if (!bytes) return bytes.error();
  return load_layers(*bytes, path.string(), options);
}

}  // namespace rilievo
