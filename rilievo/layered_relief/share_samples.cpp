// How far is the nearest sample of a picture, at most, from a point of a face that is wide enough
// to be hit? Of the picture that hits the face most densely, at worst over all faces:
// farthest_from_hits, 0.866 texels of six axes with equal texels (a face across two axes, along the
// third). Merging put what was seen there within `merged`. That has a sample of the picture within
// `reach` units (share_unit), or, t being the picture's texel, stands in the middle of its texel,
// half a diagonal away:
//
//   lacks = farthest_from_hits + merged + max(reach share_unit, t sqrt(1 / 2))
//
// That is the worst face. Where neighbouring hits are known to lie on one surface, the places
// between them count as hits (between_samples.h), which lie up to half of kOnePlane of a texel off
// it.
#include "rilievo/layered_relief/share_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <unordered_set>
#include <utility>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/between_samples.h"
#include "rilievo/layered_relief/hits_on_faces.h"
#include "rilievo/layered_relief/known_sample.h"
#include "rilievo/layered_relief/mix_sources.h"
#include "rilievo/layered_relief/sample_coverage.h"
#include "rilievo/layered_relief/sample_sides.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

// What is added to a picture: a list for each line of sight.
struct Added {
  std::vector<std::uint32_t> head;  // by line of sight, into the others
  std::vector<std::uint32_t> next;
  std::vector<KnownSample> known;  // as `next`
};

// The outer sides of closed bodies that other pictures see, where a picture has them: of line of
// sight i those from first[i] to first[i + 1], by depth.
struct OuterSides {
  struct Side {
    glm::vec4 color{0};
    glm::vec3 normal{0};
    std::uint32_t object = 0, number = 0;  // in the order in which they are found
  };
  std::vector<std::uint64_t> first;
  std::vector<float> depths;  // close together, to be searched
  std::vector<Side> sides;
};

// Calls visit(sample, world place) for each sample that `of` wants.
template <class Of, class Visit>
void each_sample(const LayeredDepthImage& layers, const Of& of, const Visit& visit) {
  const auto width = std::size_t(layers.camera.width);
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
    const glm::dvec2 at(double(i % width) + 0.5, double(i / width) + 0.5);
    for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s)
      if (of(s))
        visit(s, world_from_raster(layers.camera, at,
                                   eye_z_from(layers.depth_kind, double(layers.samples[s].depth),
                                              layers.camera, at)));
  }
}

// Those that others see; of `sides`, all pictures', number `own` is left out.
OuterSides outer_sides(std::span<const SampleSides> sides, std::size_t own) {
  const LayeredDepthImage& to = sides[own].layers();
  struct Found {
    std::size_t line;
    float depth;
    OuterSides::Side side;
  };
  std::vector<Found> found;
  std::size_t most = 0;
  for (std::size_t k = 0; k < sides.size(); ++k)
    for (std::size_t s = 0; k != own && s < sides[k].layers().samples.size(); ++s)
      most += sides[k].is_outer(s);
  found.reserve(most);
  OuterSides out;
  out.first.assign(to.first.size(), 0);
  const Placing placing(to);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    if (k == own) continue;
    const auto is_outer = [&](std::size_t s) { return sides[k].is_outer(s); };
    each_sample(sides[k].layers(), is_outer, [&](std::size_t s, const glm::dvec3& world) {
      const std::optional<PlacedIn> place = placing.find(world);
      if (!place) return;
      const LayerSample& sample = sides[k].layers().samples[s];
      found.push_back(
          {place->line,
           float(place->depth),
           {sample.color, sides[k].normal(s), sample.object, std::uint32_t(found.size())}});
      ++out.first[place->line + 1];
    });
  }
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  std::vector<std::uint64_t> next(out.first.begin(), out.first.end() - 1);
  std::vector<std::uint32_t> order(found.size());
  for (const Found& one : found) order[next[one.line]++] = one.side.number;
  out.depths.reserve(found.size()), out.sides.reserve(found.size());
  for (std::size_t line = 0; line + 1 < out.first.size(); ++line) {
    const auto begin = order.begin() + std::ptrdiff_t(out.first[line]),
               end = order.begin() + std::ptrdiff_t(out.first[line + 1]);
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      return found[a].depth != found[b].depth ? found[a].depth < found[b].depth : a < b;
    });
    for (auto at = begin; at != end; ++at)
      out.depths.push_back(found[*at].depth), out.sides.push_back(found[*at].side);
  }
  return out;
}

