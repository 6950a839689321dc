#include "rilievo/nailboard/software/software_store.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/capture/placed_raster.h"
#include "rilievo/core/expects.h"
#include "rilievo/nailboard/encode_picture.h"
#include "rilievo/nailboard/raster_gaps.h"
#include "rilievo/nailboard/software/software_nailboard_set.h"

namespace rilievo {
namespace {

// Texels a side of the largest picture, as an atlas on the GPU has it, so that both choose the same
// pictures; smaller where a large capture buffer would leave no room for pictures.
constexpr int kLargestPicture = 1024, kLargestOfLittle = kLargestPicture * 7 / 16;

std::size_t capture_bytes(int size, const NailboardStoreOptions& options) {
  return PlacedRaster::bytes(size, options.samples);
}
// At least as much again is for pictures.
std::size_t least_bytes(int size, const NailboardStoreOptions& options) {
  return 2 * capture_bytes(size, options);
}
int largest_picture(const NailboardStoreOptions& options) {
  return options.max_bytes < least_bytes(kLargestPicture, options) ? kLargestOfLittle
                                                                   : kLargestPicture;
}
// Rows are padded (software_nailboard.h); colours and codes take six bytes, without padding.
constexpr int kRowPadding = 16;
constexpr std::size_t kTexelBytes = 6;
// Memory of pictures that are gone, for the next ones.
constexpr std::size_t kMaxPooled = std::size_t(16) << 20;

// Pictures in memory, captured by the rasteriser.
class SoftwareStore final : public NailboardStore {
 public:
  SoftwareStore(const PlacedScene& placed, const NailboardStoreOptions& options)
      : samples_(options.samples),
        source_(placed),
        delta_bits_(options.delta_bits),
        largest_(largest_picture(options)),
        max_bytes_(options.max_bytes - capture_bytes(largest_, options)),
        pictures_(options.depth_mode) {}

  [[nodiscard]] SoftwareNailboardSet& pictures() override { return pictures_; }

  [[nodiscard]] int max_picture_size() const override { return largest_; }
  [[nodiscard]] int texel_cell() const override { return 2 * kRowPadding; }
  [[nodiscard]] std::uint64_t max_texels() const override { return max_bytes_ / kTexelBytes; }
  [[nodiscard]] std::size_t bytes() const override { return bytes_; }
  [[nodiscard]] DrawnBy drawn_by() const override { return DrawnBy::software; }
  [[nodiscard]] PlacedRaster* rasterizer() override { return &source_; }

  [[nodiscard]] bool allocate(std::uint32_t slot, int width, int height) override {
    const std::size_t needed = SoftwareNailboard::bytes_of(width, height);
    if (bytes_ + needed > max_bytes_) return false;
    if (slot >= slots_.size()) slots_.resize(slot + 1), sizes_.resize(slot + 1);
    RILIEVO_EXPECTS(sizes_[slot] == 0);
    if (!slots_[slot]) slots_[slot] = std::make_unique<SoftwareNailboard>();
    const std::size_t pooled = slots_[slot]->bytes();
    pooled_ -= pooled;
    // A picture counts with all memory that its slot holds, and holds hardly more than it needs:
    // the planner knows only of that. (Identifiers of objects, which few programs ask for, come on
    // top.)
    std::size_t bytes = std::max(needed, pooled);
    if (bytes > needed + needed / 16 || bytes_ + bytes > max_bytes_)
      *slots_[slot] = {}, bytes = needed;
    sizes_[slot] = bytes;
    bytes_ += bytes;
    if (bytes_ + pooled_ > max_bytes_) empty_pool();
    return true;
  }
  // The next picture of the slot takes over the memory, within limits.
  void free(std::uint32_t slot) override {
    bytes_ -= sizes_[slot];
    sizes_[slot] = 0;
    slots_[slot]->drop_objects();
    if (pooled_ + slots_[slot]->bytes() > kMaxPooled) *slots_[slot] = {};
    pooled_ += slots_[slot]->bytes();
  }
  void capture(std::uint32_t slot, const Camera& camera,
               std::span<const std::uint32_t> objects) override {
    write(slot, source_.draw(camera, objects, samples_), delta_bits_);
  }
  [[nodiscard]] int written_bits() const override { return 16; }
  void write(std::uint32_t slot, const RasterPicture& picture, int delta_bits) override {
    encode_picture(picture, delta_bits, encoded_);
    slots_[slot]->assign(picture.width, picture.height, picture.color, encoded_, delta_bits);
    if (slot >= ranges_.size()) ranges_.resize(slot + 1);
    ranges_[slot] = rilievo::delta_range({encoded_.blocks.data(), nullptr,
                                          std::size_t(blocks_across(picture.width)), 0,
                                          picture.width, picture.height});
  }
  [[nodiscard]] GapTable gaps(const Camera& camera,
                              std::span<const std::uint32_t> objects) override {
    return raster_gaps(source_.picture(), source_.draw_farthest(camera, objects), camera);
  }
  [[nodiscard]] std::optional<DeltaRange> delta_range(std::uint32_t slot) override {
    return ranges_[slot];
  }
  void finish() override {}
  void capture_objects(std::uint32_t slot, const Camera& camera,
                       std::span<const std::uint32_t> objects) override {
    write_objects(slot, source_.draw_objects(camera, objects).object);
  }
  void write_objects(std::uint32_t slot, std::span<const std::uint32_t> objects) override {
    slots_[slot]->assign_objects(objects, true);
  }
  void show(std::uint32_t slot, const PictureGeometry& geometry) override {
    pictures_.set_item(slot, *slots_[slot], geometry);
  }
  [[nodiscard]] Nailboard read(std::uint32_t slot, const PictureGeometry& geometry) const override {
    return slots_[slot]->copy(geometry);
  }
  void find_seen_shares(std::vector<float>& shares) override { pictures_.find_seen_shares(shares); }

 private:
  void empty_pool() {
    for (std::size_t slot = 0; slot < slots_.size(); ++slot)
      if (slots_[slot] && sizes_[slot] == 0) *slots_[slot] = {};
    pooled_ = 0;
  }

  int samples_;
  PlacedRaster source_;
  int delta_bits_, largest_;
  std::size_t max_bytes_, bytes_ = 0, pooled_ = 0;
  SoftwareNailboardSet pictures_;
  std::vector<std::unique_ptr<SoftwareNailboard>> slots_;  // they stay where they are
  std::vector<std::size_t> sizes_;                         // what each slot holds, bytes; 0: free
  std::vector<std::optional<DeltaRange>> ranges_;
  AtlasPicture encoded_;
};

}  // namespace

Result<> check_software_store(const NailboardStoreOptions& options) {
  if (!PlacedRaster::can_sample(options.samples))
    return Error{"pictures", "frames drawn without OpenGL have 1 or 4 samples a pixel"};
  if (options.capture_by == CaptureBy::opengl)
    return Error{"pictures", "OpenGL's captures need frames drawn by OpenGL"};
  const std::size_t least = least_bytes(kLargestOfLittle, options);
  if (options.max_bytes < least)
    return Error{"pictures", "the memory for pictures must be at least " +
                                 std::to_string((least >> 20) + 1) + " MB"};
  return Done{};
}

Result<std::unique_ptr<NailboardStore>> make_software_store(const PlacedScene& placed,
                                                            const NailboardStoreOptions& options) {
  if (Result<> possible = check_software_store(options); !possible) return possible.error();
  return {std::make_unique<SoftwareStore>(placed, options)};
}

}  // namespace rilievo
