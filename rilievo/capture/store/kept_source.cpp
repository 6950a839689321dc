#include "rilievo/capture/store/kept_source.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "rilievo/capture/store/content_hash.h"

namespace rilievo {
namespace {

// Of the distance from what is shown, rounded down to a power of two, so that eyes near to each
// other have cells of one size.
constexpr double kCellShare = 0.01;
// Samples of layers lie in rows of so many.
constexpr int kRow = 4096;

// All of a camera, as text.
std::string exact_cell(const Camera& camera) {
  ContentHash hash;
  hash.add(std::uint64_t(camera.projection));
  const auto add = [&](double number) { hash.add(std::bit_cast<std::uint64_t>(number)); };
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) add(camera.world_from_eye[column][row]);
  for (const double number : {camera.window.left, camera.window.right, camera.window.bottom,
                              camera.window.top, camera.z_near, camera.z_far})
    add(number);
  // Pictures that were kept before have none.
  if (camera.texels_per_pixel != 1) add(double(camera.texels_per_pixel));
  return "camera " + hash.text();
}

// Of what all pictures of some objects have in common.
PictureKey key_of(std::span<const std::uint32_t> objects, int samples, const Camera& camera,
                  const KeptOptions& options) {
  PictureKey key;
  key.content = options.content;
  for (const std::uint32_t object : objects) key.content += ' ' + std::to_string(object);
  key.shader = options.shader + " samples " + std::to_string(samples);
  key.width = camera.width, key.height = camera.height;
  return key;
}

// Layers as pictures: the counts of the texels in place of objects, ...
DepthImage counts_of(const LayeredDepthImage& layers) {
  const Camera& camera = layers.camera;
  DepthImage counts;
  counts.name = layers.name;
  counts.camera = camera;
  counts.depth_kind = layers.depth_kind;
  counts.color = ColorImage(camera.width, camera.height);
  counts.depth = Image<float>(camera.width, camera.height, kNoDepth);
  counts.object = Image<std::uint32_t>(camera.width, camera.height);
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i)
    counts.object.texels()[i] = std::uint32_t(layers.first[i + 1] - layers.first[i]);
  return counts;
}

// ... and the samples, of which surfaces alone have one depth. Nothing if there is a volume.
std::optional<DepthImage> samples_of(const LayeredDepthImage& layers) {
  DepthImage samples;
  samples.camera = layers.camera;
  samples.camera.width = kRow;
  samples.camera.height = int((layers.samples.size() + kRow - 1) / kRow);
  samples.camera.height = std::max(samples.camera.height, 1);
  const Camera& camera = samples.camera;
  samples.color = ColorImage(camera.width, camera.height);
  samples.depth = Image<float>(camera.width, camera.height, kNoDepth);
  samples.object = Image<std::uint32_t>(camera.width, camera.height);
  for (std::size_t i = 0; i < layers.samples.size(); ++i) {
    const LayerSample& sample = layers.samples[i];
    if (sample.back != sample.depth) return std::nullopt;
    samples.color.texels()[i] = sample.color;
    samples.depth.texels()[i] = sample.depth;
    samples.object.texels()[i] = sample.object;
  }
  return samples;
}

}  // namespace

PictureKey kept_key(const CaptureRequest& request, const Box& bounds, const KeptOptions& options) {
  PictureKey key = key_of(request.objects, request.samples, request.camera, options);
  if (request.time != 0) key.shader += " time " + std::to_string(request.time);
  if (request.identifiers) key.shader += " identifiers";
  if (request.with_sky) key.shader += " sky";
  if (options.exact) {
    key.cell = exact_cell(request.camera);
    return key;
  }
  const double distance =
      bounds.empty() ? 1.0 : glm::length(request.camera.position() - glm::dvec3(bounds.center()));
  const double side = std::exp2(std::floor(std::log2(std::max(kCellShare * distance, 1e-12))));
  key.cell = camera_cell(request.camera, side);
  return key;
}

LayersKeys kept_keys(const LayersRequest& request, const KeptOptions& options) {
  PictureKey key = key_of(request.objects, request.samples, request.camera, options);
  ContentHash merged;
  merged.add(std::bit_cast<std::uint64_t>(request.merge));
  merged.add(std::uint64_t(request.max_layers));
  key.cell = exact_cell(request.camera) + " layers " + merged.text();
  LayersKeys keys{key, key};
  keys.counts.cell += " counts", keys.samples.cell += " samples";
  // A picture with a size of its own, which is not known yet.
  keys.samples.width = keys.samples.height = 0;
  return keys;
}

void KeptSource::fail(const Error& error) {
  if (!warned_ && options_.warn) options_.warn(error.message());
  warned_ = true;
}

std::optional<DepthImage> KeptSource::find(const PictureKey& key) {
  Result<std::optional<DepthImage>> kept = store_->find(key);
  if (kept) return *std::move(kept);
  fail(kept.error());
  return std::nullopt;
}

void KeptSource::insert(const PictureKey& key, const DepthImage& picture) {
  if (Result<> inserted = store_->insert(key, picture); !inserted) fail(inserted.error());
}

Result<CapturedPicture> KeptSource::capture(const CaptureRequest& request) {
  const bool keeps = store_ && !request.farthest && (options_.exact || !request.with_sky);
  PictureKey key;
  if (keeps) {
    key = kept_key(request, source_.bounds(request.objects), options_);
    if (std::optional<DepthImage> kept = find(key)) {
      ++found_;
      CapturedPicture captured;
      captured.picture = *std::move(kept);
      return captured;
    }
  }
  Result<CapturedPicture> captured = source_.capture(request);
  if (!captured) return captured;
  ++rendered_;
  if (keeps) insert(key, captured->picture);
  return captured;
}

std::optional<LayeredDepthImage> KeptSource::find_layers(const LayersKeys& keys,
                                                         const Camera& camera) {
  const std::optional<DepthImage> counts = find(keys.counts);
  if (!counts || counts->object.empty()) return std::nullopt;
  const std::optional<DepthImage> samples = find(keys.samples);
  if (!samples || samples->object.empty()) return std::nullopt;
  LayeredDepthImage layers;
  layers.name = counts->name;
  layers.camera = camera;
  layers.depth_kind = counts->depth_kind;
  layers.first = {0};
  for (const std::uint32_t count : counts->object.texels())
    layers.first.push_back(layers.first.back() + count);
  if (layers.first.back() > samples->depth.texels().size()) return std::nullopt;
  for (std::size_t i = 0; i < layers.first.back(); ++i) {
    const float depth = samples->depth.texels()[i];
    layers.samples.push_back(
        {samples->color.texels()[i], depth, depth, samples->object.texels()[i]});
  }
  if (!validate(layers)) return std::nullopt;
  return layers;
}

Result<LayeredDepthImage> KeptSource::capture_layers(const LayersRequest& request) {
  const bool keeps = store_ && options_.exact;
  LayersKeys keys;
  if (keeps) {
    keys = kept_keys(request, options_);
    if (std::optional<LayeredDepthImage> kept = find_layers(keys, request.camera)) {
      ++found_;
      return *std::move(kept);
    }
  }
  Result<LayeredDepthImage> layers = source_.capture_layers(request);
  if (!layers) return layers;
  ++rendered_;
  const std::optional<DepthImage> samples = keeps ? samples_of(*layers) : std::nullopt;
  if (samples && samples->camera.height <= (1 << 16)) {
    // The counts come last: they say that the layers are complete.
    insert(keys.samples, *samples);
    insert(keys.counts, counts_of(*layers));
  }
  return layers;
}

}  // namespace rilievo
