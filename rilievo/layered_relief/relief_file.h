// How are layered reliefs kept in a file?
//
// As their layered pictures (io/deep_exr.h): a deep part of an OpenEXR file each. What makes
// reliefs of them are string attributes:
//   rilievo.file.representation   "layered-relief"
//   rilievo.picture.merged        ReliefPictures::Picture::merged, metres
//   rilievo.picture.moved         ... and moved
//   rilievo.picture.lacks         ... and lacks; absent if not known
// Streams, tiles and quad-trees follow from the pictures and are made again on loading.
#pragma once

#include <filesystem>

#include "rilievo/core/world_space.h"
#include "rilievo/io/exr.h"
#include "rilievo/layered_relief/relief_pictures.h"

namespace rilievo {

// Colours are rounded to halfs (io/exr.h).
[[nodiscard]] Result<> save_relief_pictures(const std::filesystem::path& path,
                                            const ReliefPictures& pictures,
                                            const WorldSpace& world = {});

// Does a file, which may hold something else, say that it holds reliefs?
[[nodiscard]] bool matches_layered_relief(const FileAttributes& attributes);
// Of the pictures of a file, which `path` names in errors.
[[nodiscard]] Result<ReliefPictures> relief_pictures_from(PictureFile file,
                                                          const std::filesystem::path& path);

}  // namespace rilievo
