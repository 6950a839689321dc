#include "rilievo/scene/gltf/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rilievo::gltf {
namespace {

// Nothing if the vector has no direction.
std::optional<glm::dvec3> unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  if (!(length > 0) || !std::isfinite(length)) return {};
  return v / length;
}

// The node's axes made orthonormal and right-handed, looking along its -z.
std::optional<glm::dmat4> rigid(const glm::dmat4& world_from_node) {
  const std::optional<glm::dvec3> back = unit(glm::dvec3(world_from_node[2]));
  if (!back) return {};
  const std::optional<glm::dvec3> right = unit(glm::cross(glm::dvec3(world_from_node[1]), *back));
  if (!right) return {};
  return glm::dmat4(glm::dvec4(*right, 0), glm::dvec4(glm::cross(*back, *right), 0),
                    glm::dvec4(*back, 0), world_from_node[3]);
}

Light read_light(const JsonValue& from, const glm::dmat4& world_from_node) {
  Light light;
  const std::string type = from["type"].text();
  if (type == "directional")
    light.kind = Light::Kind::directional;
  else if (type == "point")
    light.kind = Light::Kind::point;
  else if (type == "spot")
    light.kind = Light::Kind::spot;
  else
    from["type"].fail("is '" + type + "', which is unknown");
  light.position = glm::vec3(glm::dvec3(world_from_node[3]));
  light.direction = glm::vec3(unit(-glm::dvec3(world_from_node[2])).value_or(glm::dvec3(0, -1, 0)));
  const double intensity = std::max(from["intensity"].number(1.0), 0.0);
  light.intensity =
      glm::vec3(glm::max(from["color"].vec3(glm::dvec3(1)), glm::dvec3(0)) * intensity);
  light.range = float(std::max(from["range"].number(0.0), 0.0));
  const double quarter = std::numbers::pi / 4;
  const JsonValue spot = from["spot"];
  light.outer_cone =
      float(std::clamp(spot["outerConeAngle"].number(quarter), 0.0, std::numbers::pi / 2));
  light.inner_cone =
      float(std::clamp(spot["innerConeAngle"].number(0.0), 0.0, double(light.outer_cone)));
  return light;
}

Camera read_camera(const JsonValue& from, const glm::dmat4& world_from_eye) {
  constexpr int kHeight = 720;  // texels: a file knows proportions only
  Camera camera;
  camera.world_from_eye = world_from_eye;
  double right = 1, top = 1;
  const std::string type = from["type"].text();
  const JsonValue lens = from[type == "orthographic" ? "orthographic" : "perspective"];
  camera.z_near = lens["znear"].number();
  if (type == "perspective") {
    const double angle = lens["yfov"].number();
    if (!(angle > 0 && angle < std::numbers::pi)) lens["yfov"].fail("is not between 0 and pi");
    top = std::tan(angle / 2);
    right = top * lens["aspectRatio"].number(16.0 / 9.0);
    // Without a far plane: one so far that it makes no difference.
    camera.z_far = lens["zfar"].number(1e5 * camera.z_near);
  } else if (type == "orthographic") {
    camera.projection = Projection::parallel;
    right = std::abs(lens["xmag"].number());
    top = std::abs(lens["ymag"].number());
    camera.z_far = lens["zfar"].number();
    // A parallel camera may start at its eye, or behind; ours steps back until it does not.
    if (camera.z_near <= 0) {
      const double back = 1e-3 * (camera.z_far - camera.z_near) - camera.z_near;
      camera.world_from_eye[3] += camera.world_from_eye[2] * back;
      camera.z_near += back;
      camera.z_far += back;
    }
  } else {
    from["type"].fail("is '" + type + "', which is unknown");
  }
  camera.window = {-right, right, -top, top};
  camera.height = kHeight;
  // A lens without extent is 0 / 0, for which fmax takes the 1.
  camera.width = int(std::fmin(std::fmax(std::round(kHeight * right / top), 1.0), 16384.0));
  return camera;
}

}  // namespace

void read_lights(Document& document, const Tree& tree, const PosedTree& posed, Scene& scene) {
  const JsonValue root = document.root();
  const JsonValue lights = root["extensions"]["KHR_lights_punctual"]["lights"];
  for (int i : tree.order) {
    const JsonValue use = root["nodes"][std::size_t(i)]["extensions"]["KHR_lights_punctual"];
    if (!use || !tree.drawn[i]) continue;
    const int light = use["light"].required_index(lights.size());
    scene.lights.push_back(read_light(lights[std::size_t(light)], posed.world_from_node[i]));
  }
}

void read_cameras(Document& document, const Tree& tree, const PosedTree& posed, Scene& scene) {
  const JsonValue root = document.root(), cameras = root["cameras"];
  for (int i : tree.order) {
    const int index = root["nodes"][std::size_t(i)]["camera"].index(cameras.size());
    if (index < 0 || !tree.drawn[i]) continue;
    const JsonValue from = cameras[std::size_t(index)];
    const std::optional<glm::dmat4> world_from_eye = rigid(posed.world_from_node[i]);
    if (!world_from_eye) {
      document.context->warn(from.path() + " has a node without extent and is left out");
      continue;
    }
    const Camera camera = read_camera(from, *world_from_eye);
    if (const Result<> valid = validate(camera); !valid)
      document.context->warn(from.path() + " is left out: " + valid.error().reason);
    else
      scene.cameras.push_back(camera);
  }
}

void balance_lights(const Box& bounds, std::vector<Light>& lights) {
  const auto luminance = [](const glm::vec3& c) {
    return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;  // ITU-R BT.709
  };
  // Nobody lights an object from inside: count a light as half a radius away at least.
  const double nearest = std::max(0.5 * double(bounds.radius()), 1e-6);
  double total = 0.0;
  for (const Light& light : lights) {
    const double distance =
        std::max(glm::length(glm::dvec3(light.position) - glm::dvec3(bounds.center())), nearest);
    const bool sun = light.kind == Light::Kind::directional;
    total += luminance(light.intensity) / (sun ? 1.0 : distance * distance);
  }
  if (!(total > 0.0) || !std::isfinite(total)) return;
  const float factor = float(luminance(default_sun().intensity) / total);
  for (Light& light : lights) light.intensity *= factor;
}

}  // namespace rilievo::gltf
