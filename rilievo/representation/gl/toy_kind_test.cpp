// What it takes to add a kind of representation, and that nothing else needs to be touched: a toy
// kind that stands for an object by a box of its mean colour is baked, saved, loaded, drawn,
// compared and cached from here, by a list of kinds that the test hands in. CONTRIBUTING.md says it
// in words.
#include <gtest/gtest.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <sstream>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/compare/compare.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/object.h"
#include "rilievo/method/objects.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"

namespace rilievo {
namespace {

// --- The kind: what is kept ---------------------------------------------------------------------

constexpr std::string_view kName = "toy-box";

struct ToyBox final : Representation {
  [[nodiscard]] Box bounds() const override { return box; }
  [[nodiscard]] std::size_t bytes() const override { return sizeof(*this); }
  Box box;
  DepthImage picture;  // from which the colour is taken; what the file holds
};

glm::vec3 mean_color(const DepthImage& picture) {
  glm::vec4 sum(0.0f);
  for (const glm::vec4& color : picture.color.texels()) sum += color;
  return glm::vec3(sum) / std::max(sum.a, 1e-6f);
}

const std::array kOptions{Option{.name = "size",
                                 .type = OptionType::integer,
                                 .default_value = "32",
                                 .help = "Texels a side of the picture",
                                 .unit = "N",
                                 .min = 4,
                                 .max = 256}};

Result<Baked> bake(const BakeInput& input, const OptionValues& values, const Progress& progress) {
  auto toy = std::make_unique<ToyBox>();
  toy->box = input.source.bounds(input.objects);
  const Result<Camera> camera = view_camera(
      toy->box, glm::normalize(glm::dvec3(1, 1, 1)),
      {.projection = Projection::perspective, .size = values.integer("size"), .distance = 3});
  if (!camera) return camera.error();
  Result<CapturedPicture> captured =
      input.source.capture({.camera = *camera, .objects = input.objects});
  if (!captured) return captured.error();
  toy->picture = std::move(captured->picture);
  if (progress) progress(1, 1);
  return Baked{std::move(toy), {}};
}

bool says(const FileAttributes& attributes) {
  const auto found = attributes.file.find("representation");
  return found != attributes.file.end() && found->second == kName;
}

Result<> save(const Representation& representation, const std::filesystem::path& path) {
  const auto& toy = dynamic_cast<const ToyBox&>(representation);
  std::ostringstream text;
  for (const glm::vec3& corner : {glm::vec3(toy.box.min), glm::vec3(toy.box.max)})
    text << corner.x << " " << corner.y << " " << corner.z << " ";
  return save_pictures(path, {&toy.picture, 1},
                       {{{"representation", std::string(kName)}, {"box", text.str()}}, {}});
}

Result<std::unique_ptr<Representation>> load(PictureFile file, const std::filesystem::path& path) {
  auto toy = std::make_unique<ToyBox>();
  std::istringstream text(file.attributes.file["box"]);
  std::array<float, 6> n{};
  for (float& number : n) text >> number;
  if (!text) return Error{path.string(), "the box is missing"};
  toy->box.add({n[0], n[1], n[2]});
  toy->box.add({n[3], n[4], n[5]});
  toy->picture = std::move(file.pictures.front());
  return {std::move(toy)};
}

std::vector<Fact> describe(const Representation& representation) {
  const glm::vec3 color = mean_color(dynamic_cast<const ToyBox&>(representation).picture);
  return {{"red", std::to_string(color.r), "red", std::to_string(color.r)}};
}

const Kind& toy_kind() {
  static const Kind kind{.name = kName,
                         .summary = "a box of one colour",
                         .bake_options = kOptions,
                         .bake = bake,
                         .matches = says,
                         .load = load,
                         .save = save,
                         .describe = describe};
  return kind;
}

// --- The kind: how it is drawn ------------------------------------------------------------------

// The box itself: off by nothing where an object is its box.
double bound_px(const ErrorModel&, const glm::dmat4&, const Camera&) { return 0.25; }

class ToyDrawable final : public Drawable {
 public:
  ToyDrawable(const ToyBox& toy, std::array<GLuint, 2> programs)
      : box_(toy.box), color_(mean_color(toy.picture)), programs_(programs) {
    no_vertices_ = gl::make_vertex_array();
  }
  [[nodiscard]] std::string_view kind() const override { return kName; }
  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override {
    const GLuint program = programs_[output == Output::object_id];
    glUseProgram(program);
    glBindVertexArray(no_vertices_);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    for (const Instance& instance : instances) {
      const glm::dmat4 relative_from_world = glm::translate(glm::dmat4(1.0), -frame.position());
      const glm::mat4 clip(clip_from_relative(frame) * relative_from_world *
                           instance.world_from_capture);
      glUniformMatrix4fv(0, 1, GL_FALSE, &clip[0][0]);
      const glm::vec3 low(box_.min), high(box_.max);
      glUniform3fv(1, 1, &low[0]);
      glUniform3fv(2, 1, &high[0]);
      if (output == Output::color) {
        const glm::vec3 srgb(srgb_from_linear(color_.r), srgb_from_linear(color_.g),
                             srgb_from_linear(color_.b));
        glUniform3fv(3, 1, &srgb[0]);
      } else {
        glUniform1ui(3, instance.object);
      }
      glDrawArrays(GL_TRIANGLES, 0, 36);
    }
  }
  void draw_outlines(const Camera&, std::span<const Instance>) override {}
  [[nodiscard]] ErrorModel error_model(std::uint32_t) const override {
    ErrorModel model;
    model.bound = bound_px;
    model.bounds = box_;
    return model;
  }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const override { return {1, 0}; }
  [[nodiscard]] std::size_t bytes() const override { return sizeof(*this); }

