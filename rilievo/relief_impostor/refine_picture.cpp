#include "rilievo/relief_impostor/refine_picture.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "rilievo/core/parallel_for.h"
#include "rilievo/render/shading/sample_buffer.h"

namespace rilievo {
namespace {

constexpr int kFirstStep = 8;  // texels from one to the next in the first pass
constexpr int kMaxSamples = 4096;

// Where in its texel a sample lies, from the lower left corner.
glm::dvec2 place_of_sample(int sample, int samples) {
  if (samples == 1 || samples == 4) return glm::dvec2(sample_position(sample, samples));
  const double x = 0.5 + sample * 0.7548776662466927, y = 0.5 + sample * 0.5698402909980532;
  return {x - std::floor(x), y - std::floor(y)};
}

// A picture that gets better.
class RefinedPicture {
 public:
  RefinedPicture(const RayShader& shader, const CaptureRequest& request, std::string_view name)
      : shader_(shader), request_(request), camera_(request.camera) {
    DepthImage& picture = out_.picture;
    picture.name = name;
    picture.camera = camera_;
    picture.color = ColorImage(camera_.width, camera_.height);
    picture.depth = Image<float>(camera_.width, camera_.height, kNoDepth);
    picture.object = Image<std::uint32_t>(camera_.width, camera_.height, kNoObject);
    if (request.farthest) out_.farthest = Image<float>(camera_.width, camera_.height, kNoDepth);
  }

  [[nodiscard]] bool stopped() const {
    return request_.control && request_.control->stop.stop_requested();
  }
  // To be called before each texel: is there to be no more work?
  [[nodiscard]] bool halted() const {
    if (!request_.control) return false;
    if (request_.control->give_way) request_.control->give_way();
    return stopped();
  }
  [[nodiscard]] bool watched() const { return request_.control && request_.control->refined; }

  // The first sample of each texel of a grid that is in no coarser one.
  void first_samples(int step) {
    parallel_for(0, (camera_.height + step - 1) / step, [&](int row) {
      const int y = row * step;
      for (int x = 0; x < camera_.width && !halted(); x += step) {
        const bool coarser = step < kFirstStep && x % (2 * step) == 0 && y % (2 * step) == 0;
        if (!(coarser && watched())) start(x, y);
      }
    });
  }

  // Texels beside those whose centre shows something: a silhouette may go through them.
  void find_edges() {
    edge_ = Image<std::uint8_t>(camera_.width, camera_.height);
    const auto shows = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < camera_.width && y < camera_.height &&
             out_.picture.covered(x, y);
    };
    parallel_for(0, camera_.height, [&](int y) {
      for (int x = 0; x < camera_.width; ++x)
        edge_(x, y) =
            !shows(x, y) && (shows(x - 1, y) || shows(x + 1, y) || shows(x, y - 1) ||
                             shows(x, y + 1) || shows(x - 1, y - 1) || shows(x + 1, y - 1) ||
                             shows(x - 1, y + 1) || shows(x + 1, y + 1));
    });
  }

  // The samples [from, to) of all texels, from 1; of those beside silhouettes the first, too.
  void more_samples(int from, int to) {
    parallel_for(0, camera_.height, [&](int y) {
      for (int x = 0; x < camera_.width; ++x) {
        const bool edge = edge_(x, y);
        if (!edge && !out_.picture.covered(x, y)) continue;
        for (int s = edge && from == 1 ? 0 : from; s < to && !halted(); ++s) {
          const glm::vec4 light = sampled(x, y, s);
          if (edge && light.a > 0 && !out_.picture.covered(x, y)) start_beside(x, y, s);
          if (out_.picture.covered(x, y)) out_.picture.color(x, y) += light;
        }
      }
    });
  }

  // The picture of `samples` samples so far of the texels of a grid; the others show what the
  // grid's texel at their upper left shows.
  [[nodiscard]] CapturedPicture so_far(int samples, int step) const {
    CapturedPicture out = out_;
    const float share = 1.0f / float(samples);
    parallel_for(0, camera_.height, [&](int y) {
      const int from_y = y - y % step;
      for (int x = 0; x < camera_.width; ++x) {
        const int from_x = x - x % step;
        out.picture.color(x, y) = share * out_.picture.color(from_x, from_y);
        out.picture.depth(x, y) = out_.picture.depth(from_x, from_y);
        out.picture.object(x, y) = out_.picture.object(from_x, from_y);
        if (request_.farthest) out.farthest(x, y) = out_.farthest(from_x, from_y);
      }
    });
    if (!request_.identifiers) out.picture.object = {};
    return out;
  }

 private:
  // What the texel's centre shows, and its first sample.
  void start(int x, int y) {
    const glm::dvec2 center(x + 0.5, y + 0.5);
    if (request_.farthest) out_.farthest(x, y) = shader_.farthest(center);
    const auto seen = shader_.nearest(center);
    if (!seen) return;
    out_.picture.depth(x, y) = seen->eye_z;
    out_.picture.object(x, y) = seen->object;
    out_.picture.color(x, y) = sampled(x, y, 0);
  }
  // What a sample shows of a texel whose centre shows nothing.
  void start_beside(int x, int y, int sample) {
    const glm::dvec2 place = place_of_sample(sample, request_.samples);
    const auto seen = shader_.nearest({x + place.x, y + 1 - place.y});
    if (!seen) return;
    out_.picture.depth(x, y) = seen->eye_z;
    out_.picture.object(x, y) = seen->object;
  }
  [[nodiscard]] glm::vec4 sampled(int x, int y, int sample) const {
    return shader_.light(x, y, place_of_sample(sample, request_.samples), sample);
  }

  const RayShader& shader_;
  const CaptureRequest& request_;
  const Camera& camera_;
  CapturedPicture out_;  // colours: sums over the samples
  Image<std::uint8_t> edge_;
};

}  // namespace

Result<CapturedPicture> refine_picture(const RayShader& shader, const CaptureRequest& request,
                                       std::string_view name) {
  if (Result<> valid = validate(request.camera); !valid) return valid.error();
  if (request.samples < 1 || request.samples > kMaxSamples)
    return Error{std::string(name), "software shaders take 1 to 4096 samples per texel"};
  if (request.with_sky) return Error{std::string(name), "software shaders capture no sky"};
  RefinedPicture picture(shader, request, name);
  const Error stopped{std::string(name), std::string(kCaptureStopped)};
  // Coarse pictures only for those who look at them; the last one is the same.
  for (int step = picture.watched() ? kFirstStep : 1; step >= 1; step /= 2) {
    picture.first_samples(step);
    if (picture.stopped()) return stopped;
    if (picture.watched() && (step > 1 || request.samples > 1))
      request.control->refined(picture.so_far(1, step));
  }
  if (request.samples > 1) picture.find_edges();
  for (int from = 1; from < request.samples; from *= 4) {
    const int to = std::min(4 * from, request.samples);
    picture.more_samples(from, to);
    if (picture.stopped()) return stopped;
    if (picture.watched() && to < request.samples) request.control->refined(picture.so_far(to, 1));
  }
  if (picture.stopped()) return stopped;
  return picture.so_far(request.samples, 1);
}

}  // namespace rilievo
