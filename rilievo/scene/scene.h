// A scene: meshes with materials, assembled into models, placed as objects.
//
// An *object* is the unit that gets a picture. Objects share models and models share meshes, so
// that a forest of 10^8 triangles is a few trees with many placements. Plain data; owns everything;
// no OpenGL. Scene space: right-handed, +y up, metres, relative to an origin in the world
// (core/world_space.h), so that single precision suffices. Colours are linear unless a texture says
// otherwise.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/world_space.h"

namespace rilievo {

// How texture coordinates outside of [0, 1] are mapped.
enum class Wrap { repeat, mirrored_repeat, clamp_to_edge };

// An image with its sampling parameters. Textures can share an image.
struct Texture {
  std::string name;
  int image = 0;  // index into Scene::images
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;  // no interpolation when magnified
};

// A texture as a material uses it: with its texture coordinates and their transform.
struct TextureUse {
  int texture = -1;  // index into Scene::textures, or -1
  int uv_set = 0;    // 0 or 1
  glm::mat3 texture_from_uv{1.0f};
};

// The meaning of alpha: nothing, a cut-out at Material::alpha_cutoff, or blending.
enum class AlphaMode { opaque, mask, blend };

// glTF 2.0's metallic-roughness model. Factors multiply the textures.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};  // linear, alpha straight
  float metallic = 0.0f, roughness = 0.8f;
  glm::vec3 emissive{0.0f};
  float normal_scale = 1.0f, occlusion_strength = 1.0f;
  TextureUse base_color_texture;          // sRGB
  TextureUse metallic_roughness_texture;  // linear: g roughness, b metallic
  TextureUse normal_texture;              // linear, tangent space
  TextureUse occlusion_texture;           // linear: r
  TextureUse emissive_texture;            // sRGB
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;
  // For measures: shows where a surface is instead of its colour (scene/position_colors.h). Applied
  // to mesh space; with `unlit`.
  std::optional<glm::mat4x3> code_from_mesh = {};
  // The share of light that goes through, for ray tracers; everybody else sees it as blended.
  float transmission = 0.0f;
  float ior = 1.5f;       // index of refraction
  bool refracts = false;  // surrounds a volume, so that light is bent; else a thin wall
};

// The primitives of a mesh, and the number of corners of each.
enum class Primitive : std::uint8_t { triangles, lines, points };
[[nodiscard]] constexpr std::uint32_t corners_of(Primitive primitive) {
  return primitive == Primitive::triangles ? 3 : primitive == Primitive::lines ? 2 : 1;
}

// Triangles, lines or points with one material. A point is drawn as a disc that faces the eye, a
// line as a strip with round ends; both are opaque, whatever the material says, and unlit without
// normals. Normals count from both sides. Arrays other than positions and indices are empty or have
// one entry for each vertex. Counter-clockwise is front. Where world_from_mesh has a negative
// determinant (a mirrored object), clockwise is front, as in glTF; renderers test the determinant's
// sign.
struct Mesh {
  std::string name;
  int material = -1;  // index into Scene::materials; -1: the default material
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;   // unit; loaded triangles always have them
  std::vector<glm::vec4> tangents;  // xyz unit, w = handedness
  std::vector<glm::vec2> uv[2];
  std::vector<glm::vec4> colors;  // linear, straight alpha
  std::vector<std::uint32_t> indices;
  Primitive primitive = Primitive::triangles;
  // The diameter of points, metres of mesh space; a placement scales it by the least that it
  // stretches. Lines, and points where it is 0, are `width_px` pixels of the drawn picture wide.
  float width = 0, width_px = 1;
  Box bounds;  // with the points' discs
  // Bounds of each run of primitives, in their order: most meshes keep neighbours close in it.
  static constexpr std::uint32_t kRun = 1024;
  std::vector<Box> run_bounds;

  // Triangles, lines or points.
  [[nodiscard]] std::uint64_t primitives() const { return indices.size() / corners_of(primitive); }
  [[nodiscard]] std::uint64_t triangles() const {
    return primitive == Primitive::triangles ? primitives() : 0;
  }
};

// Sets a mesh's bounds, and those of its runs, from the vertices that primitives use: a file may
// keep others.
void update_bounds(Mesh& mesh);

