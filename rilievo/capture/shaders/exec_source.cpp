#include "rilievo/capture/shaders/exec_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "rilievo/capture/shaders/line_process.h"
#include "rilievo/io/exr_channels.h"
#include "rilievo/warp/unmix_edges.h"

namespace rilievo {
namespace {

using ExecJson = nlohmann::json;

ExecJson matrix_json(const glm::dmat4& m) {
  ExecJson out = ExecJson::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) out.push_back(m[column][row]);
  return out;
}

ExecJson json_of_camera(const Camera& camera) {
  const ImageWindow& w = camera.window;
  return {{"projection", camera.projection == Projection::parallel ? "parallel" : "perspective"},
          {"width", camera.width},
          {"height", camera.height},
          {"window", {w.left, w.right, w.bottom, w.top}},
          {"z_near", camera.z_near},
          {"z_far", camera.z_far},
          {"world_from_eye", matrix_json(camera.world_from_eye)},
          {"eye_from_world", matrix_json(eye_from_world(camera))},
          {"clip_from_eye", matrix_json(clip_from_eye(camera))}};
}

// What a program says, on one line and not for ever.
std::string quoted(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  if (text.size() > 200) text = text.substr(0, 200) + "...";
  return "\"" + text + "\"";
}

// The part of a camera's picture from texel (x, y), from the top left corner.
Camera tile_of(const Camera& camera, int x, int y, int size) {
  Camera tile = camera;
  const int right = std::min(camera.width, x + size), bottom = std::min(camera.height, y + size);
  const ImageWindow& w = camera.window;
  const double per_x = (w.right - w.left) / camera.width;
  const double per_y = (w.top - w.bottom) / camera.height;
  tile.window = {w.left + x * per_x, w.left + right * per_x, w.top - bottom * per_y,
                 w.top - y * per_y};
  tile.width = right - x, tile.height = bottom - y;
  return tile;
}

// In the space of `origin`.
Result<Box> box_of(const ExecJson& answer, const glm::dvec3& origin) {
  const Error error{"", "gives no bounds: two corners of three numbers"};
  const auto found = answer.find("bounds");
  if (found == answer.end() || !found->is_array() || found->size() != 2) return error;
  Box box;
  for (const ExecJson& corner : *found) {
    if (!corner.is_array() || corner.size() != 3) return error;
    glm::vec3 p;
    for (int i = 0; i < 3; ++i) {
      const ExecJson& number = corner[std::size_t(i)];
      if (!number.is_number() || !(std::abs(number.get<double>()) <= 1e9)) return error;
      p[i] = float(number.get<double>() - origin[i]);
    }
    box.add(p);
  }
  return box;
}

// The picture that a program has written for `camera`, into a larger one at (x, y).
Result<> read_render(const std::filesystem::path& path, const Camera& camera, DepthKind kind,
                     bool sky, int x, int y, DepthImage& into) {
  const std::string names[] = {"R", "G", "B", "Z", "A"};
  Result<std::vector<Image<float>>> planes = load_exr_channels(path, names);
  if (!planes) planes = load_exr_channels(path, std::span(names).first(4));
  if (!planes) return planes.error();
  const Image<float>& z = (*planes)[3];
  const auto error = [&](const char* reason) { return Error{path.string(), reason}; };
  if (z.width() != camera.width || z.height() != camera.height)
    return error("is not of the size that was asked for");
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const float depth = z(column, row);
      if (std::isnan(depth) || depth < 0) return error("has a depth that is not a distance");
      const double eye_z = std::isfinite(depth)
                               ? eye_z_from(kind, double(depth), camera, {column + 0.5, row + 0.5})
                               : camera.z_far;
      // Outside of the planes of the frustum there is nothing for a camera to see.
      const bool shows = eye_z >= camera.z_near && eye_z < camera.z_far;
      if (!shows && !sky) continue;
      glm::vec4 color(0, 0, 0, 1);
      for (int c = 0; c < 3; ++c) color[c] = (*planes)[std::size_t(c)](column, row);
      if (planes->size() > 4) color.a = (*planes)[4](column, row);
      if (!shows && planes->size() <= 4) continue;
      for (int c = 0; c < 4; ++c)
        if (!std::isfinite(color[c])) return error("has a colour that is not finite");
      into.color(x + column, y + row) = color;
      if (shows) into.depth(x + column, y + row) = kind == DepthKind::eye_z ? depth : float(eye_z);
    }
  return Done{};
}

