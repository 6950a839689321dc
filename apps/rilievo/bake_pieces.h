// A bake in pieces: its plan as a file, each piece by a process of its own, and their end.
//
// A piece is one or several pictures. Unless their number is given, pieces are as many as can be
// when all take equally long to a fifth, as far as small pictures with few samples tell.
//
//   PLAN            JSON, rilievo-pieces-2: what is baked, each picture, and each piece
//   PLAN.pictures/  what is finished, a file each, complete or absent
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/rilievo/bake_command.h"
#include "rilievo/capture/store/capture_pieces.h"
#include "rilievo/capture/store/group_pieces.h"
#include "rilievo/core/result.h"

namespace rilievo::app {

// A plan as it lies in its file.
struct BakePlan {
  BakeCommand command;  // what is baked; paths are absolute
  std::string content;  // of the scene, as pictures are kept by it
  std::vector<CapturePiece> pictures;
  PieceGroups pieces;  // of these pictures; seconds are 0 if nobody measured them
};

// Where a plan's pictures are.
[[nodiscard]] std::filesystem::path pictures_of(const std::string& plan);

// The plan of a bake, and how long it took to measure; `bake` runs it with a source that records.
[[nodiscard]] Result<BakePlan> make_plan(
    const BakeCommand& command, BakeSource& source,
    const std::function<Result<>(CaptureSource&, const std::function<void(int, int)>&)>& bake);
[[nodiscard]] Result<> save_plan(const BakePlan& plan, const std::string& file);
[[nodiscard]] Result<BakePlan> load_plan(const std::string& file);

// Makes one piece, unless it is there already; then false.
[[nodiscard]] Result<bool> make_piece(const BakePlan& plan, const std::string& file, int piece);
// The pieces that are not there.
[[nodiscard]] std::vector<int> missing_pieces(const BakePlan& plan, const std::string& file,
                                              const KeptOptions& kept);
// "pieces 3, 7 and 12".
[[nodiscard]] std::string list_of_pieces(const std::vector<int>& pieces);

// Fails if there is no Slurm here.
[[nodiscard]] Result<> expect_slurm();
// Lets Slurm make what is missing, at most so many pieces at a time, and waits. A piece that fails
// is tried once more. The error names those that fail again.
[[nodiscard]] Result<> run_by_slurm(const BakePlan& plan, const std::string& file, int at_a_time,
                                    const KeptOptions& kept, bool json_progress);

}  // namespace rilievo::app