 private:
  Box box_;
  glm::vec3 color_;
  std::array<GLuint, 2> programs_;
  gl::VertexArray no_vertices_;
};

class ToyFactory final : public DrawableFactory {
 public:
  ToyFactory(gl::Program color, gl::Program objects)
      : color_(std::move(color)), objects_(std::move(objects)) {}
  [[nodiscard]] std::size_t expected_bytes(const OptionValues&,
                                           const OptionValues&) const override {
    return sizeof(ToyDrawable);
  }
  [[nodiscard]] Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues&) override {
    return {std::make_unique<ToyDrawable>(dynamic_cast<const ToyBox&>(*representation),
                                          std::array<GLuint, 2>{color_, objects_})};
  }

 private:
  gl::Program color_, objects_;
};

constexpr char kVertex[] = R"(#version 450
layout(location = 0) uniform mat4 clip_from_world;
layout(location = 1) uniform vec3 low;
layout(location = 2) uniform vec3 high;
void main() {
  // Six faces of two triangles; a corner has a bit for each axis.
  const int corner[36] = int[](0,2,1, 1,2,3, 4,5,6, 5,7,6, 0,1,4, 1,5,4, 2,6,3, 3,6,7, 0,4,2, 2,4,6,
                               1,3,5, 3,7,5);
  int c = corner[gl_VertexID];
  gl_Position = clip_from_world * vec4(mix(low, high, vec3(c & 1, c >> 1 & 1, c >> 2 & 1)), 1);
})";

Result<std::unique_ptr<DrawableFactory>> make_toy_factory() {
  Result<gl::Program> color = gl::make_program("toy", kVertex, R"(#version 450
layout(location = 3) uniform vec3 color;
layout(location = 0) out vec4 out_color;
void main() { out_color = vec4(color, 1); })");
  if (!color) return color.error();
  Result<gl::Program> objects = gl::make_program("toy", kVertex, R"(#version 450
layout(location = 3) uniform uint object;
layout(location = 0) out uint out_object;
void main() { out_object = object; })");
  if (!objects) return objects.error();
  return {std::make_unique<ToyFactory>(std::move(*color), std::move(*objects))};
}

// --- The lists that the test hands in -----------------------------------------------------------

const std::array kKinds{&toy_kind()};
constexpr std::array kRows{DrawableRow{kName, make_toy_factory}};

// Boxes of many triangles; the second one moves.
BuiltinScene boxes() {
  BuiltinScene made;
  for (int i = 0; i < 3; ++i) {
    test_shapes::add(made.scene, test_shapes::box({0.5f, 0.5f, 0.5f}),
                     {0.8f, 0.3f * float(i), 0.2f},
                     glm::translate(glm::mat4(1), {1.6f * float(i) - 1.6f, 0, 0}));
  }
  made.scene.nodes = {{-1, {0, 0, 0}}};
  made.scene.objects[1].node = 0;
  made.scene.channels = {{0,
                          Channel::Path::translation,
                          Channel::Interpolation::linear,
                          {0, 1},
                          {{0, 0, 0, 0}, {0, 1, 0, 0}}}};
  made.scene.duration = 1;
  finish(made.scene);
  return made;
}

class ToyKind : public SceneTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(SceneTest::SetUp());
    ASSERT_NO_FATAL_FAILURE(load(boxes()));
    const Kind* found = find_kind(kKinds, "toy-box");
    ASSERT_NE(found, nullptr);
    kind = found;
    auto made = make_factory(kRows, kind->name);
    ASSERT_TRUE(made.ok()) << made.error().message();
    factory = std::move(*made);
    objects.bake = OptionValues(kind->bake_options);
    objects.draw = OptionValues(kind->draw_options);
    objects.min_triangles = 1;
  }
  // Which pixels' objects differ from direct drawing's, inside of outlines.
  int wrong(FrameSource& source, double time) {
    OpenGLFrames direct = opengl_direct(*renderer);
    frame_of(direct, camera, time);
    const auto truth = objects_of(direct);
    frame_of(source, camera, time);
    return wrong_inside(truth, objects_of(source));
  }

  const Camera camera = look_at({1, 2, 6}, {0, 0.3, 0}, {0, 1, 0}, 0.8, kWidth, kHeight, 0.1, 100);
  const Kind* kind = nullptr;
  std::unique_ptr<DrawableFactory> factory;
  ObjectDrawablesOptions objects;
};

