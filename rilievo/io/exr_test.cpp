#include "rilievo/io/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/exr_camera.h"
#include "rilievo/io/exr_channels.h"
#include "rilievo/io/io_test_helpers.h"

namespace rilievo {
namespace {

TEST(Exr, pictures_come_back_bit_for_bit) {
  const TemporaryFolder folder;
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::vector<DepthImage> pictures;
    for (unsigned i = 0; i <= seed % 4; ++i)
      pictures.push_back(random_picture(seed * 7 + i, 1 + int(seed * 5 % 50), 1 + int(i * 13)));
    const Result<> saved = save_pictures(folder / "a.exr", pictures);
    ASSERT_TRUE(saved.ok()) << saved.error().message();
    const Result<std::vector<DepthImage>> back = load_pictures(folder / "a.exr");
    ASSERT_TRUE(back.ok()) << back.error().message();
    ASSERT_EQ(back->size(), pictures.size());
    for (std::size_t i = 0; i < pictures.size(); ++i) expect_same(pictures[i], (*back)[i]);
  }
}

TEST(Exr, the_same_pictures_are_the_same_bytes) {
  const TemporaryFolder folder;
  const DepthImage picture = random_picture(4, 40, 30);
  const auto bytes = [&](const char* name) {
    EXPECT_TRUE(save_pictures(folder / name, {&picture, 1}).ok());
    std::ifstream in(folder / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(bytes("a.exr"), bytes("b.exr"));
}

TEST(Exr, saving_rounds_colours_to_the_nearest_half_once) {
  const TemporaryFolder folder;
  DepthImage picture = random_picture(3, 2, 1);
  picture.color(0, 0) = {0.1f, 1e9f, -1e9f, 2049.0f};
  picture.color(1, 0) = {0.0f, 1e-9f, 65504.0f, 1.0f};
  ASSERT_TRUE(save_pictures(folder / "a.exr", {&picture, 1}).ok());
  const Result<std::vector<DepthImage>> once = load_pictures(folder / "a.exr");
  ASSERT_TRUE(once.ok());
  // 2049 lies between the halfs 2048 and 2050: to even.
  EXPECT_EQ((*once)[0].color(0, 0), glm::vec4(half(0.1f), 65504.0f, -65504.0f, 2048.0f));
  EXPECT_EQ((*once)[0].color(1, 0), glm::vec4(0.0f, 0.0f, 65504.0f, 1.0f));
  ASSERT_TRUE(save_pictures(folder / "b.exr", *once).ok());
  const Result<std::vector<DepthImage>> twice = load_pictures(folder / "b.exr");
  ASSERT_TRUE(twice.ok());
  expect_same((*once)[0], (*twice)[0]);
}

TEST(Exr, attributes_of_file_and_pictures_come_back) {
  const TemporaryFolder folder;
  const std::vector<DepthImage> pictures = {random_picture(0, 4, 4), random_picture(1, 3, 5)};
  const FileAttributes attributes{{{"kind", "some-kind"}, {"empty", ""}},
                                  {{{"direction", "0 1 0"}}, {{"a.b/c", "line\nline"}}}};
  ASSERT_TRUE(save_pictures(folder / "a.exr", pictures, attributes).ok());
  const Result<PictureFile> back = load_picture_file(folder / "a.exr");
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->attributes.file, attributes.file);
  EXPECT_EQ(back->attributes.pictures, attributes.pictures);
  for (const std::string& key : {std::string(), std::string("a b"), std::string(201, 'k')})
    EXPECT_FALSE(save_pictures(folder / "b.exr", pictures, {{{key, "value"}}, {}}).ok());
}

TEST(Exr, parts_have_unique_names_and_pictures_keep_theirs) {
  const TemporaryFolder folder;
  std::vector<DepthImage> pictures(4, random_picture(2, 3, 3));
  pictures[0].name = pictures[1].name = "tree";
  pictures[2].name = "tree.2";
  pictures[3].name = "";
  ASSERT_TRUE(save_pictures(folder / "a.exr", pictures).ok());
  const Result<std::vector<DepthImage>> back = load_pictures(folder / "a.exr");
  ASSERT_TRUE(back.ok()) << back.error().message();
  for (int i = 0; i < 4; ++i) EXPECT_EQ((*back)[i].name, pictures[i].name);
}

TEST(Exr, saving_refuses_invalid_pictures) {
  const TemporaryFolder folder;
  EXPECT_FALSE(save_pictures(folder / "a.exr", {}).ok());
  DepthImage picture = random_picture(1, 4, 4);
  picture.depth(2, 2) = std::nanf("");
  EXPECT_FALSE(save_pictures(folder / "a.exr", {&picture, 1}).ok());
  picture = random_picture(1, 4, 4);
  picture.camera.width = 5;
  EXPECT_FALSE(save_pictures(folder / "a.exr", {&picture, 1}).ok());
  EXPECT_FALSE(std::filesystem::exists(folder / "a.exr"));
}

// OpenEXR's own arithmetic (row vectors times Imath matrices) on what is in the file, against the
// definition of the two attributes.
TEST(Exr, standard_matrices_mean_what_openexr_says) {
  const TemporaryFolder folder;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0, 1);
  for (unsigned seed = 0; seed < 60; ++seed) {
    // The display window is 80 x 60: as wide as one picture, as high as the other.
    const std::vector<DepthImage> pictures = {random_picture(seed, 64, 60),
                                              random_picture(seed + 100, 80, 40)};
    ASSERT_TRUE(save_pictures(folder / "a.exr", pictures).ok());
    const Imf::MultiPartInputFile file((folder / "a.exr").c_str());
    const Camera& camera = pictures[seed % 2].camera;
    const Imath::M44f view = Imf::worldToCamera(file.header(int(seed % 2)));
    const Imath::M44f to_ndc = Imf::worldToNDC(file.header(int(seed % 2)));
    for (int i = 0; i < 20; ++i) {
      const glm::dvec2 raster{u(rng) * camera.width, u(rng) * camera.height};
      const double eye_z = 1 + 10 * u(rng);
      const glm::dvec3 p = world_from_raster(camera, raster, eye_z);
      const Imath::V3f world{float(p.x), float(p.y), float(p.z)};
      Imath::V3f seen, ndc;
      view.multVecMatrix(world, seen);
      to_ndc.multVecMatrix(world, ndc);
      // Floats of 20 m, over distances of at least 1 m: some 1e-5.
      EXPECT_NEAR(seen.z, eye_z, 2e-5);
      EXPECT_NEAR(ndc.x, raster.x / 80, 1e-4);
      EXPECT_NEAR(ndc.y, raster.y / 60, 1e-4);
      EXPECT_NEAR(ndc.z, depth_from_eye_z(DepthKind::window_z, eye_z, camera, raster), 1e-4);
      const glm::dvec3 eye = glm::dvec3(eye_from_world(camera) * glm::dvec4(p, 1));
      EXPECT_NEAR(seen.x, eye.x, 2e-5);
      EXPECT_NEAR(seen.y, eye.y, 2e-5);
    }
  }
}

glm::dmat4 through_floats(const glm::dmat4& m) { return glm::dmat4(glm::mat4(m)); }

// Both cameras see every point at the same place.
void expect_same_view(const Camera& a, const Camera& b, double tolerance_px) {
  for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0.3, 1)})
    for (double eye_z : {1.0, 7.0}) {
      const glm::dvec2 raster = corner * glm::dvec2(a.width, a.height);
      const glm::dvec3 seen = raster_from_world(b, world_from_raster(a, raster, eye_z));
      EXPECT_NEAR(seen.x, raster.x, tolerance_px);
      EXPECT_NEAR(seen.y, raster.y, tolerance_px);
      EXPECT_NEAR(seen.z, eye_z, 1e-4);
    }
}

