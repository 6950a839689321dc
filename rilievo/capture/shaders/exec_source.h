// Another program as a renderer: `exec:PROGRAM` (S5.8).
//
// The program gets one line of JSON on its standard input for each request, and answers each with
// one line on its standard output:
//
//   -> {"rilievo":1,"id":1,"request":"bounds"}
//   <- {"id":1,"bounds":[[-1,0,-1],[1,2,1]]}
//   -> {"rilievo":1,"id":2,"request":"picture","file":"/tmp/.../2.exr","samples":16,"time":0,
//       "sky":false,"camera":{...}}
//   <- {"id":2,"done":true}          or, if it cannot:  {"id":2,"error":"why"}
//
// `bounds`: two corners in world space (y up, metres). `file`: the OpenEXR file to write: R G B
// (linear, premultiplied), A if there is one, and Z: eye_z in metres, 0 or at least z_far where
// there is nothing. With "objects":["a","b"] the picture shows these alone, under the light and the
// shadows of all. `samples`: of a texel; with "noise":E, if that is given, at most so many, and no
// more once a texel's error is below E by the program's own measure. `sky`: whether a background is
// wanted, too: then texels that show nothing else have its colour with A = 1. `camera`: projection
// ("perspective" or "parallel"), width, height, window (left, right, bottom, top; tangents or
// metres), z_near, z_far, and the matrices world_from_eye, eye_from_world, clip_from_eye (16
// numbers, column by column). Of a picture in tiles, each is a request of its own with a camera of
// its own. At the end of its input the program should end.
//
// The bounds need the scene to be opened and nothing to be rendered: a program that does not answer
// within `start_limit_s` is taken for one that does not know this protocol.
//
// A program that dies is started again; one that answers with rubbish or too late is killed first.
// Answers to requests that were stopped are read and thrown away. Not safe for several threads at
// once.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/scratch_folder.h"

namespace rilievo {

class LineProcess;

// Called about each second while a program is waited for, in the thread that asks, which may be
// another than the source's maker: for "bounds" or a "picture", and for how many seconds; 0: no
// longer.
using ExecWaits = std::function<void(std::string_view what, int seconds)>;

// How the program is run.
struct ExecOptions {
  std::vector<std::string> arguments = {};  // of the program
  double limit_s = 600;                     // for a picture: path tracers take minutes
  double start_limit_s = 300;               // for the bounds: large scenes take minutes to open
  int tile = 0;                             // texels a side of a tile; 0: whole pictures
  int nice = 0;                             // how far it gives way to the caller, 0 to 19
  int max_failures = 3;                     // in a row; then it is not started again
  WorldSpace world = {};                    // programs see the world, callers the scene's space
  DepthKind depth_kind = DepthKind::eye_z;  // of Z; or ray
  double noise = 0;  // below which a texel needs no more samples; 0: all get all
  // The scene's objects as the program names them. None: it shows all objects or nothing.
  std::vector<std::string> object_names = {};
  bool unmix = true;  // take what is in front out of the colours beside edges (warp/unmix_edges.h)
  // Gets one line at the first failure, and one when the program is given up.
  std::function<void(const std::string&)> warn = {};
  ExecWaits waits = {};
};

// The JSON of a camera, on one line.
[[nodiscard]] std::string camera_json(const Camera& camera);

// A program as a capture source.
class ExecSource final : public CaptureSource {
 public:
  // Starts the program and asks for its bounds.
  [[nodiscard]] static Result<std::unique_ptr<ExecSource>> create(const std::string& program,
                                                                  ExecOptions options = {});
  ~ExecSource() override;

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t>) const override { return bounds_; }
  [[nodiscard]] WorldSpace world() const override { return options_.world; }
  // Fails for chosen objects without names, back-perspective cameras, and `farthest`; if the
  // program fails, dies, is late, or writes something else than the picture. Obeys
  // request.control's `stop`. with_sky: as far as the program has one.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  // From now on (find_depth_kind.h).
  void set_depth_kind(DepthKind kind) { options_.depth_kind = kind; }

 private:
  ExecSource(const std::string& program, ExecOptions options);
  // A line that is sent; without text it has been sent before.
  struct Request {
    std::string text;
    std::uint64_t id = 0;
    std::string_view what = "picture";  // or "bounds"
  };
  [[nodiscard]] double limit_of(const Request& request) const;
  [[nodiscard]] Result<std::string> ask(const Request& request, const std::stop_token& stop);
  [[nodiscard]] Result<std::string> ask_once(const Request& request, const std::stop_token& stop,
                                             bool& died);
  [[nodiscard]] Result<> hear_stale(const std::stop_token& stop, bool& died);
  [[nodiscard]] std::filesystem::path file_of(std::uint64_t id) const;
  [[nodiscard]] Error failed(const std::string& reason);
  [[nodiscard]] Result<> render(const CaptureRequest& request, const Camera& camera, int x, int y,
                                DepthImage& into);

  std::string name_;
  ExecOptions options_;
  ScratchFolder folder_;  // of its pictures
  std::unique_ptr<LineProcess> process_;
  Box bounds_;
  std::uint64_t last_id_ = 0;
  std::uint64_t stale_id_ = 0;  // of a request that was stopped and is not answered yet; 0: none
  int failures_ = 0;            // in a row
  bool warned_ = false;
};

}  // namespace rilievo
