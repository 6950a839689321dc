// The files that a scene refers to: where they may lie, and that each is read once.
#include <gtest/gtest.h>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/png_test_helpers.h"
#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::GltfBuilder;

constexpr char kCorners[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";

// A folder with a model's folder in it, and a secret beside that.
struct Folders {
  TemporaryFolder top;
  fs::path model = top / "model";

  Folders() { fs::create_directory(model); }
  void write(const fs::path& file, const std::string& text) const {
    ASSERT_TRUE(write_file(file, text).ok());
  }
};

// The smallest .gltf whose buffer is `uri`, 36 bytes.
std::string gltf_with_buffer(const std::string& uri) {
  GltfBuilder b = test::triangle();
  json j = b.json;
  j["buffers"] = {{{"byteLength", b.bin.size()}, {"uri", uri}}};
  return j.dump();
}

std::string reason_of_file(const fs::path& file, bool allow_outside = false) {
  LoadOptions options;
  options.allow_outside = allow_outside;
  const Result<LoadedScene> loaded = load_scene(file, options);
  if (!loaded) return loaded.error().reason;
  return loaded->warnings.empty() ? "ok" : loaded->warnings[0];
}

TEST(Neighbors, a_buffer_outside_of_the_folder_is_read_only_when_allowed) {
  const Folders f;
  const std::string bin = test::triangle().bin;
  f.write(f.top / "out.bin", bin);
  f.write(f.model / "in.bin", bin);
  fs::create_directory(f.model / "sub");
  f.write(f.model / "sub" / "deep.bin", bin);
  fs::create_symlink("../out.bin", f.model / "link.bin");
  fs::create_symlink("in.bin", f.model / "near.bin");
  fs::create_directory_symlink("..", f.model / "up");
  const auto why = [&](const std::string& uri, bool allowed = false) {
    f.write(f.model / "a.gltf", gltf_with_buffer(uri));
    return reason_of_file(f.model / "a.gltf", allowed);
  };
  for (const std::string& inside : std::vector<std::string>{
           "in.bin", "./in.bin", "sub/deep.bin", "sub/../in.bin", "near.bin", "../model/in.bin"})
    EXPECT_EQ(why(inside), "ok") << inside;
  EXPECT_EQ(why((f.model / "in.bin").string()), "ok");
  for (const std::string& outside :
       std::vector<std::string>{"../out.bin", "sub/../../out.bin", "link.bin", "up/out.bin",
                                (f.top / "out.bin").string()}) {
    EXPECT_EQ(why(outside), "buffers[0] refers to '" + outside +
                                "', which is outside of the scene's folder (--allow-outside reads "
                                "it)");
    EXPECT_EQ(why(outside, true), "ok") << outside;
  }
  // A name that begins alike is another folder.
  fs::create_directory(f.top / "model2");
  f.write(f.top / "model2" / "out.bin", bin);
  EXPECT_NE(why("../model2/out.bin").find("outside"), std::string::npos);
}

TEST(Neighbors, a_library_outside_of_the_folder_is_left_out) {
  const Folders f;
  f.write(f.top / "secret.mtl", "newmtl secret\nKd 1 0 0\n");
  f.write(f.model / "a.obj",
          "mtllib ../secret.mtl\n" + std::string(kCorners) + "usemtl secret\nf 1 2 3\n");
  EXPECT_EQ(reason_of_file(f.model / "a.obj"),
            "the material library is left out: refers to '../secret.mtl', which is outside of the "
            "scene's folder (--allow-outside reads it)");
  EXPECT_EQ(reason_of_file(f.model / "a.obj", true), "ok");
}

// 60 textures of one picture: by its name, by other names of it, by a view, and as bytes of the
// document.
TEST(Neighbors, one_picture_is_decoded_once_for_all_textures) {
  const Folders f;
  const std::string png = test_png::rgba8_png(Rgba8Image(9, 5, glm::u8vec4(1, 2, 3, 4)));
  f.write(f.model / "p.png", png);
  fs::create_symlink("p.png", f.model / "q.png");
  GltfBuilder b = test::triangle();
  const int view = b.view(png);
  std::vector<json> ways = {
      {{"uri", "p.png"}},     {{"uri", "./p.png"}},
      {{"uri", "q.png"}},     {{"uri", "%70.png"}},
      {{"bufferView", view}}, {{"uri", "data:image/png;base64,iVBORw0KGgo="}}};
  b.json["samplers"] = {json::object(), {{"wrapS", 33071}}, {{"magFilter", 9728}}};
  const json primitive = b.json["meshes"][0]["primitives"][0];
  b.json["meshes"][0]["primitives"] = json::array();
  for (int i = 0; i < 60; ++i) {
    b.json["images"].push_back(ways[std::size_t(i) % ways.size()]);
    b.json["textures"].push_back({{"source", i}, {"sampler", i % 3}});
    b.json["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    json each = primitive;
    each["material"] = i;
    b.json["meshes"][0]["primitives"].push_back(each);
  }
  f.write(f.model / "a.glb", b.glb());
  const Result<LoadedScene> loaded = load_scene(f.model / "a.glb");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Scene& scene = loaded->scene;
  ASSERT_EQ(scene.images.size(), 2u);  // the file and the view
  EXPECT_EQ(scene.images[0], scene.images[1]);
  EXPECT_EQ(scene.images[0](0, 0), glm::u8vec4(1, 2, 3, 4));
  // Four of the ways lead to the file, with three samplers; one to the view, always with one.
  EXPECT_EQ(scene.textures.size(), 4u);
  EXPECT_EQ(loaded->warnings.size(), 1u);  // the bytes that are no picture, told once
  for (int i = 0; i < 60; ++i) {
    const int texture = scene.materials[std::size_t(i)].base_color_texture.texture;
    if (i % 6 == 5) {
      EXPECT_EQ(texture, -1);
      continue;
    }
    const Texture& t = scene.textures.at(std::size_t(texture));
    EXPECT_EQ(t.wrap_u, i % 3 == 1 ? Wrap::clamp_to_edge : Wrap::repeat);
    EXPECT_EQ(t.nearest, i % 3 == 2);
  }
}

TEST(Neighbors, materials_of_an_obj_share_pictures) {
  const Folders f;
  f.write(f.model / "p.png", test_png::rgba8_png(Rgba8Image(3, 3, glm::u8vec4(9, 8, 7, 255))));
  f.write(f.model / "o.png",
          test_png::rgba8_png(Rgba8Image(1, 1, glm::u8vec4(128, 128, 128, 255))));
  std::string mtl, obj = "mtllib m.mtl\n" + std::string(kCorners);
  const char* const names[] = {"p.png", "./p.png", "-clamp on p.png", ".//p.png"};
  for (int i = 0; i < 40; ++i) {
    const std::string name = "m" + std::to_string(i);
    mtl += "newmtl " + name + "\nmap_Kd " + names[i % 4] + "\n";
    if (i % 2) mtl += std::string("map_d ") + (i % 4 == 1 ? "o.png" : "./o.png") + "\n";
    obj += "usemtl " + name + "\nf 1/1 2/1 3/1\n";
  }
  f.write(f.model / "m.mtl", mtl);
  f.write(f.model / "a.obj", obj);
  const Result<LoadedScene> loaded = load_scene(f.model / "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->warnings.size(), 0u);
  const Scene& scene = loaded->scene;
  ASSERT_EQ(scene.images.size(), 2u);  // plain, and with opacity; o.png went into it
  EXPECT_EQ(scene.textures.size(), 3u);
  for (std::size_t i = 0; i < 40; ++i) {
    const Material& m = scene.materials[i];
    const Texture& t = scene.textures.at(std::size_t(m.base_color_texture.texture));
    EXPECT_EQ(scene.images.at(std::size_t(t.image))(1, 1), glm::u8vec4(9, 8, 7, i % 2 ? 128 : 255));
    EXPECT_EQ(t.wrap_u, i % 4 == 2 ? Wrap::clamp_to_edge : Wrap::repeat);
    EXPECT_EQ(m.alpha_mode, i % 2 ? AlphaMode::blend : AlphaMode::opaque);
  }
}

// A library in a folder of its own, beside pictures, in which some exporters count from the model.
TEST(Neighbors, pictures_of_a_library_lie_beside_it_or_beside_the_model) {
  const Folders f;
  fs::create_directory(f.model / "sub");
  const auto picture = [&](const fs::path& file, std::uint8_t red) {
    f.write(file, test_png::rgba8_png(Rgba8Image(1, 1, glm::u8vec4(red, 0, 0, 255))));
  };
  picture(f.top / "out.png", 1);
  picture(f.model / "p.png", 2);
  picture(f.model / "q.png", 3);
  picture(f.model / "sub" / "p.png", 4);
  const auto red_of = [&](const std::string& name, const std::string& library, bool allowed) {
    f.write(f.model / "sub" / "m.mtl", "newmtl m\nmap_Kd " + name + "\n");
    f.write(f.model / "a.obj",
            "mtllib " + library + "\n" + std::string(kCorners) + "usemtl m\nf 1/1 2/1 3/1\n");
    LoadOptions options;
    options.allow_outside = allowed;
    const Result<LoadedScene> loaded = load_scene(f.model / "a.obj", options);
    if (!loaded.ok()) return -1;
    return loaded->scene.images.empty() ? 0 : int(loaded->scene.images[0](0, 0).r);
  };
  for (const std::string library : {"sub/m.mtl", "sub\\m.mtl"}) {
    EXPECT_EQ(red_of("p.png", library, false), 4);
    EXPECT_EQ(red_of("sub/p.png", library, false), 4);
    EXPECT_EQ(red_of("../p.png", library, false), 2);
    EXPECT_EQ(red_of("q.png", library, false), 3);
    EXPECT_EQ(red_of("../../out.png", library, false), 0);
    EXPECT_EQ(red_of("../../out.png", library, true), 1);
    EXPECT_EQ(red_of("../out.png", library, false), 0);
    EXPECT_EQ(red_of("../out.png", library, true), 1);
  }
}

// The limit is reached where the library, which is the file itself, is read a tenth time.
TEST(Neighbors, a_library_is_read_once_whatever_its_name) {
  const Folders f;
  std::string obj = kCorners;
  for (int i = 0; i < 200; ++i) obj += "mtllib ./" + std::string(i, '/') + "a.obj\n";
  for (int i = 0; i < 200; ++i) obj += "mtllib a.obj\n";
  obj += "f 1 2 3\n" + std::string(100000, '#') + "\n";
  f.write(f.model / "a.obj", obj);
  LoadOptions options;
  options.max_bytes = 10 * obj.size();
  const Result<LoadedScene> loaded = load_scene(f.model / "a.obj", options);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->warnings.size(), 0u) << loaded->warnings[0];
}

TEST(Neighbors, buffers_of_one_file_read_it_once) {
  const Folders f;
  GltfBuilder b = test::triangle();
  f.write(f.model / "a.bin", b.bin + std::string(1 << 20, 'x'));
  json j = b.json;
  for (int i = 0; i < 100; ++i)
    j["buffers"].push_back({{"byteLength", b.bin.size()}, {"uri", i % 2 ? "a.bin" : "./a.bin"}});
  const json primitive = j["meshes"][0]["primitives"][0];
  for (int i = 1; i < 100; ++i) {
    json view = j["bufferViews"][0], accessor = j["accessors"][0], each = primitive;
    view["buffer"] = i, accessor["bufferView"] = i;
    j["bufferViews"].push_back(view);
    j["accessors"].push_back(accessor);
    each["attributes"]["POSITION"] = int(j["accessors"].size()) - 1;
    j["meshes"][0]["primitives"].push_back(each);
  }
  f.write(f.model / "a.gltf", j.dump());
  LoadOptions options;
  options.max_bytes = 4 << 20;
  const Result<LoadedScene> loaded = load_scene(f.model / "a.gltf", options);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->scene.meshes.size(), 100u);
}

TEST(LoadScene, a_folder_says_which_file_in_it_to_name) {
  const Folders f;
  EXPECT_EQ(reason_of_file(f.model).find("is a folder without a scene"), 0u)
      << reason_of_file(f.model);
  f.write(f.model / "b.obj", "");
  f.write(f.model / "a.GLB", "");
  EXPECT_EQ(reason_of_file(f.model), "is a folder: name a file in it, as a.GLB");
}

TEST(LoadScene, a_file_beyond_the_limit_is_not_read) {
  const Folders f;
  f.write(f.model / "a.obj", std::string(3 << 20, '#'));
  LoadOptions options;
  options.max_bytes = 2 << 20;
  EXPECT_EQ(load_scene(f.model / "a.obj", options).error().reason,
            "has 3 MiB, more than the 2 that --memory-limit-mb allows");
}

}  // namespace
}  // namespace rilievo
