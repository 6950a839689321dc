#include "rilievo/cache/gl/image_cache.h"

#include <optional>

#include "rilievo/gl/context.h"
#include "rilievo/nailboard/gl/nailboard_capture.h"

namespace rilievo {

// Pictures in an atlas of textures, captured by OpenGL or by the rasteriser.
class ImageCache::Store final : public CachePictures {
 public:
  Store(SceneRenderer& renderer, NailboardCapture pictures)
      : renderer_(renderer), pictures_(std::move(pictures)) {}

  [[nodiscard]] NailboardSet& pictures() override { return pictures_.set(); }
  [[nodiscard]] const AtlasSlot& atlas_slot(std::uint32_t slot) const { return *slots_[slot]; }

  [[nodiscard]] int max_picture_size() const override {
    return pictures_.set().atlas().max_picture_size();
  }
  [[nodiscard]] int texel_cell() const override { return AtlasAllocator::kCell; }
  [[nodiscard]] std::uint64_t max_texels() const override {
    return std::uint64_t(pictures_.set().atlas().allocator().layers()) *
           AtlasAllocator::kLayerSize * AtlasAllocator::kLayerSize;
  }
  [[nodiscard]] std::size_t bytes() const override { return pictures_.set().bytes(); }
  [[nodiscard]] DrawnBy drawn_by() const override { return DrawnBy::opengl; }
  [[nodiscard]] RasterSource* rasterizer() override { return pictures_.rasterizer(); }

  [[nodiscard]] bool allocate(std::uint32_t slot, int width, int height) override {
    if (slot >= slots_.size()) slots_.resize(slot + 1);
    slots_[slot] = pictures_.set().atlas().allocate(width, height);
    return slots_[slot].has_value();
  }
  void free(std::uint32_t slot) override {
    pictures_.set().atlas().free(*slots_[slot]);
    slots_[slot].reset();
  }
  void capture(std::uint32_t slot, const Camera& camera,
               std::span<const std::uint32_t> objects) override {
    pictures_.capture(camera, objects, *slots_[slot]);
  }
  [[nodiscard]] int written_bits() const override { return pictures_.set().atlas().delta_bits(); }
  void write(std::uint32_t slot, const RasterPicture& picture, int) override {
    pictures_.set().atlas().write(*slots_[slot], picture);
  }
  [[nodiscard]] GapTable gaps(const Camera& camera,
                              std::span<const std::uint32_t> objects) override {
    return pictures_.gaps(camera, objects);
  }
  [[nodiscard]] std::optional<DeltaRange> delta_range(std::uint32_t slot) override {
    return rilievo::delta_range(pictures_.set().atlas().blocks(*slots_[slot]));
  }
  void finish() override { gl::finish(); }
  void capture_objects(std::uint32_t slot, const Camera& camera,
                       std::span<const std::uint32_t> objects) override {
    pictures_.set().atlas().capture_objects(renderer_, camera, objects, *slots_[slot]);
  }
  void write_objects(std::uint32_t slot, std::span<const std::uint32_t> objects) override {
    pictures_.set().atlas().write_objects(*slots_[slot], objects);
  }
  void show(std::uint32_t slot, const PictureGeometry& geometry) override {
    pictures_.set().set_item(slot, *slots_[slot], geometry);
  }

 private:
  SceneRenderer& renderer_;
  NailboardCapture pictures_;
  std::vector<std::optional<AtlasSlot>> slots_;
};

ImageCache::ImageCache(SceneRenderer& renderer, std::unique_ptr<Store> store,
                       const ImageCacheOptions& options)
    : SceneFrames(renderer),
      store_(std::move(store)),
      cache_(std::make_unique<SceneCache>(renderer.placed(), *store_, options, content())) {}
ImageCache::~ImageCache() = default;
ImageCache::ImageCache(ImageCache&&) noexcept = default;

Result<std::unique_ptr<ImageCache::Store>> ImageCache::make_store(
    SceneRenderer& renderer, const ImageCacheOptions& options) {
  Result<NailboardCapture> pictures = NailboardCapture::create(
      renderer, options.capture_by, {options.max_bytes, options.delta_bits, options.samples},
      options.depth_mode);
  if (!pictures) return pictures.error();
  return {std::make_unique<Store>(renderer, std::move(*pictures))};
}

Result<std::unique_ptr<CachePictures>> ImageCache::make_pictures(SceneRenderer& renderer,
                                                                 const ImageCacheOptions& options) {
  Result<std::unique_ptr<Store>> store = make_store(renderer, options);
  if (!store) return store.error();
  return {std::move(*store)};
}

Result<ImageCache> ImageCache::create(SceneRenderer& renderer, const ImageCacheOptions& options) {
  if (options.levels)
    return Error{"levels", "the cache draws levels of detail without OpenGL only"};
  Result<std::unique_ptr<Store>> store = make_store(renderer, options);
  if (!store) return store.error();
  if (options.machine)
    if (Result<> known =
            expect_costs(*options.machine, DrawnBy::opengl, (*store)->rasterizer() != nullptr);
        !known)
      return known.error();
  return ImageCache(renderer, std::move(*store), options);
}

void ImageCache::add_alternatives(std::vector<ObjectDrawable> drawables,
                                  std::unique_ptr<DrawableFactory> factory) {
  cache_->add_alternatives(std::move(drawables), std::move(factory), content());
}

void ImageCache::add_surroundings(std::unique_ptr<Drawable> drawable,
                                  std::unique_ptr<DrawableFactory> factory,
                                  std::vector<std::uint32_t> objects) {
  cache_->add_surroundings(std::move(drawable), std::move(factory), std::move(objects), content());
}

void ImageCache::invalidate() { cache_->invalidate(content()); }
void ImageCache::finish_captures() { cache_->finish_captures(); }
void ImageCache::invalidate_object(std::uint32_t object) { cache_->invalidate_object(object); }
ImageCacheOptions& ImageCache::options() { return cache_->options(); }
void ImageCache::prepare_objects() { cache_->prepare_objects(); }

Result<> ImageCache::choose(const Camera& camera, FrameContent& content, FrameStats& stats) {
  outlines_ = cache_->options().outlines;
  sky_ = cache_->options().sky;
  cache_->choose(camera, content, stats);
  return Done{};
}

std::vector<ImageCache::Shown> ImageCache::shown() const {
  std::vector<Shown> shown;
  for (SceneCache::Shown& one : cache_->shown())
    shown.push_back({one.geometry, one.world_now_from_capture, one.bound_px, std::move(one.objects),
                     store_->atlas_slot(one.slot)});
  return shown;
}

std::vector<DepthImage> ImageCache::read_pictures() const {
  std::vector<DepthImage> read;
  for (const Shown& picture : shown()) {
    read.push_back(
        depth_image_from(store_->pictures().atlas().read(picture.slot, picture.geometry)));
    read.back().name =
        std::to_string(read.size()) + " of " + std::to_string(picture.objects.size()) + " objects";
  }
  return read;
}

}  // namespace rilievo
