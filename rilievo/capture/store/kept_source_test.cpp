#include "rilievo/capture/store/kept_source.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "rilievo/capture/callable_source.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/relief_impostor/impostor_content.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

const Box kShown{glm::vec3(-1), glm::vec3(1)};

CallableSource numbered_pictures(int& made) {
  return {"numbered", kShown, [&made](const CaptureRequest& request) -> Result<CapturedPicture> {
            ++made;
            CapturedPicture out;
            out.picture.camera = request.camera;
            out.picture.depth_kind = DepthKind::eye_z;
            out.picture.color =
                ColorImage(request.camera.width, request.camera.height, glm::vec4(float(made)));
            out.picture.depth =
                Image<float>(request.camera.width, request.camera.height, float(made));
            return out;
          }};
}

CaptureRequest request_from(const glm::dvec3& eye, int size = 8) {
  CaptureRequest request;
  request.camera = *tight_camera(Projection::perspective, eye, {0, 1, 0}, kShown);
  request.camera.width = request.camera.height = size;
  request.identifiers = false;
  return request;
}

class KeptTest : public ::testing::Test {
 protected:
  KeptTest() : store_(std::move(*PictureStore::open(folder_.path() / "kept.db"))) {}
  TemporaryFolder folder_;
  PictureStore store_;
};

TEST_F(KeptTest, what_was_rendered_once_is_not_rendered_again) {
  int made = 0;
  CallableSource shader = numbered_pictures(made);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> any(-4, 4);
  std::vector<glm::dvec3> eyes;
  for (int i = 0; i < 12; ++i) eyes.push_back({any(rng), any(rng), 6 + any(rng)});
  std::vector<float> first;
  for (int walk = 0; walk < 2; ++walk) {
    KeptSource source(shader, &store_, {"scene", "shader", {}});
    for (std::size_t i = 0; i < eyes.size(); ++i) {
      const auto captured = source.capture(request_from(eyes[i]));
      ASSERT_TRUE(captured.ok());
      // To the bit, with the camera of the one that was rendered.
      if (walk == 0) first.push_back(captured->picture.depth(0, 0));
      EXPECT_EQ(captured->picture.depth(0, 0), first[i]);
      EXPECT_EQ(captured->picture.camera, request_from(eyes[i]).camera);
    }
    EXPECT_EQ(source.rendered(), walk == 0 ? 12u : 0u);
    EXPECT_EQ(source.found(), walk == 0 ? 0u : 12u);
  }
  EXPECT_EQ(made, 12);
}

TEST_F(KeptTest, other_content_shaders_samples_objects_and_sizes_are_other_pictures) {
  const CaptureRequest request = request_from({0, 0, 5});
  const KeptOptions options{"scene", "shader", {}};
  const auto text = [](const PictureKey& key) {
    return key.content + '|' + key.shader + '|' + key.cell + '|' + std::to_string(key.width);
  };
  const std::string key = text(kept_key(request, kShown, options));
  CaptureRequest other = request;
  other.samples = 16;
  EXPECT_NE(text(kept_key(other, kShown, options)), key);
  const std::uint32_t objects[] = {3};
  other = request, other.objects = objects;
  EXPECT_NE(text(kept_key(other, kShown, options)), key);
  EXPECT_NE(text(kept_key(request_from({0, 0, 5}, 9), kShown, options)), key);
  EXPECT_NE(text(kept_key(request, kShown, {"scene 2", "shader", {}})), key);
  EXPECT_NE(text(kept_key(request, kShown, {"scene", "shader 2", {}})), key);
  // A hundredth of the distance away at most, or another cell.
  EXPECT_NE(text(kept_key(request_from({0.051, 0, 5}), kShown, options)), key);
  EXPECT_EQ(text(kept_key(request_from({0.001, 0.001, 5.001}), kShown, options)), key);
}

TEST_F(KeptTest, without_a_store_everything_is_rendered) {
  int made = 0;
  CallableSource shader = numbered_pictures(made);
  KeptSource source(shader, nullptr, {});
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(source.capture(request_from({0, 0, 5})).ok());
  EXPECT_EQ(source.rendered(), 3u);
}

