// How is a layered impostor stored in a file?
//
// As its pictures (io/exr.h): each view is a part of an OpenEXR file, which any EXR tool opens.
// These string attributes make them a layered impostor:
//   rilievo.file.representation   "layered-impostor"
//   rilievo.file.slicing          "LAYERS OVERLAP SPACING TEXELS": a whole number, a number,
//                                 eye_z or window_z, pieces or samples
//   rilievo.file.up               "X Y Z": the direction that is up, of any length
//   rilievo.file.gaze             "X Y Z X Y Z": an eye and the point that it looks at. If these
//                                 two are missing, y is up and default paths go around the bounds
//   rilievo.picture.fills         "NEIGHBOR LAYER X0 Y0 X1 Y1" for each slice that fills this
//                                 view's holes (S2.6), separated by "; ". In all views or in none:
//                                 without, they have not been looked for
// Slices, surfaces and neighbours follow from the pictures and are computed on loading.
#pragma once

#include <filesystem>

#include "rilievo/core/world_space.h"
#include "rilievo/io/exr.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Saves an impostor. Colours are rounded to half precision (io/exr.h).
[[nodiscard]] Result<> save_layered_impostor(const std::filesystem::path& path,
                                             const LayeredImpostor& impostor,
                                             const WorldSpace& world = {});

// Loads an impostor. The error names the file and the reason: not an EXR file, not a layered
// impostor, damaged pictures, or attributes that contradict them.
[[nodiscard]] Result<LayeredImpostor> load_layered_impostor(const std::filesystem::path& path);

// Do the attributes say that the pictures are the views of a layered impostor? For files that can
// contain something else.
[[nodiscard]] bool matches_layered_impostor(const FileAttributes& attributes);
// The impostor of a file's pictures; errors name `path`.
[[nodiscard]] Result<LayeredImpostor> layered_impostor_from(PictureFile file,
                                                            const std::filesystem::path& path);

}  // namespace rilievo
