// What is a kind of representation?
//
// One row of the list of kinds (representation/kinds.h): its name, its options, and how it is
// baked, kept in a file, described and made drawable. Everything outside a kind's folder knows it
// only by this row.
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
#include "rilievo/io/exr.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/kind/option.h"

namespace rilievo {

// What a kind keeps of a scene or of an object, without any way of drawing it.
class Representation {
 public:
  virtual ~Representation() = default;
  // World at capture; where an eye looks by default.
  [[nodiscard]] virtual Box bounds() const = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  // What Output::object_id writes where the pictures show but one object.
  [[nodiscard]] virtual std::uint32_t only_object() const { return 1; }
  // Which way is up and from where it is best looked at, where the pictures tell.
  [[nodiscard]] virtual Vantage vantage() const { return {}; }
  // Where to walk by default; nothing: around the bounds.
  [[nodiscard]] virtual std::optional<CameraPath> walk() const { return {}; }
};

// One line of what `rilievo info` says.
struct Fact {
  std::string key;    // of the JSON output
  std::string json;   // its value, as JSON
  std::string label;  // of the line of text, at most ten letters; empty: only in JSON
  std::string text;
};

// What a bake is made from, and of which part of it.
struct BakeInput {
  CaptureSource& source;
  std::vector<std::uint32_t> objects;  // indices into the scene's objects; empty: all
  Box eyes = {};                       // where eyes will be; empty: not known
};

struct Baked {
  std::unique_ptr<Representation> representation;
  std::vector<Fact> facts;  // about the bake itself, for its report
};

using Progress = std::function<void(int done, int total)>;  // in pictures; may be empty

// Another name for a kind drawn in one of its ways.
struct Variant {
  std::string_view name;           // as --method has it
  std::string_view option, value;  // of draw_options; empty: none, a former name of the kind
};

// What does a representation stand for?
enum class StandsFor {
  objects,       // one object or several, seen from outside
  surroundings,  // all that is seen from within a region, the sky too
};

// Of what a representation exports.
struct SceneRequest {
  int part = 0;        // one of its nodes, views ...
  bool closed = true;  // gaps that no picture has seen are closed
};

struct Kind {
  std::string_view name;     // "layered-impostor": as --as, --method and files have it
  std::string_view summary;  // half a sentence, for --help
  std::span<const Variant> variants = {};
  // Of bake; and of make_drawable, which changes no file.
  std::span<const Option> bake_options = {}, draw_options = {};
  StandsFor stands_for = StandsFor::objects;

  // The error says what the source lacks.
  Result<Baked> (*bake)(const BakeInput&, const OptionValues&, const Progress&) = nullptr;
  // Options that do not go together; asked before time is spent. May be null.
  Result<> (*check_options)(const OptionValues&) = nullptr;

  // Does a file with these attributes hold this kind?
  bool (*says)(const FileAttributes&) = nullptr;
  // Does load() read the planes of pictures itself, some at a time? Then it gets none.
  bool reads_later = false;
  // The error names the file and what is wrong with it.
  Result<std::unique_ptr<Representation>> (*load)(PictureFile,
                                                  const std::filesystem::path&) = nullptr;
  Result<> (*save)(const Representation&, const std::filesystem::path&) = nullptr;
  std::vector<Fact> (*describe)(const Representation&) = nullptr;
  // The same as an ordinary textured mesh, for other programs; null where a kind is none.
  Result<Scene> (*to_scene)(const Representation&, const SceneRequest&) = nullptr;
};

// One backend's way to draw a kind: what instances of it share (shaders) is made once. Must outlive
// its drawables.
class DrawableFactory {
 public:
  virtual ~DrawableFactory() = default;
  // Memory that drawing a bake with these options will take; an estimate for budgets.
  [[nodiscard]] virtual std::size_t expected_bytes(const OptionValues& bake,
                                                   const OptionValues& draw) const = 0;
  // Switches off what a bake need not do for this way of drawing alone.
  virtual void spare(OptionValues& /*bake*/, const OptionValues& /*draw*/) const {}
  [[nodiscard]] virtual Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues& draw) = 0;
};

}  // namespace rilievo
