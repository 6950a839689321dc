// What there is to draw: meshes with materials, put together into models, placed as objects.
//
// An *object* is what gets a picture. Objects share models and models share meshes, so that a
// forest of 10^8 triangles is a few trees and many placements. Plain data; owns everything; no
// OpenGL. World space: right-handed, +y up, metres. Colours linear unless a texture says otherwise.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"

namespace rilievo {

enum class Wrap { repeat, mirrored_repeat, clamp_to_edge };

// How an image is sampled; many textures may share one.
struct Texture {
  std::string name;
  int image = 0;  // index into Scene::images
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;  // magnify without interpolation
};

struct TextureUse {
  int texture = -1;  // index into Scene::textures, or none
  int uv_set = 0;    // 0 or 1
  glm::mat3 texture_from_uv{1.0f};
};

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
};

// Triangles with one material. Arrays other than positions and indices are empty or have one entry
// a vertex. Counter-clockwise is front; where world_from_mesh has a negative determinant (a
// mirrored object), clockwise is: whoever draws or traces flips it by the determinant's sign, as in
// glTF.
struct Mesh {
  std::string name;
  int material = -1;  // index into Scene::materials, or the default material
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;   // unit; a loaded mesh always has them
  std::vector<glm::vec4> tangents;  // xyz unit, w = handedness
  std::vector<glm::vec2> uv[2];
  std::vector<glm::vec4> colors;  // linear, straight alpha
  std::vector<std::uint32_t> indices;
  Box bounds;

  [[nodiscard]] std::uint64_t triangles() const { return indices.size() / 3; }
};

struct Part {
  int mesh = 0;
  glm::mat4 model_from_mesh{1.0f};
};

struct Model {
  std::string name;
  std::vector<Part> parts;
  Box bounds;  // of all parts, model space
  std::uint64_t triangles = 0;
};

// A node of the hierarchy that animation moves; parents come before their children.
struct Node {
  int parent = -1;
  glm::vec3 translation{0.0f};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1.0f};
};

// A keyed curve on one node. `values` holds vec3 or quaternion (x y z w) keys in xyzw; cubic
// splines store in-tangent, value, out-tangent for each key.
struct Channel {
  enum class Path { translation, rotation, scale };
  enum class Interpolation { step, linear, cubic_spline };
  int node = 0;
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  // seconds, ascending
  std::vector<glm::vec4> values;
};

struct Object {
  std::string name;
  int model = 0;
  int node = -1;              // animated: placed by this node at each time ...
  glm::mat4 placement{1.0f};  // ... times this; not animated: world_from_model itself
  bool moving = false;        // does any channel move it?
};

struct Light {
  enum class Kind { directional, point, spot };
  Kind kind = Kind::directional;
  glm::vec3 position{0.0f};
  glm::vec3 direction{0, -1, 0};                    // the way the light travels, unit
  glm::vec3 intensity{1.0f};                        // linear; lux for directional, candela else
  float range = 0.0f;                               // 0: unlimited
  float inner_cone = 0.0f, outer_cone = 0.785398f;  // radians
};

// A clear sky: two colours, blended by elevation, that also light the scene from all around.
struct Sky {
  glm::vec3 zenith{0.25f, 0.45f, 0.85f};
  glm::vec3 horizon{0.75f, 0.82f, 0.90f};
  glm::vec3 ground{0.20f, 0.19f, 0.17f};
};

struct Scene {
  std::string name;
  std::vector<Rgba8Image> images;  // row 0 is v = 0 (glTF's convention); alpha straight
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Model> models;
  std::vector<Node> nodes;
  std::vector<Channel> channels;
  float duration = 0.0f;  // seconds; the animation repeats
  std::vector<Object> objects;
  std::vector<Light> lights;    // empty: the default sun
  std::vector<Camera> cameras;  // those the file brought along
  Sky sky;
};

// The curve's value at `time` (seconds; constant before the first key and after the last): a vec3
// in xyz, or a unit quaternion.
[[nodiscard]] glm::vec4 sample(const Channel& channel, double time);

// The time within the animation that `time` stands for: it repeats.
[[nodiscard]] double repeated(double time, double duration);

// world_from_model of every object at `time` seconds into the caller's buffer, which is resized.
void pose(const Scene& scene, double time, std::vector<glm::mat4>& world_from_model);

// A placement in the world as one relative to `origin`; no digits are lost on the way.
[[nodiscard]] glm::mat4 relative_to(const glm::dvec3& origin, const glm::mat4& world_from_model);

// Triangles of all objects, instances counted.
[[nodiscard]] std::uint64_t count_triangles(const Scene& scene);

// A box that holds all objects at `time`: the box of their transformed boxes.
[[nodiscard]] Box world_bounds(const Scene& scene, double time = 0.0);

// Fills in what can be derived: bounds and triangle counts of meshes and models, Object::moving.
void finish(Scene& scene);

// Are all indices in range, all numbers finite, all parents before their children?
[[nodiscard]] Result<> validate(const Scene& scene);

// The sun that shines when a scene has no lights.
[[nodiscard]] Light default_sun();

}  // namespace rilievo