TEST(ExrCamera, comes_back_from_the_standard_matrices) {
  std::mt19937 rng(6);
  for (int i = 0; i < 300; ++i) {
    Camera camera = random_camera(rng, 100, 80);
    if (camera.keeps_farthest()) camera.projection = Projection::perspective;
    StandardMatrices m = standard_matrices(camera);
    // The deviations that are recognised: RenderMan's screen (-1 to 1, y up), and eye space.
    const bool screen = i % 2, eye_space = i / 2 % 2;
    if (screen) m.ndc_from_world = clip_from_world(camera);
    if (eye_space) m.camera_from_world = eye_from_world(camera);
    m = {through_floats(m.camera_from_world), through_floats(m.ndc_from_world)};
    Result<Camera> back = camera_from_standard(m);
    ASSERT_TRUE(back.ok()) << back.error().reason << " " << i;
    back->width = 100, back->height = 80;
    EXPECT_EQ(back->projection, camera.projection);
    EXPECT_TRUE(validate(*back).ok());
    // Matrices in floats, eyes 30 m away from the world's origin: 1e-6 of 100 texels and of 30 m.
    expect_same_view(camera, *back, 1e-2);
  }
}

TEST(ExrCamera, refuses_matrices_that_are_no_camera) {
  std::mt19937 rng(7);
  Camera camera = random_camera(rng, 10, 10);
  camera.projection = Projection::perspective;
  const StandardMatrices good = standard_matrices(camera);
  ASSERT_TRUE(camera_from_standard(good).ok());
  const auto reason = [&](const std::function<void(StandardMatrices&)>& spoil) {
    StandardMatrices m = good;
    spoil(m);
    const Result<Camera> c = camera_from_standard(m);
    return c.ok() ? std::string() : c.error().reason;
  };
  using M = StandardMatrices;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason([&](M& m) { m.camera_from_world[1][2] = nan; }), "");
  EXPECT_NE(reason([&](M& m) { m.ndc_from_world[3][0] = nan; }), "");
  EXPECT_NE(reason([](M& m) { m.camera_from_world *= 2.0; }), "");
  EXPECT_NE(reason([](M& m) { m.camera_from_world[0] *= 2.0; }), "");
  EXPECT_NE(reason([](M& m) { m.camera_from_world = glm::dmat4(0.0); }), "");
  EXPECT_NE(reason([](M& m) { m.ndc_from_world = glm::dmat4(0.0); }), "");
  EXPECT_NE(reason([](M& m) { m.ndc_from_world = glm::dmat4(1.0); }), "");
  EXPECT_NE(reason([](M& m) { std::swap(m.ndc_from_world, m.camera_from_world); }), "");
  EXPECT_NE(reason([](M& m) { m.ndc_from_world = glm::transpose(m.ndc_from_world); }), "");
  EXPECT_NE(reason([](M& m) { m.camera_from_world = glm::transpose(m.camera_from_world); }), "");
  // The pose of another eye, and a mirrored world.
  EXPECT_NE(reason([](M& m) { m.camera_from_world[3].x += 1.0; }), "");
  EXPECT_NE(reason([](M& m) {
              glm::dmat4 mirror(1.0);
              mirror[0][0] = -1;
              m.camera_from_world = m.camera_from_world * mirror;
              m.ndc_from_world = m.ndc_from_world * mirror;
            }),
            "");
}

