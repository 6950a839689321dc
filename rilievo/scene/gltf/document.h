// A glTF 2.0 document and the bytes behind it. Internal to loading; throws LoadError.
//
// The document stays JSON: every reader takes from it what it understands, and checks it there.
// Buffers are read, and compressed views decoded, when first asked for.
#pragma once

#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/io/load_context.h"
#include "rilievo/scene/gltf/json.h"

namespace rilievo::gltf {

struct Document {
  nlohmann::json json;
  Bytes binary_chunk;  // of a .glb: what buffer 0 holds
  bool has_binary_chunk = false;
  std::vector<std::optional<Bytes>> buffers, views;  // once read; empty until then
  std::deque<std::string> owned;                     // what they point to
  std::map<std::string, Bytes> read;                 // what was at a URI, by identity_of()
  LoadContext* context = nullptr;

  [[nodiscard]] JsonValue root() const { return JsonValue(json); }
  [[nodiscard]] std::size_t count(const char* array) const { return root()[array].size(); }
};

// `file` must outlive the document. Checks the container, the version and extensionsRequired.
[[nodiscard]] Document open_document(Bytes file, LoadContext& context);

// What a URI holds: "data:" decoded, or the neighbouring file that it names.
[[nodiscard]] std::string read_uri(const std::string& uri, LoadContext& context);

// The same for all URIs that say the same, or lead to the same file.
[[nodiscard]] std::string identity_of(const std::string& uri, const LoadContext& context);

// bufferViews[i], decompressed if it is compressed.
[[nodiscard]] Bytes read_view(Document& document, std::size_t i);
// Its stride in bytes; 0 if its elements are tightly packed.
[[nodiscard]] std::uint32_t view_stride(const Document& document, std::size_t i);

// EXT_meshopt_compression: the decoded content of bufferViews[i], whose `extension` that is.
[[nodiscard]] std::string decode_meshopt(Document& document, const JsonValue& extension);

// `length` bytes of buffers[i] from `offset`.
[[nodiscard]] Bytes read_buffer(Document& document, const JsonValue& view);

}  // namespace rilievo::gltf
