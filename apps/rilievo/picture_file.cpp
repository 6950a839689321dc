#include "apps/rilievo/picture_file.h"

#include <nlohmann/json.hpp>

#include "apps/rilievo/kinds.h"
#include "rilievo/io/world_attributes.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/representation/load_representation.h"

namespace rilievo::app {
namespace {

constexpr char kFrame[] = "frame";

std::string text_of(const FramePictures& frame) {
  const Camera& camera = *frame.camera;
  const ImageWindow& window = camera.window;
  nlohmann::json pose = nlohmann::json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) pose.push_back(camera.world_from_eye[column][row]);
  return nlohmann::json{{"world_from_eye", pose},
                        {"window", {window.left, window.right, window.bottom, window.top}},
                        {"z_near", camera.z_near},
                        {"z_far", camera.z_far},
                        {"size", {camera.width, camera.height}},
                        {"delta_bits", frame.delta_bits}}
      .dump();
}

Result<> read_text(const std::string& text, const std::string& file, FramePictures& frame) {
  const Error broken{file, "the attribute of the frame's camera is broken"};
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return broken;
  // Numbers that are none of an int become 0, which is refused.
  const auto integer = [](const nlohmann::json& number) {
    const double value = number.get<double>();
    return 0 < value && value <= 1e6 ? int(value) : 0;
  };
  try {
    Camera camera;
    for (int i = 0; i < 16; ++i)
      camera.world_from_eye[i / 4][i % 4] = json.at("world_from_eye").at(i).get<double>();
    const auto& window = json.at("window");
    camera.window = {window.at(0).get<double>(), window.at(1).get<double>(),
                     window.at(2).get<double>(), window.at(3).get<double>()};
    camera.z_near = json.at("z_near").get<double>();
    camera.z_far = json.at("z_far").get<double>();
    camera.width = integer(json.at("size").at(0));
    camera.height = integer(json.at("size").at(1));
    frame.delta_bits = integer(json.at("delta_bits"));
    if (!validate(camera) || frame.delta_bits < 2 || frame.delta_bits > 16) return broken;
    frame.camera = camera;
  } catch (const nlohmann::json::exception&) {
    return broken;
  }
  return Done{};
}

}  // namespace

Result<> save_frame_pictures(const std::string& file, const FramePictures& frame) {
  FileAttributes attributes;
  store_world(frame.world, attributes.file);
  if (frame.camera) attributes.file[kFrame] = text_of(frame);
  return save_pictures(file, frame.pictures, attributes);
}

Result<PictureFileContent> open_pictures(const std::string& file) {
  // What it says of itself first: some kinds read its pictures as they need them.
  Result<PictureFile> loaded = load_picture_file(file, {0, 0});
  if (!loaded) return loaded.error();
  PictureFileContent content;
  content.kind = kind_of_file(kinds(), loaded->attributes);
  if (!content.kind || !content.kind->reads_later) {
    loaded = load_picture_file(file);
    if (!loaded) return loaded.error();
  }
  const Result<WorldSpace> world = world_from(loaded->attributes.file);
  if (!world) return Error{file, world.error().reason};
  content.frame.world = *world;
  if (content.kind) {
    Result<std::unique_ptr<Representation>> made = content.kind->load(std::move(*loaded), file);
    if (!made) return made.error();
    content.representation = std::move(*made);
    content.representation->world = *world;
    return content;
  }
  content.frame.pictures = std::move(loaded->pictures);
  const auto text = loaded->attributes.file.find(kFrame);
  if (text != loaded->attributes.file.end())
    if (Result<> read = read_text(text->second, file, content.frame); !read) return read.error();
  return content;
}

Result<PictureFileContent> open_representation(const std::string& file) {
  Result<LoadedRepresentation> loaded = load_representation(file);
  if (!loaded) return loaded.error();
  PictureFileContent content;
  content.kind = loaded->kind;
  content.representation = std::move(loaded->representation);
  return content;
}

}  // namespace rilievo::app
