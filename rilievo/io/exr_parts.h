// What writers of several parts share: names, attributes of callers, one display window.
//
// Internal to `io`. Errors carry no path: whoever opened the file adds it.
#pragma once

#include <ImfHeader.h>

#include <set>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/io/exr.h"

namespace rilievo::exr {

// Parts must be named, each differently; pictures need not be.
[[nodiscard]] std::string unique_name(const std::string& wanted, std::set<std::string>& taken);

// Of the file and of each picture: are all keys 1 to 200 printable characters?
[[nodiscard]] Result<> check_attributes(const FileAttributes& attributes);

// Into the headers of all parts, one a picture.
void insert_attributes(std::vector<Imf::Header>& headers, const FileAttributes& attributes);

// Those of a header whose names begin so.
[[nodiscard]] Attributes attributes_of(const Imf::Header& header, std::string_view prefix);

// What OpenEXR wants to be the same in all parts of a file: one display window that holds every
// picture at its upper left corner, and one width of a pixel over its height (1 if they differ).
struct Shared {
  int width = 1, height = 1;
  float aspect = 1.0f;
};
[[nodiscard]] Shared shared_by(std::span<const Camera> cameras);

// A part's header: windows and camera; no channels yet.
[[nodiscard]] Imf::Header part_header(const Camera& camera, DepthKind depth_kind,
                                      const std::string& name, const std::string& part_name,
                                      const Shared& shared, Imf::Compression compression);

}  // namespace rilievo::exr
