#include "rilievo/io/exr_header.h"

#include <ImfChannelList.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "rilievo/io/exr_camera.h"
#include "rilievo/io/exr_names.h"

namespace rilievo::exr {
namespace {

template <class To>
To imath_matrix(const glm::dmat4& m) {
  To out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = typename To::BaseType(m[i][j]);
  return out;
}

template <class From>
glm::dmat4 glm_matrix(const From& m) {
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = double(m[i][j]);
  return out;
}

}  // namespace

bool MemoryStream::read(char out[], int count) {
  if (count < 0 || std::uint64_t(count) > bytes_.size() - position_)
    throw std::runtime_error("it ends too early");
  std::memcpy(out, bytes_.data() + position_, std::size_t(count));
  position_ += std::size_t(count);
  return position_ < bytes_.size();
}

void MemoryStream::seekg(uint64_t position) {
  if (position > bytes_.size()) throw std::runtime_error("it ends too early");
  position_ = std::size_t(position);
}

std::string one_line(std::string text) {
  constexpr std::string_view kPrefix = "Cannot read image file \"memory\". ";
  if (text.starts_with(kPrefix)) text.erase(0, kPrefix.size());
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

void MemoryOutput::write(const char bytes[], int count) {
  const std::size_t end = position_ + std::size_t(count);
  if (end > bytes_.size()) bytes_.resize(end);
  std::copy_n(bytes, count, bytes_.begin() + std::ptrdiff_t(position_));
  position_ = end;
}

Size size_of(const Imath::Box2i& box) {
  return {std::int64_t(box.max.x) - box.min.x + 1, std::int64_t(box.max.y) - box.min.y + 1};
}

// DEFLATE, the densest of the codecs in practice, makes of one byte at most 1032. A buffer of lines
// (256 with DWAB, else at most 32) or a tile is allocated even for a part that needs only a piece
// of it.
Result<> check_claims(const Imf::Header& header, double file_bytes) {
  const Size size = size_of(header.dataWindow());
  if (size.width < 1 || size.height < 1) return because("its data window is empty");
  if (size.width > 1 << 16 || size.height > 1 << 16)
    return because("its data window is larger than 65536 texels along a side");
  double texel_bytes = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    texel_bytes += c.channel().type == Imf::HALF ? 2 : 4;
  // How many samples a deep texel has is not known before it is read; that it says, in 4 bytes.
  if (header.hasType() && Imf::isDeepData(header.type())) texel_bytes = 4;
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

glm::vec4 finite_color(glm::vec4 color) {
  for (int c = 0; c < 4; ++c) {
    if (std::isnan(color[c])) color[c] = 0;
    if (std::isinf(color[c])) color[c] = std::copysign(kHalfMax, color[c]);
  }
  return color;
}

void insert_camera(Imf::Header& header, const Camera& camera, const Camera& display,
                   DepthKind depth_kind, const std::string& name) {
  const StandardMatrices standard = standard_matrices(display);
  Imf::addWorldToCamera(header, imath_matrix<Imath::M44f>(standard.camera_from_world));
  Imf::addWorldToNDC(header, imath_matrix<Imath::M44f>(standard.ndc_from_world));

  const ImageWindow& window = camera.window;
  header.insert(kVersionName, Imf::IntAttribute(kVersion));
  header.insert(kName, Imf::StringAttribute(name));
  header.insert(kProjection, Imf::StringAttribute(kProjections.at(std::size_t(camera.projection))));
  header.insert(kDepthKind, Imf::StringAttribute(kDepthKinds.at(std::size_t(depth_kind))));
  header.insert(kWorldFromEye,
                Imf::M44dAttribute(imath_matrix<Imath::M44d>(camera.world_from_eye)));
  header.insert(kWindowMin, Imf::V2dAttribute({window.left, window.bottom}));
  header.insert(kWindowMax, Imf::V2dAttribute({window.right, window.top}));
  header.insert(kSize, Imf::V2iAttribute({camera.width, camera.height}));
  header.insert(kDepthRange, Imf::V2dAttribute({camera.z_near, camera.z_far}));
}

Result<Camera> own_camera(const Imf::Header& header) {
  if (attribute<int>(header, kVersionName) != kVersion)
    return because("was written by another version of Rilievo");
  const auto projection = index_of(kProjections, attribute<std::string>(header, kProjection));
  const auto pose = attribute<Imath::M44d>(header, kWorldFromEye);
  const auto low = attribute<Imath::V2d>(header, kWindowMin);
  const auto high = attribute<Imath::V2d>(header, kWindowMax);
  const auto range = attribute<Imath::V2d>(header, kDepthRange);
  const auto size = attribute<Imath::V2i>(header, kSize);
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

Result<Camera> cropped_camera(const Imf::Header& header, Camera camera) {
  const Imath::Box2i &display = header.displayWindow(), &data = header.dataWindow();
  const Size shown = size_of(display), kept = size_of(data);
  if (shown.width < 1 || shown.height < 1) return because("its display window is empty");
  ImageWindow& w = camera.window;
  const double step_x = (w.right - w.left) / double(shown.width);
  const double step_y = (w.top - w.bottom) / double(shown.height);
  w.left += step_x * (double(data.min.x) - display.min.x);
  w.right = w.left + step_x * double(kept.width);
  w.top -= step_y * (double(data.min.y) - display.min.y);
  w.bottom = w.top - step_y * double(kept.height);
  camera.width = int(kept.width);
  camera.height = int(kept.height);
  return camera;
}

Result<Camera> standard_camera(const Imf::Header& header) {
  const auto view = attribute<Imath::M44f>(header, "worldToCamera");
  const auto ndc = attribute<Imath::M44f>(header, "worldToNDC");
  if (!view || !ndc) return because("has no camera (worldToCamera and worldToNDC)");
  const Result<Camera> camera = camera_from_standard({glm_matrix(*view), glm_matrix(*ndc)});
  if (!camera) return camera;
  return cropped_camera(header, *camera);
}

}  // namespace rilievo::exr
