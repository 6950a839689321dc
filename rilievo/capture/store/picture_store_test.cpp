#include "rilievo/capture/store/picture_store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <list>
#include <thread>
#include <vector>

#include "rilievo/capture/store/content_hash.h"
#include "rilievo/capture/store/picture_bytes.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

DepthImage stored_picture(std::uint64_t seed, int width, int height) {
  Random random(seed);
  DepthImage p;
  p.name = "picture " + std::to_string(seed);
  p.camera = look_at({3.1, 2, double(seed)}, {0, 0, 0}, {0, 1, 0}, 0.7, width, height, 0.25, 60);
  p.camera.projection = Projection(seed % 3);
  p.depth_kind = DepthKind(seed / 3 % 3);
  p.color = ColorImage(width, height);
  p.depth = Image<float>(width, height, kNoDepth);
  if (seed % 2) p.object = Image<std::uint32_t>(width, height);
  for (std::size_t i = 0; i < p.color.texels().size(); ++i) {
    if (random.below(3) == 0) continue;
    for (int c = 0; c < 4; ++c) p.color.texels()[i][c] = random.unit();
    p.depth.texels()[i] = 0.3f + random.unit();
    if (seed % 2) p.object.texels()[i] = std::uint32_t(1 + random.below(9));
  }
  return p;
}

void expect_equal(const DepthImage& a, const DepthImage& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.depth_kind, b.depth_kind);
  EXPECT_TRUE(a.color == b.color);
  EXPECT_TRUE(a.depth == b.depth);
  EXPECT_TRUE(a.object == b.object);
}

PictureKey key_of(int i) { return {"content", "raytrace", "cell " + std::to_string(i), 8, 8}; }

void execute_sql(const std::filesystem::path& path, const char* sql) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
  sqlite3_close(db);
}

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(PictureStore, pictures_come_back_to_the_bit_also_after_reopening) {
  TemporaryFolder folder;
  for (int round = 0; round < 2; ++round) {
    Result<PictureStore> store = PictureStore::open(folder / "store");
    ASSERT_TRUE(store.ok()) << store.error().message();
    for (int i = 0; i < 12; ++i) {
      const DepthImage picture = stored_picture(std::uint64_t(i), 5 + i, 9);
      if (round == 0) {
        ASSERT_TRUE(store->insert(key_of(i), picture).ok());
      }
      const Result<std::optional<DepthImage>> found = store->find(key_of(i));
      ASSERT_TRUE(found.ok() && *found);
      expect_equal(**found, picture);
    }
    EXPECT_EQ(*store->count(), 12u);
    EXPECT_EQ(store->stats().found, 12u);
    // Every part of the key counts.
    for (int part = 0; part < 5; ++part) {
      PictureKey other = key_of(3);
      if (part == 0) other.content = "Content";
      if (part == 1) other.shader += " ";
      if (part == 2) other.cell = "cell 31";
      if (part == 3) other.width = 9;
      if (part == 4) other.height = 9;
      const auto found = store->find(other);
      ASSERT_TRUE(found.ok());
      EXPECT_FALSE(*found);
    }
  }
}

TEST(PictureStore, a_key_holds_the_last_picture) {
  TemporaryFolder folder;
  Result<PictureStore> store = PictureStore::open(folder / "store");
  ASSERT_TRUE(store.ok());
  for (std::uint64_t i = 0; i < 3; ++i)
    ASSERT_TRUE(store->insert(key_of(0), stored_picture(i, 8, 8)).ok());
  EXPECT_EQ(*store->count(), 1u);
  expect_equal(**store->find(key_of(0)), stored_picture(2, 8, 8));
}

