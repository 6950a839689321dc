// Is a picture rendered, or was it before? A capture source that looks into a store first. (S5.6)
//
// A picture is kept for the cell of its eye, a cube with a side of a hundredth of the distance from
// what it shows, or less: whoever asks from the same cell gets it with its own camera, which a warp
// makes up for. Where that is not good enough, as in a bake, eyes are told apart to the bit
// (`exact`), and the sky and layers are kept, too. A store that fails costs renderings, nothing
// else. As safe for threads as the source that renders; several may share a store.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/store/picture_store.h"

namespace rilievo {

// What pictures are kept by.
struct KeptOptions {
  std::string content;  // content_hash(), or what stands for it
  std::string shader;   // with the options that change its pictures
  // Gets the first failure of the store, once.
  std::function<void(const std::string&)> warn = {};
  bool exact = false;  // only for the very same camera, to the bit
};

// The key of the picture of a request; `bounds`: of what it shows.
[[nodiscard]] PictureKey kept_key(const CaptureRequest& request, const Box& bounds,
                                  const KeptOptions& options);
// The keys under which the layers of a request are kept, as two pictures: how many each texel has,
// and all of them in a row. Exact.
struct LayersKeys {
  PictureKey counts, samples;
};
[[nodiscard]] LayersKeys kept_keys(const LayersRequest& request, const KeptOptions& options);

// A source with a store in front of it.
class KeptSource final : public ForwardingSource {
 public:
  // Both must outlive it. Without a store everything is rendered.
  KeptSource(CaptureSource& source, PictureKeeper* store, KeptOptions options)
      : ForwardingSource(source), store_(store), options_(std::move(options)) {}

  // Pictures with farthest depths are not kept, and those with the sky only if exact. Fails where
  // the source does.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  // Kept if exact. Fails where the source does.
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override;

  // The pictures that the source rendered, and those that the store had. Any thread.
  [[nodiscard]] std::uint64_t rendered() const { return rendered_; }
  [[nodiscard]] std::uint64_t found() const { return found_; }

 private:
  void fail(const Error& error);
  [[nodiscard]] std::optional<DepthImage> find(const PictureKey& key);
  void insert(const PictureKey& key, const DepthImage& picture);
  [[nodiscard]] std::optional<LayeredDepthImage> find_layers(const LayersKeys& keys,
                                                             const Camera& camera);

  PictureKeeper* store_;
  KeptOptions options_;
  std::atomic<std::uint64_t> rendered_{0}, found_{0};
  bool warned_ = false;
};

}  // namespace rilievo
