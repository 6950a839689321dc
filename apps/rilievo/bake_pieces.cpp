#include "apps/rilievo/bake_pieces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <utility>

#include "apps/rilievo/estimate_pictures.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/capture/store/picture_folder.h"
#include "rilievo/capture/watched_source.h"
#include "rilievo/core/file.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::app {
namespace {

using nlohmann::json;

constexpr char kPlanSchema[] = "rilievo-pieces-2";
constexpr char kAllAsked[] = "all pictures were asked for";
// Pieces may be off their mean by 20 %. Of that the estimate takes a half.
constexpr double kUneven = 0.1;
constexpr std::uint64_t kMaxPlanBytes = std::uint64_t(1) << 28;
// Slurm is asked so often, and given up if it does not answer so many times in a row.
constexpr std::chrono::seconds kPoll(1);
constexpr int kMostUnanswered = 60;

std::string absolute_path(const std::string& path) {
  std::error_code failed;
  const std::filesystem::path whole = std::filesystem::absolute(path, failed);
  return failed ? path : whole.lexically_normal().string();
}

// The same from any folder.
std::string absolute_source(const std::string& source) {
  const std::string program(program_named(source));
  return program.find('/') != program.npos ? "exec:" + absolute_path(program) : source;
}

json json_of(const BakeCommand& command) {
  const FileLimits& limits = command.limits;
  json out{{"schema", kPlanSchema},
           {"scene", command.scene},
           {"output", command.output},
           {"as", command.as},
           {"options", command.kinds.bake},
           {"source", command.source.source},
           {"samples", command.source.samples},
           {"only", command.source.only},
           {"without", command.source.without},
           {"noise", command.source.noise},
           {"around_samples", command.source.around_samples},
           {"program_scene", command.source.program_scene},
           {"files",
            {{"memory_mb", limits.memory_mb},
             {"allow_outside", limits.allow_outside},
             {"point_metres", limits.point_size.metres},
             {"point_pixels", limits.point_size.pixels}}}};
  if (limits.up) out["files"]["up"] = int(*limits.up);
  if (limits.metres_per_unit) out["files"]["metres_per_unit"] = *limits.metres_per_unit;
  if (command.source.depth_kind) out["ray_depth"] = *command.source.depth_kind == DepthKind::ray;
  return out;
}

// Throws what nlohmann throws.
BakeCommand command_of(const json& in) {
  BakeCommand command;
  in.at("scene").get_to(command.scene);
  in.at("output").get_to(command.output);
  in.at("as").get_to(command.as);
  for (const auto& [name, value] : in.at("options").items())
    command.kinds.bake[name] = value.get<std::string>();
  in.at("source").get_to(command.source.source);
  in.at("samples").get_to(command.source.samples);
  in.at("only").get_to(command.source.only);
  in.at("without").get_to(command.source.without);
  in.at("noise").get_to(command.source.noise);
  in.at("around_samples").get_to(command.source.around_samples);
  in.at("program_scene").get_to(command.source.program_scene);
  FileLimits& limits = command.limits;
  const json& files = in.at("files");
  files.at("memory_mb").get_to(limits.memory_mb);
  files.at("allow_outside").get_to(limits.allow_outside);
  files.at("point_metres").get_to(limits.point_size.metres);
  files.at("point_pixels").get_to(limits.point_size.pixels);
  if (files.contains("up")) limits.up = UpAxis(std::clamp(files["up"].get<int>(), 0, 2));
  if (files.contains("metres_per_unit")) limits.metres_per_unit = files["metres_per_unit"];
  if (in.contains("ray_depth"))
    command.source.depth_kind = in["ray_depth"].get<bool>() ? DepthKind::ray : DepthKind::eye_z;
  return command;
}

std::vector<int> all_missing(const BakePlan& plan, const PictureFolder& folder,
                             const KeptOptions& kept) {
  const auto is_there = [&](int picture) {
    const std::vector<PictureKey> keys = keys_of(plan.pictures[std::size_t(picture)], kept);
    return std::ranges::all_of(keys, [&](const PictureKey& key) { return folder.has(key); });
  };
  std::vector<int> missing;
  for (std::size_t i = 0; i < plan.pieces.pictures.size(); ++i)
    if (!std::ranges::all_of(plan.pieces.pictures[i], is_there)) missing.push_back(int(i));
  return missing;
}

std::string shell_word(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// What a command prints, and whether it succeeds.
struct Heard {
  std::string text;
  int status = -1;
};
Heard hear(const std::string& command) {
  Heard heard;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return heard;
  std::array<char, 4096> bytes;
  while (const std::size_t n = std::fread(bytes.data(), 1, bytes.size(), pipe))
    heard.text.append(bytes.data(), n);
  heard.status = ::pclose(pipe);
  while (!heard.text.empty() && std::isspace(static_cast<unsigned char>(heard.text.back())))
    heard.text.pop_back();
  return heard;
}

std::string batch_script(const BakePlan& plan, const std::string& file) {
  std::error_code ignored;
  const std::string self = std::filesystem::read_symlink("/proc/self/exe", ignored).string();
  std::string line = fmt::format("exec {} bake --plan {} --piece \"$SLURM_ARRAY_TASK_ID\"",
                                 shell_word(self), shell_word(file));
  // No file starts a program by itself: the plan's has to be named.
  if (!program_named(plan.command.source.source).empty())
    line += " --source " + shell_word(plan.command.source.source);
  return fmt::format(
      "#!/bin/sh\n#SBATCH --job-name=rilievo-bake\n#SBATCH --requeue\n#SBATCH --open-mode=append\n"
      "#SBATCH --output={}\n{}\n",
      shell_word((pictures_of(file) / "piece-%a.txt").string()), line);
}

// The last line that a piece's process printed.
std::string last_words(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return last;
}

}  // namespace

std::filesystem::path pictures_of(const std::string& plan) { return plan + ".pictures"; }

Result<BakePlan> make_plan(
    const BakeCommand& command, BakeSource& source,
    const std::function<Result<>(CaptureSource&, const std::function<void(int, int)>&)>& bake) {
  if (!source.light())
    return Error{"--plan", "is for sources that take long: raytrace and exec:PROGRAM"};
  BakePlan plan;
  plan.command = command;
  if (!is_builtin(command.scene)) plan.command.scene = absolute_path(command.scene);
  plan.command.output = absolute_path(command.output);
  plan.command.source.source = absolute_source(command.source.source);
  if (!command.source.program_scene.empty())
    plan.command.source.program_scene = absolute_path(command.source.program_scene);
  plan.content = source.kept().content;
  PieceRecorder recorder(*source.light(), source.geometry());
  source.replace_light(recorder);
  int total = 0;
  // The last picture is asked for, but the bake is not finished.
  WatchedSource watched(source.source(), 0, [&total](int done) -> Result<> {
    if (total > 0 && done == total) return Error{"", kAllAsked};
    return Done{};
  });
  const Result<> baked = bake(watched, [&total](int, int all) { total = all; });
  if (!baked && baked.error().reason != kAllAsked) return baked.error();
  std::set<std::string> known;
  for (const CapturePiece& piece : recorder.pieces())
    if (known.insert(piece_json(piece)).second) plan.pictures.push_back(piece);
  const int count = int(plan.pictures.size());
  if (count == 0) return Error{command.scene, "asks for no pictures"};
  if (command.pieces.value_or(0) >= count) {
    for (int i = 0; i < count; ++i) plan.pieces.pictures.push_back({i});
    plan.pieces.seconds.resize(plan.pictures.size());
    return plan;
  }
  Progress progress("estimate", command.json_progress);
  const Result<std::vector<double>> seconds =
      estimate_seconds(plan.pictures, *source.light(), progress);
  if (!seconds) return seconds.error();
  plan.pieces =
      command.pieces ? group_pieces(*seconds, *command.pieces) : even_pieces(*seconds, kUneven);
  return plan;
}

Result<> save_plan(const BakePlan& plan, const std::string& file) {
  json out = json_of(plan.command);
  out["content"] = plan.content;
  for (const CapturePiece& picture : plan.pictures)
    out["pictures"].push_back(json::parse(piece_json(picture)));
  for (std::size_t i = 0; i < plan.pieces.pictures.size(); ++i)
    out["pieces"].push_back(
        {{"pictures", plan.pieces.pictures[i]}, {"seconds", plan.pieces.seconds[i]}});
  return write_json(file, out);
}

Result<BakePlan> load_plan(const std::string& file) {
  const Result<std::string> text = read_file(file, kMaxPlanBytes);
  if (!text) return text.error();
  BakePlan plan;
  try {
    const json in = json::parse(*text);
    if (!in.is_object() || in.value("schema", "") != kPlanSchema)
      return Error{file, "is no plan of a bake in pieces"};
    plan.command = command_of(in);
    in.at("content").get_to(plan.content);
    for (const json& one : in.at("pictures")) {
      Result<CapturePiece> picture = piece_from_json(one.dump());
      if (!picture)
        return Error{file,
                     fmt::format("picture {}: {}", plan.pictures.size(), picture.error().reason)};
      plan.pictures.push_back(std::move(*picture));
    }
    for (const json& one : in.at("pieces")) {
      std::vector<int> of = one.at("pictures").get<std::vector<int>>();
      for (const int picture : of)
        if (picture < 0 || picture >= int(plan.pictures.size()))
          return Error{file, fmt::format("piece {} is of a picture that is not there: {}",
                                         plan.pieces.pictures.size(), picture)};
      plan.pieces.pictures.push_back(std::move(of));
      plan.pieces.seconds.push_back(one.at("seconds").get<double>());
    }
  } catch (const json::exception& wrong) {
    return Error{file, std::string("is a damaged plan: ") + wrong.what()};
  }
  if (!find_kind(kinds(), plan.command.as))
    return Error{file, "names a kind that is unknown: " + plan.command.as};
  return plan;
}

Result<bool> make_piece(const BakePlan& plan, const std::string& file, int piece) {
  const std::vector<std::vector<int>>& pieces = plan.pieces.pictures;
  if (piece >= int(pieces.size()))
    return Error{"--piece", fmt::format("there is no piece {}: {} has {}, from 0", piece, file,
                                        pieces.size())};
  PictureFolder folder(pictures_of(file));
  SourceOptions options = plan.command.source;
  options.keeper = &folder;
  std::string wrong = "its file is damaged as soon as it is written";
  options.warn = [&wrong](const std::string& text) { wrong = text; };
  Result<BakeSource> source = BakeSource::open(plan.command.scene, plan.command.limits, options);
  if (!source) return source.error();
  if (!source->light() || source->kept().content != plan.content)
    return Error{plan.command.scene, "has changed since " + file + " was made: plan it again"};
  for (const int picture : pieces[std::size_t(piece)]) {
    const CapturePiece& one = plan.pictures[std::size_t(picture)];
    if (Result<> made = capture_piece(one, *source->light()); !made) return made.error();
    for (const PictureKey& key : keys_of(one, source->kept())) {
      const Result<std::optional<DepthImage>> kept = folder.find(key);
      if (!kept) return kept.error();
      if (!*kept) return Error{fmt::format("piece {} cannot be kept", piece), wrong};
    }
  }
  return source->rendered() > 0;
}

std::vector<int> missing_pieces(const BakePlan& plan, const std::string& file,
                                const KeptOptions& kept) {
  return all_missing(plan, PictureFolder(pictures_of(file)), kept);
}

std::string list_of_pieces(const std::vector<int>& pieces) {
  constexpr std::size_t kMaxShown = 8;
  if (pieces.size() == 1) return fmt::format("piece {}", pieces[0]);
  const std::size_t shown = std::min(pieces.size(), kMaxShown);
  const bool all = shown == pieces.size();
  const auto end = pieces.begin() + std::ptrdiff_t(all ? shown - 1 : shown);
  return fmt::format(
      "pieces {} and {}", fmt::join(pieces.begin(), end, ", "),
      all ? std::to_string(pieces.back()) : fmt::format("{} more", pieces.size() - shown));
}

Result<> expect_slurm() {
  for (const char* tool : {"sbatch", "squeue"})
    if (hear(std::string("command -v ") + tool).status != 0)
      return Error{"--slurm", std::string("needs Slurm: ") + tool + " is not on the PATH"};
  return Done{};
}

Result<> run_by_slurm(const BakePlan& plan, const std::string& file, int at_a_time,
                      const KeptOptions& kept, bool json_progress) {
  const std::filesystem::path folder = pictures_of(file);
  if (Result<> made = make_folder(folder); !made) return made;
  const std::string script = (folder / "batch.sh").string();
  if (Result<> written = write_text(script, batch_script(plan, file)); !written) return written;
  Progress progress("piece", json_progress);
  const int total = int(plan.pieces.pictures.size());
  std::vector<int> missing = missing_pieces(plan, file, kept);
  const int before = total - int(missing.size());
  for (int attempt = 0; attempt < 2 && !missing.empty(); ++attempt) {
    const Heard job = hear(fmt::format("sbatch --parsable --array={}%{} {}",
                                       fmt::join(missing, ","), at_a_time, shell_word(script)));
    if (job.status != 0 || job.text.empty())
      return Error{"sbatch", job.text.empty() ? "cannot be run, or refuses the job" : job.text};
    // "ID" or "ID;cluster".
    const std::string id = job.text.substr(0, job.text.find(';'));
    for (int unanswered = 0;;) {
      const Heard queue = hear("squeue --noheader --jobs=" + id + " --format=%T 2>&1");
      // What is over for long is unknown to it.
      const bool over = queue.status == 0 ? queue.text.empty()
                                          : queue.text.find("Invalid job id") != queue.text.npos;
      if (over) break;
      unanswered = queue.status == 0 ? 0 : unanswered + 1;
      if (unanswered > kMostUnanswered) return Error{"squeue", "does not answer: " + queue.text};
      progress.show(total - int(missing_pieces(plan, file, kept).size()), total, before);
      std::this_thread::sleep_for(kPoll);
    }
    missing = missing_pieces(plan, file, kept);
  }
  if (missing.empty()) return Done{};
  const std::string said = last_words(folder / fmt::format("piece-{}.txt", missing.front()));
  return Error{file, fmt::format("{} failed twice{}", list_of_pieces(missing),
                                 said.empty() ? "" : "; the first said: " + said)};
}

}  // namespace rilievo::app
