#include "rilievo/layered_relief/relief_drawable.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "rilievo/layered_relief/relief_bound.h"
#include "rilievo/layered_relief/relief_kind.h"
#include "rilievo/layered_relief/soften_silhouettes.h"

namespace rilievo {
namespace {

// In triangles, on a software rasteriser with two cores: 280 ns each. A sample is warped in some 2
// ns, and again where tiles overlap.
constexpr double kReliefSample = 0.01;

constexpr int kLargestPiece = 1024;

double bound_px(const ErrorModel& model, const glm::dmat4& world_from_capture,
                const Camera& frame) {
  const std::optional<Camera> camera = camera_at_capture(frame, world_from_capture);
  if (!camera) return std::numeric_limits<double>::infinity();
  return relief_bound_px(model.load<ReliefStats>(), model.bounds, *camera);
}

double gap_px(const ErrorModel& model, const glm::dmat4& world_from_capture, const Camera& frame) {
  const std::optional<Camera> camera = camera_at_capture(frame, world_from_capture);
  if (!camera) return std::numeric_limits<double>::infinity();
  return relief_gap_px(model.load<ReliefStats>(), model.bounds, *camera);
}

bool names_objects(const ReliefPictures& pictures) {
  for (const ReliefPictures::Picture& picture : pictures.pictures)
    for (const LayerSample& sample : picture.layers.samples)
      if (sample.object != kNoObject) return true;
  return false;
}

class ReliefDrawable final : public Drawable {
 public:
  ReliefDrawable(ReliefSet colors, ReliefSet identifiers, std::uint32_t only,
                 const ReliefStats& stats, const Box& bounds, const PrewarpOptions& options,
                 PrewarpedBoards& boards)
      : colors_(std::move(colors)),
        identifiers_(std::move(identifiers)),
        only_(only),
        stats_(stats),
        bounds_(bounds),
        boards_(boards),
        drawer_(boards.make_drawer()) {
    for (const LayeredRelief& relief : colors_.reliefs) prewarps_.emplace_back(relief, options);
    for (const LayeredRelief& relief : identifiers_.reliefs)
      identifier_prewarps_.emplace_back(relief, options);
  }
  ~ReliefDrawable() override {
    for (const Shown& shown : shown_) release(shown);
  }

  [[nodiscard]] std::string_view kind() const override { return kLayeredReliefName; }

  void draw(const Camera& frame, std::span<const Instance> instances, Output output) override {
    // Objects that are not told by the caller are in the reliefs, if they show several.
    const bool own = output == Output::object_id && !identifiers_.reliefs.empty();
    std::size_t first = 0;
    while (first < instances.size()) {
      const std::size_t end = place(frame, instances, first, own);
      for (std::size_t i = first; i < end; ++i) add_boards(instances[i], shown_[i - first], own);
      drawer_->draw(frame, placed_, output);
      first = end;
    }
  }
  void draw_outlines(const Camera& frame, std::span<const Instance> instances) override {
    std::size_t first = 0;
    while (first < instances.size()) {
      const std::size_t end = place(frame, instances, first, false);
      for (std::size_t i = first; i < end; ++i) add_boards(instances[i], shown_[i - first], false);
      drawer_->draw_outlines(frame, placed_);
      first = end;
    }
  }

  [[nodiscard]] const TileDrawer* tiles() const override { return drawer_->tiles(); }
  [[nodiscard]] const TileDrawer* outline_tiles() const override {
    return drawer_->outline_tiles();
  }

  [[nodiscard]] ErrorModel error_model(std::uint32_t) const override {
    ErrorModel model;
    model.bound = bound_px;
    model.gap = gap_px;
    model.bounds = bounds_;
    model.texel = double(stats_.largest_texel);
    model.store(stats_);
    return model;
  }
  [[nodiscard]] CostTerms cost_terms(std::uint32_t) const override {
    std::size_t samples = 0;
    for (const LayeredRelief& relief : colors_.reliefs)
      samples = std::max(samples, relief.samples());
    CostTerms cost = boards_.cost_terms();
    cost.fixed += kReliefSample * double(samples);
    return cost;
  }
  [[nodiscard]] std::size_t bytes() const override {
    std::size_t sum = 0;
    for (const LayeredRelief& relief : colors_.reliefs) sum += rilievo::bytes(relief);
    for (const LayeredRelief& relief : identifiers_.reliefs) sum += rilievo::bytes(relief);
    return sum;
  }

