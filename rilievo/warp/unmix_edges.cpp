#include "rilievo/warp/unmix_edges.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {
namespace {

// Colours closer than this are one: nothing can be told apart along their line. Linear light,
// squared.
constexpr float kOneColor = 1e-4f;
// As far as the inside of a surface may lie from its corners, in texels.
constexpr int kReach = 4, kWindow = 2 * kReach + 1;

class EdgeColors {
 public:
  explicit EdgeColors(const DepthImage& picture)
      : picture_(picture), links_(texel_links(picture)), edge_(links_.width(), links_.height()) {
    parallel_for(0, links_.height(), [&](int y) {
      for (int x = 0; x < links_.width(); ++x) edge_(x, y) = is_edge({x, y});
    });
  }

  // The colour that the texel is to have; none: its own.
  [[nodiscard]] std::optional<glm::vec4> unmixed(const glm::ivec2& at) const {
    if (!picture_.covered(at.x, at.y) || !edge_(at.x, at.y)) return std::nullopt;
    if (!is_behind(at)) return std::nullopt;
    const glm::vec4 own = picture_.color(at.x, at.y);
    const std::optional<glm::vec3> inside = inside_of(at);
    if (!(own.a > 0) || !inside) return std::nullopt;
    const std::optional<glm::vec3> other = beyond(at, *inside);
    if (!other) return std::nullopt;
    const glm::vec3 way = *other - *inside, color = glm::vec3(own) / own.a;
    const float length = glm::dot(way, way);
    if (length < kOneColor) return std::nullopt;
    const float share = std::clamp(glm::dot(color - *inside, way) / length, 0.0f, 1.0f);
    const glm::vec3 left = glm::max(color - share * way, glm::vec3(0.0f));
    return glm::vec4(own.a * left, own.a);
  }

 private:
  [[nodiscard]] bool within(const glm::ivec2& p) const {
    return p.x >= 0 && p.y >= 0 && p.x < links_.width() && p.y < links_.height();
  }
  [[nodiscard]] bool linked(const glm::ivec2& at, std::size_t k) const {
    return links_(at.x, at.y) >> k & 1;
  }
  [[nodiscard]] bool is_edge(const glm::ivec2& at) const {
    for (std::size_t k = 0; k < kLinkSteps.size(); ++k)
      if (within(at + kLinkSteps[k]) && !linked(at, k)) return true;
    return false;
  }
  // Is a neighbour in front of the texel, or does nobody know? An edge in front may keep a mixed
  // colour: it is antialiased.
  [[nodiscard]] bool is_behind(const glm::ivec2& at) const {
    for (std::size_t k = 0; k < kLinkSteps.size(); ++k) {
      const glm::ivec2 p = at + kLinkSteps[k];
      if (!within(p) || linked(at, k)) continue;
      const float z = picture_.depth(p.x, p.y);
      if (z == kNoDepth || z < picture_.depth(at.x, at.y)) return true;
    }
    return false;
  }
  // The mean of the nearest colours inside of the same surface, a few links away.
  [[nodiscard]] std::optional<glm::vec3> inside_of(const glm::ivec2& at) const {
    bool met[kWindow][kWindow] = {};
    met[kReach][kReach] = true;
    std::vector<glm::ivec2> ring{at}, next;
    for (int step = 0; step < kReach; ++step) {
      glm::vec4 sum(0);
      next.clear();
      for (const glm::ivec2& from : ring)
        for (std::size_t k = 0; k < kLinkSteps.size(); ++k) {
          if (!linked(from, k)) continue;
          const glm::ivec2 to = from + kLinkSteps[k], place = to - at + kReach;
          if (std::exchange(met[place.y][place.x], true)) continue;
          next.push_back(to);
          if (!edge_(to.x, to.y)) sum += picture_.color(to.x, to.y);
        }
      if (sum.a > 0) return glm::vec3(sum) / sum.a;
      std::swap(ring, next);
    }
    return std::nullopt;
  }
  // The mean of what is on the other side of the edge: behind the texels that are mixed, too,
  // unless the own surface goes on there.
  [[nodiscard]] std::optional<glm::vec3> beyond(const glm::ivec2& at,
                                                const glm::vec3& inside) const {
    glm::vec4 sum(0);
    const auto distance = [&](const glm::vec4& color) {
      return color.a > 0 ? glm::distance(glm::vec3(color) / color.a, inside) : 0.0f;
    };
    for (std::size_t k = 0; k < kLinkSteps.size(); ++k) {
      const glm::ivec2 beside = at + kLinkSteps[k], behind = beside + kLinkSteps[k];
      if (!within(beside) || linked(at, k)) continue;
      const glm::vec4 first = picture_.color(beside.x, beside.y);
      const glm::vec4 second = within(behind) ? picture_.color(behind.x, behind.y) : first;
      sum += distance(first) > distance(second) ? first : second;
    }
    if (!(sum.a > 0)) return std::nullopt;
    return glm::vec3(sum) / sum.a;
  }

  const DepthImage& picture_;
  Image<std::uint8_t> links_, edge_;
};

}  // namespace

void unmix_edges(DepthImage& picture) {
  const EdgeColors colors(picture);
  ColorImage unmixed = picture.color;
  parallel_for(0, unmixed.height(), [&](int y) {
    for (int x = 0; x < unmixed.width(); ++x)
      if (const auto color = colors.unmixed({x, y})) unmixed(x, y) = *color;
  });
  picture.color = std::move(unmixed);
}

}  // namespace rilievo
