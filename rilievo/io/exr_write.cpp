#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "rilievo/core/file.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_names.h"

namespace rilievo {
namespace {

// The largest finite half.
constexpr float kHalfMax = 65504.0f;

// Parts must be named, each differently; pictures need not be.
std::string unique_name(const std::string& wanted, std::set<std::string>& taken) {
  const std::string base = wanted.empty() ? "picture" : wanted;
  std::string name = base;
  for (int i = 2; !taken.insert(name).second; ++i) name = base + "." + std::to_string(i);
  return name;
}

Result<> check_attributes(const Attributes& attributes) {
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

// What OpenEXR wants to be the same in all parts of a file: one display window that holds every
// picture at its upper left corner, and one width of a pixel over its height (1 if they differ).
struct Shared {
  int width = 1, height = 1;
  float aspect = 1.0f;
};

Shared shared_by(std::span<const DepthImage> pictures) {
  const auto aspect_of = [](const Camera& c) {
    const double aspect = ((c.window.right - c.window.left) / c.width) /
                          ((c.window.top - c.window.bottom) / c.height);
    // OpenEXR refuses extreme ones.
    return aspect > 1e-5 && aspect < 1e5 ? float(aspect) : 1.0f;
  };
  Shared shared;
  shared.aspect = aspect_of(pictures.front().camera);
  for (const DepthImage& picture : pictures) {
    shared.width = std::max(shared.width, picture.camera.width);
    shared.height = std::max(shared.height, picture.camera.height);
    if (aspect_of(picture.camera) != shared.aspect) shared.aspect = 1.0f;
  }
  return shared;
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

Imf::Header make_header(const DepthImage& picture, const std::string& part_name,
                        const Shared& shared) {
  const Camera& camera = picture.camera;
  const Camera display = display_camera(camera, shared);
  const ImageWindow& shown = display.window;
  Imf::Header header(
      shared.width, shared.height, shared.aspect,
      {float(0.5 * (shown.left + shown.right)), float(0.5 * (shown.bottom + shown.top))},
      float(shown.right - shown.left), Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
  header.dataWindow() = {{0, 0}, {camera.width - 1, camera.height - 1}};
  header.setName(part_name);
  header.setType(Imf::SCANLINEIMAGE);
  for (const char* channel : {"R", "G", "B", "A"})
    header.channels().insert(channel, Imf::Channel(Imf::HALF));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  if (!picture.object.empty()) header.channels().insert("id", Imf::Channel(Imf::UINT));

  exr::insert_camera(header, camera, display, picture.depth_kind, picture.name);
  return header;
}

void write_planes(Imf::OutputPart part, const DepthImage& picture) {
  const int w = picture.camera.width, h = picture.camera.height;
  std::vector<half> rgba(std::size_t(w) * std::size_t(h) * 4);
  const auto to_half = [](float v) { return half(std::clamp(v, -kHalfMax, kHalfMax)); };
  for (std::size_t i = 0; i < picture.color.texels().size(); ++i)
    for (int c = 0; c < 4; ++c) rgba[4 * i + c] = to_half(picture.color.texels()[i][c]);

  const Imath::Box2i window({0, 0}, {w - 1, h - 1});
  Imf::FrameBuffer planes;
  const std::size_t texel = 4 * sizeof(half);
  const char* names[] = {"R", "G", "B", "A"};
  for (int c = 0; c < 4; ++c)
    planes.insert(names[c], Imf::Slice::Make(Imf::HALF, rgba.data() + c, window, texel, texel * w));
  planes.insert("Z", Imf::Slice::Make(Imf::FLOAT, picture.depth.texels().data(), window));
  if (!picture.object.empty())
    planes.insert("id", Imf::Slice::Make(Imf::UINT, picture.object.texels().data(), window));
  part.setFrameBuffer(planes);
  part.writePixels(h);
}

}  // namespace

Result<> save_pictures(const std::filesystem::path& path, std::span<const DepthImage> pictures,
                       const FileAttributes& attributes) {
  RILIEVO_EXPECTS(attributes.pictures.empty() || attributes.pictures.size() == pictures.size());
  const auto error = [&](const std::string& reason) { return Error{path.string(), reason}; };
  if (pictures.empty()) return error("there is no picture to save");
  if (Result<> keys = check_attributes(attributes.file); !keys) return error(keys.error().reason);
  for (const Attributes& of_picture : attributes.pictures)
    if (Result<> keys = check_attributes(of_picture); !keys) return error(keys.error().reason);
  for (const DepthImage& picture : pictures)
    if (Result<> valid = validate(picture); !valid)
      return error("picture '" + picture.name + "': " + valid.error().reason);

  exr::MemoryOutput stream;
  try {
    std::set<std::string> names;
    std::vector<Imf::Header> headers;
    const Shared shared = shared_by(pictures);
    for (const DepthImage& picture : pictures)
      headers.push_back(make_header(picture, unique_name(picture.name, names), shared));
    insert(headers.front(), exr::kFilePrefix, attributes.file);
    for (std::size_t i = 0; i < attributes.pictures.size(); ++i)
      insert(headers[i], exr::kPicturePrefix, attributes.pictures[i]);

    Imf::MultiPartOutputFile out(stream, headers.data(), int(headers.size()), false, 0);
    for (int i = 0; i < int(pictures.size()); ++i)
      write_planes(Imf::OutputPart(out, i), pictures[std::size_t(i)]);
  } catch (const std::exception& failed) {
    return error(failed.what());
  }
  return write_file(path, stream.bytes());
}

}  // namespace rilievo