// A foreign file: what `edit` leaves of a plain RGBAZ image with the standard matrices.
struct Foreign {
  Imf::Header header{8, 6};
  std::vector<float> z = std::vector<float>(48, 5.0f);
  std::vector<float> rgb = std::vector<float>(48, 0.5f);
  Imf::PixelType z_type = Imf::FLOAT;

  explicit Foreign(const Camera& camera) {
    for (const char* c : {"R", "G", "B", "A"}) header.channels().insert(c, Imf::Channel(Imf::HALF));
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    set_camera(standard_matrices(camera));
  }
  void set_camera(const StandardMatrices& m) {
    Imath::M44f view, ndc;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        view[i][j] = float(m.camera_from_world[i][j]);
        ndc[i][j] = float(m.ndc_from_world[i][j]);
      }
    Imf::addWorldToCamera(header, view);
    Imf::addWorldToNDC(header, ndc);
  }
  Imf::FrameBuffer planes(std::vector<half>& halfs) const {
    const Imath::Box2i window = header.dataWindow();
    halfs.assign(48, half(0.5f));
    Imf::FrameBuffer out;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      const bool small = c.channel().type == Imf::HALF;
      const void* data = small ? static_cast<const void*>(halfs.data())
                         : std::string_view(c.name()) == "Z" ? static_cast<const void*>(z.data())
                                                             : static_cast<const void*>(rgb.data());
      out.insert(c.name(), Imf::Slice::Make(c.channel().type, data, window, 0, 0,
                                            c.channel().xSampling, c.channel().ySampling));
    }
    return out;
  }
  void save(const std::filesystem::path& path) const {
    std::vector<half> halfs;
    const Imf::FrameBuffer buffer = planes(halfs);
    if (header.hasTileDescription()) {
      Imf::TiledOutputFile file(path.c_str(), header);
      file.setFrameBuffer(buffer);
      // Every level from the same memory: only the base level is looked at.
      for (int l = 0; l < file.numLevels(); ++l)
        file.writeTiles(0, file.numXTiles(l) - 1, 0, file.numYTiles(l) - 1, l);
    } else {
      Imf::OutputFile file(path.c_str(), header);
      file.setFrameBuffer(buffer);
      const Imath::Box2i window = header.dataWindow();
      file.writePixels(window.max.y - window.min.y + 1);
    }
  }
};

