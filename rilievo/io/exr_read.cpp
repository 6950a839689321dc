#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/file.h"
#include "rilievo/io/deep_exr_parts.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_layers.h"
#include "rilievo/io/exr_names.h"
#include "rilievo/io/exr_parts.h"
#include "rilievo/io/exr_sizes.h"

namespace rilievo {

using namespace exr;

namespace {

// The channels of the picture; ours have no layers.
Result<PictureChannels> check_channels(const Imf::Header& header, bool ours) {
  if (header.hasType() && Imf::isDeepData(header.type()))
    return because("is a deep image, not a flat picture with depth");
  PictureChannels names;
  if (!ours) {
    const Result<PictureChannels> found = picture_channels(header.channels());
    if (!found) return found.error();
    names = *found;
  }
  for (const std::string& name : {names.color[0], names.color[1], names.color[2], names.depth}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (!channel) return because("has no channel " + name + but_it_has(header.channels()));
    if (channel->type == Imf::UINT) return because("channel " + name + " holds integers");
  }
  for (const std::string& name : {names.color[0], names.color[1], names.color[2], names.color[3],
                                  names.depth, names.object}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (channel && (channel->xSampling != 1 || channel->ySampling != 1))
      return because("channel " + name + " is sub-sampled");
  }
  return names;
}

void read_planes(Imf::InputPart& part, const PictureChannels& names, DepthImage& picture) {
  const Imath::Box2i window = part.header().dataWindow();
  const int w = picture.camera.width, h = picture.camera.height;
  picture.color = ColorImage(w, h, glm::vec4(0, 0, 0, 1));
  picture.depth = Image<float>(w, h);
  Imf::FrameBuffer planes;
  float* texels = &picture.color.texels()[0].r;
  const std::size_t texel = sizeof(glm::vec4);
  for (int c = 0; c < 4; ++c)
    planes.insert(names.color[std::size_t(c)],
                  Imf::Slice::Make(Imf::FLOAT, texels + c, window, texel, texel * w, 1, 1,
                                   c == 3 ? 1.0 : 0.0));
  planes.insert(names.depth, Imf::Slice::Make(Imf::FLOAT, picture.depth.texels().data(), window));
  const Imf::Channel* id = part.header().channels().findChannel(names.object);
  if (id && id->type == Imf::UINT) {
    picture.object = Image<std::uint32_t>(w, h);
    planes.insert(names.object,
                  Imf::Slice::Make(Imf::UINT, picture.object.texels().data(), window));
  }
  part.setFrameBuffer(planes);
  part.readPixels(window.min.y, window.max.y);
}

// Foreign colours and depths to ours, and the depth range from them.
Result<> adopt_foreign_texels(DepthImage& picture) {
  float nearest = kNoDepth, farthest = 0;
  for (std::size_t i = 0; i < picture.depth.texels().size(); ++i) {
    float& depth = picture.depth.texels()[i];
    glm::vec4& color = picture.color.texels()[i];
    color = finite_color(color);
    if (std::isnan(depth)) return because("a depth is not a number");
    if (depth < 0) return because("a depth is negative");
    // Without coverage and colour there is nothing, however far away a renderer puts it.
    if (depth == 0 || depth >= kForeignFar || color == glm::vec4(0.0f)) {
      depth = kNoDepth;
      color = glm::vec4(0.0f);
      if (!picture.object.empty()) picture.object.texels()[i] = kNoObject;
      continue;
    }
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (farthest > 0) {
    // A little room, so that no sample lies on a plane of the frustum.
    picture.camera.z_near = double(nearest) * 0.999;
    picture.camera.z_far = double(farthest) * 1.001;
  }
  return Done{};
}

Result<DepthImage> read_part(Imf::MultiPartInputFile& file, int index, bool with_planes) {
  const Imf::Header& header = file.header(index);
  DepthImage picture;
  const bool ours = header.find(kVersionName) != header.end();
  const Result<PictureChannels> channels = check_channels(header, ours);
  if (!channels) return channels.error();
  Result<Camera> camera = ours ? own_camera(header) : standard_camera(header);
  if (!camera) return camera.error();
  picture.camera = *camera;
  if (ours) {
    const auto kind = index_of(kDepthKinds, attribute<std::string>(header, kDepthKind));
    if (!kind) return because("some of its rilievo attributes are missing or damaged");
    picture.depth_kind = DepthKind(*kind);
  }
  picture.name = attribute<std::string>(header, kName)
                     .value_or(header.hasName() ? header.name() : std::string());

  if (!with_planes) return picture;
  Imf::InputPart part(file, index);
  read_planes(part, *channels, picture);
  if (!ours)
    if (Result<> adopted = adopt_foreign_texels(picture); !adopted) return adopted.error();
  if (Result<> valid = validate(picture); !valid) return because(valid.error().reason);
  return picture;
}

Result<PictureFile> read_parts(Imf::MultiPartInputFile& file, double file_bytes,
                               const PictureRange& range) {
  const auto error = [&](int part, const Error& e) {
    const std::string which = file.parts() > 1 ? "part " + std::to_string(part) + ": " : "";
    return because(which + e.reason);
  };
  // All claims before the first allocation.
  for (int i = 0; i < file.parts(); ++i)
    if (Result<> claims = check_claims(file.header(i), file_bytes); !claims)
      return error(i, claims.error());
  // Deep pictures are ours, and all parts are; foreign ones are read by deep_exr.h.
  const bool deep = is_own_deep_part(file.header(0));
  PictureFile out;
  for (int i = 0; i < file.parts(); ++i) {
    const bool with_planes = range.has(std::size_t(i));
    if (deep) {
      Result<LayeredDepthImage> layers = read_layers(file, i, file_bytes, {}, with_planes);
      if (!layers) return error(i, layers.error());
      out.layers.push_back(*std::move(layers));
    } else {
      Result<DepthImage> picture = read_part(file, i, with_planes);
      if (!picture) return error(i, picture.error());
      out.pictures.push_back(*std::move(picture));
    }
    out.attributes.pictures.push_back(attributes_of(file.header(i), kPicturePrefix));
  }
  out.attributes.file = attributes_of(file.header(0), kFilePrefix);
  return out;
}

}  // namespace

Result<PictureFile> load_picture_file(const std::filesystem::path& path,
                                      const PictureRange& range) {
  const Result<std::string> bytes = read_file(path, kMaxBytes);
  if (!bytes) return bytes.error();
  if (Result<> sizes = check_exr_sizes(*bytes); !sizes)
    return Error{path.string(), sizes.error().reason};
  try {
    MemoryStream stream(*bytes);
    Imf::MultiPartInputFile file(stream, 0);
    Result<PictureFile> read = read_parts(file, double(bytes->size()), range);
    if (!read) return Error{path.string(), read.error().reason};
    return read;
  } catch (const std::exception& failed) {
    return Error{path.string(), "is not a readable OpenEXR file: " + one_line(failed.what())};
  }
}

Result<std::vector<DepthImage>> load_pictures(const std::filesystem::path& path) {
  Result<PictureFile> file = load_picture_file(path);
  if (!file) return file.error();
  if (!file->layers.empty())
    return Error{path.string(), "is a deep image, not a flat picture with depth"};
  return std::move(file->pictures);
}

}  // namespace rilievo
