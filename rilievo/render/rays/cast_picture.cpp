#include "rilievo/render/rays/cast_picture.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/raster/raster_instances.h"
#include "rilievo/render/rays/fill_pinholes.h"
#include "rilievo/render/rays/hit_surface.h"
#include "rilievo/render/rays/stroke_hits.h"
#include "rilievo/render/shading/picture_shader.h"
#include "rilievo/render/shading/shading_model.h"
#include "rilievo/render/shading/texel_shader.h"

namespace rilievo {
namespace {

// The farthest depth of a SampleBuffer that is not nothing.
constexpr float kBelowOne = 0x1.fffffep-1f;

// The camera's rays, in doubles: the k-th from where it stops looking, see camera_ray().
class CameraRays {
 public:
  explicit CameraRays(const Camera& camera)
      : parallel_(camera.projection == Projection::parallel),
        position_(camera.position()),
        forward_(camera.forward()),
        start_(camera.keeps_farthest() ? camera.z_far : camera.z_near),
        step_((camera.keeps_farthest() ? camera.z_near : camera.z_far) - start_) {
    const glm::dmat3 axes(camera.world_from_eye);
    const ImageWindow& w = camera.window;
    corner_ = axes * glm::dvec3(w.left, w.bottom, parallel_ ? 0 : -1);
    per_x_ = (w.right - w.left) / camera.width * axes[0];
    per_y_ = (w.top - w.bottom) / camera.height * axes[1];
  }
  // Through a place in texels from the *lower* left corner.
  void put(double x, double y, RayPacket& packet) const {
    const int i = packet.count++;
    const glm::dvec3 through = corner_ + x * per_x_ + y * per_y_;
    const glm::dvec3 direction = parallel_ ? forward_ : through;
    const glm::vec3 origin(position_ + start_ * direction + (parallel_ ? through : glm::dvec3(0)));
    const glm::vec3 way(step_ * direction);
    for (int axis = 0; axis < 3; ++axis)
      packet.origin[axis][i] = origin[axis], packet.direction[axis][i] = way[axis];
    packet.t_near[i] = 0, packet.t_far[i] = 1;
  }
  [[nodiscard]] double eye_z(double t) const { return start_ + t * step_; }

 private:
  bool parallel_;
  glm::dvec3 position_, forward_, corner_, per_x_, per_y_;
  double start_, step_;
};

// The rays of a camera's texels, for a frame whose pixels are `pixel` texels wide.
PictureRays coarse_rays(const Camera& camera, float pixel) {
  PictureRays rays = picture_rays(camera);
  rays.footprint = pixel;
  return rays;
}

}  // namespace

struct PictureCaster::State {
  const RayScene& rays;
  // By model and part: how many parts before it are in pictures.
  std::vector<std::vector<std::uint32_t>> place_of_part;
  std::vector<std::uint32_t> all, first_of_object;
  std::unique_ptr<bool[]> included;
  std::vector<PlacedMesh> placed;
  std::vector<Light> lights;
  SampleBuffer seen;
  PinholeFiller pinholes;
  PictureShader shader;
  // Points and lines, which are rasterised.
  SampleRaster strokes;
  std::vector<PlacedMesh> placed_strokes;
  std::vector<RasterInstance> stroke_instances;
  std::vector<RasterMask> no_masks;