Camera foreign_camera() { return look_at({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 0.8, 8, 6, 0.1, 100); }

TEST(ExrForeign, an_ordinary_render_with_depth_and_matrices_loads) {
  const TemporaryFolder folder;
  Foreign foreign(foreign_camera());
  foreign.z[0] = 2.0f, foreign.z[1] = 9.0f;
  foreign.z[2] = 0.0f, foreign.z[3] = 1e30f, foreign.z[4] = kNoDepth;
  foreign.save(folder / "a.exr");
  const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "a.exr");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const DepthImage& p = loaded->front();
  EXPECT_TRUE(validate(p).ok());
  EXPECT_EQ(p.depth_kind, DepthKind::eye_z);
  EXPECT_EQ(p.depth(1, 0), 9.0f);
  EXPECT_EQ(p.color(1, 0), glm::vec4(0.5f));
  for (int x = 2; x < 5; ++x) {
    EXPECT_FALSE(p.covered(x, 0));
    EXPECT_EQ(p.color(x, 0), glm::vec4(0.0f));
  }
  EXPECT_LT(p.camera.z_near, 2.0);
  EXPECT_GT(p.camera.z_far, 9.0);
  expect_same_view(foreign_camera(), p.camera, 1e-3);
}

TEST(ExrForeign, colours_that_are_not_finite_are_made_finite) {
  const TemporaryFolder folder;
  Foreign foreign(foreign_camera());
  foreign.header.channels().insert("R", Imf::Channel(Imf::FLOAT));
  foreign.rgb[3] = kNoDepth, foreign.rgb[4] = -kNoDepth, foreign.rgb[5] = std::nanf("");
  foreign.rgb[6] = 1e30f;
  foreign.save(folder / "a.exr");
  const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "a.exr");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const ColorImage& color = loaded->front().color;
  EXPECT_EQ(color(3, 0), glm::vec4(65504, 0.5f, 0.5f, 0.5f));
  EXPECT_EQ(color(4, 0), glm::vec4(-65504, 0.5f, 0.5f, 0.5f));
  EXPECT_EQ(color(5, 0), glm::vec4(0, 0.5f, 0.5f, 0.5f));
  EXPECT_EQ(color(6, 0), glm::vec4(1e30f, 0.5f, 0.5f, 0.5f));
}

