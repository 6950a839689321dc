#include "rilievo/io/exr_layers.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "rilievo/io/text_scan.h"

namespace rilievo::exr {
namespace {

bool has(const Imf::ChannelList& channels, const std::string& name) {
  return channels.findChannel(name) != nullptr;
}

// The layers, each with its dot behind it, that have R, G and B.
std::vector<std::string> colored_layers(const Imf::ChannelList& channels) {
  std::vector<std::string> layers;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    const std::string name = c.name();
    if (name != "R" && !name.ends_with(".R")) continue;
    const std::string layer = name.substr(0, name.size() - 1);
    if (has(channels, layer + "G") && has(channels, layer + "B")) layers.push_back(layer);
  }
  return layers;
}

// What lies before "Depth.Z" in a channel's name, or nothing if it is no depth.
std::optional<std::string> depth_prefix(const std::string& name) {
  if (name == "Z") return "";
  const std::string lower = lower_case(name);
  for (const std::string_view depth : {"depth.z", "depth.v", "depth.y", "depth.r", "depth"})
    if (lower.ends_with(depth) &&
        (lower.size() == depth.size() || lower[lower.size() - depth.size() - 1] == '.'))
      return name.substr(0, name.size() - depth.size());
  return {};
}

// In one line, whatever bytes a damaged file has for names.
std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxCount = 20, kMaxLength = 60;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxCount); ++i)
    list += (i ? ", " : "") + names[i].substr(0, kMaxLength);
  for (char& c : list)
    if (std::uint8_t(c) < 0x20 || c == 0x7f) c = '?';
  if (names.size() > kMaxCount)
    list += " and " + std::to_string(names.size() - kMaxCount) + " more";
  return list;
}

PictureChannels named(const std::string& layer, const std::string& depth) {
  return {{layer + "R", layer + "G", layer + "B", layer + "A"}, depth, layer + "id"};
}

}  // namespace

std::string but_it_has(const Imf::ChannelList& channels) {
  std::vector<std::string> names;
  for (auto c = channels.begin(); c != channels.end(); ++c) names.push_back(c.name());
  return names.empty() ? "; it has none" : "; it has " + list_of(names);
}

Result<PictureChannels> picture_channels(const Imf::ChannelList& channels) {
  std::vector<std::string> layers = colored_layers(channels), depths;
  for (auto c = channels.begin(); c != channels.end(); ++c)
    if (depth_prefix(c.name())) depths.emplace_back(c.name());
  for (const std::string& layer : layers)
    if (!layer.empty() && has(channels, layer + "Z")) depths.push_back(layer + "Z");
  const bool plain = std::find(layers.begin(), layers.end(), "") != layers.end();
  if (plain && has(channels, "Z")) return PictureChannels{};
  if (plain) {
    layers = {""};
  } else if (layers.size() > 1) {
    // Passes of one render (ViewLayer.DiffCol) have colours, too.
    std::vector<std::string> combined;
    for (const std::string& layer : layers)
      if (lower_case(layer).ends_with("combined.")) combined.push_back(layer);
    if (!combined.empty()) layers = combined;
  }
  // Colours and depth of one render.
  std::vector<std::string> renders;
  PictureChannels found;
  for (const std::string& layer : layers)
    for (const std::string& depth : depths) {
      const std::string render = depth_prefix(depth).value_or("");
      const bool own =
          depth == layer + "Z" || (layer.size() > render.size() && layer.starts_with(render) &&
                                   layer.find('.', render.size()) == layer.size() - 1 &&
                                   depth_prefix(depth) && (!render.empty() || depths.size() == 1));
      if (!own) continue;
      renders.push_back(render.empty() ? layer : render);
      found = named(layer, depth);
    }
  const auto error = [](const std::string& reason) { return Error{"", reason}; };
  if (renders.size() == 1) return found;
  if (renders.size() > 1)
    return error("has several layers with colours and depth, of which one is to be kept: " +
                 list_of(renders));
  if (layers.size() == 1 && depths.size() == 1) return named(layers[0], depths[0]);
  const std::string there = but_it_has(channels);
  for (const char* name : {"R", "G", "B"})
    if (layers.empty() && !has(channels, name))
      return error(std::string("has no channel ") + name + there);
  if (depths.empty()) return error("has no channel Z" + there);
  return error("has several layers with colours or depth that do not belong together" + there);
}

}  // namespace rilievo::exr