  explicit State(const RayScene& rays);
  void place(const Camera& camera, std::span<const std::uint32_t> objects);
  // Fills `seen`.
  void cast(const PictureRays& seen_by, const Camera& camera, bool all_objects, int samples);
  // Points and lines that are nearer than what `seen` has.
  void add_strokes(const Camera& camera);
  void cast_coarse(const PictureRays& seen_by, const Camera& camera);
  [[nodiscard]] PictureView view(const PictureRays& seen_by, const Camera& camera) {
    return {
        seen,
        {placed, seen_by, surface_lights(rays.scene(), camera.position(), lights), seen.samples}};
  }
  void set(std::size_t sample, float depth, std::uint32_t object, int part, std::uint32_t triangle);
  [[nodiscard]] std::uint32_t triangle_of(std::uint32_t object, int part,
                                          std::uint32_t triangle) const;
};

PictureCaster::State::State(const RayScene& rays) : rays(rays) {
  RILIEVO_EXPECTS(rays.parts() == RayParts::opaque);
  const Scene& scene = rays.scene();
  for (const Model& model : scene.models) {
    std::vector<std::uint32_t>& places = place_of_part.emplace_back();
    std::uint32_t place = 0;
    for (const Part& part : model.parts) {
      places.push_back(place);
      place += !rays.materials().of_mesh(part.mesh).blended;
    }
  }
  all.resize(scene.objects.size());
  std::iota(all.begin(), all.end(), 0u);
  included = std::make_unique<bool[]>(all.size());
}

void PictureCaster::State::place(const Camera& camera, std::span<const std::uint32_t> objects) {
  const Scene& scene = rays.scene();
  place_meshes(scene, rays.materials(), camera.position(), objects, rays.poses(), placed);
  first_of_object.assign(scene.objects.size(), 0);
  std::fill_n(included.get(), scene.objects.size(), false);
  std::uint32_t first = 0;
  for (const std::uint32_t object : objects) {
    first_of_object[object] = first;
    included[object] = true;
    for (const Part& part : scene.models[std::size_t(scene.objects[object].model)].parts)
      first += !rays.materials().of_mesh(part.mesh).blended;
  }
}

// What a sample shows: `depth` as SampleBuffer has it, of an object from 0 on.
void PictureCaster::State::set(std::size_t sample, float depth, std::uint32_t object, int part,
                               std::uint32_t triangle) {
  seen.depth[sample] = std::clamp(depth, 0.0f, kBelowOne);
  seen.triangle[sample] = triangle_of(object, part, triangle);
}

// The number of a triangle in the SampleBuffer.
std::uint32_t PictureCaster::State::triangle_of(std::uint32_t object, int part,
                                                std::uint32_t triangle) const {
  const auto& places = place_of_part[std::size_t(rays.scene().objects[object].model)];
  return placed[first_of_object[object] + places[std::size_t(part)]].first_triangle + triangle;
}

void PictureCaster::State::cast(const PictureRays& seen_by, const Camera& camera, bool all_objects,
                                int samples) {
  const Scene& scene = rays.scene();
  seen.begin(camera.width, camera.height, samples);
  RayPictureView view{seen_by, camera.position(), {}};
  if (!all_objects) view.objects = {included.get(), scene.objects.size()};
  const CameraRays camera_rays(camera);
  // A packet is a square of texels: its rays stay together longest.
  const int side = samples == 1 ? 4 : 2;
  static_assert(RayPacket::kMaxCount == 16);
  parallel_for(0, (camera.height + side - 1) / side, [&](int band) {
    RayPacket packet;
    std::size_t place[RayPacket::kMaxCount];  // of the samples
    for (int x = 0; x < camera.width; x += side) {
      packet.count = 0;
      for (int row = band * side; row < std::min((band + 1) * side, camera.height); ++row)
        for (int k = x; k < std::min(x + side, camera.width); ++k)
          for (int s = 0; s < samples; ++s) {
            const glm::vec2 at = sample_position(s, samples);
            place[packet.count] =
                seen.row(row) + std::size_t(k) * std::size_t(samples) + std::size_t(s);
            camera_rays.put(double(k) + double(at.x), double(row) + double(at.y), packet);
          }
      rays.first_hits(view, packet);
      for (int i = 0; i < packet.count; ++i) {
        if (packet.object[i] == 0) continue;
        const double eye_z = camera_rays.eye_z(double(packet.distance[i]));
        const double window_z = depth_from_eye_z(DepthKind::window_z, eye_z, camera, {});
        set(place[i], float(camera.keeps_farthest() ? 1.0 - window_z : window_z),
            packet.object[i] - 1, packet.part[i], packet.triangle[i]);
      }
    }
  });
  add_strokes(camera);
}

void PictureCaster::State::add_strokes(const Camera& camera) {
  placed_strokes.clear();
  for (const PlacedMesh& mesh : placed)
    if (mesh.mesh->primitive != Primitive::triangles) placed_strokes.push_back(mesh);
  if (placed_strokes.empty()) return;
  make_instances(camera, placed_strokes, stroke_instances, no_masks);
  for (RasterInstance& instance : stroke_instances) {
    if (camera.keeps_farthest()) keep_farthest(instance);
    instance.min_w = camera.projection == Projection::parallel ? 0 : float(camera.z_near);
  }
  strokes.begin(seen.width, seen.height, seen.samples);
  strokes.draw(stroke_instances);
  const SampleBuffer& from = strokes.seen();
  parallel_for(0, seen.height, [&](int y) {
    const std::size_t first = seen.row(y);
    const std::size_t count = std::size_t(seen.width) * std::size_t(seen.samples);
    for (std::size_t i = first; i < first + count; ++i)
      if (from.depth[i] < seen.depth[i])
        seen.depth[i] = from.depth[i], seen.triangle[i] = from.triangle[i];
  });
}

void PictureCaster::State::cast_coarse(const PictureRays& seen_by, const Camera& camera) {
  place(camera, all);
  cast(seen_by, camera, true, 1);
  pinholes.fill(placed, seen);
}

PictureCaster::PictureCaster(const RayScene& scene) : state_(new State(scene)) {}
PictureCaster::PictureCaster(PictureCaster&&) noexcept = default;
PictureCaster& PictureCaster::operator=(PictureCaster&&) noexcept = default;
PictureCaster::~PictureCaster() = default;

void PictureCaster::draw(const Camera& camera, std::span<const std::uint32_t> objects, int samples,
                         RasterPicture& picture) {
  State& s = *state_;
  s.place(camera, objects.empty() ? s.all : objects);
  s.cast(picture_rays(camera), camera, objects.empty(), samples);
  s.shader.shade(view(camera), picture);
}

void PictureCaster::cast(const Camera& camera, int samples) {
  state_->place(camera, state_->all);
  state_->cast(picture_rays(camera), camera, true, samples);
}

PictureView PictureCaster::view(const Camera& camera) {
  return state_->view(picture_rays(camera), camera);
}

const SampleBuffer& PictureCaster::seen() const { return state_->seen; }
std::span<const PlacedMesh> PictureCaster::meshes() const { return state_->placed; }

void PictureCaster::draw_objects(const Camera& camera, ObjectPicture& picture) {
  cast(camera, 1);
  identify(seen(), meshes(), picture);
}

void PictureCaster::draw_coarse(const Camera& camera, float pixel, RasterPicture& picture) {
  State& s = *state_;
  const PictureRays rays = coarse_rays(camera, pixel);
  s.cast_coarse(rays, camera);
  s.shader.shade(s.view(rays, camera), picture);
}

void PictureCaster::draw_coarse_objects(const Camera& camera, float pixel, ObjectPicture& picture) {
  state_->cast_coarse(coarse_rays(camera, pixel), camera);
  identify(seen(), meshes(), picture);
}

CameraRay camera_ray(const Camera& camera, const glm::dvec2& raster) {
  const double start = camera.keeps_farthest() ? camera.z_far : camera.z_near;
  const double end = camera.keeps_farthest() ? camera.z_near : camera.z_far;
  const glm::dvec3 origin = world_from_raster(camera, raster, start);
  return {origin, world_from_raster(camera, raster, end) - origin, start, end - start};
}

DepthImage cast_picture(const RayScene& rays, const Camera& camera, const CastOptions& options) {
  RILIEVO_EXPECTS(options.samples == 1 || (options.samples == 4 && !options.staggered));
  DepthImage picture;
  picture.camera = camera;
  picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
  picture.object = Image<std::uint32_t>(camera.width, camera.height, kNoObject);
  PictureCaster caster(rays);
  PictureCaster::State& s = *caster.state_;
  const bool all = options.objects.empty();
  s.place(camera, all ? s.all : options.objects);
  if (options.samples == 1)
    s.seen.begin(camera.width, camera.height, 1, options.staggered);
  else
    s.cast(picture_rays(camera), camera, all, options.samples);
  const int last = camera.height - 1;  // rows from the top
  RayPictureView seen_by{picture_rays(camera), camera.position(), {}};
  if (!all) seen_by.objects = {s.included.get(), rays.scene().objects.size()};
  CenterTexels centers;
  if (options.samples > 1) {
    centers.depth = Image<float>(camera.width, camera.height, 1.0f);
    centers.triangle = Image<std::uint32_t>(camera.width, camera.height, ShownTexels::kNothing);
  }
  const StrokeHits strokes(rays, camera, seen_by.objects);
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      glm::dvec2 raster(x + 0.5, y + 0.5);
      if (options.staggered) {
        const glm::dvec2 at = staggered_position(x, last - y);
        raster = {x + at.x, y + 1 - at.y};
      }
      const CameraRay ray = camera_ray(camera, raster);
      const auto hit =
          strokes.nearer(raster, rays.first_hit(seen_by, ray.origin, ray.direction, 0.0f, 1.0f));
      if (!hit) continue;
      picture.depth(x, y) = float(ray.eye_z_start + double(hit->distance) * ray.eye_z_step);
      picture.object(x, y) = hit->object;
      if (options.samples == 1) {
        s.set(s.seen.row(last - y) + std::size_t(x), 0.0f, hit->object - 1, hit->part,
              hit->triangle);
      } else {
        const double z = depth_from_eye_z(DepthKind::window_z, picture.depth(x, y), camera, {});
        centers.depth(x, last - y) =
            std::min(float(camera.keeps_farthest() ? 1.0 - z : z), kBelowOne);
        centers.triangle(x, last - y) = s.triangle_of(hit->object - 1, hit->part, hit->triangle);
      }
    }
  });
  const PictureView view{
      s.seen,
      {s.placed, picture_rays(camera), surface_lights(rays.scene(), camera.position(), s.lights),
       s.seen.samples, ColorScale::linear, s.seen.staggered}};
  if (options.samples == 1)
    s.shader.shade(view, picture, options.sky);
  else
    shade_texels(view, choose_texels(centers, s.seen, s.placed, picture), picture, options.sky);
  return picture;
}