// The inner side of a wall has the outer side's colour, if another picture sees that: whichever eye
// sees the place, through a gap between samples or past the wall's edge, would see the outer side.
void color_as_outer(const LayeredDepthImage& to, const OuterSides& outer, const glm::vec3& normal,
                    std::size_t line, double per_metre, LayerSample& sample) {
  const double reach = kOneSurface * largest_texel(to.camera);
  double least = reach * reach;
  const glm::vec4* color = nullptr;
  each_line_around(to.camera, line, reach, [&](std::size_t beside, double aside) {
    if (aside > least) return;
    const auto deeper = [&](float depth) { return double(depth - sample.depth) / per_metre; };
    const double before = -std::sqrt(least - aside) * (1 + 1e-9);  // rounding
    const auto begin = outer.depths.begin() + std::ptrdiff_t(outer.first[beside]),
               end = outer.depths.begin() + std::ptrdiff_t(outer.first[beside + 1]);
    // Of equally near ones the first of the last line of sight counts.
    std::uint32_t number = kNone;
    for (auto at =
             std::partition_point(begin, end, [&](float depth) { return deeper(depth) < before; });
         at != end; ++at) {
      const double off = aside + deeper(*at) * deeper(*at);
      if (off > least) {
        if (deeper(*at) > 0) break;
        continue;
      }
      const OuterSides::Side& other = outer.sides[std::size_t(at - outer.depths.begin())];
      if (other.object != sample.object || glm::dot(other.normal, normal) >= 0) continue;
      if (off == least && number != kNone && other.number > number) continue;
      least = off, number = other.number;
      color = &other.color;
    }
  });
  if (color) sample.color = *color;
}

// What a picture lacks, which others add to it.
class Lacking {
 public:
  Lacking(const LayeredDepthImage& to, const OuterSides& outer, double reach, double per_metre)
      : to_(to), placing_(to), coverage_(to, reach), outer_(outer), per_metre_(per_metre) {
    added_.head.assign(to.first.size() - 1, kNone);
    // Room for what is usual: vectors that grow touch their memory anew.
    added_.next.reserve(2 * to.samples.size());
    added_.known.reserve(2 * to.samples.size());
  }

  // Samples of picture `source` whose turn it is (SampleSides::turn).
  void add_from(const SampleSides& sides, std::uint32_t source, int turn) {
    const auto of = [&](std::size_t s) { return sides.turn(s, to_.camera.forward()) == turn; };
    each_sample(sides.layers(), of, [&](std::size_t s, const glm::dvec3& world) {
      if (const std::optional<PlacedIn> place = lacks(world))
        add(known_of(sides, source, s), *place);
    });
  }
  // What lies between the samples of picture `source` (has_places_beside).
  void add_between(const SampleSides& sides, const SurfaceLattice& lattice, std::uint32_t source,
                   double spacing) {
    const auto of = [&](std::size_t s) {
      return has_places_beside(sides, s, to_.camera.forward());
    };
    lattice.each_place(spacing, of, [&](const PlaceBetween& between) {
      const std::optional<PlacedIn> place = lacks(between.world);
      if (!place) return;
      KnownSample known = known_of(sides, source, between.around[0]);
      known.sample.color = color_of(sides.layers(), between);
      add(known, *place);
    });
  }
  [[nodiscard]] const Added& added() const { return added_; }

 private:
  // Where, if it is in the picture and no sample near it.
  [[nodiscard]] std::optional<PlacedIn> lacks(const glm::dvec3& world) {
    if (coverage_.covers(placing_.about(world))) return std::nullopt;
    return placing_.find(world);
  }
  void add(KnownSample known, const PlacedIn& place) {
    known.sample.depth = known.sample.back = float(place.depth);
    if (known.inner)
      color_as_outer(to_, outer_, known.normal, place.line, per_metre_, known.sample);
    coverage_.add(place.line, known.sample.depth);
    added_.next.push_back(added_.head[place.line]);
    added_.head[place.line] = std::uint32_t(added_.known.size());
    added_.known.push_back(known);
  }

  const LayeredDepthImage& to_;
  Placing placing_;
  SampleCoverage coverage_;
  const OuterSides& outer_;
  double per_metre_;
  Added added_;
};

