// Finished pictures in a folder, a file each.
//
// For what several machines make: no file is ever changed, each appears complete or not at all (a
// rename), and a folder on a network drive does. A picture whose bytes do not fit their hash counts
// as missing. Little-endian machines; any number of processes and threads.
#pragma once

#include <filesystem>
#include <string>

#include "rilievo/capture/store/picture_store.h"

namespace rilievo {

// The name of a picture's file.
[[nodiscard]] std::string picture_file_name(const PictureKey& key);

// A folder of pictures.
class PictureFolder final : public PictureKeeper {
 public:
  // Made when the first picture is kept.
  explicit PictureFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  // Is there a file of that name? It may be damaged.
  [[nodiscard]] bool has(const PictureKey& key) const;
  [[nodiscard]] Result<std::optional<DepthImage>> find(const PictureKey& key) override;
  [[nodiscard]] Result<> insert(const PictureKey& key, const DepthImage& picture) override;

 private:
  std::filesystem::path folder_;
};

}  // namespace rilievo