 private:
  struct Part {
    PrewarpedBoard board;
    PictureGeometry geometry;  // at capture
  };
  // What was warped for an instance.
  struct Shown {
    Camera camera;  // at capture
    bool identifiers = false;
    std::vector<Part> parts;
  };

  void release(const Shown& shown) {
    for (const Part& part : shown.parts) boards_.release(part.board);
  }
  [[nodiscard]] bool is_current(const Shown& shown, const Camera& camera, bool identifiers) {
    return shown.camera == camera && (shown.identifiers || !identifiers) &&
           std::all_of(shown.parts.begin(), shown.parts.end(),
                       [&](const Part& part) { return boards_.use(part.board); });
  }

  // Instances [first, end) get boards, as many as there is room for, at least one; shown_[0] is of
  // the first.
  std::size_t place(const Camera& frame, std::span<const Instance> instances, std::size_t first,
                    bool identifiers) {
    boards_.begin();
    placed_.clear();
    for (std::size_t k = instances.size(); first == 0 && k < shown_.size(); ++k) {
      release(shown_[k]);
      shown_[k].parts.clear();
      shown_[k].camera = {};
    }
    std::size_t end = first;
    for (; end < instances.size(); ++end) {
      const std::size_t k = end - first;
      if (k == shown_.size()) shown_.emplace_back();
      Shown& shown = shown_[k];
      const std::optional<Camera> camera =
          camera_at_capture(frame, instances[end].world_from_capture);
      if (camera && is_current(shown, *camera, identifiers)) continue;
      release(shown);
      shown.parts.clear();
      if (!camera) continue;
      if (!warp(*camera, identifiers, shown) && end > first) break;
    }
    return std::max(end, first + 1);
  }

  // False if there is no room. An eye that nothing can be warped for sees nothing.
  bool warp(const Camera& camera, bool identifiers, Shown& shown) {
    shown.camera = camera;
    shown.identifiers = identifiers;
    int picked = pick_relief(stats_, bounds_, camera.position());
    if (picked < 0) picked = pick_relief(colors_, camera.position());
    if (picked < 0) return true;
    const auto index = std::size_t(picked);
    if (!prewarps_[index].warp(camera.position(), &camera, whole_) || whole_.color.empty())
      return true;
    const double focal = camera.width / (camera.window.right - camera.window.left);
    const Camera& capture = whole_.geometry.capture;
    const double texel_px = focal * (capture.window.right - capture.window.left) / capture.width;
    const int level = relief_level(texel_px, double(stats_.texel_px));
    // Halves have the mean of what is covered.
    if (level > 0)
      halve_prewarped(whole_, level, halved_, scratch_);
    else if (!colors_.reliefs[index].perspective())
      soften_silhouettes(whole_);
    const Prewarped& result = level > 0 ? halved_ : whole_;
    for (const PicturePiece& piece : pieces_of(result.width(), result.height(), kLargestPiece)) {
      const std::optional<PrewarpedBoard> board = boards_.place(piece.width, piece.height);
      if (!board) {
        release(shown);
        shown.parts.clear();
        shown.camera = {};
        return false;
      }
      boards_.write(*board, result, piece);
      shown.parts.push_back({*board, geometry_of(result.geometry, piece)});
    }
    if (identifiers) write_identifiers(index, camera, level, shown);
    return true;
  }

