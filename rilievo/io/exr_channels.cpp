#include "rilievo/io/exr_channels.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "rilievo/core/file.h"
#include "rilievo/io/exr_header.h"
#include "rilievo/io/exr_layers.h"
#include "rilievo/io/exr_sizes.h"

namespace rilievo {
namespace {

constexpr std::uint64_t kMaxPictureBytes = std::uint64_t(1) << 32;

}  // namespace

Result<std::vector<Image<float>>> load_exr_channels(const std::filesystem::path& path,
                                                    std::span<const std::string> names) {
  const auto error = [&](const std::string& reason) { return Error{path.string(), reason}; };
  const Result<std::string> bytes = read_file(path, kMaxPictureBytes);
  if (!bytes) return bytes.error();
  if (Result<> sizes = check_exr_sizes(*bytes); !sizes) return error(sizes.error().reason);
  try {
    exr::MemoryStream stream(*bytes);
    Imf::InputFile file(stream, 0);
    const Imf::Header& header = file.header();
    if (header.hasType() && Imf::isDeepData(header.type())) return error("is a deep image");
    // A channel's floats take at most twice what it claims, which may be halfs.
    if (Result<> claims = exr::check_claims(header, double(bytes->size())); !claims)
      return error(claims.error().reason);
    const Imath::Box2i window = header.dataWindow();
    const exr::Size size = exr::size_of(window);
    std::vector<Image<float>> planes;
    Imf::FrameBuffer buffer;
    planes.reserve(names.size());
    for (const std::string& name : names) {
      const Imf::Channel* channel = header.channels().findChannel(name);
      if (!channel) return error("has no channel " + name + exr::but_it_has(header.channels()));
      if (channel->xSampling != 1 || channel->ySampling != 1)
        return error("channel " + name + " is sub-sampled");
      planes.emplace_back(int(size.width), int(size.height));
      if (!buffer.findSlice(name))
        buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, planes.back().texels().data(), window));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    // A channel that is asked for twice has been read once.
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto first = std::find(names.begin(), names.end(), names[i]) - names.begin();
      if (std::size_t(first) < i) planes[i] = planes[std::size_t(first)];
    }
    return planes;
  } catch (const std::exception& failed) {
    return error(failed.what());
  }
}

Result<> save_exr_channels(const std::filesystem::path& path, std::span<const std::string> names,
                           std::span<const Image<float>> planes) {
  RILIEVO_EXPECTS_EQ(names.size(), planes.size());
  RILIEVO_EXPECTS(!planes.empty());
  const int width = planes[0].width(), height = planes[0].height();
  exr::MemoryOutput stream;
  try {
    Imf::Header header(width, height);
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < names.size(); ++i) {
      header.channels().insert(names[i], Imf::Channel(Imf::FLOAT));
      buffer.insert(names[i],
                    Imf::Slice::Make(Imf::FLOAT, planes[i].texels().data(), header.dataWindow()));
    }
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  } catch (const std::exception& failed) {
    return Error{path.string(), failed.what()};
  }
  return write_file(path, stream.bytes());
}

}  // namespace rilievo
