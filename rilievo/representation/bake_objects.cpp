#include "rilievo/representation/bake_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/linear_maps.h"

namespace rilievo {
namespace {

// Objects that one drawable serves, ascending; the first is the one that is baked.
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

// Metres between the nearest points of two boxes; 0 where they overlap.
double distance_between(const Box& a, const Box& b) {
  return double(glm::length(glm::max(glm::max(a.min - b.max, b.min - a.max), glm::vec3(0))));
}

// Heavy objects, those first whose drawable saves most triangles.
std::vector<Group> heavy_groups(const PlacedScene& placed, std::uint64_t min_triangles) {
  const Scene& scene = placed.scene();
  std::map<GroupKey, Group> by_key;
  for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
    const int model = scene.objects[object].model;
    const glm::mat4& pose = placed.poses()[object];
    const std::uint64_t triangles = scene.models[std::size_t(model)].triangles;
    if (triangles < min_triangles || !placed.has_opaque_parts(object) ||
        !is_invertible(glm::dmat3(pose)))
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

// What is baked as one, where it is.
Result<ObjectDrawable> bake_as_one(const BakeInput& input, const Kind& kind,
                                   DrawableFactory& factory, const OptionValues& bake,
                                   const OptionValues& draw, const Progress& progress) {
  Result<Baked> baked = kind.bake(input, bake, progress);
  if (!baked) return baked.error();
  Result<std::unique_ptr<Drawable>> drawable =
      factory.make_drawable(std::move(baked->representation), draw);
  if (!drawable) return drawable.error();
  ObjectDrawable made;
  made.drawable = std::move(*drawable);
  made.objects.assign(input.objects.begin(), input.objects.end());
  made.together = true;
  return made;
}

}  // namespace

Result<std::vector<ObjectDrawable>> bake_object_drawables(const PlacedScene& placed,
                                                          CaptureSource& source, const Kind& kind,
                                                          DrawableFactory& factory,
                                                          const ObjectDrawablesOptions& options) {
  const std::size_t bytes =
      std::max<std::size_t>(1, factory.expected_bytes(options.bake, options.draw));
  std::vector<Group> groups = heavy_groups(placed, options.min_triangles);
  groups.resize(std::min(groups.size(), options.max_bytes / bytes));
  OptionValues bake = options.bake;
  factory.spare(bake, options.draw);
  std::vector<ObjectDrawable> drawables;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t object = groups[g].objects.front();
    Progress progress;
    if (options.progress)
      progress = [&](int done, int total) {
        options.progress(int(g) * total + done, int(groups.size()) * total);
      };
    Result<Baked> baked = kind.bake({source, {object}}, bake, progress);
    if (!baked) continue;
    Result<std::unique_ptr<Drawable>> drawable =
        factory.make_drawable(std::move(baked->representation), options.draw);
    if (!drawable) return drawable.error();
    drawables.push_back({std::move(*drawable), std::move(groups[g].objects),
                         glm::inverse(glm::dmat4(placed.poses()[object]))});
  }
  return drawables;
}

Result<ObjectDrawable> bake_surroundings_drawable(const PlacedScene& placed, CaptureSource& source,
                                                  const Kind& kind, DrawableFactory& factory,
                                                  const SurroundingsOptions& options) {
  RILIEVO_EXPECTS(kind.stands_for == StandsFor::surroundings);
  const std::vector<Object>& objects = placed.scene().objects;
  std::vector<std::uint32_t> beyond;
  for (std::uint32_t object = 0; object < objects.size(); ++object) {
    if (objects[object].moving || !placed.has_opaque_parts(object)) continue;
    if (distance_between(placed.bounds()[object], options.eyes) >= options.beyond)
      beyond.push_back(object);
  }
  if (beyond.empty())
    return Error{std::string(kind.name),
                 "no object that stands still lies beyond the distance asked for"};
  return bake_as_one({source, beyond, options.eyes}, kind, factory, options.bake, options.draw,
                     options.progress);
}

Result<ObjectDrawable> bake_together_drawable(const PlacedScene& placed, CaptureSource& source,
                                              const Kind& kind, DrawableFactory& factory,
                                              const ObjectDrawablesOptions& options) {
  RILIEVO_EXPECTS(kind.stands_for != StandsFor::surroundings);
  const std::vector<Object>& objects = placed.scene().objects;
  std::vector<std::uint32_t> still;
  for (std::uint32_t object = 0; object < objects.size(); ++object)
    if (!objects[object].moving && placed.has_opaque_parts(object)) still.push_back(object);
  if (still.empty()) return Error{std::string(kind.name), "no object stands still"};
  OptionValues bake = options.bake;
  factory.spare(bake, options.draw);
  if (factory.expected_bytes(bake, options.draw) > options.max_bytes)
    return Error{std::string(kind.name), "takes more memory than there is for it"};
  return bake_as_one({source, still, {}}, kind, factory, bake, options.draw, options.progress);
}

}  // namespace rilievo
