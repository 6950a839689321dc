#include "rilievo/render/raster/frame_raster.h"

#include <algorithm>
#include <string>

#include "rilievo/core/expects.h"
#include "rilievo/render/raster/raster_instances.h"

namespace rilievo {

void FrameRaster::place(const Camera& camera, std::span<const std::uint32_t> objects,
                        std::span<const glm::mat4> poses) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  find_places(camera, objects, poses, placed_);
  make_instances(camera, placed_, instances_, masks_);
}

void FrameRaster::place(const Camera& camera, std::span<const PlacedMesh> placed) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  placed_.assign(placed.begin(), placed.end());
  make_instances(camera, placed_, instances_, masks_);
}

void FrameRaster::place_nearest_first(const Camera& camera, const PlacedScene& scene,
                                      std::span<const std::uint32_t> objects,
                                      std::span<const CrossFade> fading) {
  nearest_first_.clear();
  for (const std::uint32_t object : objects)
    nearest_first_.emplace_back(
        glm::length(glm::dvec3(scene.bounds()[object].center()) - camera.position()), object);
  std::sort(nearest_first_.begin(), nearest_first_.end());
  objects_.clear();
  for (const auto& [distance, object] : nearest_first_) objects_.push_back(object);
  for (const CrossFade& one : fading) objects_.push_back(one.object);
  place(camera, objects_, scene.poses());
}

void FrameRaster::keep_farthest() {
  for (RasterInstance& instance : instances_) rilievo::keep_farthest(instance);
}

void FrameRaster::begin(const Camera& camera, int samples, NearPlane near_plane, bool staggered) {
  raster_.begin(camera.width, camera.height, samples, staggered);
  next_instance_ = 0, next_triangle_ = 0;
  work_.clear();
  cut_.clear();
  if (near_plane == NearPlane::clamps) {
    for (RasterInstance& instance : instances_) instance.strokes.clamps = true;
    return;
  }
  near_clip_.clear();
  instances_.resize(placed_.size());  // without the pieces of the last time
  const float z_near = float(camera.z_near);
  for (std::size_t i = 0; i < placed_.size(); ++i)
    if (placed_[i].mesh->primitive != Primitive::triangles)
      instances_[i].min_w = z_near;
    else if (NearClip::crosses(instances_[i], placed_[i].mesh->bounds, z_near))
      if (near_clip_.cut(*placed_[i].mesh, camera.width, camera.height, z_near, instances_[i]))
        cut_.push_back(i);
  instances_.insert(instances_.end(), near_clip_.instances().begin(), near_clip_.instances().end());
}

void FrameRaster::fill(const Camera& camera, int samples, NearPlane near_plane, bool staggered) {
  begin(camera, samples, near_plane, staggered);
  raster_.draw(instances_);
  const std::span<const MeshWork> work = raster_.work();
  work_.assign(work.begin(), work.begin() + std::ptrdiff_t(placed_.size()));
  for (std::size_t i = 0; i < cut_.size(); ++i) {
    const MeshWork& piece = work[placed_.size() + i];
    work_[cut_[i]].projected += piece.projected, work_[cut_[i]].filled += piece.filled;
  }
}

bool FrameRaster::fill_some(std::uint64_t triangles) {
  constexpr std::uint32_t kPiece = SampleRaster::kPiece;
  some_.clear();
  for (std::uint64_t taken = 0; taken < triangles && next_instance_ < instances_.size();) {
    RasterInstance part = instances_[next_instance_];
    const std::uint32_t first = next_triangle_, left = part.triangles - first;
    const std::uint64_t wanted = (triangles - taken + kPiece - 1) / kPiece * kPiece;
    part.triangles = std::uint32_t(std::min<std::uint64_t>(left, wanted));
    part.indices += std::size_t(first) * corners_of(part.primitive);
    part.first_triangle += first;
    if (part.numbers) part.numbers += first;
    if (!part.boxes.empty())
      part.boxes = part.boxes.subspan(first / kPiece, (part.triangles + kPiece - 1) / kPiece);
    taken += part.triangles, next_triangle_ += part.triangles;
    if (part.triangles == left) ++next_instance_, next_triangle_ = 0;
    if (part.triangles > 0) some_.push_back(part);
  }
  raster_.draw(some_);
  return next_instance_ < instances_.size();
}

std::uint64_t FrameRaster::triangles() const {
  std::uint64_t sum = 0;
  for (const RasterInstance& instance : instances_) sum += instance.triangles;
  return sum;
}

Result<> FrameRaster::find_visible(const Camera& camera, int samples, const PlacedScene& scene,
                                   std::span<const std::uint32_t> objects,
                                   std::span<const CrossFade> fading) {
  if (std::max(camera.width, camera.height) > SampleRaster::kMaxSize)
    return Error{"frame", "the rasteriser draws at most " + std::to_string(SampleRaster::kMaxSize) +
                              " pixels a side"};
  place_nearest_first(camera, scene, objects, fading);

  // The meshes of each object that fades are the next ones of the list, from its end on.
  std::size_t end = instances_.size();
  for (std::size_t i = fading.size(); i-- > 0;) {
    const CrossFade& one = fading[i];
    for (const Part& part :
         scene.scene().models[std::size_t(scene.scene().objects[one.object].model)].parts) {
      if (!scene.opaque_meshes()[std::size_t(part.mesh)]) continue;
      --end;
      instances_[end].share_from = one.from, instances_[end].share_to = one.to;
    }
  }
  fill(camera, samples, NearPlane::cuts);
  return Done{};
}

PictureView FrameRaster::view(const Camera& camera) {
  return {raster_.seen(),
          {placed_, picture_rays(camera), surface_lights(scene_, camera.position(), lights_),
           raster_.seen().samples, ColorScale::srgb, raster_.seen().staggered}};
}

}  // namespace rilievo
