#include "rilievo/capture/store/picture_folder.h"

#include <array>
#include <span>

#include "rilievo/capture/store/content_hash.h"
#include "rilievo/capture/store/picture_bytes.h"
#include "rilievo/core/file.h"

namespace rilievo {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(8) << 30;

std::string hash_of(std::span<const std::byte> bytes) {
  ContentHash hash;
  hash.add(bytes);
  return hash.text();
}

}  // namespace

std::string picture_file_name(const PictureKey& key) {
  ContentHash hash;
  // Lengths, because the borders of texts count only to eight bytes.
  for (const std::string* text : {&key.content, &key.shader, &key.cell})
    hash.add(std::uint64_t(text->size())), hash.add(*text);
  hash.add(std::uint64_t(key.width)), hash.add(std::uint64_t(key.height));
  return hash.text() + ".picture";
}

bool PictureFolder::has(const PictureKey& key) const {
  std::error_code ignored;
  return std::filesystem::exists(folder_ / picture_file_name(key), ignored);
}

Result<std::optional<DepthImage>> PictureFolder::find(const PictureKey& key) {
  if (!has(key)) return std::optional<DepthImage>();
  const Result<std::string> file = read_file(folder_ / picture_file_name(key), kMaxBytes);
  if (!file) return file.error();
  const std::size_t digits = hash_of({}).size();
  if (file->size() < digits) return std::optional<DepthImage>();
  const auto bytes = std::as_bytes(std::span(*file)).subspan(digits);
  if (hash_of(bytes) != file->substr(0, digits)) return std::optional<DepthImage>();
  return picture_from_bytes(bytes);
}

Result<> PictureFolder::insert(const PictureKey& key, const DepthImage& picture) {
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed) return Error{folder_.string(), "cannot be made: " + failed.message()};
  const std::vector<std::byte> bytes = picture_bytes(picture);
  const std::string hash = hash_of(bytes);
  const std::array pieces{std::as_bytes(std::span(hash)), std::span<const std::byte>(bytes)};
  return write_file(folder_ / picture_file_name(key), pieces);
}

}  // namespace rilievo