TEST(ExrForeign, tiles_mipmaps_missing_alpha_and_half_depth_load) {
  const TemporaryFolder folder;
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
    Foreign foreign(foreign_camera());
    for (int i = 0; i < 48; ++i) foreign.z[i] = float(1 + i);
    foreign.header.setTileDescription({4, 4, mode});
    foreign.save(folder / "tiled.exr");
    const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "tiled.exr");
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    for (int i = 0; i < 48; ++i) EXPECT_EQ(loaded->front().depth(i % 8, i / 8), float(1 + i));
  }
  Foreign foreign(foreign_camera());
  foreign.header.channels() = {};
  for (const char* c : {"R", "G", "B", "Z"})
    foreign.header.channels().insert(c, Imf::Channel(Imf::HALF));
  foreign.save(folder / "rgbz.exr");
  const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "rgbz.exr");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->front().color(3, 3), glm::vec4(0.5f, 0.5f, 0.5f, 1.0f));
  EXPECT_EQ(loaded->front().depth(3, 3), 0.5f);
}

TEST(ExrForeign, a_data_window_is_a_crop_of_the_display_windows_camera) {
  const TemporaryFolder folder;
  for (const Imath::V2i& origin : {Imath::V2i(0, 0), Imath::V2i(5, 3), Imath::V2i(-4, -2)}) {
    // The display window is 20 x 10 at `shown`; the data window 8 x 6 at `origin`, also outside.
    const Imath::V2i shown(-1, 1);
    Camera whole = foreign_camera();
    whole.width = 20, whole.height = 10;
    Foreign foreign(whole);
    foreign.header.displayWindow() = {shown, shown + Imath::V2i(19, 9)};
    foreign.header.dataWindow() = {origin, origin + Imath::V2i(7, 5)};
    foreign.save(folder / "a.exr");
    const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "a.exr");
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    const Camera& part = loaded->front().camera;
    EXPECT_EQ(part.width, 8);
    for (const glm::dvec2 raster : {glm::dvec2(0, 0), glm::dvec2(7.5, 2)}) {
      const glm::dvec3 p = world_from_raster(part, raster, 4.0);
      const glm::dvec3 seen = raster_from_world(whole, p);
      EXPECT_NEAR(seen.x, raster.x + origin.x - shown.x, 1e-4);
      EXPECT_NEAR(seen.y, raster.y + origin.y - shown.y, 1e-4);
    }
  }
}

TEST(ExrForeign, what_is_missing_or_wrong_is_named) {
  const TemporaryFolder folder;
  const auto reason = [&](const std::function<void(Foreign&)>& spoil) {
    Foreign foreign(foreign_camera());
    spoil(foreign);
    foreign.save(folder / "a.exr");
    const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "a.exr");
    if (loaded.ok()) return std::string();
    EXPECT_EQ(loaded.error().where, (folder / "a.exr").string());
    return loaded.error().reason;
  };
  const auto without = [](const char* gone) {
    return [gone](Foreign& f) {
      Imf::ChannelList kept;
      for (auto c = f.header.channels().begin(); c != f.header.channels().end(); ++c)
        if (std::string_view(c.name()) != gone) kept.insert(c.name(), c.channel());
      f.header.channels() = kept;
    };
  };
  EXPECT_EQ(reason([](Foreign&) {}), "");
  EXPECT_EQ(reason(without("Z")), "has no channel Z; it has A, B, G, R");
  EXPECT_EQ(reason(without("R")), "has no channel R; it has A, B, G, Z");
  EXPECT_EQ(reason([](Foreign& f) {
              // Header::erase leaks.
              const Imf::ChannelList channels = f.header.channels();
              f.header = Imf::Header(8, 6);
              f.header.channels() = channels;
            }),
            "has no camera (worldToCamera and worldToNDC)");
  EXPECT_EQ(reason([](Foreign& f) { f.z[17] = std::nanf(""); }), "a depth is not a number");
  EXPECT_EQ(reason([](Foreign& f) { f.z[17] = -1.0f; }), "a depth is negative");
  EXPECT_NE(reason([](Foreign& f) { f.set_camera({glm::dmat4(0.0), glm::dmat4(0.0)}); }), "");
  EXPECT_EQ(
      reason([](Foreign& f) { f.header.channels().insert("B", Imf::Channel(Imf::HALF, 2, 2)); }),
      "channel B is sub-sampled");
}