// Waits for a line, and says so each second.
LineProcess::Heard hear(LineProcess& process, std::string_view what, double limit_s,
                        const ExecWaits& waits, const std::stop_token& stop, std::string& line) {
  using Clock = LineProcess::Clock;
  const Clock::time_point begin = Clock::now();
  const auto limit =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit_s));
  for (int seconds = 1;; ++seconds) {
    const Clock::duration next = std::min<Clock::duration>(limit, std::chrono::seconds(seconds));
    const LineProcess::Heard heard = process.receive(line, begin + next, stop);
    const bool over = heard != LineProcess::Heard::late || next == limit;
    if (waits && (!over || seconds > 1)) waits(what, over ? 0 : seconds);
    if (over) return heard;
  }
}

}  // namespace

std::string camera_json(const Camera& camera) { return json_of_camera(camera).dump(); }

ExecSource::ExecSource(const std::string& program, ExecOptions options)
    : name_("exec:" + program), options_(std::move(options)) {}

// Before its folder goes.
ExecSource::~ExecSource() { process_.reset(); }

std::filesystem::path ExecSource::file_of(std::uint64_t id) const {
  return folder_.path() / (std::to_string(id) + ".exr");
}

// The program is of no more use; warns once.
Error ExecSource::failed(const std::string& reason) {
  process_.reset();
  stale_id_ = 0;
  ++failures_;
  const bool given_up = failures_ >= options_.max_failures;
  if (options_.warn && (given_up || !warned_))
    options_.warn(name_ + ": " + reason +
                  (given_up ? "; it is given up" : "; it is started again for the next picture"));
  warned_ = true;
  return Error{name_, reason};
}

// Waits for the answer to a request that nobody wants any more.
Result<> ExecSource::hear_stale(const std::stop_token& stop, bool& died) {
  if (stale_id_ == 0) return Done{};
  const std::uint64_t id = std::exchange(stale_id_, 0);
  const Result<std::string> heard = ask_once({.text = "", .id = id}, stop, died);
  std::error_code ignored;
  if (heard) std::filesystem::remove(file_of(id), ignored);
  return heard ? Result<>(Done{}) : Result<>(heard.error());
}

double ExecSource::limit_of(const Request& request) const {
  return request.what == "bounds" ? options_.start_limit_s : options_.limit_s;
}

// The answer to a request that has been sent, or is sent here.
Result<std::string> ExecSource::ask_once(const Request& request, const std::stop_token& stop,
                                         bool& died) {
  died = false;
  if (!request.text.empty() && !process_->send(request.text)) {
    died = true;
    return failed("has ended, or does not read its input");
  }
  std::string line;
  switch (hear(*process_, request.what, limit_of(request), options_.waits, stop, line)) {
    case LineProcess::Heard::line:
      break;
    case LineProcess::Heard::stopped:
      stale_id_ = request.id;
      return Error{name_, std::string(kCaptureStopped)};
    case LineProcess::Heard::late:
      return failed(fmt::format("has not answered within {:g} s, asked for {}", limit_of(request),
                                request.what == "bounds" ? "its scene's bounds" : "a picture"));
    case LineProcess::Heard::ended:
      died = true;
      return failed("has ended without an answer");
    case LineProcess::Heard::too_long:
      return failed("answers with a line that does not end");
  }
  const ExecJson answer = ExecJson::parse(line, nullptr, false);
  if (!answer.is_object() || !answer.contains("id") || !answer["id"].is_number_integer() ||
      answer["id"] != request.id)
    return failed("answers with something else than JSON for the request: " + quoted(line));
  return line;
}

