#include "rilievo/render/rays/cast_pixels.h"

#include <algorithm>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/core/touch_memory.h"
#include "rilievo/render/shading/picture_shader.h"
#include "rilievo/render/shading/sample_buffer.h"

namespace rilievo {

std::optional<RayHit> hit_at_pixel(const RayScene& rays, const Camera& frame,
                                   const FramePixel& pixel, std::span<const bool> objects) {
  const glm::dvec3 eye = frame.position();
  const glm::dvec3 through = world_from_raster(frame, {pixel.x + 0.5, pixel.y + 0.5}, 1) - eye;
  return rays.first_hit(glm::vec3(eye + frame.z_near * through), glm::vec3(through), 0,
                        float(frame.z_far - frame.z_near), RaySides::seen, objects);
}

PixelCaster::PixelCaster(const RayScene& rays)
    : rays_(rays), included_(std::make_unique<bool[]>(rays.scene().objects.size())) {
  RILIEVO_EXPECTS(rays.parts() == RayParts::opaque);
  for (const Model& model : rays.scene().models) {
    std::vector<std::uint32_t>& places = place_of_part_.emplace_back();
    std::uint32_t place = 0;
    for (const Part& part : model.parts) {
      places.push_back(place);
      place += !rays.materials().of_mesh(part.mesh).blended;
    }
  }
}
PixelCaster::~PixelCaster() = default;

void PixelCaster::take_memory(std::size_t samples) {
  touch_memory(inverse_z_, samples);
  touch_memory(triangles_, samples);
}

void PixelCaster::cast(const Camera& camera, int samples, std::span<const FramePixel> pixels,
                       std::span<const std::uint32_t> objects) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  RILIEVO_EXPECTS(samples == 1 || samples == 4);
  const Scene& scene = rays_.scene();
  place_meshes(scene, rays_.materials(), camera.position(), objects, rays_.poses(), placed_);
  first_of_object_.assign(scene.objects.size(), 0);
  std::fill_n(included_.get(), scene.objects.size(), false);
  std::uint32_t first = 0;
  for (const std::uint32_t object : objects) {
    first_of_object_[object] = first;
    included_[object] = true;
    for (const Part& part : scene.models[std::size_t(scene.objects[object].model)].parts)
      first += !rays_.materials().of_mesh(part.mesh).blended;
  }
  const std::size_t count = pixels.size() * std::size_t(samples);
  inverse_z_.assign(count, 0.0f);
  triangles_.resize(count);

  const glm::dmat3 axes(camera.world_from_eye);
  const ImageWindow& w = camera.window;
  const glm::dvec3 corner = axes * glm::dvec3(w.left, w.bottom, -1);
  const glm::dvec3 per_x = (w.right - w.left) / camera.width * axes[0];
  const glm::dvec3 per_y = (w.top - w.bottom) / camera.height * axes[1];
  const double start = camera.z_near, step = camera.z_far - camera.z_near;
  const RayPictureView view{
      picture_rays(camera), camera.position(), {included_.get(), scene.objects.size()}};
  // Several packets for each call of a thread.
  constexpr std::size_t kRun = 8 * RayPacket::kMaxCount;
  parallel_for(std::size_t(0), (count + kRun - 1) / kRun, [&](std::size_t run) {
    RayPacket packet;
    const std::size_t end = std::min((run + 1) * kRun, count);
    for (std::size_t from = run * kRun; from < end; from += RayPacket::kMaxCount) {
      packet.count = int(std::min(std::size_t(RayPacket::kMaxCount), end - from));
      for (int i = 0; i < packet.count; ++i) {
        const std::size_t sample = from + std::size_t(i);
        const FramePixel pixel = pixels[sample / std::size_t(samples)];
        // Samples have places from the lower left.
        const glm::vec2 at = sample_position(int(sample % std::size_t(samples)), samples);
        const double x = pixel.x + double(at.x), y = camera.height - 1 - pixel.y + double(at.y);
        const glm::dvec3 through = corner + x * per_x + y * per_y;
        const glm::vec3 origin(camera.position() + start * through), way(step * through);
        for (int axis = 0; axis < 3; ++axis)
          packet.origin[axis][i] = origin[axis], packet.direction[axis][i] = way[axis];
        packet.t_near[i] = 0, packet.t_far[i] = 1;
      }
      rays_.first_hits(view, packet);
      for (int i = 0; i < packet.count; ++i) {
        if (packet.object[i] == 0) continue;
        const std::uint32_t object = packet.object[i] - 1;
        const auto& places = place_of_part_[std::size_t(scene.objects[object].model)];
        const std::size_t sample = from + std::size_t(i);
        inverse_z_[sample] = float(1 / (start + double(packet.distance[i]) * step));
        triangles_[sample] =
            placed_[first_of_object_[object] + places[std::size_t(packet.part[i])]].first_triangle +
            packet.triangle[i];
      }
    }
  });
}

ShadedScene PixelCaster::view(const Camera& camera, int samples) {
  return {placed_, picture_rays(camera), surface_lights(rays_.scene(), camera.position(), lights_),
          samples};
}

}  // namespace rilievo