  void write_identifiers(std::size_t index, const Camera& camera, int level, const Shown& shown) {
    if (!identifier_prewarps_[index].warp(camera.position(), &camera, whole_)) return;
    if (level > 0) halve_identifiers(whole_, level, halved_, scratch_);
    const Prewarped& result = level > 0 ? halved_ : whole_;
    std::size_t part = 0;
    std::vector<std::uint32_t> objects;
    for (const PicturePiece& piece : pieces_of(result.width(), result.height(), kLargestPiece)) {
      objects.resize(std::size_t(piece.width) * std::size_t(piece.height));
      for (int y = 0; y < piece.height; ++y) {
        const std::size_t from =
            std::size_t(piece.y + piece.height - 1 - y) * std::size_t(result.width()) +
            std::size_t(piece.x);
        std::memcpy(&objects[std::size_t(y) * std::size_t(piece.width)], &result.color[from],
                    std::size_t(piece.width) * sizeof(std::uint32_t));
      }
      boards_.write_objects(shown.parts[part++].board, objects);
    }
  }

  void add_boards(const Instance& instance, const Shown& shown, bool own) {
    const std::uint32_t object = own ? kNoObject : object_of(instance, only_);
    for (const Part& part : shown.parts)
      placed_.push_back({part.board, placed(part.geometry, instance.world_from_capture), object,
                         instance.from, instance.to});
  }

  ReliefSet colors_, identifiers_;  // identifiers: of several objects, else empty
  std::uint32_t only_;              // the object, if it is one
  ReliefStats stats_;
  Box bounds_;
  PrewarpedBoards& boards_;
  std::unique_ptr<BoardDrawer> drawer_;
  std::vector<Prewarp> prewarps_, identifier_prewarps_;
  // Kept, so that drawing does not allocate.
  std::vector<Shown> shown_;
  std::vector<PlacedBoard> placed_;
  Prewarped whole_, halved_, scratch_;
};

class ReliefFactory final : public DrawableFactory {
 public:
  explicit ReliefFactory(std::unique_ptr<PrewarpedBoards> boards) : boards_(std::move(boards)) {}

  [[nodiscard]] std::size_t expected_bytes(const OptionValues& bake,
                                           const OptionValues&) const override {
    const ReliefCaptureOptions options = relief_capture_options(bake);
    // Half of a texture shows something, two surfaces on each line of sight; 32 bytes a sample.
    // What the textures share is three quarters as much again.
    const std::size_t bytes = options.share_texels > 0 ? 56 : 32;
    return std::size_t(options.textures) * std::size_t(options.size) * std::size_t(options.size) *
           bytes;
  }
  [[nodiscard]] Result<std::unique_ptr<Drawable>> make_drawable(
      std::unique_ptr<Representation> representation, const OptionValues& draw) override {
    const auto& relief = dynamic_cast<const ReliefRepresentation&>(*representation);
    return make_relief_drawable(relief.pictures, *boards_, relief_draw_options(draw));
  }

 private:
  std::unique_ptr<PrewarpedBoards> boards_;
};

}  // namespace

Result<std::unique_ptr<Drawable>> make_relief_drawable(const ReliefPictures& pictures,
                                                       PrewarpedBoards& boards,
                                                       const PrewarpOptions& options) {
  Result<ReliefSet> colors = make_relief_set(pictures);
  if (!colors) return colors.error();
  ReliefSet identifiers;
  const std::uint32_t only = only_object(pictures);
  if (only == kNoObject && names_objects(pictures)) {
    Result<ReliefSet> made = make_relief_set(pictures, true);
    if (!made) return made.error();
    identifiers = *std::move(made);
  }
  double moved = 0, lacks = 0;
  bool known = true;
  for (const ReliefPictures::Picture& picture : pictures.pictures) {
    moved = std::max(moved, picture.moved);
    lacks = std::max(lacks, picture.lacks);
    known = known && picture.lacks > 0;
  }
  const ReliefStats stats =
      relief_stats(*colors, pictures.bounds, moved, options, known ? lacks : 0, pictures.strokes);
  return {std::make_unique<ReliefDrawable>(*std::move(colors), std::move(identifiers), only, stats,
                                           pictures.bounds, options, boards)};
}

std::unique_ptr<DrawableFactory> make_relief_factory(std::unique_ptr<PrewarpedBoards> boards) {
  return std::make_unique<ReliefFactory>(std::move(boards));
}

}  // namespace rilievo
