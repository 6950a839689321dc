#include "rilievo/scene/polygons/obj_material.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rilievo/io/picture_decode.h"
#include "rilievo/io/text_scan.h"

namespace rilievo {
namespace {

double next_number(std::string_view& rest, double otherwise) {
  const std::string_view word = take_word(rest);
  if (word.empty() || word[0] == '#') {
    rest = {};
    return otherwise;
  }
  const std::optional<double> number = number_of(word);
  if (!number) refuse(no_number(word));
  return std::isfinite(*number) ? *number : otherwise;
}

// "r g b", or one number for all three.
glm::vec3 color(std::string_view rest) {
  const double r = next_number(rest, 0.0), g = next_number(rest, r), b = next_number(rest, g);
  return glm::vec3(glm::clamp(glm::dvec3(r, g, b), 0.0, 1e6));
}

bool is_spectral(std::string_view rest) {
  const std::string first = lower_case(take_word(rest));
  return first == "spectral" || first == "xyz";
}

bool has_alpha(const Rgba8Image& image) {
  return std::any_of(image.texels().begin(), image.texels().end(),
                     [](const glm::u8vec4& c) { return c.a < 250; });
}

// The opacity picture's alpha, or its brightness if it has none, as the alpha of `image`.
void set_alpha(const Rgba8Image& opacity, Rgba8Image& image) {
  const bool by_alpha = has_alpha(opacity);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const glm::u8vec4& o = opacity(int(std::int64_t(x) * opacity.width() / image.width()),
                                     int(std::int64_t(y) * opacity.height() / image.height()));
      image(x, y).a = by_alpha ? o.a : std::uint8_t((o.r + o.g + o.b) / 3);
    }
}

}  // namespace

// Cut-outs (leaves, fences) are nearly all in or out; glass is in between.
AlphaMode alpha_mode_of(const Rgba8Image& image) {
  if (!has_alpha(image)) return AlphaMode::opaque;
  const auto between = std::count_if(image.texels().begin(), image.texels().end(),
                                     [](const glm::u8vec4& c) { return c.a > 25 && c.a < 230; });
  // A quarter: the soft edges of leaves that are a few texels wide.
  return std::size_t(between) * 4 > image.texels().size() ? AlphaMode::blend : AlphaMode::mask;
}

// Options, each with as many arguments as it takes, then the file's name, which may have spaces.
ObjMaterials::Map ObjMaterials::parse_map(std::string_view rest) {
  Map map;
  while (true) {
    std::string_view after = trimmed(rest);
    if (!after.starts_with('-')) break;
    const std::string option = lower_case(take_word(after));
    if (option == "-s" || option == "-o" || option == "-t") {
      glm::dvec3 v(option == "-s" ? 1.0 : 0.0);
      // One to three numbers follow.
      for (int c = 0; c < 3; ++c) {
        std::string_view ahead = after;
        const std::string_view word = take_word(ahead);
        const std::optional<double> number = number_of(word);
        const bool last = trimmed(ahead).empty();  // then it is the file's name
        if (!number || !std::isfinite(*number) || last) break;
        v[c] = *number;
        after = ahead;
      }
      if (option == "-s") map.scale = v;
      if (option == "-o") map.offset = v;
    } else if (option == "-mm") {
      (void)take_word(after), (void)take_word(after);
    } else {
      const std::string argument = lower_case(take_word(after));
      if (option == "-clamp") map.clamp = argument == "on";
    }
    rest = after;
  }
  map.file = trimmed(rest);
  return map;
}

void ObjMaterials::parse(std::string_view text, const std::string& library) {
  Definition* now = nullptr;
  std::size_t number = 0;
  for (std::optional<std::string_view> line = take_line(text); line; line = take_line(text)) {
    ++number;
    try {
      parse_line(*line, library, now);
    } catch (const LoadError& fault) {
      refuse("'" + library + "' line " + std::to_string(number) + " " + fault.reason);
    }
  }
}