// Its own samples and those added.
LayeredDepthImage with(const SampleSides& own, std::uint32_t number, const OuterSides& outer,
                       const Added& added, double per_metre) {
  const LayeredDepthImage& layers = own.layers();
  LayeredDepthImage out;
  out.name = layers.name;
  out.camera = layers.camera;
  out.depth_kind = layers.depth_kind;
  std::vector<KnownSample> known;
  known.reserve(layers.samples.size() + added.known.size());
  out.first.reserve(layers.first.size());
  out.first.push_back(0);
  // A line's samples by depth, its own before those added, and these in the order of their list:
  // sorted by numbers, as samples are wide.
  struct Entry {
    float depth;
    std::uint32_t place;  // in this order
    std::uint64_t sample;
    bool is_own;
  };
  std::vector<Entry> entries;
  for (std::size_t line = 0; line + 1 < layers.first.size(); ++line) {
    entries.clear();
    for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s)
      entries.push_back({layers.samples[s].depth, std::uint32_t(entries.size()), s, true});
    for (std::uint32_t k = added.head[line]; k != kNone; k = added.next[k])
      entries.push_back(
          {added.known[k].sample.depth, std::uint32_t(entries.size()), std::uint64_t(k), false});
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.depth != b.depth ? a.depth < b.depth : a.place < b.place;
    });
    for (const Entry& entry : entries) {
      if (!entry.is_own) {
        known.push_back(added.known[entry.sample]);
        continue;
      }
      known.push_back(known_of(own, number, entry.sample));
      if (own.is_inner(entry.sample))
        color_as_outer(layers, outer, own.normal(entry.sample), line, per_metre,
                       known.back().sample);
    }
    out.first.push_back(known.size());
  }
  out.samples.reserve(known.size());
  for (const KnownSample& k : known) out.samples.push_back(k.sample);
  mix_sources(out, known, per_metre, out.samples);
  return out;
}

}  // namespace

bool has_places_beside(const SampleSides& sides, std::size_t sample, const glm::dvec3& forward) {
  // A face is seen at this cosine by one of three axes at least (1 / sqrt(3)), and a little less by
  // another one whose neighbours may be known where the first one's are not.
  constexpr float kSeesWell = 0.5f;
  if (!sides.is_closed(sample) || sides.turn(sample, forward) != 0) return false;
  return -glm::dot(sides.normal(sample), glm::vec3(sides.layers().camera.forward())) >= kSeesWell;
}

double share_unit(const Camera& camera, double largest) {
  const double texel = largest_texel(camera);
  return texel * std::sqrt(relief_splat_scale(texel, largest));
}

void share_samples(ReliefPictures& pictures, double reach) {
  std::vector<LayeredDepthImage> shared(pictures.pictures.size());
  std::vector<Camera> cameras;
  double merged = 0, largest = 0;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    cameras.push_back(picture.layers.camera);
    largest = std::max(largest, largest_texel(picture.layers.camera));
    merged = std::max(merged, picture.merged);
  }
  const double from_hits = farthest_from_hits(cameras);
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : pictures.pictures) all.push_back(&picture.layers);
  const std::unordered_set<std::uint32_t> closed = find_closed_objects(all);
  std::vector<SampleSides> sides;
  for (const LayeredDepthImage* layers : all) sides.emplace_back(*layers, closed);
  std::vector<SurfaceLattice> lattices;
  for (const SampleSides& of : sides) lattices.emplace_back(of);
  parallel_for(std::size_t(0), shared.size(), [&](std::size_t i) {
    const LayeredDepthImage& to = pictures.pictures[i].layers;
    const double unit = share_unit(to.camera, largest);
    const double per_metre =
        to.depth_kind == DepthKind::window_z ? 1 / (to.camera.z_far - to.camera.z_near) : 1.0;
    const OuterSides outer = outer_sides(sides, i);
    Lacking lacking(to, outer, reach * unit, per_metre);
    for (int turn = 0; turn < SampleSides::kTurns; ++turn)
      for (std::size_t k = 0; k < shared.size(); ++k)
        if (k != i) lacking.add_from(sides[k], std::uint32_t(k), turn);
    // What was hit comes first. The picture's own samples may be far apart, too.
    for (std::size_t k = 0; k < shared.size(); ++k)
      lacking.add_between(sides[k], lattices[k], std::uint32_t(k), kBetween * unit);
    shared[i] = with(sides[i], std::uint32_t(i), outer, lacking.added(), per_metre);
  });
  for (std::size_t i = 0; i < shared.size(); ++i) {
    ReliefPictures::Picture& picture = pictures.pictures[i];
    if (shared[i].samples.size() > picture.layers.samples.size())
      picture.moved =
          std::max(picture.moved, std::sqrt(0.5) * largest_texel(picture.layers.camera)) +
          0.5 * kOnePlane * largest;
    picture.layers = std::move(shared[i]);
    picture.lacks = std::isfinite(from_hits)
                        ? from_hits + merged +
                              std::max(reach * share_unit(picture.layers.camera, largest),
                                       std::sqrt(0.5) * largest_texel(picture.layers.camera))
                        : 0;
  }
}

}  // namespace rilievo
