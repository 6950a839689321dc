#include "rilievo/render/shading/band_shader.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {

void BandShader::shade(const PictureView& view, int from, int to) {
  RILIEVO_EXPECTS(0 <= from && from < to && to <= from + kBand);
  const std::size_t texels = std::size_t(to - from) * std::size_t(view.samples.width);
  // What is seen ...
  seen_.clear();
  first_of_.resize(view.meshes.size(), kNone);
  mesh_ = 0;
  covered_.resize(texels);
  nearest_.resize(texels);
  for (int y = from; y < to; ++y)
    view.samples.samples == 4 ? find_seen<4>(view, y, y - from) : find_seen<1>(view, y, y - from);
  // ... is shaded mesh by mesh: what belongs to one is placed and made alike.
  if (!view.sample_colors) sums_.assign(texels, glm::vec3(0.0f));
  surfaces_.count = 0;
  for (const std::uint32_t mesh : met_) {
    add_mesh(view, view.meshes[mesh], first_of_[mesh], from);
    first_of_[mesh] = kNone;
  }
  met_.clear();
  flush(view);
}

// Depth and coverage of a row, and what is to be shaded there.
template <int samples>
void BandShader::find_seen(const PictureView& view, int y, int row) {
  const int width = view.samples.width;
  const float* depths = view.samples.depths(y);
  const std::uint32_t* triangles = view.samples.triangles(y);
  const std::size_t first = std::size_t(row) * std::size_t(width);
  for (int x = 0; x < width; ++x, depths += samples, triangles += samples) {
    float nearest = 1.0f;
    int covered = 0;
    bool alike = true;
    for (int s = 0; s < samples; ++s) {
      nearest = std::min(nearest, depths[s]);
      covered += depths[s] < 1.0f;
      alike &= triangles[s] == triangles[0];
    }
    nearest_[first + std::size_t(x)] = nearest;
    covered_[first + std::size_t(x)] = std::uint8_t(covered);
    if (covered == 0) continue;
    if (covered == samples && alike) {
      add_seen(view, triangles[0], x, row, samples);
      continue;
    }
    for (int s = 0; s < samples; ++s) {
      if (depths[s] >= 1.0f) continue;
      int same = 0, earlier = 0;
      for (int k = 0; k < samples; ++k)
        if (depths[k] < 1.0f && triangles[k] == triangles[s]) ++same, earlier += k < s;
      if (earlier == 0) add_seen(view, triangles[s], x, row, same);
    }
  }
}

void BandShader::add_seen(const PictureView& view, std::uint32_t triangle, int x, int row,
                          int samples) {
  // Mostly of the same mesh as the last one.
  if (triangle - view.meshes[mesh_].first_triangle >= view.meshes[mesh_].triangles)
    mesh_ = std::uint32_t(std::upper_bound(view.meshes.begin(), view.meshes.end(), triangle,
                                           [](std::uint32_t t, const PlacedMesh& placed) {
                                             return t < placed.first_triangle;
                                           }) -
                          view.meshes.begin() - 1);
  std::uint32_t& first = first_of_[mesh_];
  if (first == kNone) met_.push_back(mesh_);
  seen_.push_back({triangle - view.meshes[mesh_].first_triangle, first, std::uint16_t(x),
                   std::uint16_t(row), std::uint16_t(samples)});
  first = std::uint32_t(seen_.size() - 1);
}

void BandShader::add_mesh(const PictureView& view, const PlacedMesh& placed, std::uint32_t first,
                          int from) {
  const Mesh& mesh = *placed.mesh;
  const bool uses_uv[2] = {placed.surface.material->uses_uv[0],
                           placed.surface.material->uses_uv[1]};
  const auto width = std::size_t(view.samples.width);
  rays_.count = 0;
  for (std::uint32_t s = first; s != kNone; s = seen_[s].next) {
    const Seen& seen = seen_[s];
    const std::size_t i = rays_.count++;
    waiting_[surfaces_.count + i] = {
        seen.row * width + seen.x,
        view.samples.row(from + seen.row) + std::size_t(seen.x) * std::size_t(view.samples.samples),
        float(seen.samples), placed.first_triangle + seen.triangle};
    const glm::vec3 ray = view.rays.first + float(seen.x) * view.rays.per_x +
                          float(from + int(seen.row)) * view.rays.per_y;
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
    if (placed.surface.has_colors && placed.surface.material->blended)
      for (int k = 0; k < 3; ++k) rays_.alpha[k][i] = mesh.colors[corner[k]].a;
    for (int set = 0; set < 2; ++set) {
      if (!uses_uv[set]) continue;
      const std::vector<glm::vec2>& uv = mesh.uv[set];
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 2; ++axis)
          rays_.uv[set][k][axis][i] = uv.empty() ? 0.0f : uv[corner[k]][axis];
    }
    if (rays_.count == TriangleRays::kMaxCount) append(view, placed);
  }
  append(view, placed);
}

void BandShader::append(const PictureView& view, const PlacedMesh& placed) {
  append_surfaces(rays_, view.rays, placed.surface, surfaces_);
  rays_.count = 0;
  if (surfaces_.count + TriangleRays::kMaxCount > Surfaces::kMaxCount) flush(view);
}

void BandShader::flush(const PictureView& view) {
  shade_surfaces(view.lights, surfaces_, view.scale, colors_);
  for (std::size_t i = 0; !view.sample_colors && i < surfaces_.count; ++i)
    sums_[waiting_[i].texel] +=
        waiting_[i].samples * glm::vec3(colors_.rgb[0][i], colors_.rgb[1][i], colors_.rgb[2][i]);
  if (view.sample_colors)
    view.samples.samples == 4 ? write_samples<4>(view) : write_samples<1>(view);
  surfaces_.count = 0;
}

// The colours of the surfaces into the samples that show them.
template <std::size_t samples>
void BandShader::write_samples(const PictureView& view) const {
  const SampleBuffer& in = view.samples;
  for (std::size_t i = 0; i < surfaces_.count; ++i) {
    const float alpha = std::clamp(surfaces_.field[Surfaces::alpha][i], 0.0f, 1.0f);
    std::uint32_t color = std::uint32_t(alpha * 255.0f + 0.5f) << 24;
    for (int c = 0; c < 3; ++c)
      color |= std::uint32_t(colors_.rgb[c][i] * alpha * 255.0f + 0.5f) << (8 * c);
    const std::size_t first = waiting_[i].first_sample;
    for (std::size_t at = first; at < first + samples; ++at)
      if (in.depth[at] < 1 && in.triangle[at] == waiting_[i].triangle)
        view.sample_colors[at] = color;
  }
}

}  // namespace rilievo