Result<std::string> ExecSource::ask(const Request& request, const std::stop_token& stop) {
  // What has died meanwhile is started again, once for each request.
  for (int attempt = 0;; ++attempt) {
    if (failures_ >= options_.max_failures)
      return Error{name_, "has failed too often in a row and is given up"};
    if (!process_) {
      Result<std::unique_ptr<LineProcess>> started =
          LineProcess::start(name_.substr(5), options_.arguments, options_.nice);
      if (!started) return failed(started.error().reason);
      process_ = *std::move(started);
    }
    bool died = false;
    Result<> stale = hear_stale(stop, died);
    if (stale) {
      Result<std::string> answer = ask_once(request, stop, died);
      if (answer || !died || attempt > 0) return answer;
    } else if (!died || attempt > 0) {
      return stale.error();
    }
  }
}

Result<std::unique_ptr<ExecSource>> ExecSource::create(const std::string& program,
                                                       ExecOptions options) {
  std::unique_ptr<ExecSource> source(new ExecSource(program, std::move(options)));
  Result<ScratchFolder> folder = ScratchFolder::create("rilievo-exec");
  if (!folder) return folder.error();
  source->folder_ = *std::move(folder);
  // What fails here is the caller's to say.
  const auto warn = std::exchange(source->options_.warn, {});
  const std::uint64_t id = ++source->last_id_;
  const ExecJson request{{"rilievo", 1}, {"id", id}, {"request", "bounds"}};
  const Result<std::string> answer = source->ask({request.dump(), id, "bounds"}, {});
  if (!answer) return answer.error();
  const Result<Box> box =
      box_of(ExecJson::parse(*answer, nullptr, false), source->options_.world.origin);
  if (!box) return Error{source->name_, box.error().reason};
  source->bounds_ = *box;
  source->options_.warn = warn;
  source->failures_ = 0, source->warned_ = false;
  return source;
}

// Asks for the picture of `camera`, which lies at (x, y) in `into`.
Result<> ExecSource::render(const CaptureRequest& request, const Camera& camera, int x, int y,
                            DepthImage& into) {
  const std::uint64_t id = ++last_id_;
  const std::filesystem::path file = file_of(id);
  Camera in_world = camera;
  in_world.world_from_eye[3] += glm::dvec4(options_.world.origin, 0);
  ExecJson json{{"rilievo", 1},
                {"id", id},
                {"request", "picture"},
                {"file", file.string()},
                {"samples", request.samples},
                {"time", request.time},
                {"sky", request.with_sky},
                {"camera", json_of_camera(in_world)}};
  for (const std::uint32_t object : request.objects)
    json["objects"].push_back(options_.object_names.at(object));
  if (options_.noise > 0) json["noise"] = options_.noise;
  const std::stop_token stop = request.control ? request.control->stop : std::stop_token();
  const Result<std::string> line = ask({.text = json.dump(), .id = id}, stop);
  std::error_code ignored;
  if (!line) return line.error();
  const ExecJson answer = ExecJson::parse(*line, nullptr, false);
  if (const auto error = answer.find("error"); error != answer.end())
    return Error{name_,
                 "says " + quoted(error->is_string() ? error->get<std::string>() : error->dump())};
  const Result<> read =
      read_render(file, camera, options_.depth_kind, request.with_sky, x, y, into);
  std::filesystem::remove(file, ignored);
  if (!read) return failed("has not made the picture: " + read.error().message());
  failures_ = 0;
  return Done{};
}

Result<CapturedPicture> ExecSource::capture(const CaptureRequest& request) {
  const Camera& camera = request.camera;
  if (Result<> valid = validate(camera); !valid) return valid.error();
  if (!request.objects.empty() && options_.object_names.empty())
    return Error{name_, "knows no single objects"};
  if (camera.keeps_farthest() || request.farthest)
    return Error{name_, "knows nearest surfaces only"};
  CapturedPicture captured;
  DepthImage& picture = captured.picture;
  picture.name = name_;
  picture.camera = camera;
  picture.color = ColorImage(camera.width, camera.height);
  picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
  const int tile = options_.tile > 0 ? options_.tile : std::max(camera.width, camera.height);
  for (int y = 0; y < camera.height; y += tile)
    for (int x = 0; x < camera.width; x += tile)
      if (Result<> made = render(request, tile_of(camera, x, y, tile), x, y, picture); !made)
        return made.error();
  if (options_.unmix) unmix_edges(picture);
  return captured;
}

}  // namespace rilievo
