#include "rilievo/capture/store/kept_source.h"

#include <cmath>

namespace rilievo {
namespace {

// Of the distance from what is shown, rounded down to a power of two, so that eyes near to each
// other have cells of one size.
constexpr double kCellShare = 0.01;

}  // namespace

PictureKey kept_key(const CaptureRequest& request, const Box& bounds, const KeptOptions& options) {
  const double distance =
      bounds.empty() ? 1.0 : glm::length(request.camera.position() - glm::dvec3(bounds.center()));
  const double side = std::exp2(std::floor(std::log2(std::max(kCellShare * distance, 1e-12))));
  PictureKey key;
  key.content = options.content;
  for (const std::uint32_t object : request.objects) key.content += ' ' + std::to_string(object);
  key.shader = options.shader + " samples " + std::to_string(request.samples);
  if (request.time != 0) key.shader += " time " + std::to_string(request.time);
  if (request.identifiers) key.shader += " identifiers";
  key.cell = camera_cell(request.camera, side);
  key.width = request.camera.width, key.height = request.camera.height;
  return key;
}

void KeptSource::fail(const Error& error) {
  if (!warned_ && options_.warn) options_.warn(error.message());
  warned_ = true;
}

Result<CapturedPicture> KeptSource::capture(const CaptureRequest& request) {
  const bool keeps = store_ && !request.farthest && !request.with_sky;
  PictureKey key;
  if (keeps) {
    key = kept_key(request, source_.bounds(request.objects), options_);
    Result<std::optional<DepthImage>> kept = store_->find(key);
    if (!kept) {
      fail(kept.error());
    } else if (*kept) {
      ++found_;
      CapturedPicture captured;
      captured.picture = **std::move(kept);
      return captured;
    }
  }
  Result<CapturedPicture> captured = source_.capture(request);
  if (!captured) return captured;
  ++rendered_;
  if (keeps)
    if (Result<> inserted = store_->insert(key, captured->picture); !inserted)
      fail(inserted.error());
  return captured;
}

}  // namespace rilievo
