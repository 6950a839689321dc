#include "rilievo/scene/gltf/document.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace rilievo::gltf {
namespace {

std::uint32_t little_endian32(Bytes b, std::size_t at) {
  return std::uint32_t(b[at]) | std::uint32_t(b[at + 1]) << 8 | std::uint32_t(b[at + 2]) << 16 |
         std::uint32_t(b[at + 3]) << 24;
}

// glTF 2.0, section 4: a header of 12 bytes, a JSON chunk, and perhaps a BIN chunk.
Bytes open_container(Bytes file, Document& document) {
  constexpr std::uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;
  if (file.size() < 12) refuse("is cut short: a .glb file has a header of 12 bytes");
  const std::uint32_t version = little_endian32(file, 4);
  if (version != 2) refuse("is glTF " + std::to_string(version) + ".0; only 2.0 can be read");
  const std::uint32_t length = little_endian32(file, 8);
  if (length > file.size())
    refuse("is cut short: it has " + std::to_string(file.size()) + " bytes, but announces " +
           std::to_string(length));
  if (length < file.size())
    document.context->warn("bytes behind the announced end of the file are left out");

  Bytes json;
  bool first = true;
  std::size_t at = 12;
  while (length - std::min<std::size_t>(at, length) >= 8) {
    const std::uint32_t size = little_endian32(file, at), type = little_endian32(file, at + 4);
    at += 8;
    if (size > length - at) refuse("has a chunk that reaches behind the end of the file");
    const Bytes chunk = file.subspan(at, size);
    if (first && type != kJson) refuse("does not begin with a JSON chunk");
    if (first) json = chunk;
    if (!first && type == kBin && !document.has_binary_chunk) {
      document.binary_chunk = chunk;
      document.has_binary_chunk = true;
    }
    first = false;
    at += size;
  }
  if (first) refuse("has no JSON chunk");
  return json;
}

// What nlohmann::json takes for a document, counted by the marks outside of its strings: an object
// or an array is a block of its own, a member a node of a map, an element a place in a vector that
// doubles as it grows, a string a block; what is in long strings, they take as in the file.
std::uint64_t memory_of_json(Bytes text) {
  std::uint64_t brackets = 0, colons = 0, commas = 0, strings = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::uint8_t c = text[i];
    if (in_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_string = !in_string;
      strings += in_string;
    } else if (!in_string) {
      brackets += c == '{' || c == '[';
      colons += c == ':';
      commas += c == ',';
    }
  }
  // The name of a member is no block of its own.
  const std::uint64_t values = strings - std::min(strings, colons);
  return 96 * brackets + 112 * colons + 32 * commas + 48 * values + text.size();
}

nlohmann::json parse_json(Bytes text, LoadContext& context) {
  if (text.size() >= 3 && text[0] == 0xEF && text[1] == 0xBB && text[2] == 0xBF)
    text = text.subspan(3);  // a byte order mark, which editors add
  context.budget.take(memory_of_json(text));
  try {
    return nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::exception& e) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ..."
    std::string what = e.what();
    if (const std::size_t end = what.find("] "); end != std::string::npos) what.erase(0, end + 2);
    // What was read last may be long, and is the file's own.
    what = what.substr(0, what.find("; last read: "));
    std::replace_if(
        what.begin(), what.end(), [](unsigned char c) { return c < 0x20; }, ' ');
    refuse("is not valid JSON: " + what.substr(0, 200));
  }
}

// Extensions whose meaning is kept, and those that only come close to it (with a warning where
// they are met).
constexpr std::array<std::string_view, 16> kSupported = {"KHR_texture_transform",
                                                         "KHR_lights_punctual",
                                                         "EXT_mesh_gpu_instancing",
                                                         "KHR_draco_mesh_compression",
                                                         "EXT_meshopt_compression",
                                                         "KHR_meshopt_compression",
                                                         "CESIUM_RTC",
                                                         "KHR_mesh_quantization",
                                                         "EXT_texture_webp",
                                                         "KHR_materials_unlit",
                                                         "KHR_materials_emissive_strength",
                                                         "KHR_materials_transmission",
                                                         "KHR_materials_ior",
                                                         "KHR_materials_volume",
                                                         "KHR_materials_pbrSpecularGlossiness",
                                                         "KHR_materials_variants"};

