#include "rilievo/scene/assimp_files.h"

#include <algorithm>
#include <cstring>

namespace rilievo {
namespace {

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(const std::string& bytes) : bytes_(bytes) {}
  size_t Read(void* to, size_t size, size_t count) override {
    if (size == 0) return 0;
    const std::size_t n = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, n * size);
    at_ += n * size;
    return n;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    if (offset > bytes_.size() - base) return aiReturn_FAILURE;
    at_ = base + offset;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::string utf8_from(Bytes text) {
  const bool little = text.size() >= 2 && text[0] == 0xFF && text[1] == 0xFE;
  const bool big = text.size() >= 2 && text[0] == 0xFE && text[1] == 0xFF;
  if (!little && !big) {
    const bool mark = text.size() >= 3 && text[0] == 0xEF && text[1] == 0xBB && text[2] == 0xBF;
    const Bytes body = text.subspan(mark ? 3 : 0);
    return {reinterpret_cast<const char*>(body.data()), body.size()};
  }
  std::string out;
  std::uint32_t high = 0;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    std::uint32_t c = little ? text[i] | text[i + 1] << 8 : text[i] << 8 | text[i + 1];
    if (c >= 0xD800 && c < 0xDC00) {
      high = c;
      continue;
    }
    if (c >= 0xDC00 && c < 0xE000) {
      c = high ? 0x10000 + ((high - 0xD800) << 10) + (c - 0xDC00) : 0xFFFD;
      high = 0;
    }
    if (c < 0x80) {
      out += char(c);
    } else if (c < 0x800) {
      out += {char(0xC0 | c >> 6), char(0x80 | (c & 0x3F))};
    } else if (c < 0x10000) {
      out += {char(0xE0 | c >> 12), char(0x80 | (c >> 6 & 0x3F)), char(0x80 | (c & 0x3F))};
    } else {
      out += {char(0xF0 | c >> 18), char(0x80 | (c >> 12 & 0x3F)), char(0x80 | (c >> 6 & 0x3F)),
              char(0x80 | (c & 0x3F))};
    }
  }
  return out;
}

AssimpFiles::AssimpFiles(const std::string& name, std::string bytes, LoadContext& context)
    : context_(context) {
  files_.emplace(name, std::move(bytes));
}

const std::string* AssimpFiles::find(const char* name) const {
  const std::string path = std::filesystem::path(name).lexically_normal().string();
  const auto [known, fresh] = files_.try_emplace(path);
  if (fresh) {
    try {
      known->second = utf8_from(bytes_of(read_neighbor(context_, path)));
    } catch (const LoadFault& fault) {
      context_.warn("a material library is left out: " + fault.reason);
    }
  }
  return known->second ? &*known->second : nullptr;
}

bool AssimpFiles::Exists(const char* name) const { return find(name) != nullptr; }

Assimp::IOStream* AssimpFiles::Open(const char* name, const char* mode) {
  if (std::strchr(mode, 'r') == nullptr) return nullptr;
  const std::string* const bytes = find(name);
  return bytes ? new MemoryStream(*bytes) : nullptr;
}

}  // namespace rilievo