// Against a list in the order of use.
TEST(PictureStore, the_least_recently_used_pictures_go_first) {
  struct Entry {
    int key;
    std::uint64_t bytes;
  };
  TemporaryFolder folder;
  const StoreOptions options{.max_bytes = 20'000};
  std::list<Entry> twin;  // the most recently used last
  Random random(4);
  Result<PictureStore> store = PictureStore::open(folder / "store", options);
  ASSERT_TRUE(store.ok());
  for (int step = 0; step < 400; ++step) {
    if (step % 100 == 99) store = PictureStore::open(folder / "store", options);
    const int key = random.below(30);
    const auto at = std::find_if(twin.begin(), twin.end(), [&](auto& e) { return e.key == key; });
    if (random.below(2)) {
      const auto found = store->find(key_of(key));
      ASSERT_TRUE(found.ok());
      ASSERT_EQ(found->has_value(), at != twin.end()) << step;
      if (at != twin.end()) twin.splice(twin.end(), twin, at);
    } else {
      const DepthImage picture =
          stored_picture(std::uint64_t(step), 4 + random.below(12), 4 + random.below(12));
      const std::uint64_t bytes = picture_bytes(picture).size();
      ASSERT_TRUE(store->insert(key_of(key), picture).ok());
      if (at != twin.end()) twin.erase(at);
      twin.push_back({key, bytes});
      const auto total = [&] {
        std::uint64_t sum = 0;
        for (const Entry& e : twin) sum += e.bytes;
        return sum;
      };
      while (total() > options.max_bytes) twin.pop_front();
      ASSERT_EQ(*store->bytes(), total());
    }
    ASSERT_EQ(*store->count(), twin.size());
  }
  // A smaller limit holds from the next opening on; what is too large alone is not kept.
  store = PictureStore::open(folder / "store", {.max_bytes = 6'000});
  ASSERT_TRUE(store.ok());
  EXPECT_LE(*store->bytes(), 6'000u);
  EXPECT_TRUE((*store->find(key_of(twin.back().key))).has_value());
  ASSERT_TRUE(store->insert(key_of(99), stored_picture(1, 64, 64)).ok());
  EXPECT_FALSE((*store->find(key_of(99))).has_value());
}

TEST(PictureStore, a_damaged_picture_is_found_and_dropped) {
  TemporaryFolder folder;
  const char* damages[] = {
      "UPDATE texels SET bytes = CAST(substr(bytes, 1, 9) || x'5A' || substr(bytes, 11) AS BLOB)",
      "UPDATE texels SET bytes = substr(bytes, 1, length(bytes) - 1)",
      "UPDATE texels SET bytes = x''", "DELETE FROM texels", "UPDATE pictures SET hash = '0'"};
  for (const char* damage : damages) {
    const std::filesystem::path path = folder / "store";
    std::filesystem::remove(path);
    {
      Result<PictureStore> store = PictureStore::open(path);
      ASSERT_TRUE(store.ok());
      ASSERT_TRUE(store->insert(key_of(1), stored_picture(1, 8, 8)).ok());
    }
    execute_sql(path, damage);
    Result<PictureStore> store = PictureStore::open(path);
    ASSERT_TRUE(store.ok());
    const auto found = store->find(key_of(1));
    ASSERT_TRUE(found.ok()) << found.error().message();
    EXPECT_FALSE(*found) << damage;
    EXPECT_EQ(store->stats().damaged, 1u);
    EXPECT_EQ(*store->count(), 0u);
    ASSERT_TRUE(store->insert(key_of(1), stored_picture(1, 8, 8)).ok());
    EXPECT_TRUE((*store->find(key_of(1))).has_value());
  }
}

TEST(PictureStore, a_store_that_is_cut_off_is_an_error_or_lacks_pictures) {
  TemporaryFolder folder;
  {
    Result<PictureStore> store = PictureStore::open(folder / "whole");
    for (int i = 0; i < 10; ++i)
      ASSERT_TRUE(store->insert(key_of(i), stored_picture(std::uint64_t(i), 30, 30)).ok());
  }
  const std::string whole = bytes_of_file(folder / "whole");
  Random random(8);
  for (int round = 0; round < 25; ++round) {
    const std::filesystem::path path = folder / ("cut" + std::to_string(round));
    std::string bytes = whole.substr(0, 1 + std::size_t(random.below(int(whole.size()))));
    if (round % 2) bytes[std::size_t(random.below(int(bytes.size())))] ^= 0x40;
    std::ofstream(path, std::ios::binary) << bytes;
    Result<PictureStore> store = PictureStore::open(path);
    if (!store) {
      EXPECT_EQ(store.error().where, path.string());
      continue;
    }
    for (int i = 0; i < 10; ++i) {
      const auto found = store->find(key_of(i));
      if (found && *found) expect_equal(**found, stored_picture(std::uint64_t(i), 30, 30));
    }
  }
}

TEST(PictureStore, files_of_others_and_newer_stores_are_refused_and_left_alone) {
  TemporaryFolder folder;
  const auto refused = [&](const char* name, const char* reason) {
    const std::string before = bytes_of_file(folder / name);
    const Result<PictureStore> store = PictureStore::open(folder / name);
    ASSERT_FALSE(store.ok()) << name;
    EXPECT_EQ(store.error().where, folder / name);
    EXPECT_NE(store.error().reason.find(reason), std::string::npos) << store.error().reason;
    EXPECT_EQ(bytes_of_file(folder / name), before) << name;
  };
  execute_sql(folder / "foreign", "CREATE TABLE a (b); INSERT INTO a VALUES (1)");
  refused("foreign", "is a database of another program");
  execute_sql(folder / "numbered", "PRAGMA application_id = 7; CREATE TABLE a (b)");
  refused("numbered", "is a database of another program");
  std::ofstream(folder / "text") << std::string(5000, 'x');
  refused("text", "is not a store of pictures");
  ASSERT_TRUE(PictureStore::open(folder / "newer").ok());
  execute_sql(folder / "newer", "PRAGMA user_version = 3");
  refused("newer", "is a store of a newer version (its schema is 3, this program knows 2)");
  std::filesystem::create_directory(folder / "folder");
  EXPECT_EQ(PictureStore::open(folder / "folder").error().reason, "is a folder");
  EXPECT_FALSE(PictureStore::open(folder / "no" / "where").ok());
  // A file without any bytes is nobody's.
  std::ofstream(folder / "empty").flush();
  EXPECT_TRUE(PictureStore::open(folder / "empty").ok());
}

// Schema 1 had no order of use.
TEST(PictureStore, an_older_store_is_brought_up_to_date) {
  TemporaryFolder folder;
  {
    Result<PictureStore> store = PictureStore::open(folder / "store");
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(store->insert(key_of(i), stored_picture(1, 8, 8)).ok());
  }
  execute_sql(folder / "store",
              "DROP INDEX pictures_used; ALTER TABLE pictures DROP COLUMN used;"
              "PRAGMA user_version = 1");
  const std::uint64_t one = picture_bytes(stored_picture(1, 8, 8)).size();
  Result<PictureStore> store = PictureStore::open(folder / "store", {.max_bytes = 3 * one});
  ASSERT_TRUE(store.ok()) << store.error().message();
  EXPECT_EQ(*store->count(), 3u);
  EXPECT_FALSE((*store->find(key_of(0))).has_value());
  for (int i = 1; i < 4; ++i) EXPECT_TRUE((*store->find(key_of(i))).has_value());
  ASSERT_TRUE(store->insert(key_of(9), stored_picture(1, 8, 8)).ok());
  EXPECT_FALSE((*store->find(key_of(1))).has_value());
}

// In a process of its own; returns its number.
template <class Work>
pid_t in_child(const Work& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work() ? 0 : 1);
  return child;
}

TEST(PictureStore, two_processes_use_a_store_at_once) {
  TemporaryFolder folder;
  const auto work = [&](int first) {
    // Opened at the same moment, while the file does not exist yet.
    Result<PictureStore> store = PictureStore::open(folder / "store", {.wait_s = 60});
    if (!store) return false;
    for (int i = 0; i < 40; ++i) {
      const DepthImage shared = stored_picture(std::uint64_t(i), 20, 20);
      if (!store->insert(key_of(first + i), shared) || !store->insert(key_of(5000 + i), shared))
        return false;
      const auto found = store->find(key_of(5000 + i));
      if (!found || !*found || !((*found)->color == shared.color)) return false;
    }
    return true;
  };
  const pid_t other = in_child([&] { return work(1000); });
  EXPECT_TRUE(work(0));
  int status = 0;
  ASSERT_EQ(waitpid(other, &status, 0), other);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  Result<PictureStore> store = PictureStore::open(folder / "store");
  ASSERT_TRUE(store.ok());
  EXPECT_EQ(*store->count(), 120u);
}

// In its first moments a file changes its kind of log, its marks and its tables.
TEST(PictureStore, processes_that_make_a_store_at_once_all_succeed) {
  for (int round = 0; round < 10; ++round) {
    TemporaryFolder folder;
    std::vector<pid_t> children;
    for (int i = 0; i < 6; ++i)
      children.push_back(in_child([&] {
        Result<PictureStore> store = PictureStore::open(folder / "store", {.wait_s = 60});
        return store && store->insert(key_of(i), stored_picture(std::uint64_t(i), 8, 8)).ok();
      }));
    for (const pid_t child : children) {
      int status = 0;
      ASSERT_EQ(waitpid(child, &status, 0), child);
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    Result<PictureStore> store = PictureStore::open(folder / "store");
    ASSERT_TRUE(store.ok());
    EXPECT_EQ(*store->count(), 6u);
  }
}

// RILIEVO_KILLS sets another number of rounds.
TEST(PictureStore, a_process_killed_at_any_moment_leaves_whole_pictures) {
  TemporaryFolder folder;
  const char* wanted = std::getenv("RILIEVO_KILLS");
  const int rounds = wanted ? std::atoi(wanted) : 30;
  Random random(3);
  const StoreOptions options{.max_bytes = 200'000, .wait_s = 60};
  std::uint64_t whole = 0;
  for (int round = 0; round < rounds; ++round) {
    // Now and then from no file at all.
    if (round % 8 == 0)
      for (const char* name : {"store", "store-wal", "store-shm"})
        std::filesystem::remove(folder / name);
    const pid_t child = in_child([&] {
      Result<PictureStore> store = PictureStore::open(folder / "store", options);
      for (int i = round;; ++i)
        if (!store || !store->insert(key_of(i % 40), stored_picture(std::uint64_t(i % 40), 40, 40)))
          return false;
    });
    ASSERT_GT(child, 0);
    std::this_thread::sleep_for(std::chrono::microseconds(random.below(12'000)));
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));  // it had not failed before

    Result<PictureStore> store = PictureStore::open(folder / "store", options);
    ASSERT_TRUE(store.ok()) << store.error().message();
    for (int i = 0; i < 40; ++i) {
      const auto found = store->find(key_of(i));
      ASSERT_TRUE(found.ok()) << found.error().message();
      if (!*found) continue;
      ++whole;
      ASSERT_TRUE((*found)->color == stored_picture(std::uint64_t(i), 40, 40).color);
    }
    ASSERT_EQ(store->stats().damaged, 0u);
    ASSERT_LE(*store->bytes(), options.max_bytes);
  }
  RecordProperty("whole_pictures", std::to_string(whole));
}

TEST(ContentHash, depends_on_all_that_a_picture_shows_and_on_nothing_else) {
  const auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built.ok());
  const std::string hash = content_hash(built->scene);
  EXPECT_EQ(hash.size(), 32u);
  Scene scene = built->scene;
  scene.name = "other", scene.meshes[0].name = "other";
  EXPECT_EQ(content_hash(scene), hash);
  const auto differs = [&](auto&& change) {
    Scene other = built->scene;
    change(other);
    EXPECT_NE(content_hash(other), hash);
  };
  differs([](Scene& s) { s.meshes[0].positions.back().y += 1e-6f; });
  differs([](Scene& s) { std::swap(s.meshes[0].indices[0], s.meshes[0].indices[1]); });
  differs([](Scene& s) { s.materials[0].roughness += 1e-6f; });
  differs([](Scene& s) { s.materials[0].transmission = 1; });
  differs([](Scene& s) { s.materials[0].base_color_texture.uv_set = 1; });
  differs([](Scene& s) { s.objects[0].placement[3].x += 1e-3f; });
  differs([](Scene& s) { s.objects.pop_back(); });
  differs([](Scene& s) { s.lights.push_back({}); });
  differs([](Scene& s) { s.sky.ground.x += 1e-3f; });
  differs([](Scene& s) { s.images.emplace_back(1, 1); });
}

TEST(ContentHash, every_bit_and_every_border_of_pieces_counts) {
  const auto of = [](std::initializer_list<std::string_view> pieces) {
    ContentHash hash;
    for (const std::string_view piece : pieces) hash.add(piece);
    return hash.text();
  };
  std::vector<std::string> texts = {of({}),         of({""}),       of({"a"}), of({"ab", ""}),
                                    of({"", "ab"}), of({"a", "b"}), of({"ab"})};
  std::string bytes(20, '\0');
  for (std::size_t bit = 0; bit < 160; ++bit) {
    bytes[bit / 8] = char(bytes[bit / 8] ^ (1 << bit % 8));
    texts.push_back(of({bytes}));
  }
  std::sort(texts.begin(), texts.end());
  EXPECT_EQ(std::adjacent_find(texts.begin(), texts.end()), texts.end());
}

TEST(CameraCell, tells_cells_kinds_and_aims_apart) {
  const Camera camera = look_at({1.2, -0.3, 5}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8, 0.1, 9);
  Camera near = camera, other = camera, parallel = camera;
  near.world_from_eye[3].x = 1.45;
  other.world_from_eye[3].y = 0.01;
  parallel.projection = Projection::parallel;
  EXPECT_EQ(camera_cell(camera, 0.5), camera_cell(near, 0.5));
  EXPECT_NE(camera_cell(camera, 0.5), camera_cell(near, 0.1));
  EXPECT_NE(camera_cell(camera, 0.5), camera_cell(other, 0.5));
  EXPECT_NE(camera_cell(camera, 0.5), camera_cell(parallel, 0.5));
  EXPECT_NE(camera_cell(camera, 0.5), camera_cell(camera, 0.5, 1));
}

}  // namespace
}  // namespace rilievo