float farthest_eye_z(const RayScene& rays, const Camera& camera, const glm::dvec2& raster,
                     const StrokeHits& strokes) {
  // The first one from the ray's other end.
  const glm::dvec3 end = world_from_raster(camera, raster, camera.z_far);
  const glm::dvec3 back = world_from_raster(camera, raster, camera.z_near) - end;
  const auto hit = rays.first_hit(end, back, 0.0f, 1.0f, RaySides::both, strokes.objects());
  const float of_strokes = strokes.farthest_eye_z(raster);
  if (!hit) return of_strokes;
  const float eye_z = float(camera.z_far + double(hit->distance) * (camera.z_near - camera.z_far));
  return of_strokes < kNoDepth ? std::max(eye_z, of_strokes) : eye_z;
}

HitShader::HitShader(const RayScene& scene, const Camera& camera, float least_roughness)
    : scene_(scene),
      rays_(picture_rays(camera)),
      height_(camera.height),
      least_roughness_(least_roughness),
      lights_(surface_lights(scene.scene(), camera.position(), storage_)) {}

glm::vec4 HitShader::shade(const RayHit& hit, int x, int y) const {
  namespace model = shading_model;
  // As BandShader has it, for the same bytes.
  const glm::vec3 ray = rays_.first + float(x) * rays_.per_x + float(height_ - 1 - y) * rays_.per_y;
  model::SurfacePoint<float> point = surface_of_hit(scene_, hit, rays_, ray, lights_.eye);
  point.roughness = std::max(point.roughness, least_roughness_);
  const glm::vec3 view(point.view.x, point.view.y, point.view.z);
  if (!surface_material(scene_, hit).double_sided && glm::dot(hit.normal, view) < 0) {
    point.normal = -1.0f * point.normal;
    point.view = glm::reflect(view, hit.normal);
  }
  const model::Vec3<float> light = model::shade_point(lights_, point);
  return {light.x, light.y, light.z, 1.0f};
}

}  // namespace rilievo
