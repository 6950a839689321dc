// Where do finished pictures stay from one run to the next? In a store, one SQLite file (S5.6).
//
// A picture is found by what it shows (a hash of the content), who made it (the shader and its
// options), the cell of the camera, and its size. Beside the file, SQLite keeps FILE-wal and
// FILE-shm while somebody has it open.
//
//   several processes  may use a file at once: each waits for the others for up to `wait_s`
//   kill -9            at any moment leaves each picture whole or absent (a write-ahead log, one
//                      transaction a picture); each picture's bytes are checked on reading, and a
//                      picture that does not fit its hash is dropped
//   a size limit       the least recently used pictures go first; a picture larger than the limit
//                      is not kept
//   other files        a newer store, another program's database, or no database at all is refused
//                      and left as it is; an older store is brought up to date
//
// Pictures come back to the bit. Safe for several threads. Only on little-endian machines.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"

namespace rilievo {

// What a picture is looked up by.
struct PictureKey {
  std::string content;  // content_hash(), or what stands for it
  std::string shader;   // with the options that change its pictures
  std::string cell;     // camera_cell()
  int width = 0, height = 0;
};

// The cell of a camera, as text: its projection, the cube with sides of `size` metres that its eye
// is in, and `aim`, an index of the caller's own of where it looks. Requires size > 0.
[[nodiscard]] std::string camera_cell(const Camera& camera, double size, int aim = 0);

// Where finished pictures are kept: a store, or a folder (picture_folder.h).
class PictureKeeper {
 public:
  virtual ~PictureKeeper() = default;
  // The picture of a key, if it is there.
  [[nodiscard]] virtual Result<std::optional<DepthImage>> find(const PictureKey& key) = 0;
  // Keeps a picture, instead of one of the same key. Requires a valid picture.
  [[nodiscard]] virtual Result<> insert(const PictureKey& key, const DepthImage& picture) = 0;
};

// How a store is opened.
struct StoreOptions {
  std::uint64_t max_bytes = std::uint64_t(4) << 30;  // of the pictures
  double wait_s = 10;                                // for other processes
};

// What a store has done since it was opened.
struct StoreStats {
  std::uint64_t found = 0, missed = 0, stored = 0, evicted = 0;
  std::uint64_t damaged = 0;  // dropped because their bytes were not what had been stored
};

// An open store.
class PictureStore final : public PictureKeeper {
 public:
  // Opens or makes the file. The error names it.
  [[nodiscard]] static Result<PictureStore> open(const std::filesystem::path& path,
                                                 const StoreOptions& options = {});
  PictureStore(PictureStore&&) noexcept;
  PictureStore& operator=(PictureStore&&) noexcept;
  ~PictureStore() override;

  // The picture of a key, if it is there; it then counts as used.
  [[nodiscard]] Result<std::optional<DepthImage>> find(const PictureKey& key) override;
  // Keeps a picture, instead of one of the same key, and lets others go. Requires a valid picture.
  [[nodiscard]] Result<> insert(const PictureKey& key, const DepthImage& picture) override;

  // The bytes and the number of the pictures.
  [[nodiscard]] Result<std::uint64_t> bytes();
  [[nodiscard]] Result<std::uint64_t> count();
  [[nodiscard]] StoreStats stats() const;

 private:
  struct State;
  explicit PictureStore(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
