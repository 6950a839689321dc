#include "rilievo/layered_relief/mix_sources.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rilievo {
namespace {

// The cosine between normals from which on samples show one side of one surface.
constexpr float kSameSide = 0.7f;
// Leaves are a few texels wide, and what their samples know of their normals is often no more than
// the side. Samples of both sides lie in one place, and each as far from its texel's middle: texels
// within which they are of one leaf.
constexpr double kOneSheet = 1.8;
// The cosine that a picture counts with, at least, in a mean with others.
constexpr float kLeastFaces = 0.05f;

// What samples of one picture say of a place.
struct Opinion {
  std::uint32_t source = 0;
  glm::vec3 color{0};
  float faces = 0, count = 0;  // sums
};

// What samples of several pictures say of one side of a surface.
class Opinions {
 public:
  void clear() { opinions_.clear(); }
  [[nodiscard]] std::size_t size() const { return opinions_.size(); }
  void add(const KnownSample& of) {
    auto found = std::find_if(opinions_.begin(), opinions_.end(),
                              [&](const Opinion& o) { return o.source == of.source; });
    if (found == opinions_.end()) found = opinions_.insert(found, {.source = of.source});
    found->color += glm::vec3(of.sample.color);
    found->faces += of.faces;
    ++found->count;
  }
  [[nodiscard]] glm::vec3 mean() const {
    glm::vec4 sum(0);
    for (const Opinion& o : opinions_) {
      const float faces = std::max(o.faces / o.count, kLeastFaces);
      sum += faces * faces * glm::vec4(o.color / o.count, 1);
    }
    return glm::vec3(sum) / sum.a;
  }

 private:
  std::vector<Opinion> opinions_;
};

// The share of a picture's viewers that see the side whose normal is at this cosine to the way
// towards them; they look from all over a face of a cube.
float share_of_viewers(float faces) {
  const float slope = faces / std::sqrt(std::max(1 - faces * faces, 1e-6f));
  return std::clamp(0.5f * (1 + slope), 0.0f, 1.0f);
}

// The cosine between the way towards the viewers and a normal: that which several samples say, as
// that of one alone errs, and shares of sides would differ from sample to sample.
float facing(const glm::vec3& sum, const glm::vec3& own, const glm::vec3& forward) {
  const float length = glm::length(sum);
  return -glm::dot(length > 0 ? sum / length : own, forward);
}

// Is `other` seen beside `of`, on the same side of one surface?
bool same_side(const KnownSample& of, const KnownSample& other) {
  if (other.inner || !other.sure || other.sample.object != of.sample.object) return false;
  return !of.sure ||
         glm::dot(other.normal, of.inner ? -of.normal : of.normal) >= (of.sheet ? 0.0f : kSameSide);
}

// Does `other` show the other side of the sheet that `of` shows?
bool other_side(const KnownSample& of, const KnownSample& other) {
  return of.sheet && other.sample.object == of.sample.object &&
         glm::dot(of.normal, other.normal) < 0;
}

}  // namespace

// Where samples of several pictures lie side by side on one surface, each has what all of them say:
// a highlight is elsewhere for each, and the surface would be peppered with it. A picture counts as
// it faces the surface, squared: beside many samples of one that does, those of one
// that sees it nearly edge-on would be a dotted line. An inner side shows what is seen of the outer
// one. Both sides of a leaf are seen, but a place has one colour: the mean of both, by the shares
// of the picture's viewers that see them, so that no leaf is peppered with its other side.
void mix_sources(const LayeredDepthImage& layers, const std::vector<KnownSample>& known,
                 double per_metre, std::vector<LayerSample>& out) {
  const double texel = largest_texel(layers.camera);
  const glm::vec3 forward(layers.camera.forward());
  std::vector<float> depths;  // close together, to be searched
  depths.reserve(known.size());
  for (const KnownSample& k : known) depths.push_back(k.sample.depth);
  Opinions opinions, others;
  for (std::size_t line = 0; line + 1 < layers.first.size(); ++line)
    for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s) {
      const KnownSample& of = known[s];
      opinions.clear(), others.clear();
      glm::vec3 normal(0);  // what all of them say of it
      const double reach = (of.sheet ? kOneSheet : kOneSurface) * texel;
      const float along = float(reach * per_metre);
      each_line_around(layers.camera, line, reach, [&](std::size_t beside, double aside) {
        const auto begin = depths.begin() + std::ptrdiff_t(layers.first[beside]),
                   end = depths.begin() + std::ptrdiff_t(layers.first[beside + 1]);
        auto at = std::lower_bound(begin, end, of.sample.depth - along);
        for (; at != end && *at <= of.sample.depth + along; ++at) {
          const double deeper = double(*at - of.sample.depth) / per_metre;
          if (aside + deeper * deeper > reach * reach) continue;
          const KnownSample& other = known[std::size_t(at - depths.begin())];
          if (same_side(of, other))
            opinions.add(other), normal += other.normal;
          else if (other_side(of, other))
            others.add(other), normal -= other.normal;
        }
      });
      glm::vec3 color(out[s].color);
      if (opinions.size() >= (of.inner || !of.sure ? 1u : 2u)) color = opinions.mean();
      if (others.size() > 0)
        color =
            glm::mix(others.mean(), color, share_of_viewers(facing(normal, of.normal, forward)));
      out[s].color = glm::vec4(color, out[s].color.a);
    }
}

}  // namespace rilievo
