// The first animation of a glTF document as curves.
#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/scene/gltf/accessor.h"
#include "rilievo/scene/gltf/nodes.h"

namespace rilievo::gltf {
namespace {

constexpr std::size_t kFirst = 0;

struct Curve {
  Channel::Interpolation interpolation = Channel::Interpolation::linear;
  std::vector<float> times;
  int numbers = 1;            // a value
  std::vector<float> values;  // one value a key, or three for cubic splines
};

std::vector<float> finite_floats(Document& document, const Accessor& accessor,
                                 const JsonValue& where) {
  std::vector<float> values = read_floats(document, accessor);
  for (float v : values)
    if (!std::isfinite(v)) where.fail("has numbers that are not finite");
  return values;
}

// `each`: how many elements of the output accessor make one value (morph targets; else 1).
Curve read_curve(Document& document, const JsonValue& sampler, std::size_t each) {
  constexpr std::array kOne{1};
  const std::size_t accessors = document.count("accessors");
  const Accessor input = describe_accessor(document, sampler["input"].required_index(accessors));
  const Accessor output = describe_accessor(document, sampler["output"].required_index(accessors));
  expect_numbers(document, input, kOne);

  Curve curve;
  const std::string kind = sampler["interpolation"].text("LINEAR");
  if (kind == "STEP")
    curve.interpolation = Channel::Interpolation::step;
  else if (kind == "CUBICSPLINE")
    curve.interpolation = Channel::Interpolation::cubic_spline;
  else if (kind != "LINEAR")
    sampler["interpolation"].fail("is '" + kind + "', which is unknown");

  const std::size_t values_per_key = kind == "CUBICSPLINE" ? 3 : 1;
  if (input.count == 0) sampler.fail("has no keys");
  if (output.count != input.count * values_per_key * each)
    sampler.fail("has " + std::to_string(output.count) + " values for " +
                 std::to_string(input.count) + " keys");
  curve.times = finite_floats(document, input, sampler["input"]);
  curve.numbers = output.numbers * int(each);
  curve.values = finite_floats(document, output, sampler["output"]);

  // A key at or before its predecessor's time can never be reached.
  const std::size_t stride = std::size_t(curve.numbers) * values_per_key;
  std::size_t kept = 1;
  for (std::size_t k = 1; k < curve.times.size(); ++k) {
    if (!(curve.times[k] > curve.times[kept - 1])) continue;
    curve.times[kept] = curve.times[k];
    std::copy_n(curve.values.begin() + k * stride, stride, curve.values.begin() + kept * stride);
    ++kept;
  }
  if (kept < curve.times.size())
    document.context->warn(sampler.path() + " has keys whose times do not ascend; left out");
  curve.times.resize(kept);
  curve.values.resize(kept * stride);
  return curve;
}

// Numbers first ... first + count - 1 of every value.
Channel channel_of(const Curve& curve, int node, int first, int count) {
  Channel channel;
  channel.node = node;
  channel.interpolation = curve.interpolation;
  channel.times = curve.times;
  channel.values.resize(curve.values.size() / curve.numbers, glm::vec4(0));
  for (std::size_t i = 0; i < channel.values.size(); ++i)
    for (int c = 0; c < count; ++c)
      channel.values[i][c] = curve.values[i * curve.numbers + first + c];
  return channel;
}

std::size_t count_targets(Document& document, int node) {
  const JsonValue root = document.root();
  const int mesh = root["nodes"][std::size_t(node)]["mesh"].index(document.count("meshes"));
  if (mesh < 0) return 0;
  const JsonValue primitives = root["meshes"][std::size_t(mesh)]["primitives"];
  return primitives.size() == 0 ? 0 : primitives[kFirst]["targets"].size();
}

}  // namespace

Animation read_animation(Document& document) {
  Animation out;
  const JsonValue animations = document.root()["animations"];
  if (animations.size() == 0) return out;
  if (animations.size() > 1)
    document.context->warn("only the first of " + std::to_string(animations.size()) +
                           " animations is played");
  const JsonValue first = animations[kFirst];
  const JsonValue samplers = first["samplers"], channels = first["channels"];
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const JsonValue target = channels[i]["target"];
    const int node = target["node"].index(document.count("nodes"));
    const std::string path = target["path"].text();
    if (node < 0) continue;  // the specification says to ignore it
    const JsonValue sampler = samplers[channels[i]["sampler"].required_index(samplers.size())];

    if (path == "weights") {
      const std::size_t targets = count_targets(document, node);
      if (targets == 0) target.fail("has no morph targets whose weights could change");
      const Curve curve = read_curve(document, sampler, targets);
      document.context->budget.take(curve.values.size(), sizeof(glm::vec4) + sizeof(float));
      WeightTrack track{node, {}};
      for (std::size_t t = 0; t < targets; ++t)
        track.targets.push_back(channel_of(curve, node, int(t), 1));
      out.duration = std::max(out.duration, curve.times.back());
      out.weights.push_back(std::move(track));
      continue;
    }
    const bool rotation = path == "rotation";
    if (!rotation && path != "translation" && path != "scale") {
      document.context->warn(target.path() + " animates '" + path + "', which is left out");
      continue;
    }
    const Curve curve = read_curve(document, sampler, 1);
    const int numbers = rotation ? 4 : 3;
    if (curve.numbers != numbers) sampler["output"].fail("does not fit what it animates");
    document.context->budget.take(curve.values.size() / numbers, sizeof(glm::vec4));
    Channel channel = channel_of(curve, node, 0, numbers);
    channel.path = rotation                ? Channel::Path::rotation
                   : path == "translation" ? Channel::Path::translation
                                           : Channel::Path::scale;
    out.duration = std::max(out.duration, curve.times.back());
    out.channels.push_back(std::move(channel));
  }
  return out;
}

}  // namespace rilievo::gltf