TEST(ExrForeign, a_claim_of_too_many_texels_is_refused_before_they_are_allocated) {
  const TemporaryFolder folder;
  Foreign(foreign_camera()).save(folder / "a.exr");
  std::ifstream in(folder / "a.exr", std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  // dataWindow (box2i, 16 bytes): its maximum becomes 16 millions along both sides.
  const std::string key = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  for (std::size_t i = 0; i < 2; ++i)
    bytes.replace(at + key.size() + 8 + 4 * i, 4, std::string("\xFE\xFF\xFF\0", 4));
  std::ofstream(folder / "b.exr", std::ios::binary) << bytes;
  const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "b.exr");
  ASSERT_FALSE(loaded.ok());
}

// Five planes of 65536 x 6 texels, of a file of less than a kilobyte.
TEST(ExrChannels, a_claim_counts_every_channel) {
  const TemporaryFolder folder;
  Foreign(foreign_camera()).save(folder / "a.exr");
  const std::string names[] = {"R", "G", "B", "A", "Z"};
  EXPECT_TRUE(load_exr_channels(folder / "a.exr", names).ok());
  std::string bytes = *read_file(folder / "a.exr", 1 << 24);
  const std::string key = std::string("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + key.size() + 8, 4, std::string("\xFF\xFF\0\0", 4));
  ASSERT_TRUE(write_file(folder / "b.exr", bytes).ok());
  const Result<std::vector<Image<float>>> loaded = load_exr_channels(folder / "b.exr", names);
  ASSERT_FALSE(loaded.ok());
  EXPECT_EQ(loaded.error().reason, "claims 65536 x 6 texels, more than its bytes can hold");
}

// OpenEXR reads as many bytes as the type has: it would take the byte too many for the next name.
TEST(ExrForeign, an_attribute_of_another_size_than_its_type_is_refused) {
  const TemporaryFolder folder;
  Foreign(foreign_camera()).save(folder / "a.exr");
  const std::string whole = *read_file(folder / "a.exr", 1 << 24);
  ASSERT_TRUE(load_pictures(folder / "a.exr").ok());
  for (const std::string_view name : {"channels", "compression", "dataWindow", "lineOrder",
                                      "pixelAspectRatio", "screenWindowCenter"}) {
    const std::size_t at = whole.find(std::string(name) + '\0');
    ASSERT_NE(at, std::string::npos) << name;
    const std::size_t size = whole.find('\0', at + name.size() + 1) + 1;
    for (const int more : {-1, 1}) {
      std::string bytes = whole;
      bytes[size] = char(bytes[size] + more);
      if (more > 0)
        bytes.insert(size + 4, 1, '\0');
      else
        bytes.erase(size + 4, 1);
      ASSERT_TRUE(write_file(folder / "b.exr", bytes).ok());
      const Result<std::vector<DepthImage>> loaded = load_pictures(folder / "b.exr");
      ASSERT_FALSE(loaded.ok()) << name << more;
      EXPECT_NE(loaded.error().reason.find("another size than its type"), std::string::npos)
          << loaded.error().message();
    }
  }
}

}  // namespace
}  // namespace rilievo