// A mesh in a model.
struct Part {
  int mesh = 0;
  glm::mat4 model_from_mesh{1.0f};
};

// Meshes that objects place together.
struct Model {
  std::string name;
  std::vector<Part> parts;
  Box bounds;                   // of all parts; model space
  std::uint64_t triangles = 0;  // lines and points count as triangles do
};

// An animated transform. Parents come before their children.
struct Node {
  int parent = -1;
  glm::dvec3 translation{0.0};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1.0f};
};

// A keyed curve of one node's transform. `values` holds vec3 or quaternion keys (x y z w); cubic
// splines store in-tangent, value and out-tangent for each key.
struct Channel {
  enum class Path { translation, rotation, scale };
  enum class Interpolation { step, linear, cubic_spline };
  int node = 0;
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  // seconds, ascending
  std::vector<glm::vec4> values;
};

// A model placed in the world.
struct Object {
  std::string name;
  int model = 0;
  int node = -1;              // the animated node that places it, or -1
  glm::mat4 placement{1.0f};  // world_from_model, or node_from_model if there is a node
  bool moving = false;        // a channel moves it
};

// A light, as in KHR_lights_punctual.
struct Light {
  enum class Kind { directional, point, spot };
  Kind kind = Kind::directional;
  glm::vec3 position{0.0f};
  glm::vec3 direction{0, -1, 0};                    // in which the light travels; unit
  glm::vec3 intensity{1.0f};                        // linear; lux if directional, else candela
  float range = 0.0f;                               // metres; 0: unlimited
  float inner_cone = 0.0f, outer_cone = 0.785398f;  // radians
};

// A clear sky: two colours, blended by elevation, that also light the scene from all directions.
struct Sky {
  glm::vec3 zenith{0.25f, 0.45f, 0.85f};
  glm::vec3 horizon{0.75f, 0.82f, 0.90f};
  glm::vec3 ground{0.20f, 0.19f, 0.17f};

  bool operator==(const Sky&) const = default;
};

// A scene with everything that it owns.
struct Scene {
  std::string name;
  WorldSpace world;
  std::vector<Rgba8Image> images;  // row 0 is v = 0 (as in glTF); straight alpha
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Model> models;
  std::vector<Node> nodes;
  std::vector<Channel> channels;
  float duration = 0.0f;  // of the animation, seconds; it repeats
  std::vector<Object> objects;
  std::vector<Light> lights;    // if empty, default_sun() shines
  std::vector<Camera> cameras;  // of the file
  Sky sky;
};

// The curve's value at `time` (seconds): a vec3 in xyz, or a unit quaternion. Constant before the
// first and after the last key.
[[nodiscard]] glm::vec4 sample(const Channel& channel, double time);

// `time` within the first period of an animation of `duration` seconds.
[[nodiscard]] double repeated(double time, double duration);

// Makes `origin` the scene's: everything in it moves the other way.
void set_origin(Scene& scene, const glm::dvec3& origin);

// Writes world_from_model of each object at `time` (seconds) into the caller's buffer and resizes
// it.
void pose(const Scene& scene, double time, std::vector<glm::mat4>& world_from_model);

// world_from_model with translations relative to `origin`, without loss of precision.
[[nodiscard]] glm::mat4 relative_to(const glm::dvec3& origin, const glm::mat4& world_from_model);

// Triangles of all objects, and lines and points; each instance counts.
[[nodiscard]] std::uint64_t count_triangles(const Scene& scene);

// Distances shrink at most to this share of themselves: the smallest singular value, exact where
// the axes are orthogonal.
[[nodiscard]] double smallest_stretch(const glm::mat4& transform);

// A box that contains all objects at `time`: the box of their transformed boxes.
[[nodiscard]] Box world_bounds(const Scene& scene, double time = 0.0);

// Computes the derived data: bounds and triangle counts of meshes and models, Object::moving.
void finish(Scene& scene);

// Checks that all indices are in range, all numbers are finite, and parents precede their children.
[[nodiscard]] Result<> validate(const Scene& scene);

// The light of a scene without lights.
[[nodiscard]] Light default_sun();

}  // namespace rilievo
