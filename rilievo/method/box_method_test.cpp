// A method in one file and one line: every object as its box. The library knows nothing of it.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

Scene three_shapes() {
  Scene scene;
  test_shapes::add(scene, test_shapes::torus(0.8, 0.3), {0.8f, 0.5f, 0.2f},
                   glm::translate(glm::mat4(1), {-1.6f, 0, 0}));
  test_shapes::add(scene, test_shapes::sphere(0.7), {0.3f, 0.7f, 0.3f});
  test_shapes::add(scene, test_shapes::torus(0.6, 0.2), {0.3f, 0.4f, 0.9f},
                   glm::rotate(glm::translate(glm::mat4(1), {1.6f, 0.3f, 0}), 0.8f, {1, 0.3f, 0}));
  finish(scene);
  return scene;
}

// The scene with a box in the place of each model.
Scene scene_of_boxes(const Scene& scene) {
  Scene boxes = scene;
  boxes.meshes.clear();
  boxes.models.clear();
  boxes.materials.assign(1, Material());
  Scene shapes;
  for (const Model& model : scene.models) {
    const Box& box = model.bounds;
    test_shapes::add(shapes, test_shapes::box(0.5f * (box.max - box.min)), glm::vec3(0.7f));
    Mesh mesh = shapes.meshes.back();
    for (glm::vec3& position : mesh.positions) position += box.center();
    mesh.material = 0;
    mesh.normals.clear();
    make_flat(mesh);
    boxes.meshes.push_back(std::move(mesh));
    boxes.models.emplace_back();
    boxes.models.back().parts = {{int(boxes.meshes.size()) - 1, glm::mat4(1)}};
  }
  finish(boxes);
  return boxes;
}

// Everything in view is polygons, of the boxes.
class BoxChooser final : public FrameChooser {
 public:
  explicit BoxChooser(const Scene& scene) : boxes_(scene_of_boxes(scene)) {}

  void add_sets(FrameContent&) override {}
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats&) override {
    placed.cull(camera, content.polygons);
    return Done{};
  }

  Scene boxes_;
  std::unique_ptr<Backend> backend_;  // of the boxes
};

Result<Method> make_boxes(const MethodOptions&, Backend& backend) {
  auto chooser = std::make_unique<BoxChooser>(backend.scene());
  Result<std::unique_ptr<Backend>> of_boxes = backend.make_backend(chooser->boxes_);
  if (!of_boxes) return of_boxes.error();
  chooser->backend_ = std::move(*of_boxes);
  Backend& drawn_by = *chooser->backend_;
  Result<std::unique_ptr<FrameSource>> frames = drawn_by.make_frames(std::move(chooser));
  if (!frames) return frames.error();
  Method method;
  method.frames = std::move(*frames);
  return method;
}

TEST(Method, in_one_file_and_one_line_draws_every_object_as_its_box) {
  std::vector<MethodRow> rows(methods().begin(), methods().end());
  rows.push_back({"boxes", make_boxes});  // the line

  const Scene scene = three_shapes();
  SoftwareBackend backend(scene, 4);
  EXPECT_FALSE(make_method("boxes", {}, backend).ok());
  const Result<Method> boxes = make_method(rows, "boxes", {}, backend);
  const Result<Method> direct = make_method(rows, "direct", {}, backend);
  ASSERT_TRUE(boxes.ok() && direct.ok());
  for (const double time : {0.0, 0.7}) {
    const Camera camera = look_at({1 + time, 2, 7}, {0, 0, 0}, {0, 1, 0}, 0.7, 192, 108, 0.1, 50);
    for (const Result<Method>* method : {&boxes, &direct}) {
      ASSERT_TRUE((*method)->frames->draw(camera, time).ok());
      ASSERT_TRUE((*method)->frames->draw_objects().ok());
    }
    // A box holds what it stands for: where the object is seen, its box is, or one before it.
    const SoftwareTarget &a = *boxes->frames->software_target(),
                         &b = *direct->frames->software_target();
    const Image<float> box_z = a.eye_z(), true_z = b.eye_z();
    int more = 0;
    for (int y = 0; y < 108; ++y)
      for (int x = 0; x < 192; ++x) {
        const bool shown = a.objects()(x, y) != kNoObject, wanted = b.objects()(x, y) != kNoObject;
        more += shown && !wanted;
        if (!wanted) continue;
        ASSERT_TRUE(shown) << x << ' ' << y;
        EXPECT_LE(box_z(x, y), true_z(x, y) * 1.0001f) << x << ' ' << y;
      }
    EXPECT_GT(more, 100);
    EXPECT_EQ(boxes->frames->stats().polygons, 3);
  }
}

TEST(Method, names_are_told_apart_and_unknown_ones_refused) {
  const Scene nothing;
  SoftwareBackend backend(nothing, 1);
  const std::vector<std::string> names = method_names();
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(names[i], names[j]);
  const Result<Method> wrong = make_method("nonsense", {}, backend);
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.error().where, "nonsense");
}

}  // namespace
}  // namespace rilievo
