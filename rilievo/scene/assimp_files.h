// The files that assimp may see: the scene itself, from memory, and material libraries beside it.
// Internal to loading.
#pragma once

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <map>
#include <optional>
#include <string>

#include "rilievo/scene/load_context.h"

namespace rilievo {

// Text in UTF-16 (with its byte order mark) as UTF-8; other text as it is, less a mark.
[[nodiscard]] std::string utf8_from(Bytes text);

// One file is given by name and content; every other one is read beside the scene, and its absence
// is a warning.
class AssimpFiles : public Assimp::IOSystem {
 public:
  AssimpFiles(const std::string& name, std::string bytes, LoadContext& context);
  bool Exists(const char* name) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override;
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const std::string* find(const char* name) const;

  LoadContext& context_;
  mutable std::map<std::string, std::optional<std::string>> files_;  // nothing: not readable
};

}  // namespace rilievo
