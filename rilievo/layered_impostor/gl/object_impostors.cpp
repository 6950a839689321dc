#include "rilievo/layered_impostor/gl/object_impostors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace rilievo {
namespace {

// Objects that one impostor serves, ascending; the first is the one that is baked.
struct Group {
  std::vector<std::uint32_t> objects;
  double triangles = 0;  // drawn, all objects together
};

// Same model, and the same pose but for a translation.
using GroupKey = std::array<float, 10>;
GroupKey key_of(int model, const glm::mat4& pose) {
  GroupKey key{};
  for (int i = 0; i < 9; ++i) key[std::size_t(i)] = pose[i / 3][i % 3];
  key[9] = float(model);
  return key;
}

bool is_invertible(const glm::mat4& pose) {
  const double d = glm::determinant(glm::dmat3(pose));
  return std::isfinite(d) && d != 0;
}

// Heavy objects, those first whose impostor saves most triangles.
std::vector<Group> heavy_groups(const SceneRenderer& renderer, std::uint64_t min_triangles) {
  const Scene& scene = renderer.scene();
  std::map<GroupKey, Group> by_key;
  for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
    const int model = scene.objects[object].model;
    const glm::mat4& pose = renderer.poses()[object];
    const std::uint64_t triangles = scene.models[std::size_t(model)].triangles;
    if (triangles < min_triangles || !renderer.has_opaque_parts(object) || !is_invertible(pose))
      continue;
    Group& group = by_key[key_of(model, pose)];
    group.objects.push_back(object);
    group.triangles += double(triangles);
  }
  std::vector<Group> groups;
  for (auto& [key, group] : by_key) groups.push_back(std::move(group));
  std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.triangles != b.triangles ? a.triangles > b.triangles
                                      : a.objects.front() < b.objects.front();
  });
  return groups;
}

double raggedness_of(const LayeredImpostor& impostor) {
  std::size_t shown = 0, ragged = 0;
  for (const TexelSurface& surface : impostor.surfaces)
    for (const SurfaceTexel& texel : surface.texels.texels()) {
      shown += texel.q != 0;
      ragged += texel.q != 0 && texel.links != 0xFF;
    }
  return shown > 0 ? double(ragged) / double(shown) : 0;
}

// Does the motion scale alike in all directions, and not mirror?
bool is_uniform(const glm::dmat4& motion) {
  const glm::dmat3 m(motion);
  const glm::dmat3 square = glm::transpose(m) * m;
  const double scale2 = (square[0][0] + square[1][1] + square[2][2]) / 3;
  // Poses are floats: their rounding is no stretch.
  constexpr double kRounding = 1e-4;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(square[i][k] - (i == k ? scale2 : 0)) <= kRounding * scale2)) return false;
  return glm::determinant(m) > 0;
}

}  // namespace

std::optional<glm::dmat4> motion_of(const ObjectImpostor& impostor, const glm::mat4& pose) {
  const glm::dmat4 motion = glm::dmat4(pose) * impostor.object_from_impostor;
  if (!is_uniform(motion)) return std::nullopt;
  return motion;
}

Result<std::vector<ObjectImpostor>> bake_object_impostors(SceneRenderer& renderer,
                                                          const ObjectImpostorOptions& options) {
  BakeOptions bake = options.bake;
  bake.fills = options.method == LayeredMethod::slices;
  const int views = int(make_view_set(bake.views).directions.size());
  const std::size_t bytes =
      layered_texture_bytes(views, bake.camera.size, bake.camera.size, options.method);
  std::vector<Group> groups = heavy_groups(renderer, options.min_triangles);
  groups.resize(std::min(groups.size(), options.max_bytes / bytes));
  std::vector<ObjectImpostor> impostors;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t baked = groups[g].objects.front();
    if (options.bake.progress)
      bake.progress = [&](int done, int) {
        options.bake.progress(int(g) * views + done, int(groups.size()) * views);
      };
    Result<LayeredImpostor> impostor = bake_layered(renderer, {&baked, 1}, bake);
    if (!impostor) continue;
    const LayeredErrorFigures error = layered_error_figures(*impostor);
    const double raggedness = raggedness_of(*impostor);
    Result<LayeredPictures> pictures = LayeredPictures::create(std::move(*impostor));
    if (!pictures) return pictures.error();
    pictures->keep_only(options.method);
    impostors.push_back({std::move(*pictures), error, raggedness, std::move(groups[g].objects),
                         glm::inverse(glm::dmat4(renderer.poses()[baked]))});
  }
  return impostors;
}

}  // namespace rilievo
