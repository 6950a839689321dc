#include "bench/impostor_judge.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/nailboard/software/software_boards.h"
#include "rilievo/relief_impostor/impostor_warp.h"
#include "rilievo/relief_impostor/merge_warps.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::bench {
namespace {

// A part of a premultiplied picture, over black.
Rgba8Image cropped(const Rgba8Image& image, const glm::ivec4& crop) {
  Rgba8Image out(crop.z - crop.x, crop.w - crop.y);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      out(x, y) = glm::u8vec4(glm::u8vec3(image(x + crop.x, y + crop.y)), 255);
  return out;
}

// left, top, right, bottom around what is not transparent, and some.
glm::ivec4 around(const Rgba8Image& image) {
  glm::ivec4 crop(image.width(), image.height(), 0, 0);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (image(x, y).a > 0)
        crop = {std::min(crop.x, x), std::min(crop.y, y), std::max(crop.z, x + 1),
                std::max(crop.w, y + 1)};
  return {std::max(0, crop.x - 8), std::max(0, crop.y - 8), std::min(image.width(), crop.z + 8),
          std::min(image.height(), crop.w + 8)};
}

}  // namespace

Result<TracedScene> traced_scene(const std::string& name) {
  TracedScene traced;
  traced.scene = std::make_unique<Scene>();
  if (name.starts_with("builtin:")) {
    Result<BuiltinScene> made = make_builtin(name);
    if (!made) return made.error();
    *traced.scene = std::move(made->scene);
    traced.name = name;
  } else {
    Result<LoadedScene> loaded = load_scene(name);
    if (!loaded) return loaded.error();
    *traced.scene = std::move(loaded->scene);
    traced.name = std::filesystem::path(name).stem().string();
  }
  Result<RayScene> rays = RayScene::create(*traced.scene, 0.0, RayParts::all);
  if (!rays) return rays.error();
  traced.rays = std::make_unique<RayScene>(std::move(*rays));
  RayTracer tracer(*traced.rays);
  const double whole = double(tracer.bounds({}).radius());
  std::uint64_t most = 0;
  bool small = false;
  for (std::uint32_t i = 0; i < traced.scene->objects.size(); ++i) {
    const std::uint32_t one[] = {i};
    const Box box = tracer.bounds(one);
    if (box.empty()) continue;
    const Model& model = traced.scene->models[std::size_t(traced.scene->objects[i].model)];
    std::uint64_t triangles = 0;
    for (const auto& part : model.parts)
      triangles += traced.scene->meshes[std::size_t(part.mesh)].indices.size() / 3;
    const bool is_small = double(box.radius()) < 0.5 * whole;
    if (is_small < small || (is_small == small && triangles <= most)) continue;
    most = triangles, small = is_small;
    traced.object = i, traced.box = box;
  }
  if (traced.box.empty()) return Error{name, "has nothing to show"};
  return traced;
}

Camera orbit_camera(const TracedScene& traced, double angle, int width, int height) {
  const glm::dvec3 center(traced.box.center());
  const double away = 2.8 * double(traced.box.radius());
  const glm::dvec3 way = glm::normalize(glm::dvec3(std::sin(angle), 0.4, std::cos(angle)));
  return look_at(center + away * way, center, {0, 1, 0}, 0.8, width, height, 0.05 * away,
                 40 * away);
}

ImpostorQuality mean_quality(const std::vector<ImpostorQuality>& all) {
  ImpostorQuality mean;
  for (const ImpostorQuality& q : all)
    mean.psnr_db += std::min(q.psnr_db, 99.0), mean.ssim += q.ssim, mean.flip += q.flip;
  const double count = std::max<double>(1, double(all.size()));
  return {mean.psnr_db / count, mean.ssim / count, mean.flip / count};
}

ImpostorJudge::ImpostorJudge(const TracedScene& traced, int width, int height, int samples)
    : traced_(&traced),
      target_(width, height, samples),
      drawable_(std::make_unique<ImpostorDrawable>(std::make_unique<SoftwareBoards>(), 1)),
      truth_objects_{traced.object} {}

Result<DepthImage> ImpostorJudge::shade(const Camera& seen_from, const WorkerOptions& options) {
  RayTracer tracer(*traced_->rays);
  const std::uint32_t objects[] = {traced_->object};
  const Result<Camera> camera = impostor_camera(traced_->box, impostor_eye(seen_from), options);
  if (!camera) return camera.error();
  CaptureRequest request;
  request.camera = *camera;
  request.objects = objects;
  request.samples = options.samples;
  request.identifiers = false;
  Result<CapturedPicture> captured = tracer.capture(request);
  if (!captured) return captured.error();
  return std::move(captured->picture);
}

Result<ImpostorQuality> ImpostorJudge::judge(const Prewarped& board, const Camera& camera) {
  if (!(truth_camera_ == camera)) {
    RayTracer tracer(*traced_->rays);
    CaptureRequest request;
    request.camera = camera;
    request.objects = truth_objects_;
    request.samples = samples_;
    request.identifiers = false;
    const Result<CapturedPicture> captured =
        source_ ? source_->capture(request) : tracer.capture(request);
    if (!captured) return captured.error();
    truth_premultiplied_ = make_nailboard(captured->picture, 16).color;
    truth_camera_ = camera;
  }
  std::vector<const TileDrawer*> drawers;
  if (!board.color.empty()) {
    EncodedPiece encoded;
    encode_prewarped(board, {0, 0, board.width(), board.height()}, encoded);
    ImpostorFrame frame;
    frame.board = &board, frame.encoded = &encoded, frame.board_number = ++number_;
    drawable_->begin();
    if (!drawable_->show(0, frame)) return Error{traced_->name, "has no room"};
    const Instance instance{glm::dmat4(1.0), 0, traced_->object + 1};
    drawable_->draw(camera, {&instance, 1}, Output::color);
    drawers.push_back(drawable_->tiles());
  }
  target_.draw(camera.z_far, drawers);
  crop_ = around(truth_premultiplied_);
  if (crop_.z - crop_.x < 16 || crop_.w - crop_.y < 16)
    return Error{traced_->name, "is not in view"};
  drawn_ = cropped(target_.color(), crop_);
  truth_ = cropped(truth_premultiplied_, crop_);
  return ImpostorQuality{psnr_db(drawn_, truth_), ssim(drawn_, truth_), flip(truth_, drawn_)};
}

Rgba8Image ImpostorJudge::same_part(const DepthImage& picture) const {
  return cropped(make_nailboard(picture, 16).color, crop_);
}

Prewarped as_one_plane(const DepthImage& picture) {
  const Nailboard board = make_nailboard(picture, 16);
  Prewarped plane;
  plane.geometry = board.geometry;
  plane.color.assign(board.color.texels().begin(), board.color.texels().end());
  plane.delta.assign(board.delta.texels().begin(), board.delta.texels().end());
  return plane;
}

Prewarped merged_for(const DepthImage& one, const DepthImage& two, const glm::dvec3& eye) {
  WarpPairScratch scratch;
  Prewarped result;
  if (!warp_pair(impostor_picture(one), impostor_picture(two), eye, {}, scratch, result)) return {};
  return result;
}

Prewarped warped_for(const DepthImage& picture, const glm::dvec3& eye) {
  ImpostorWarpScratch scratch;
  Prewarped result;
  if (!warp_impostor(impostor_picture(picture), eye, {}, scratch, result)) return {};
  return result;
}

}  // namespace rilievo::bench