// For ThreadSanitizer: random eyes, captures that are given up, several workers on one store that
// lets pictures go. RILIEVO_STRESS_S makes it last so many seconds.
TEST_F(KeptTest, workers_on_one_store_do_not_race) {
  const char* asked = std::getenv("RILIEVO_STRESS_S");
  const double seconds = asked ? std::atof(asked) : 0;
  auto store = PictureStore::open(folder_.path() / "stress.db", {.max_bytes = 400'000});
  ASSERT_TRUE(store.ok());
  std::vector<std::unique_ptr<CallableSource>> shaders;
  std::vector<std::unique_ptr<KeptSource>> kept;
  std::vector<CaptureSource*> sources;
  for (int worker = 0; worker < 3; ++worker) {
    shaders.push_back(std::make_unique<CallableSource>(
        "wall", kShown, [](const CaptureRequest& request) -> Result<CapturedPicture> {
          CapturedPicture out;
          out.picture.camera = request.camera;
          out.picture.depth_kind = DepthKind::eye_z;
          out.picture.color = ColorImage(request.camera.width, request.camera.height, glm::vec4(1));
          out.picture.depth = Image<float>(request.camera.width, request.camera.height,
                                           float(1.1 * request.camera.z_near));
          for (int pass = 0; pass < 3; ++pass) {
            if (request.control->stop.stop_requested())
              return Error{"wall", std::string(kCaptureStopped)};
            request.control->refined(out);
          }
          return out;
        }));
    kept.push_back(
        std::make_unique<KeptSource>(*shaders.back(), &*store, KeptOptions{"scene", "wall", {}}));
    sources.push_back(kept.back().get());
  }
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> any(-1, 1);
  const Stopwatch watch;
  std::uint64_t done = 0;
  for (int round = 0; round < 3 || watch.ms() < 1e3 * seconds; ++round) {
    ImpostorWorkers workers(sources, {{}, {.drawable = false}, {}}, {.size = 24});
    double angle = any(rng);
    for (int frame = 0; frame < 150; ++frame) {
      angle = any(rng) > 0.8 ? 3 * any(rng) : angle + 0.02;
      for (std::size_t object = 0; object < 3; ++object) {
        const double away = 4 + any(rng), turn = angle + double(object);
        ImpostorEye eye{.position = {away * std::sin(turn), any(rng), away * std::cos(turn)}};
        eye.velocity = {any(rng), any(rng), any(rng)};
        eye.turn = {0, any(rng), 0};
        (void)workers.frame(object, eye);
      }
      if (frame % 20 == 0) workers.wait_until_idle();
    }
    done += workers.stats().pictures;
    EXPECT_EQ(workers.stats().failed, 0u);
  }
  EXPECT_GT(done, 10u);
  EXPECT_GT(store->stats().stored, 10u);
  EXPECT_EQ(store->stats().damaged, 0u);
}

TEST(ImpostorContent, objects_are_found_by_name_and_by_number) {
  Scene scene;
  for (const char* name : {"a", "b", "a", "#0"}) {
    scene.objects.emplace_back();
    scene.objects.back().name = name;
  }
  EXPECT_EQ(*find_objects(scene, {"a"}), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(*find_objects(scene, {"#1", "b", "#2"}), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(*find_objects(scene, {"#0"}), (std::vector<std::uint32_t>{3}));  // a name comes first
  EXPECT_EQ(find_objects(scene, {})->size(), 4u);
  for (const char* wrong : {"c", "", "#", "#4", "#-1", "#1x"})
    EXPECT_FALSE(find_objects(scene, {wrong}).ok()) << wrong;
}

TEST(ImpostorContent, a_field_stands_where_its_object_does) {
  const auto scene = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(scene.ok());
  ImpostorContentOptions options;
  options.shader = "sdf:torus";
  options.objects = {"#1", "#2"};
  const auto content = make_impostor_content(scene->scene, 0, options);
  ASSERT_TRUE(content.ok()) << content.error().message();
  ASSERT_EQ(content->impostors.size(), 2u);
  for (const ShadedImpostor& impostor : content->impostors) {
    EXPECT_FALSE(impostor.shown.drawable);  // its polygons show something else
    const Box field = content->sources[0]->bounds(impostor.shown.objects);
    const Model& model =
        scene->scene.models[std::size_t(scene->scene.objects[impostor.objects[0]].model)];
    const Box object = transformed(content->rays->poses()[impostor.objects[0]], model.bounds);
    EXPECT_LT(glm::length(field.center() - object.center()), 1e-3f);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(field.min[k], object.min[k] - 1e-3f);
      EXPECT_LE(field.max[k], object.max[k] + 1e-3f);
    }
  }
}

TEST(ImpostorContent, what_is_unknown_is_refused) {
  const Scene scene;
  EXPECT_FALSE(make_impostor_content(scene, 0, {.shader = "raymarch"}).ok());
  EXPECT_FALSE(make_impostor_content(scene, 0, {.objects = {"teapot"}}).ok());
  EXPECT_FALSE(make_impostor_content(scene, 0, {.store = "/nowhere/at/all.db"}).ok());
}

}  // namespace
}  // namespace rilievo