TEST_F(ToyKind, is_baked_saved_loaded_described_and_drawn) {
  OpenGLSource source(*renderer);
  auto baked = kind->bake({source, {2}}, objects.bake, {});
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  const TemporaryFolder folder;
  const auto file = folder / "toy.exr";
  ASSERT_TRUE(kind->save(*baked->representation, file).ok());
  auto content = load_picture_file(file);
  ASSERT_TRUE(content.ok());
  EXPECT_EQ(kind_of_file(kKinds, content->attributes), kind);
  EXPECT_EQ(kind_of_file(kinds(), content->attributes), nullptr);  // none of the library's
  auto loaded = kind->load(std::move(*content), file);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ((*loaded)->bounds().min, baked->representation->bounds().min);
  // Colours are halfs in files: three digits.
  EXPECT_NEAR(std::stod(kind->describe(**loaded)[0].json),
              std::stod(kind->describe(*baked->representation)[0].json), 1e-3);

  auto drawable = factory->make_drawable(std::move(*loaded), objects.draw);
  ASSERT_TRUE(drawable.ok());
  OpenGLFrames frames =
      opengl_stored(*renderer, std::move(*drawable), {{glm::dmat4(1.0), 0, 3}}, false);
  frame_of(frames, camera);
  EXPECT_EQ(frames.stats().count(kName), 1);
  const auto seen = objects_of(frames);
  // Where direct drawing shows the third box, and nothing else.
  OpenGLFrames direct = opengl_direct(*renderer);
  frame_of(direct, camera);
  const auto truth = objects_of(direct);
  int shown = 0, other = 0;
  for (std::size_t i = 0; i < seen.texels().size(); ++i) {
    shown += seen.texels()[i] == 3;
    other += truth.texels()[i] == 3 && seen.texels()[i] != 3;
  }
  EXPECT_GT(shown, 500);
  EXPECT_LE(other, shown / 50);  // pixels on edges, by other floats
  EXPECT_TRUE(gl::check_errors("toy").ok());
}

TEST_F(ToyKind, stands_for_the_objects_of_a_scene_and_is_compared_like_any_method) {
  OpenGLSource source(*renderer);
  auto frames = opengl_chosen(*renderer, [&](const PlacedScene& placed) {
    return ObjectChooser::create(placed, source, *kind, std::move(factory), {objects, 1e9});
  });
  ASSERT_TRUE(frames.ok()) << frames.error().message();
  for (const double time : {0.0, 0.7}) EXPECT_EQ(wrong(*frames, time), 0) << time;
  EXPECT_EQ(frames->stats().count(kName), 3);
  EXPECT_EQ(frames->stats().polygons, 0);

  OpenGLFrames direct = opengl_direct(*renderer);
  const ComparedSource sources[] = {{"direct", &direct}, {"toy-box", &*frames}};
  CompareOptions options;
  options.width = kWidth, options.height = kHeight, options.frames = 3;
  const auto report = compare(
      sources,
      [&](int frame) {
        return WalkFrame{camera, 0.3 * frame};
      },
      options);
  ASSERT_TRUE(report.ok()) << report.error().message();
  bool counted = false;
  for (const auto& [way, count] : report->methods[1].drawn_as)
    counted |= way == kName && count == 9;
  EXPECT_TRUE(counted);
  for (const FrameResult& frame : report->methods[1].frames) {
    EXPECT_EQ(frame.wrong_visibility, 0);
    EXPECT_GT(frame.psnr_db, 15);  // three faces of one colour each, drawn in their mean
  }
}

TEST_F(ToyKind, is_an_alternative_of_the_cache_by_its_bound_and_its_cost) {
  auto cache = opengl_cache(*renderer, {});
  ASSERT_TRUE(cache.ok());
  OpenGLSource source(*renderer);
  auto drawables = bake_object_drawables(renderer->placed(), source, *kind, *factory, objects);
  ASSERT_TRUE(drawables.ok()) << drawables.error().message();
  cache->cache().add_alternatives(std::move(*drawables), std::move(factory));
  for (int frame = 0; frame < 4; ++frame) {
    EXPECT_EQ(wrong(*cache, 0.2 * frame), 0) << frame;
    EXPECT_EQ(cache->stats().count(kName), 3) << frame;
    EXPECT_EQ(cache->stats().bound_px, 0.25);
  }
  cache->cache().options().error_px = 0.1;  // less than it can promise
  frame_of(*cache, camera, 0.8);
  EXPECT_EQ(cache->stats().count(kName), 0);
}

}  // namespace
}  // namespace rilievo
