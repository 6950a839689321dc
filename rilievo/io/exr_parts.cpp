#include "rilievo/io/exr_parts.h"

#include <ImfStringAttribute.h>

#include <algorithm>

#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_names.h"

namespace rilievo::exr {
namespace {

Result<> check_keys(const Attributes& attributes) {
  for (const auto& [key, value] : attributes) {
    const bool printable =
        std::all_of(key.begin(), key.end(), [](char c) { return c > ' ' && c < 127; });
    if (key.empty() || key.size() > 200 || !printable)
      return Error{"", "the attribute key '" + key + "' is not 1 to 200 printable characters"};
  }
  return Done{};
}

void insert(Imf::Header& header, std::string_view prefix, const Attributes& attributes) {
  for (const auto& [key, value] : attributes)
    header.insert(std::string(prefix) + key, Imf::StringAttribute(value));
}

float aspect_of(const Camera& c) {
  const double aspect =
      ((c.window.right - c.window.left) / c.width) / ((c.window.top - c.window.bottom) / c.height);
  // OpenEXR refuses extreme ones.
  return aspect > 1e-5 && aspect < 1e5 ? float(aspect) : 1.0f;
}

// The picture's camera, grown to the right and downwards to show the whole display window.
Camera display_camera(Camera camera, const Shared& shared) {
  ImageWindow& w = camera.window;
  if (shared.width != camera.width)
    w.right = w.left + (w.right - w.left) / camera.width * shared.width;
  if (shared.height != camera.height)
    w.bottom = w.top - (w.top - w.bottom) / camera.height * shared.height;
  camera.width = shared.width;
  camera.height = shared.height;
  return camera;
}

}  // namespace

std::string unique_name(const std::string& wanted, std::set<std::string>& taken) {
  const std::string base = wanted.empty() ? "picture" : wanted;
  std::string name = base;
  for (int i = 2; !taken.insert(name).second; ++i) name = base + "." + std::to_string(i);
  return name;
}

Result<> check_attributes(const FileAttributes& attributes) {
  if (Result<> keys = check_keys(attributes.file); !keys) return keys;
  for (const Attributes& of_picture : attributes.pictures)
    if (Result<> keys = check_keys(of_picture); !keys) return keys;
  return Done{};
}

void insert_attributes(std::vector<Imf::Header>& headers, const FileAttributes& attributes) {
  insert(headers.front(), kFilePrefix, attributes.file);
  for (std::size_t i = 0; i < attributes.pictures.size(); ++i)
    insert(headers[i], kPicturePrefix, attributes.pictures[i]);
}

Attributes attributes_of(const Imf::Header& header, std::string_view prefix) {
  Attributes out;
  for (auto a = header.begin(); a != header.end(); ++a) {
    const std::string_view name = a.name();
    if (!name.starts_with(prefix)) continue;
    if (const auto value = attribute<std::string>(header, a.name()))
      out.emplace(name.substr(prefix.size()), *value);
  }
  return out;
}

Shared shared_by(std::span<const Camera> cameras) {
  Shared shared;
  shared.aspect = aspect_of(cameras.front());
  for (const Camera& camera : cameras) {
    shared.width = std::max(shared.width, camera.width);
    shared.height = std::max(shared.height, camera.height);
    if (aspect_of(camera) != shared.aspect) shared.aspect = 1.0f;
  }
  return shared;
}

Imf::Header part_header(const Camera& camera, DepthKind depth_kind, const std::string& name,
                        const std::string& part_name, const Shared& shared,
                        Imf::Compression compression) {
  const Camera display = display_camera(camera, shared);
  const ImageWindow& shown = display.window;
  Imf::Header header(
      shared.width, shared.height, shared.aspect,
      {float(0.5 * (shown.left + shown.right)), float(0.5 * (shown.bottom + shown.top))},
      float(shown.right - shown.left), Imf::INCREASING_Y, compression);
  header.dataWindow() = {{0, 0}, {camera.width - 1, camera.height - 1}};
  header.setName(part_name);
  insert_camera(header, camera, display, depth_kind, name);
  return header;
}

}  // namespace rilievo::exr
