#include "rilievo/capture/photograph_source.h"

#include <utility>

#include "rilievo/warp/reproject.h"
#include "rilievo/warp/unmix_edges.h"

namespace rilievo {

PhotographSource::PhotographSource(std::string name, std::vector<DepthImage> photographs,
                                   const Box& box, const WorldSpace& world)
    : name_(std::move(name)),
      photographs_(std::move(photographs)),
      box_(box.empty() ? measured_bounds(photographs_) : box),
      world_(world) {
  for (DepthImage& photograph : photographs_) unmix_edges(photograph);
}

Box PhotographSource::bounds(std::span<const std::uint32_t>) const { return box_; }

Result<CapturedPicture> PhotographSource::capture(const CaptureRequest& request) {
  if (request.farthest) return Error{name_, "photographs do not contain hidden surfaces"};
  if (box_.empty()) return Error{name_, "no photograph has a measured depth"};
  if (Result<> ok = validate(request.camera); !ok) return ok.error();
  ReprojectOptions options;
  options.box = box_;
  Reprojection reprojected = reproject(photographs_, {&request.camera, 1}, options);
  CapturedPicture captured{std::move(reprojected.pictures.front()), {}};
  captured.picture.name = name_;
  return captured;
}

}  // namespace rilievo