void ObjMaterials::parse_line(std::string_view rest, const std::string& library, Definition*& now) {
  const std::string word = lower_case(take_word(rest));
  if (word == "newmtl") {
    const std::string name(trimmed(rest));
    context_.budget.take(sizeof(Definition) + 2 * name.size() + 128);
    now = &(definitions_[name] = Definition{});
    now->material.name = name;
    now->material.base_color = {0.8f, 0.8f, 0.8f, 1.0f};
  } else if (!now) {
    return;
  } else if ((word == "kd" || word == "ke") && is_spectral(rest)) {
    context_.warn("colours given as spectral curves or as CIE XYZ are left out");
  } else if (word == "kd") {
    now->material.base_color = glm::vec4(glm::min(color(rest), 1.0f), 1.0f);
  } else if (word == "ke") {
    now->material.emissive = color(rest);
  } else if (word == "d") {
    std::string_view ahead = rest;
    if (lower_case(take_word(ahead)) == "-halo") {
      context_.warn("the material '" + now->material.name +
                    "' fades towards its outline (d -halo), which is drawn as plain opacity");
      rest = ahead;
    }
    now->opacity = next_number(rest, 1.0);
  } else if (word == "tr") {
    now->transparency = next_number(rest, 0.0);
  } else if (word == "ns") {
    // Blinn's exponent n as a width: alpha^2 = 2 / (n + 2), and roughness^2 = alpha.
    const double n = std::clamp(next_number(rest, 0.0), 0.0, 1e6);
    if (n > 0) now->material.roughness = float(std::pow(2.0 / (n + 2.0), 0.25));
  } else if (word == "pr") {
    now->material.roughness = float(std::clamp(next_number(rest, 0.8), 0.0, 1.0));
  } else if (word == "pm") {
    now->material.metallic = float(std::clamp(next_number(rest, 0.0), 0.0, 1.0));
  } else if (word == "map_kd" || word == "map_d" || word == "map_ke" || word == "norm") {
    context_.budget.take(256 + library.size() + rest.size());
    Map& map = now->maps[word] = parse_map(rest);
    const std::size_t folder = library.find_last_of("/\\");
    map.folder = folder == std::string::npos ? "" : library.substr(0, folder);
  }
}

std::string ObjMaterials::read_library(const std::string& name) {
  std::string file;
  try {
    if (!libraries_.insert(neighbor_path(context_, name)).second) return {};
    // Looking for files takes time, and nobody has so many.
    constexpr std::size_t kMaxCount = 1000;
    if (libraries_.size() > kMaxCount) refuse("there are more than 1000");
    file = read_neighbor(context_, name);
  } catch (const LoadError& fault) {
    return fault.reason;
  }
  std::string converted;
  parse(utf8_from(bytes_of(file), converted), name);
  return {};
}

void ObjMaterials::read(const std::string& names) {
  if (!statements_.insert(names).second) return;
  // A name with spaces, or several names: try the whole first.
  const std::string why = read_library(names);
  if (why.empty()) return;
  std::string_view rest = names;
  const std::string_view first = take_word(rest);
  if (trimmed(rest).empty()) return context_.warn("the material library is left out: " + why);
  rest = names;
  for (std::string_view name = first; !(name = take_word(rest)).empty();)
    if (const std::string fault = read_library(std::string(name)); !fault.empty())
      context_.warn("a material library is left out: " + fault);
}

// Names of pictures count from the library that has them; but some exporters write them as they are
// found from the model's folder.
std::string ObjMaterials::path_of(const Map& map) const {
  if (!map.folder.empty()) try {
      const std::string beside = map.folder + "/" + map.file;
      std::error_code failed;
      if (std::filesystem::is_regular_file(neighbor_path(context_, beside), failed)) return beside;
    } catch (const LoadError&) {
      // It would lie outside of the scene's folder.
    }
  return map.file;
}

// Index into images_ of a picture, decoded once whatever its names; -1 if it cannot be had.
int ObjMaterials::image(const Map& map) {
  if (map.file.empty()) return -1;
  const std::string file = path_of(map);
  try {
    const auto [known, fresh] = files_.try_emplace(neighbor_path(context_, file), -1);
    if (!fresh) return known->second;
    const std::string encoded = read_neighbor(context_, file);
    images_.push_back(decode_picture(bytes_of(encoded), context_.budget));
    return known->second = int(images_.size()) - 1;
  } catch (const LoadError& fault) {
    const bool named = fault.reason.find(file) != std::string::npos;
    context_.warn("a texture is left out: " + (named ? "" : "'" + file + "' ") + fault.reason);
    return -1;
  }
}

// An image (-1: a white one) with another's alpha or brightness as its alpha.
int ObjMaterials::image_with_opacity(int image, int opacity) {
  if (opacity < 0 || opacity == image) return image;
  const auto [known, fresh] = with_opacity_.try_emplace({image, opacity}, image);
  if (!fresh) return known->second;
  const Rgba8Image& mask = images_[std::size_t(opacity)];
  const Rgba8Image& base = image < 0 ? mask : images_[std::size_t(image)];
  try {
    context_.budget.take_pixels(base.texels().size(), sizeof(glm::u8vec4));
  } catch (const LoadError& fault) {
    context_.warn("an opacity picture is left out: " + fault.reason);
    return image;
  }
  Rgba8Image both =
      image < 0 ? Rgba8Image(mask.width(), mask.height(), glm::u8vec4(255)) : Rgba8Image(base);
  set_alpha(mask, both);
  images_.push_back(std::move(both));
  return known->second = int(images_.size()) - 1;
}