bool supported(const std::string& extension) {
  return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

// What to do about an extension that is not supported.
std::string remedy_for(const std::string& extension) {
  if (extension != "KHR_texture_basisu") return "";
  return ": 'gltf-transform ktxdecompress IN.glb OUT.glb' (npm: @gltf-transform/cli) makes PNG of "
         "its textures";
}

void check_versions_and_extensions(Document& document) {
  const JsonValue root = document.root();
  if (!document.json.is_object()) refuse("is JSON, but not a glTF document");
  const JsonValue asset = root["asset"];
  if (!asset) refuse("is JSON, but not a glTF document: it has no 'asset'");
  const std::string version = asset["version"].text();
  const std::string needed = asset["minVersion"].text("2.0");
  if (version.empty())
    refuse("does not say which glTF it is: asset.version is empty; 2.0 can be read");
  if (!version.starts_with("2.")) refuse("is glTF " + version + "; only 2.0 can be read");
  if (needed != "2.0") refuse("needs a reader of glTF " + needed + "; this one reads 2.0");

  const JsonValue required = root["extensionsRequired"];
  for (std::size_t i = 0; i < required.size(); ++i)
    if (const std::string name = required[i].text(); !supported(name))
      refuse("requires the extension " + name + ", which is not supported" + remedy_for(name));
  // One place that all counts from: near it, floats are exact.
  if (const JsonValue center = root["extensions"]["CESIUM_RTC"]["center"]; center.size() == 3) {
    std::string place;
    for (std::size_t i = 0; i < 3; ++i) place += " " + std::to_string(center[i].number());
    document.context->warn("coordinates count from the centre that CESIUM_RTC gives:" + place);
  }
  const JsonValue used = root["extensionsUsed"];
  for (std::size_t i = 0; i < used.size(); ++i)
    if (const std::string name = used[i].text(); !supported(name))
      document.context->warn("the extension " + name + " is not supported and left out");
}

// Many buffers may be one file.
Bytes read_once(Document& document, const std::string& uri) {
  const auto [known, fresh] = document.read.try_emplace(identity_of(uri, *document.context));
  if (fresh) {
    document.owned.push_back(read_uri(uri, *document.context));
    known->second = bytes_of(document.owned.back());
  }
  return known->second;
}

Bytes whole_buffer(Document& document, int i) {
  if (document.buffers[i]) return *document.buffers[i];
  const JsonValue buffer = document.root()["buffers"][std::size_t(i)];
  const std::uint64_t length = buffer["byteLength"].whole();
  Bytes bytes;
  if (buffer["uri"]) {
    try {
      bytes = read_once(document, buffer["uri"].text());
    } catch (const LoadError& fault) {
      buffer.fail(fault.reason);
    }
  } else if (i == 0 && document.has_binary_chunk) {
    bytes = document.binary_chunk;
  } else {
    buffer.fail("has neither a URI nor a binary chunk");
  }
  if (length > bytes.size())
    buffer.fail("has " + std::to_string(bytes.size()) + " bytes, but announces " +
                std::to_string(length));
  document.buffers[i] = bytes.first(length);
  return *document.buffers[i];
}

}  // namespace

Bytes read_buffer(Document& document, const JsonValue& view) {
  const int buffer = view["buffer"].required_index(document.count("buffers"));
  const std::uint64_t offset = view["byteOffset"].whole(0), length = view["byteLength"].whole();
  const Bytes bytes = whole_buffer(document, buffer);
  if (offset > bytes.size() || length > bytes.size() - offset)
    view.fail("reaches behind the end of buffers[" + std::to_string(buffer) + "]");
  return bytes.subspan(offset, length);
}

Bytes read_view(Document& document, std::size_t i) {
  if (document.views[i]) return *document.views[i];
  const JsonValue view = document.root()["bufferViews"][i];
  JsonValue meshopt = view["extensions"]["EXT_meshopt_compression"];
  if (!meshopt) meshopt = view["extensions"]["KHR_meshopt_compression"];
  if (meshopt) {
    document.owned.push_back(decode_meshopt(document, meshopt));
    document.views[i] = bytes_of(document.owned.back());
    if (document.views[i]->size() < view["byteLength"].whole())
      view.fail("decompresses to fewer bytes than it announces");
  } else {
    document.views[i] = read_buffer(document, view);
  }
  return *document.views[i];
}

std::uint32_t view_stride(const Document& document, std::size_t i) {
  const JsonValue stride = document.root()["bufferViews"][i]["byteStride"];
  if (!stride) return 0;
  const std::uint64_t bytes = stride.whole();
  if (bytes < 4 || bytes > 252) stride.fail("is not between 4 and 252");
  return std::uint32_t(bytes);
}

Document open_document(Bytes file, LoadContext& context) {
  Document document;
  document.context = &context;
  const bool binary =
      file.size() >= 4 && file[0] == 'g' && file[1] == 'l' && file[2] == 'T' && file[3] == 'F';
  document.json = parse_json(binary ? open_container(file, document) : file, context);
  check_versions_and_extensions(document);
  document.buffers.resize(document.count("buffers"));
  document.views.resize(document.count("bufferViews"));
  return document;
}

}  // namespace rilievo::gltf
