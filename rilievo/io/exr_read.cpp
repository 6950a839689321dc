#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "rilievo/core/file.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/exr_camera.h"
#include "rilievo/io/exr_names.h"
#include "rilievo/io/exr_sizes.h"

namespace rilievo {
namespace {

// From here on a foreign depth is "nothing there": renderers write 1e30, 1e32, 1e38.
constexpr float kForeignFar = 1e30f;

constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 34;

// A file in memory, for OpenEXR to read from.
class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(std::string_view bytes) : Imf::IStream("memory"), bytes_(bytes) {}

  bool read(char out[], int count) override {
    if (count < 0 || std::uint64_t(count) > bytes_.size() - position_)
      throw std::runtime_error("it ends too early");
    std::memcpy(out, bytes_.data() + position_, std::size_t(count));
    position_ += std::size_t(count);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override {
    if (position > bytes_.size()) throw std::runtime_error("it ends too early");
    position_ = std::size_t(position);
  }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
};

Error because(const std::string& reason) { return Error{"", reason}; }

template <class Value>
std::optional<Value> attribute(const Imf::Header& header, const char* name) {
  const auto* found = header.findTypedAttribute<Imf::TypedAttribute<Value>>(name);
  if (!found) return std::nullopt;
  return found->value();
}

template <class From>
glm::dmat4 glm_matrix(const From& m) {
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = double(m[i][j]);
  return out;
}

template <std::size_t n>
std::optional<std::size_t> index_of(const std::array<const char*, n>& names,
                                    const std::optional<std::string>& wanted) {
  for (std::size_t i = 0; wanted && i < n; ++i)
    if (*wanted == names[i]) return i;
  return std::nullopt;
}

struct Size {
  std::int64_t width, height;
};

Size size_of(const Imath::Box2i& box) {
  return {std::int64_t(box.max.x) - box.min.x + 1, std::int64_t(box.max.y) - box.min.y + 1};
}

// Can a file of `file_bytes` hold this part? DEFLATE, the densest of the codecs in practice, makes
// of one byte at most 1032. A buffer of lines (256 with DWAB, else at most 32) or a tile is
// allocated even for a part that needs only a piece of it.
Result<> check_claims(const Imf::Header& header, double file_bytes) {
  const Size size = size_of(header.dataWindow());
  if (size.width < 1 || size.height < 1) return because("its data window is empty");
  if (size.width > 1 << 24 || size.height > 1 << 24)
    return because("its data window is larger than 16777216 texels along a side");
  double texel_bytes = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    texel_bytes += c.channel().type == Imf::HALF ? 2 : 4;
  const double limit = 1100.0 * file_bytes + double(4 << 20);
  const int lines = header.compression() == Imf::DWAB_COMPRESSION ? 256 : 32;
  double texels = double(size.width) * double(std::max<std::int64_t>(size.height, lines));
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tile = header.tileDescription();
    texels = std::max(texels, double(tile.xSize) * double(tile.ySize));
  }
  if (texels * texel_bytes > limit)
    return because("claims " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                   " texels, more than its bytes can hold");
  return Done{};
}

Result<> check_channels(const Imf::Header& header) {
  if (header.hasType() && Imf::isDeepData(header.type()))
    return because("is a deep image, not a flat picture with depth");
  for (const char* name : {"R", "G", "B", "Z"}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (!channel) return because(std::string("has no channel ") + name);
    if (channel->type == Imf::UINT)
      return because(std::string("channel ") + name + " holds integers");
  }
  for (const char* name : {"R", "G", "B", "A", "Z", "id"}) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (channel && (channel->xSampling != 1 || channel->ySampling != 1))
      return because(std::string("channel ") + name + " is sub-sampled");
  }
  return Done{};
}

// Our own camera, exactly as it was saved.
Result<Camera> own_camera(const Imf::Header& header) {
  if (attribute<int>(header, exr::kVersionName) != exr::kVersion)
    return because("was written by another version of Rilievo");
  const auto projection =
      index_of(exr::kProjections, attribute<std::string>(header, exr::kProjection));
  const auto pose = attribute<Imath::M44d>(header, exr::kWorldFromEye);
  const auto low = attribute<Imath::V2d>(header, exr::kWindowMin);
  const auto high = attribute<Imath::V2d>(header, exr::kWindowMax);
  const auto range = attribute<Imath::V2d>(header, exr::kDepthRange);
  const auto size = attribute<Imath::V2i>(header, exr::kSize);
  if (!projection || !pose || !low || !high || !range || !size)
    return because("some of its rilievo attributes are missing or damaged");
  const Size kept = size_of(header.dataWindow());
  if (kept.width != size->x || kept.height != size->y)
    return because("was cropped or resized by another program");
  Camera camera;
  camera.projection = Projection(*projection);
  camera.world_from_eye = glm_matrix(*pose);
  camera.window = {low->x, high->x, low->y, high->y};
  camera.z_near = range->x;
  camera.z_far = range->y;
  camera.width = size->x;
  camera.height = size->y;
  return camera;
}

// The camera of the standard matrices, cut to the part of the display window that has texels.
Result<Camera> foreign_camera(const Imf::Header& header) {
  const auto view = attribute<Imath::M44f>(header, "worldToCamera");
  const auto ndc = attribute<Imath::M44f>(header, "worldToNDC");
  if (!view || !ndc) return because("has no camera (worldToCamera and worldToNDC)");
  Result<Camera> camera = camera_from_standard({glm_matrix(*view), glm_matrix(*ndc)});
  if (!camera) return camera;

  const Imath::Box2i &display = header.displayWindow(), &data = header.dataWindow();
  const Size shown = size_of(display), kept = size_of(data);
  if (shown.width < 1 || shown.height < 1) return because("its display window is empty");
  ImageWindow& w = camera->window;
  const double step_x = (w.right - w.left) / double(shown.width);
  const double step_y = (w.top - w.bottom) / double(shown.height);
  w.left += step_x * (double(data.min.x) - display.min.x);
  w.right = w.left + step_x * double(kept.width);
  w.top -= step_y * (double(data.min.y) - display.min.y);
  w.bottom = w.top - step_y * double(kept.height);
  camera->width = int(kept.width);
  camera->height = int(kept.height);
  return camera;
}

