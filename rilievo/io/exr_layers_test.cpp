#include "rilievo/io/exr_layers.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <map>

#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/exr.h"

namespace rilievo {
namespace {

using Names = std::vector<std::string>;

Imf::ChannelList channels_of(const Names& names) {
  Imf::ChannelList channels;
  for (const std::string& name : names) channels.insert(name, Imf::Channel(Imf::FLOAT));
  return channels;
}

// The names of red and depth, or the error.
std::string found(const Names& names) {
  const Result<exr::PictureChannels> result = exr::picture_channels(channels_of(names));
  return result ? result->color[0] + " " + result->depth : result.error().reason;
}

Names with(Names names, const Names& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

TEST(ExrLayers, the_picture_is_found) {
  const Names plain{"R", "G", "B", "A", "Z"};
  const Names blender{"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
                      "ViewLayer.Combined.A", "ViewLayer.Depth.Z"};
  const Names passes{"ViewLayer.DiffCol.R", "ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B",
                     "ViewLayer.Normal.X",  "ViewLayer.Normal.Y",  "ViewLayer.Normal.Z"};
  const Names composite{"Composite.Combined.R", "Composite.Combined.G", "Composite.Combined.B"};
  EXPECT_EQ(found(plain), "R Z");
  EXPECT_EQ(found(with(plain, blender)), "R Z");
  EXPECT_EQ(found(blender), "ViewLayer.Combined.R ViewLayer.Depth.Z");
  EXPECT_EQ(found(with(with(blender, passes), composite)),
            "ViewLayer.Combined.R ViewLayer.Depth.Z");
  EXPECT_EQ(found({"R", "G", "B", "Depth.Z"}), "R Depth.Z");
  EXPECT_EQ(found({"R", "G", "B", "depth.V", "normal.Z"}), "R depth.V");
  EXPECT_EQ(found({"rgba.R", "rgba.G", "rgba.B", "Z"}), "rgba.R Z");
  EXPECT_EQ(found({"beauty.R", "beauty.G", "beauty.B", "beauty.Z"}), "beauty.R beauty.Z");
  EXPECT_EQ(found({"RenderLayer.Combined.R", "RenderLayer.Combined.G", "RenderLayer.Combined.B",
                   "RenderLayer.Depth.Z", "Other.Combined.R", "Other.Combined.G",
                   "Other.Combined.B", "Other.Depth.Z"}),
            "has several layers with colours and depth, of which one is to be kept: Other., "
            "RenderLayer.");
  EXPECT_EQ(found({"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B",
                   "ViewLayer.Normal.Z"}),
            "has no channel Z; it has ViewLayer.Combined.B, ViewLayer.Combined.G, "
            "ViewLayer.Combined.R, ViewLayer.Normal.Z");
  EXPECT_EQ(found({"Y", "Z"}), "has no channel R; it has Y, Z");
  EXPECT_EQ(found({}), "has no channel R; it has none");
  EXPECT_EQ(found({"a\nb"}), "has no channel R; it has a?b");
  Names many;
  for (int i = 0; i < 30; ++i) many.push_back("a" + std::to_string(10 + i));
  EXPECT_TRUE(found(many).ends_with("a28, a29 and 10 more")) << found(many);
}

// Blender's camera sees nothing: depth 1e10, colour and alpha 0.
TEST(ExrLayers, layers_and_empty_backgrounds_are_read) {
  for (const bool layers : {false, true})
    for (const float background : {1e10f, 65504.0f, 1e30f}) {
      const TemporaryFolder folder;
      Imf::Header header(8, 6);
      Imf::addWorldToCamera(header, Imath::M44f());
      Imf::addWorldToNDC(
          header, Imath::M44f(1, 0, 0, 0, 0, 1, 0, 0, -0.5f, -0.5f, -1.001f, -1, 0, 0, -0.1f, 0));
      const std::string color = layers ? "ViewLayer.Combined." : "";
      const std::string depth = layers ? "ViewLayer.Depth.Z" : "Z";
      std::map<std::string, std::vector<float>> planes;
      for (const char* channel : {"R", "G", "B", "A"}) planes[color + channel].assign(48, 0.0f);
      planes[depth].assign(48, background);
      for (int i = 0; i < 24; ++i) {
        for (auto& [name, plane] : planes) plane[std::size_t(i)] = name == depth ? 2.0f : 1.0f;
        planes[color + "G"][std::size_t(i)] = 0.25f;
      }
      Imf::FrameBuffer buffer;
      for (auto& [name, plane] : planes) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), header.dataWindow()));
      }
      {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(6);
      }
      const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "a.exr");
      ASSERT_TRUE(loaded) << loaded.error().message();
      const DepthImage& picture = loaded->front();
      for (int i = 0; i < 48; ++i) EXPECT_EQ(picture.covered(i % 8, i / 8), i < 24);
      EXPECT_EQ(picture.color(0, 0), glm::vec4(1, 0.25f, 1, 1));
      EXPECT_LT(picture.camera.z_far, 2.1);
    }
}

}  // namespace
}  // namespace rilievo
