// rilievo view SCENE: a window on a scene, drawn by any method, beside direct drawing; or on what
// was baked into a file.

#include <epoxy/gl.h>
// After epoxy.
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <functional>
#include <memory>
#include <string>

#include "apps/rilievo/command.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/picture_file.h"
#include "apps/rilievo/program_scene.h"
#include "apps/rilievo/scene_file.h"
#include "apps/rilievo/view_state.h"
#include "apps/rilievo/window.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/frame/gl/opengl_target.h"
#include "rilievo/gl/context.h"
#include "rilievo/gl/object.h"
#include "rilievo/io/png.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo::app {
namespace {

struct ViewCommand {
  std::string scene, screenshot, method;
  FileLimits limits;
  bool split = false;
  FrameOptions frames;
  MethodOptions methods;
};

// Columns [left, right) of the resolved frame onto the window.
void show_columns(const FrameTarget& target, int left, int right) {
  glBlitNamedFramebuffer(target.resolved_framebuffer(), 0, left, 0, right, target.height(), left, 0,
                         right, target.height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

// Uploads frames that are in memory, to show them in the window.
class MemoryWindow {
 public:
  // Columns [left, right) of the frame onto the window.
  void show(const Rgba8Image& frame, int left, int right) {
    if (frame.width() != width_ || frame.height() != height_) {
      width_ = frame.width(), height_ = frame.height();
      texture_ = gl::make_texture_2d(GL_RGBA8, width_, height_);
      framebuffer_ = gl::make_framebuffer();
      glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(texture_, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE,
                        frame.texels().data());
    // The frame's top row comes first, OpenGL's last.
    glBlitNamedFramebuffer(framebuffer_, 0, left, height_, right, 0, left, 0, right, height_,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }

 private:
  int width_ = 0, height_ = 0;
  gl::Texture texture_;
  gl::Framebuffer framebuffer_;
};

Rgba8Image read_window(int width, int height) {
  Image<glm::u8vec4> image(width, height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  for (int y = 0; y < height; ++y)
    glReadPixels(0, height - 1 - y, width, 1, GL_RGBA, GL_UNSIGNED_BYTE, image.row(y).data());
  for (glm::u8vec4& pixel : image.texels()) pixel.a = 255;
  return image;
}

// Mouse and keys into a pose.
void move_eye(ViewState& state, const glm::dvec3& center, GLFWwindow* window) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool dragging = !io.WantCaptureMouse && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  const double per_pixel = state.vertical_fov / std::max(1.0f, io.DisplaySize.y);
  const double left = dragging ? -per_pixel * io.MouseDelta.x : 0;
  const double up = dragging ? -per_pixel * io.MouseDelta.y : 0;
  const double wheel = io.WantCaptureMouse ? 0 : 0.1 * io.MouseWheel;
  if (state.mode == ViewMode::orbit) circle(state.pose, center, 3 * left, 3 * up, wheel);
  if (state.mode != ViewMode::fly) return;
  turn(state.pose, -left, -up);  // grabs the picture
  if (io.WantCaptureKeyboard) return;
  const auto key = [&](int plus, int minus) {
    return double(glfwGetKey(window, plus) == GLFW_PRESS) -
           double(glfwGetKey(window, minus) == GLFW_PRESS);
  };
  const glm::dvec3 way{key(GLFW_KEY_D, GLFW_KEY_A), key(GLFW_KEY_E, GLFW_KEY_Q),
                       key(GLFW_KEY_W, GLFW_KEY_S)};
  fly(state.pose, way * double(state.speed) * double(io.DeltaTime));
}

Camera camera_of(const ViewState& state, int width, int height) {
  return look_at(state.pose.eye, state.pose.eye + forward_of(state.pose), up_of(state.pose),
                 state.vertical_fov, width, height, state.path.z_near, state.path.z_far);
}

void measure(ViewState& state, const FrameStats& stats, double frame_ms) {
  state.stats = stats;
  state.frame_ms.add(float(frame_ms));
  state.captures.add(float(stats.captures));
  state.megabytes.add(1e-6f * float(stats.picture_bytes));
}

// A file name that is not taken yet.
std::string free_name(const char* stem, const char* extension) {
  for (int i = 1;; ++i) {
    const std::string name = fmt::format("{}-{}{}", stem, i, extension);
    if (!std::filesystem::exists(name)) return name;
  }
}

std::string outcome(const Result<>& result, const std::string& file) {
  return result ? "saved " + file : result.error().where + ": " + result.error().reason;
}

// What is looked at.
struct Subject {
  Box bounds;
  FramePlan plan;
  std::vector<std::string> methods;  // the first if none is asked for
  std::function<Result<Method>(const std::string& method, const MethodOptions& options)> make;
  FrameSource* direct = nullptr;  // none if nothing but pictures is known
  Vantage vantage{};
  glm::dvec3 origin{0.0};  // of the space of all these, in the world
  bool moves = false;      // does anything but the eye?
};

// What an orbit goes around.
glm::dvec3 center_of(const Subject& subject) {
  if (subject.vantage.gaze) return subject.vantage.gaze->target;
  return subject.bounds.empty() ? glm::dvec3(0) : glm::dvec3(subject.bounds.center());
}

class Viewer {
 public:
  Viewer(const ViewCommand& options, const Subject& subject, Window& window)
      : options_(options),
        subject_(subject),
        window_(window),
        center_(center_of(subject)),
        world_from_upright_(upright_axes(subject.vantage.up)) {
    const FramePlan& plan = subject.plan;
    state_.path = plan.path;
    state_.path_frames = plan.frames;
    state_.method = options.method.empty() ? subject.methods.front() : options.method;
    state_.method_names = subject.methods;
    state_.can_split = subject.direct != nullptr;
    state_.moves = subject.moves;
    state_.methods = options.methods;
    state_.split = options.split;
    state_.vertical_fov = plan.path.keys.front().vertical_fov;
    state_.speed = float(0.2 * std::max(1e-3, double(subject.bounds.radius())));
  }

  Result<> save_last() {
    const std::filesystem::path file = options_.screenshot;
    if (Result<> made = make_folder(file.parent_path()); !made) return made;
    return save_png(file, read_window(width_, height_));
  }

  Result<> run() {
    for (int frame = 0; window_.begin_frame(); ++frame) {
      if (Result<> drawn = frame_of(frame); !drawn) return drawn;
      const bool last = !options_.screenshot.empty() && frame + 1 >= state_.path_frames;
      if (last) return save_last();
      window_.show();
    }
    if (!options_.screenshot.empty())
      return Error{options_.screenshot, "the window was closed before the end of the path"};
    return Done{};
  }

 private:
  Result<> frame_of(int frame) {
    if (Result<> ready = prepare(); !ready) return ready;
    const bool scripted = !options_.screenshot.empty();
    if (scripted) state_.path_frame = frame;
    if (state_.mode == ViewMode::play) {
      state_.time = frame_time(state_.path, state_.path_frame);
      state_.pose = pose_of(camera_at(state_.path, state_.time, 1, 1), world_from_upright_);
    } else {
      move_eye(state_, center_, window_.handle());
      if (state_.animate) state_.time += ImGui::GetIO().DeltaTime;
    }
    const Camera camera = state_.mode == ViewMode::play
                              ? camera_at(state_.path, state_.time, width_, height_)
                              : camera_of(state_, width_, height_);
    const double scene_time = options_.frames.scene_time(state_.time);
    const SoftwareTarget* memory = method_.frames->software_target();
    BackendTarget& target = memory ? static_cast<BackendTarget&>(software_) : *left_;
    const Result<double> ms = time_frame(*method_.frames, target, {camera, scene_time});
    if (!ms) return ms.error();
    measure(state_, method_.frames->stats(), *ms);
    state_.impostors.clear();
    if (method_.impostors) {
      const std::span<const ImpostorStatus> statuses = method_.impostors();
      state_.impostors.assign(statuses.begin(), statuses.end());
    }
    if (memory)
      memory_.show(memory->color(), 0, width_);
    else
      show_columns(left_->frame(), 0, width_);
    if (state_.split) {
      const Result<double> direct_ms = time_frame(*subject_.direct, *right_, {camera, scene_time});
      if (!direct_ms) return direct_ms.error();
      state_.direct_ms.add(float(*direct_ms));
      show_columns(right_->frame(), int(state_.split_at * float(width_)), width_);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    answer(read_on_request());
    show_panel(state_);
    window_.draw_panel();
    if (state_.mode == ViewMode::play && state_.animate && !scripted)
      state_.path_frame = (state_.path_frame + 1) % state_.path_frames;
    return Done{};
  }

  // The targets fit the window, the source fits the method.
  Result<> prepare() {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_.handle(), &width, &height);
    width = std::max(width, 1), height = std::max(height, 1);
    if (!left_ || width != width_ || height != height_) {
      width_ = width, height_ = height;
      for (auto* target : {&left_, &right_}) {
        Result<OpenGLTarget> made = OpenGLTarget::create(width, height, options_.frames.samples);
        if (!made) return made.error();
        *target = std::make_unique<OpenGLTarget>(std::move(*made));
      }
    }
    if (!state_.new_source) {
      if (method_.follow) method_.follow(state_.methods);
      return Done{};
    }
    state_.new_source = false;
    Result<Method> made = subject_.make(state_.method, state_.methods);
    if (!made) {
      if (!method_.frames) return made.error();
      // What the panel asked for cannot be: what there was is drawn on.
      state_.message = made.error().message();
      state_.method = name_;
      return Done{};
    }
    method_ = std::move(*made);
    name_ = state_.method;
    return Done{};
  }

  // The picture without the panel, if a screenshot was asked for.
  Rgba8Image read_on_request() {
    return state_.save_screenshot ? read_window(width_, height_) : Rgba8Image();
  }

  void answer(const Rgba8Image& picture) {
    if (state_.save_screenshot) {
      const std::string file = free_name("screenshot", ".png");
      state_.message = outcome(save_png(file, picture), file);
    }
    if (state_.save_path) {
      CameraPath path = state_.recorded;
      path.z_near = state_.path.z_near, path.z_far = state_.path.z_far;
      const std::string file = free_name("path", ".json");
      state_.message = path.keys.empty()
                           ? "set a key first"
                           : outcome(save_path(relative_to(-subject_.origin, path), file), file);
    }
    state_.save_screenshot = state_.save_path = false;
  }

  const ViewCommand& options_;
  const Subject& subject_;
  Window& window_;
  glm::dvec3 center_;
  glm::dmat3 world_from_upright_;
  ViewState state_;
  Method method_;
  std::string name_;  // of method_
  std::unique_ptr<OpenGLTarget> left_, right_;
  SoftwareBackendTarget software_;
  MemoryWindow memory_;
  int width_ = 0, height_ = 0;
};

Result<std::unique_ptr<Window>> open_window(const ViewCommand& options) {
  return Window::create("Rilievo - " + options.scene, options.frames.width, options.frames.height,
                        true);
}

Result<> view_scene(const ViewCommand& options) {
  const Result<OpenedScene> opened =
      open_scene(options.scene, options.limits, options.frames.scene_time(0), !options.frames.time);
  if (!opened) return opened.error();
  const Result<FramePlan> plan = plan_frames(options.frames, *opened);
  if (!plan) return plan.error();
  MethodOptions with = options.methods;
  const Result<ProgramScene> program =
      ProgramScene::create(options.scene, options.limits, opened->scene, with);
  if (!program) return program.error();
  const auto window = open_window(options);
  if (!window) return window.error();
  Stage stage(opened->scene, options.frames.samples, &opened->deformations);
  Result<Method> direct = stage.make_direct();
  if (!direct) return direct.error();
  const std::string first = default_method(options.methods);
  Subject subject{world_bounds(opened->scene), *plan, {first}, {}, direct->frames.get()};
  subject.origin = opened->scene.world.origin;
  subject.moves = opened->scene.duration > 0 || !opened->deformations.meshes.empty();
  for (const std::string& name : method_names())
    if (name != first) subject.methods.push_back(name);
  subject.make = [&](const std::string& method, MethodOptions methods) {
    set_eyes(*plan, methods);
    methods.program_scene = with.program_scene;
    methods.impostors.background = true;
    return stage.make(method, methods);
  };
  return Viewer(options, subject, **window).run();
}

Result<> view_file(const ViewCommand& options) {
  Result<PictureFileContent> content = open_representation(options.scene);
  if (!content) return content.error();
  const Kind& kind = *content->kind;
  if (!options.method.empty())
    if (Result<> known = expect_method_of(kind, options.method, "--method"); !known) return known;
  if (options.split) return Error{"--split", "a file has no direct drawing to compare with"};
  const Box bounds = content->representation->bounds();
  const Vantage vantage = content->representation->vantage();
  const Result<FramePlan> plan = plan_frames(options.frames, *content->representation);
  if (!plan) return plan.error();
  const auto window = open_window(options);
  if (!window) return window.error();
  const Scene nothing;
  Stage stage(nothing, options.frames.samples);
  Subject subject{bounds, *plan, kind_method_names(kind), {}, nullptr, vantage};
  subject.origin = content->representation->world.origin;
  subject.make = [&](const std::string& method, const MethodOptions& with) -> Result<Method> {
    // A drawable takes the representation for itself: the next method loads it again.
    if (!content->representation) {
      content = open_representation(options.scene);
      if (!content) return content.error();
    }
    return stage.make(method, with, std::move(content->representation));
  };
  return Viewer(options, subject, **window).run();
}

}  // namespace

Command view_command(CLI::App& app) {
  auto options = std::make_shared<ViewCommand>();
  CLI::App* command = app.add_subcommand("view", "Show a scene in a window");
  command
      ->add_option("SCENE", options->scene,
                   std::string(kSceneHelp) + "; or the OpenEXR file of a baked representation")
      ->required();
  command
      ->add_option("--method", options->method,
                   "The drawing method (default auto; for a file, its kind)")
      ->check(known_method());
  command->add_flag("--split", options->split,
                    "Show direct drawing in the right half of the window");
  command
      ->add_option("--screenshot", options->screenshot,
                   "Play the path once, save the window as a PNG file, and quit")
      ->type_name("FILE");
  add_frame_options(*command, options->frames);
  options->methods.max_spike = kInteractiveSpike;
  options->methods.by_clock = true;
  options->methods.fps = 60;
  add_method_options(*command, options->methods);
  add_file_limits(*command, options->limits);
  command->footer("Example: rilievo view builtin:bridge --split");
  return {command, [options](const std::string&) -> Result<> {
            if (Result<> good = expect_outputs({options->screenshot}); !good) return good;
            return holds_pictures(options->scene) ? view_file(*options) : view_scene(*options);
          }};
}

}  // namespace rilievo::app
