// A kind of representation.
//
// A row in the list of kinds (representation/kinds.h): its name, its options, and the functions
// that bake, load, save, describe and draw it. Code outside a kind's folder knows it only by this
// row.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/bounds.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/core/world_space.h"
#include "rilievo/io/exr.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/kind/option.h"

namespace rilievo {

// The baked data of a scene or an object, without any means to draw it.
class Representation {
 public:
  virtual ~Representation() = default;
  // The bounds of what it shows, world space at capture; eyes look there by default.
  [[nodiscard]] virtual Box bounds() const = 0;
  // Its memory, bytes.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  // The identifier that Output::object_id writes if the pictures show only one object.
  [[nodiscard]] virtual std::uint32_t only_object() const { return 1; }
  // The direction that is up and the best viewpoint, if the pictures tell.
  [[nodiscard]] virtual Vantage vantage() const { return {}; }
  // The default camera path; none: a path around the bounds.
  [[nodiscard]] virtual std::optional<CameraPath> walk() const { return {}; }

  // Where the space of its pictures lies in the world.
  WorldSpace world;
};

// One line of the output of `rilievo info`.
struct Fact {
  std::string key;    // in the JSON output
  std::string json;   // the value as JSON
  std::string label;  // in the text output, at most ten letters; empty: only in JSON
  std::string text;
};

// The source of a bake, and the part of it to bake.
struct BakeInput {
  CaptureSource& source;
  std::vector<std::uint32_t> objects;  // indices into the scene's objects; empty: all
  Box eyes = {};                       // the region of the eyes, world space; empty: unknown
  // Places in it that an eye takes one after the other; empty: unknown.
  std::vector<glm::vec3> eye_path = {};
};

// The result of a bake.
struct Baked {
  std::unique_ptr<Representation> representation;
  std::vector<Fact> facts;  // about the bake itself, for its report
};

// Called during long work with the number of pictures that are done.
using Progress = std::function<void(int done, int total)>;  // in pictures; may be empty

// Another name for a kind drawn in one of its ways.
struct Variant {
  std::string_view name;  // as a value of --method
  std::string_view option,
      value;  // an option of draw_options and its value; empty: a former name of the kind
};

// The content that a representation stands for.
enum class StandsFor {
  objects,       // one or several objects, seen from outside
  surroundings,  // everything visible from within a region, including the sky
};

// The part of a representation to export as a scene.
struct SceneRequest {
  int part = 0;        // index of a node, view, ...
  bool closed = true;  // close gaps that no picture shows
};

// A kind of representation. Functions marked so may be null.
struct Kind {
  std::string_view name;     // the value of --as and --method, and the name in files
  std::string_view summary;  // a short phrase for --help
  // Bakes sources that are deep images (CaptureSource::deep_images).
  bool takes_deep_images = false;
  std::span<const Variant> variants = {};
  // The options of bake, and those of make_drawable, which change no file.
  std::span<const Option> bake_options = {}, draw_options = {};
  StandsFor stands_for = StandsFor::objects;

  // Bakes the input. Fails where the source lacks something; the error says what.
  Result<Baked> (*bake)(const BakeInput&, const OptionValues&, const Progress&) = nullptr;
  // Checks, before time is spent, that the options go together. May be null.
  Result<> (*check_options)(const OptionValues&) = nullptr;

  // Returns whether a file with these attributes contains this kind.
  bool (*matches)(const FileAttributes&) = nullptr;
  // load() reads the planes of pictures itself, some at a time: it gets pictures without planes.
  bool reads_later = false;
  // Makes a representation of a file's pictures. The error names the file and the reason.
  Result<std::unique_ptr<Representation>> (*load)(PictureFile,
                                                  const std::filesystem::path&) = nullptr;
  // Saves a representation. The file is replaced at once or not at all.
  Result<> (*save)(const Representation&, const std::filesystem::path&) = nullptr;
  // The lines that `rilievo info` prints.
  std::vector<Fact> (*describe)(const Representation&) = nullptr;
  // Makes an ordinary textured mesh for other programs. Null if the kind has none.
  Result<Scene> (*to_scene)(const Representation&, const SceneRequest&) = nullptr;
};

// A backend's means to draw a kind; holds what its drawables share (shaders). Must outlive them.
class DrawableFactory {
 public:
  virtual ~DrawableFactory() = default;
  // An estimate of the memory that drawing a bake with these options takes, in bytes; for budgets.
  [[nodiscard]] virtual std::size_t expected_bytes(const OptionValues& bake,
                                                   const OptionValues& draw) const = 0;
  // Switches off bake options whose results this way of drawing does not use.
  virtual void spare(OptionValues& /*bake*/, const OptionValues& /*draw*/) const {}
  // Uploads a representation, or places it in memory.
  [[nodiscard]] virtual Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues& draw) = 0;
};

}  // namespace rilievo
