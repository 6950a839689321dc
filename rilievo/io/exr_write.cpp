#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>

#include <algorithm>
#include <set>

#include "rilievo/core/file.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_parts.h"

namespace rilievo {
namespace {

Imf::Header make_header(const DepthImage& picture, const std::string& part_name,
                        const exr::Shared& shared) {
  Imf::Header header = exr::part_header(picture.camera, picture.depth_kind, picture.name, part_name,
                                        shared, Imf::ZIP_COMPRESSION);
  header.setType(Imf::SCANLINEIMAGE);
  for (const char* channel : {"R", "G", "B", "A"})
    header.channels().insert(channel, Imf::Channel(Imf::HALF));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  if (!picture.object.empty()) header.channels().insert("id", Imf::Channel(Imf::UINT));
  return header;
}

void write_planes(Imf::OutputPart part, const DepthImage& picture) {
  const int w = picture.camera.width, h = picture.camera.height;
  std::vector<half> rgba(std::size_t(w) * std::size_t(h) * 4);
  const auto to_half = [](float v) { return half(std::clamp(v, -exr::kHalfMax, exr::kHalfMax)); };
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
  if (Result<> keys = exr::check_attributes(attributes); !keys) return error(keys.error().reason);
  for (const DepthImage& picture : pictures)
    if (Result<> valid = validate(picture); !valid)
      return error("picture '" + picture.name + "': " + valid.error().reason);

  exr::MemoryOutput stream;
  try {
    std::set<std::string> names;
    std::vector<Camera> cameras;
    for (const DepthImage& picture : pictures) cameras.push_back(picture.camera);
    const exr::Shared shared = exr::shared_by(cameras);
    std::vector<Imf::Header> headers;
    for (const DepthImage& picture : pictures)
      headers.push_back(make_header(picture, exr::unique_name(picture.name, names), shared));
    exr::insert_attributes(headers, attributes);

    Imf::MultiPartOutputFile out(stream, headers.data(), int(headers.size()), false, 0);
    for (int i = 0; i < int(pictures.size()); ++i)
      write_planes(Imf::OutputPart(out, i), pictures[std::size_t(i)]);
  } catch (const std::exception& failed) {
    return error(failed.what());
  }
  return write_file(path, stream.bytes());
}

}  // namespace rilievo
