// How is a layered impostor kept in a file?
//
// As its pictures (io/exr.h): one part of an OpenEXR file a view, which any EXR tool opens. What
// makes a layered impostor of them are string attributes:
//   rilievo.file.representation   "layered-impostor"
//   rilievo.file.slicing          "LAYERS OVERLAP SPACING TEXELS": a whole number, a number,
//                                 eye_z or window_z, pieces or samples
//   rilievo.picture.fills         "NEIGHBOR LAYER X0 Y0 X1 Y1" for each slice that fills this
//                                 view's holes (S2.6), separated by "; ". In all views or in none:
//                                 without, they have not been looked for
// Slices, surfaces and neighbours follow from the pictures and are made again on loading.
#pragma once

#include <filesystem>

#include "rilievo/io/exr.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Colours are rounded to halfs (io/exr.h).
[[nodiscard]] Result<> save_layered_impostor(const std::filesystem::path& path,
                                             const LayeredImpostor& impostor);

// The error names the file and what is wrong with it: not an EXR, no layered impostor, broken
// pictures, attributes that contradict them.
[[nodiscard]] Result<LayeredImpostor> load_layered_impostor(const std::filesystem::path& path);

// The two steps of it, for a file that may hold something else. Does it say that its pictures are
// the views of a layered impostor?
[[nodiscard]] bool says_layered_impostor(const FileAttributes& attributes);
// Of the pictures of a file, which `path` names in errors.
[[nodiscard]] Result<LayeredImpostor> layered_impostor_from(PictureFile file,
                                                            const std::filesystem::path& path);

}  // namespace rilievo
