// Writes the files of a walk for browsers (walk.h).
//
// Pictures come first, under names that follow from their contents; then the page; then the
// manifest, so that a folder with a manifest is whole. Files of an earlier walk in the folder that
// the manifest no longer names are removed at the end.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "rilievo/core/result.h"
#include "rilievo/web_walk/walk.h"

namespace rilievo {

// The writer of one walk.
class WalkWriter {
 public:
  // Checks that the folder is missing, empty, or holds a walk: other folders are refused.
  // The first file makes it.
  [[nodiscard]] static Result<WalkWriter> create(const std::filesystem::path& folder);
  WalkWriter(WalkWriter&&) noexcept;
  WalkWriter& operator=(WalkWriter&&) noexcept;
  ~WalkWriter();

  // Writes a file, once for equal contents. `extension` is "webp" or "bin". Any thread.
  [[nodiscard]] Result<WalkFile> add(std::span<const std::uint8_t> bytes,
                                     std::string_view extension);

  // Writes the page and the manifest.
  [[nodiscard]] Result<> finish(const WalkManifest& manifest);

  // The number and the bytes of all files written so far, the page included.
  [[nodiscard]] std::size_t files() const;
  [[nodiscard]] std::size_t bytes() const;
  // The bytes until the first view that can be walked: the page, the manifest, the sketches, and
  // the coarsest level of the node nearest to where the walk begins. After finish().
  [[nodiscard]] std::size_t first_view_bytes(const WalkManifest& manifest) const;

 private:
  struct State;
  explicit WalkWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