AlphaMode ObjMaterials::alpha_mode(int image) {
  const auto [known, fresh] = alpha_modes_.try_emplace(image);
  if (fresh) known->second = alpha_mode_of(images_[std::size_t(image)]);
  return known->second;
}

TextureUse ObjMaterials::texture_use(const Map& map, const Map& opacity) {
  TextureUse use;
  // In OBJ's space, where v grows upwards: uv' = scale uv + offset. With v = 1 - w on both sides,
  // w' = scale w + (1 - scale - offset).
  use.texture_from_uv[0][0] = float(map.scale.x);
  use.texture_from_uv[2][0] = float(map.offset.x);
  use.texture_from_uv[1][1] = float(map.scale.y);
  use.texture_from_uv[2][1] = float(1.0 - map.scale.y - map.offset.y);

  const int source = image_with_opacity(image(map), image(opacity));
  if (source < 0) return use;
  const auto [known, fresh] = sampled_.try_emplace({source, map.clamp}, int(textures_.size()));
  if (fresh) {
    Texture texture;
    texture.name = map.file.empty() ? opacity.file : map.file;
    texture.image = source;
    if (map.clamp) texture.wrap_u = texture.wrap_v = Wrap::clamp_to_edge;
    textures_.push_back(std::move(texture));
  }
  use.texture = known->second;
  return use;
}

void ObjMaterials::finish(Definition& definition, bool colored) {
  Material& m = definition.material;
  // No format of this family says which side of a surface shows.
  m.double_sided = true;
  const Map opacity_map = definition.maps["map_d"];
  Map base = definition.maps["map_kd"];
  const bool pictured = !base.file.empty();
  if (!pictured) base = Map{"", "", opacity_map.scale, opacity_map.offset, opacity_map.clamp};
  if (pictured || !opacity_map.file.empty()) m.base_color_texture = texture_use(base, opacity_map);
  const bool has_picture = m.base_color_texture.texture >= 0;
  if (colored || (pictured && has_picture)) m.base_color = glm::vec4(1.0f);
  if (has_picture) m.alpha_mode = alpha_mode(textures_[m.base_color_texture.texture].image);
  if (const Map& glow = definition.maps["map_ke"]; !glow.file.empty()) {
    m.emissive_texture = texture_use(glow, {});
    if (m.emissive == glm::vec3(0)) m.emissive = glm::vec3(1);
  }
  if (const Map& normal = definition.maps["norm"]; !normal.file.empty())
    m.normal_texture = texture_use(normal, {});

  const double opacity = definition.opacity.value_or(1.0 - definition.transparency.value_or(0.0));
  // Exporters round to three digits.
  constexpr double kRounding = 0.002;
  if (definition.transparency && std::abs(opacity + *definition.transparency - 1.0) > kRounding)
    context_.warn("the material '" + m.name +
                  "' has an opacity (d) and a transparency (Tr) that contradict each other; the "
                  "opacity counts");
  // Some exporters confuse d with Tr: nobody models what cannot be seen.
  if (opacity <= 0.0) {
    context_.warn("the material '" + m.name + "' is fully transparent; it is drawn opaque");
  } else if (opacity < 1.0) {
    m.alpha_mode = AlphaMode::blend;
    m.base_color.a = float(opacity);
  }
}

int ObjMaterials::use(const std::string& name, bool colored) {
  const auto [known, fresh] = used_.try_emplace(name, -1);
  if (!fresh) return known->second;
  const auto found = definitions_.find(name);
  if (found == definitions_.end()) {
    if (!name.empty() && !definitions_.empty())
      context_.warn("the material '" + name + "' is not defined");
    return -1;
  }
  finish(found->second, colored);
  known->second = int(materials_.size());
  materials_.push_back(found->second.material);
  return known->second;
}

Scene ObjMaterials::take() {
  Scene out;
  // Without the images that only went into others.
  std::map<int, int> kept;
  for (Texture& texture : textures_) {
    const auto [at, fresh] = kept.try_emplace(texture.image, int(out.images.size()));
    if (fresh) out.images.push_back(std::move(images_[std::size_t(texture.image)]));
    texture.image = at->second;
  }
  out.materials = std::move(materials_);
  out.textures = std::move(textures_);
  return out;
}

}  // namespace rilievo