void read_planes(Imf::InputPart& part, DepthImage& picture) {
  const Imath::Box2i window = part.header().dataWindow();
  const int w = picture.camera.width, h = picture.camera.height;
  picture.color = ColorImage(w, h, glm::vec4(0, 0, 0, 1));
  picture.depth = Image<float>(w, h);
  Imf::FrameBuffer planes;
  const char* names[] = {"R", "G", "B", "A"};
  float* texels = &picture.color.texels()[0].r;
  const std::size_t texel = sizeof(glm::vec4);
  for (int c = 0; c < 4; ++c)
    planes.insert(names[c], Imf::Slice::Make(Imf::FLOAT, texels + c, window, texel, texel * w, 1, 1,
                                             c == 3 ? 1.0 : 0.0));
  planes.insert("Z", Imf::Slice::Make(Imf::FLOAT, picture.depth.texels().data(), window));
  const Imf::Channel* id = part.header().channels().findChannel("id");
  if (id && id->type == Imf::UINT) {
    picture.object = Image<std::uint32_t>(w, h);
    planes.insert("id", Imf::Slice::Make(Imf::UINT, picture.object.texels().data(), window));
  }
  part.setFrameBuffer(planes);
  part.readPixels(window.min.y, window.max.y);
}

// Foreign depths to ours, and the depth range from them.
Result<> adopt_foreign_depth(DepthImage& picture) {
  float nearest = kNoDepth, farthest = 0;
  for (std::size_t i = 0; i < picture.depth.texels().size(); ++i) {
    float& depth = picture.depth.texels()[i];
    if (std::isnan(depth)) return because("a depth is not a number");
    if (depth < 0) return because("a depth is negative");
    if (depth == 0 || depth >= kForeignFar) {
      depth = kNoDepth;
      picture.color.texels()[i] = glm::vec4(0.0f);
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

Result<DepthImage> read_part(Imf::MultiPartInputFile& file, int index) {
  const Imf::Header& header = file.header(index);
  if (Result<> channels = check_channels(header); !channels) return channels.error();
  DepthImage picture;
  const bool ours = header.find(exr::kVersionName) != header.end();
  Result<Camera> camera = ours ? own_camera(header) : foreign_camera(header);
  if (!camera) return camera.error();
  picture.camera = *camera;
  if (ours) {
    const auto kind = index_of(exr::kDepthKinds, attribute<std::string>(header, exr::kDepthKind));
    if (!kind) return because("some of its rilievo attributes are missing or damaged");
    picture.depth_kind = DepthKind(*kind);
  }
  picture.name = attribute<std::string>(header, exr::kName)
                     .value_or(header.hasName() ? header.name() : std::string());

  Imf::InputPart part(file, index);
  read_planes(part, picture);
  if (!ours)
    if (Result<> depth = adopt_foreign_depth(picture); !depth) return depth.error();
  if (Result<> valid = validate(picture); !valid) return because(valid.error().reason);
  return picture;
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

Result<PictureFile> read_parts(Imf::MultiPartInputFile& file, double file_bytes) {
  const auto error = [&](int part, const Error& e) {
    const std::string which = file.parts() > 1 ? "part " + std::to_string(part) + ": " : "";
    return because(which + e.reason);
  };
  // All claims before the first allocation.
  for (int i = 0; i < file.parts(); ++i)
    if (Result<> claims = check_claims(file.header(i), file_bytes); !claims)
      return error(i, claims.error());
  PictureFile out;
  for (int i = 0; i < file.parts(); ++i) {
    Result<DepthImage> picture = read_part(file, i);
    if (!picture) return error(i, picture.error());
    out.pictures.push_back(*std::move(picture));
    out.attributes.pictures.push_back(attributes_of(file.header(i), exr::kPicturePrefix));
  }
  out.attributes.file = attributes_of(file.header(0), exr::kFilePrefix);
  return out;
}

// OpenEXR's messages may have several lines, and name our stream, which has no name to speak of.
std::string one_line(std::string text) {
  constexpr std::string_view kPrefix = "Cannot read image file \"memory\". ";
  if (text.starts_with(kPrefix)) text.erase(0, kPrefix.size());
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

}  // namespace

Result<PictureFile> load_picture_file(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_file(path, kMostBytes);
  if (!bytes) return bytes.error();
  if (Result<> sizes = check_exr_sizes(*bytes); !sizes)
    return Error{path.string(), sizes.error().reason};
  try {
    MemoryStream stream(*bytes);
    Imf::MultiPartInputFile file(stream, 0);
    Result<PictureFile> read = read_parts(file, double(bytes->size()));
    if (!read) return Error{path.string(), read.error().reason};
    return read;
  } catch (const std::exception& failed) {
    return Error{path.string(), "is not a readable OpenEXR file: " + one_line(failed.what())};
  }
}

Result<std::vector<DepthImage>> load_pictures(const std::filesystem::path& path) {
  Result<PictureFile> file = load_picture_file(path);
  if (!file) return file.error();
  return std::move(file->pictures);
}

}  // namespace rilievo
