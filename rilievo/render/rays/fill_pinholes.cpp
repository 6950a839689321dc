#include "rilievo/render/rays/fill_pinholes.h"

#include <array>
#include <utility>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// The sides first: of two that face each other, at most one shows the texel's own object.
constexpr std::array<std::pair<int, int>, 8> kNeighbours{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

// The neighbour that the texel is to look like; null: it is no pinhole.
const std::pair<int, int>* find_cover(const ObjectPicture& picture, int x, int y) {
  const auto at = [&](const std::pair<int, int>& step) {
    return std::size_t(y + step.second) * std::size_t(picture.width) + std::size_t(x + step.first);
  };
  const std::size_t texel = at({0, 0});
  const std::uint32_t own = picture.object[texel];
  const std::pair<int, int>* cover = nullptr;
  int same = 0;
  for (const auto& step : kNeighbours) {
    const std::size_t neighbour = at(step);
    const std::uint32_t object = picture.object[neighbour];
    if (object == own) {
      if (++same > 1) return nullptr;
      continue;
    }
    if (object == kNoObject || !(picture.depth[neighbour] < picture.depth[texel])) return nullptr;
    if (!cover)
      cover = &step;
    else if (object != picture.object[at(*cover)])
      return nullptr;
  }
  return cover;
}

}  // namespace

void PinholeFiller::fill(std::span<const PlacedMesh> meshes, SampleBuffer& samples) {
  identify(samples, meshes, objects_);
  rows_.resize(std::size_t(samples.height));
  parallel_for(0, samples.height, [&](int y) {
    std::vector<Filled>& row = rows_[std::size_t(y)];
    row.clear();
    if (y == 0 || y == samples.height - 1) return;
    for (int x = 1; x < samples.width - 1; ++x)
      if (const auto* step = find_cover(objects_, x, y))
        row.push_back({samples.row(y) + std::size_t(x),
                       samples.row(y + step->second) + std::size_t(x + step->first)});
  });
  // What covers a pinhole is none itself, as the pinhole beside it lies behind it.
  for (const std::vector<Filled>& row : rows_)
    for (const Filled& filled : row) {
      samples.depth[filled.to] = samples.depth[filled.from];
      samples.triangle[filled.to] = samples.triangle[filled.from];
    }
}

}  // namespace rilievo
