#include "rilievo/web_walk/node_files.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/web_walk/sha256.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;

EnvironmentNodes two_nodes(int size) {
  std::vector<DepthImage> pictures;
  for (const glm::dvec3& eye : {glm::dvec3(0), glm::dvec3(0.5, 0, 0)}) {
    EnvironmentMap map = make_node(
        size, box_around(glm::dvec3(-4, -1.6, -3) - eye, glm::dvec3(5, 2, 4) - eye),
        [](const glm::dvec3& to, double) {
          return glm::vec4(0.5 + 0.4 * std::sin(to.x), 0.5, 0.5 + 0.4 * std::cos(to.y), 1);
        },
        eye);
    for (DepthImage& face : map.faces) pictures.push_back(std::move(face));
  }
  Result<EnvironmentNodes> nodes = make_environment_nodes(std::move(pictures), {});
  EXPECT_TRUE(nodes);
  return std::move(*nodes);
}

Result<> write_walk(const fs::path& folder, const EnvironmentNodes& nodes,
                    const WalkOptions& options = {}) {
  Result<WalkWriter> writer = WalkWriter::create(folder);
  if (!writer) return writer.error();
  WalkManifest manifest;
  manifest.name = "room";
  if (Result<> added = add_nodes(nodes, *writer, manifest, options); !added) return added;
  return writer->finish(manifest);
}

nlohmann::json manifest_of(const fs::path& folder) {
  const Result<std::string> text = read_file(folder / "walk.json", 1 << 24);
  return text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
}

std::map<std::string, std::string> contents_of(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      all[entry.path().lexically_relative(folder).string()] = *read_file(entry.path(), 1 << 28);
  return all;
}

TEST(NodeFiles, WritesFilesNamedByTheirContentsAndAManifestThatNamesAllOfThem) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_walk(folder / "walk", two_nodes(32), {.coarse_face = 16}));
  const nlohmann::json json = manifest_of(folder / "walk");
  EXPECT_EQ(json["schema"], "rilievo-walk-1");
  ASSERT_EQ(json["nodes"].size(), 2u);
  std::set<std::string> named{"walk.json", "index.html", "viewer.js", "headset.js",
                              json["sketches"]["file"].get<std::string>()};
  const std::map<std::string, std::string> files = contents_of(folder / "walk");
  const auto expect_file = [&](const nlohmann::json& entry) {
    const std::string name = entry["file"];
    named.insert(name);
    ASSERT_TRUE(files.contains(name)) << name;
    const std::string& text = files.at(name);
    EXPECT_EQ(text.size(), entry["bytes"].get<std::size_t>());
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    EXPECT_EQ(fs::path(name).stem(), sha256_hex(bytes, 32));
  };
  expect_file(json["sketches"]);
  for (const nlohmann::json& node : json["nodes"]) {
    ASSERT_EQ(node["levels"].size(), 2u);
    EXPECT_EQ(node["levels"][0]["face_size"], 16);
    EXPECT_EQ(node["levels"][1]["face_size"], 32);
    for (const nlohmann::json& level : node["levels"]) {
      expect_file(level["colors"]);
      expect_file(level["mesh"]);
      expect_file(level["weights"]);
      EXPECT_GE(level["colors"]["psnr_db"].get<double>(), WalkOptions().least_psnr_db);
    }
  }
  for (const auto& [name, text] : files) EXPECT_TRUE(named.contains(name)) << name;
}

TEST(NodeFiles, WritesTheSameBytesAgainAndLeavesNothingOfAnEarlierWalk) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_walk(folder / "one", two_nodes(32)));
  ASSERT_TRUE(write_walk(folder / "two", two_nodes(16)));
  ASSERT_TRUE(write_walk(folder / "two", two_nodes(32)));
  EXPECT_EQ(contents_of(folder / "one"), contents_of(folder / "two"));
}

TEST(NodeFiles, RefusesAFolderOfOtherFiles) {
  const TemporaryFolder folder;
  std::ofstream(folder / "precious") << "mine";
  const Result<> written = write_walk(folder.path(), two_nodes(16));
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message().find("other files"), std::string::npos);
  EXPECT_EQ(folder.entries(), 1);
}

TEST(NodeFiles, DilatesColoursPastWhatShowsNothing) {
  EnvironmentMap map =
      make_node(16, box_around({-1, -1, -1}, {1, 1, 1}), [](const glm::dvec3& to, double) {
        return to.y > 0.2 ? glm::vec4(0.0f) : glm::vec4(1, 0, 0, 1);
      });
  for (DepthImage& face : map.faces)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x)
        if (face.color(x, y).a == 0) face.depth(x, y) = kNoDepth;
  const Rgba8Image sheet = face_sheet(map);
  ASSERT_EQ(sheet.width(), 48);
  ASSERT_EQ(sheet.height(), 32);
  // Every side but the upper one has something that is red.
  for (int f = 0; f < 6; ++f) {
    if (f == 2) continue;
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x)
        ASSERT_EQ(glm::u8vec3(sheet(f % 3 * 16 + x, f / 3 * 16 + y)), glm::u8vec3(255, 0, 0)) << f;
  }
}

TEST(NodeFiles, SaysWhatIsMissingToIdentifyObjects) {
  const TemporaryFolder folder;
  const Result<> written = write_walk(folder / "walk", two_nodes(16), {.objects = true});
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message().find("no identifiers"), std::string::npos);
}

}  // namespace
}  // namespace rilievo
