#include "rilievo/render/raster/band_shader.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {

void BandShader::shade(const PictureView& view, int from, int to, RasterPicture& picture) {
  RILIEVO_EXPECTS(0 <= from && from < to && to <= from + kBand);
  const std::size_t width = std::size_t(picture.width), first = std::size_t(from) * width;
  const std::size_t texels = std::size_t(to - from) * width;
  // What is seen ...
  seen_.clear();
  first_of_.resize(view.instances.size(), kNone);
  instance_ = 0;
  for (int y = from; y < to; ++y) find_seen(view, y, y - from, picture);
  // ... is shaded instance by instance: what belongs to one is placed and made alike.
  sums_.assign(texels, glm::vec3(0.0f));
  surfaces_.count = 0;
  for (const std::uint32_t instance : met_) {
    add_instance(view, instance, from);
    first_of_[instance] = kNone;
  }
  met_.clear();
  flush(view);
  const float scale = 255.0f / float(view.raster.samples());
  for (std::size_t i = 0; i < texels; ++i) {
    glm::u8vec4& color = picture.color[first + i];
    color = glm::u8vec4(glm::u8vec3(sums_[i] * scale + 0.5f), color.a);
  }
}

// Depth and coverage of a row, and what is to be shaded there.
void BandShader::find_seen(const PictureView& view, int y, int row, RasterPicture& picture) {
  const int samples = view.raster.samples(), width = view.raster.width();
  const float* depths = view.raster.depths(y);
  const std::uint32_t* names = view.raster.names(y);
  const std::size_t first = std::size_t(y) * std::size_t(width);
  for (int x = 0; x < width; ++x, depths += samples, names += samples) {
    float nearest = 1.0f;
    int covered = 0;
    bool alike = true;
    for (int s = 0; s < samples; ++s) {
      nearest = std::min(nearest, depths[s]);
      covered += depths[s] < 1.0f;
      alike &= names[s] == names[0];
    }
    picture.depth[first + std::size_t(x)] = nearest;
    picture.color[first + std::size_t(x)].a =
        std::uint8_t((510 * covered + samples) / (2 * samples));
    if (covered == 0) continue;
    if (covered == samples && alike) {
      add_seen(view, names[0], x, row, samples);
      continue;
    }
    for (int s = 0; s < samples; ++s) {
      if (depths[s] >= 1.0f) continue;
      int same = 0, earlier = 0;
      for (int k = 0; k < samples; ++k)
        if (depths[k] < 1.0f && names[k] == names[s]) ++same, earlier += k < s;
      if (earlier == 0) add_seen(view, names[s], x, row, same);
    }
  }
}

void BandShader::add_seen(const PictureView& view, std::uint32_t name, int x, int row,
                          int samples) {
  // Mostly of the same instance as the last one.
  if (name - view.instances[instance_].first_name >= view.instances[instance_].triangles)
    instance_ = std::uint32_t(std::upper_bound(view.instances.begin(), view.instances.end(), name,
                                               [](std::uint32_t n, const RasterInstance& r) {
                                                 return n < r.first_name;
                                               }) -
                              view.instances.begin() - 1);
  std::uint32_t& first = first_of_[instance_];
  if (first == kNone) met_.push_back(instance_);
  seen_.push_back({name - view.instances[instance_].first_name, first, std::uint16_t(x),
                   std::uint16_t(row), std::uint16_t(samples)});
  first = std::uint32_t(seen_.size() - 1);
}

void BandShader::add_instance(const PictureView& view, std::uint32_t instance, int from) {
  const PlacedMesh& placed = view.placed[instance];
  const Mesh& mesh = *placed.mesh;
  const auto width = std::size_t(view.raster.width());
  rays_.count = 0;
  for (std::uint32_t s = first_of_[instance]; s != kNone; s = seen_[s].next) {
    const Seen& seen = seen_[s];
    const std::size_t i = rays_.count++;
    shares_[surfaces_.count + i] = {seen.row * width + seen.x, float(seen.samples)};
    const glm::vec3 ray = view.first_ray + float(seen.x) * view.ray_per_x +
                          float(from + int(seen.row)) * view.ray_per_y;
    const std::uint32_t* corner = &mesh.indices[3 * std::size_t(seen.triangle)];
    for (int axis = 0; axis < 3; ++axis) rays_.ray[axis][i] = ray[axis];
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        rays_.position[k][axis][i] = mesh.positions[corner[k]][axis];
    if (placed.surface.has_normals)
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
          rays_.normal[k][axis][i] = mesh.normals[corner[k]][axis];
    if (placed.surface.has_colors)
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis) rays_.color[k][axis][i] = mesh.colors[corner[k]][axis];
    if (rays_.count == TriangleRays::kMost) append(view, placed);
  }
  append(view, placed);
}

void BandShader::append(const PictureView& view, const PlacedMesh& placed) {
  append_surfaces(rays_, placed.surface, surfaces_);
  rays_.count = 0;
  if (surfaces_.count + TriangleRays::kMost > Surfaces::kMost) flush(view);
}

void BandShader::flush(const PictureView& view) {
  shade_surfaces(view.lights, surfaces_, colors_);
  for (std::size_t i = 0; i < surfaces_.count; ++i)
    sums_[shares_[i].texel] +=
        shares_[i].samples * glm::vec3(colors_.srgb[0][i], colors_.srgb[1][i], colors_.srgb[2][i]);
  surfaces_.count = 0;
}

}  // namespace rilievo
