#include "rilievo/capture/shaders/refine_picture.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "rilievo/core/parallel_for.h"
#include "rilievo/core/texel_rule.h"
#include "rilievo/render/shading/sample_buffer.h"

namespace rilievo {
namespace {

constexpr int kFirstStep = 8;  // texels from one to the next in the first pass
constexpr int kMaxSamples = 4096;
// The slope that a surface may have of which one sample is known.
constexpr float kUnknownSlope = 4;

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
    covered_ = Image<float>(camera_.width, camera_.height);
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

  // Texels through which a silhouette may go: whose centre shows nothing, beside one that shows
  // something or where another of the first four samples does, and those that have another surface,
  // or nothing, beside them.
  void find_edges() {
    const int width = camera_.width, height = camera_.height;
    edge_ = Image<Edge>(width, height, Edge::none);
    const Nearness nearness(camera_);
    Image<float> center(width, height, kNoNearness);
    parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x)
        if (out_.picture.covered(x, y))
          center(x, y) = nearness.of_eye_z(double(out_.picture.depth(x, y)));
    });
    planes_ = Image<TexelPlane>(width, height);
    parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        const bool shows = out_.picture.covered(x, y);
        if (shows) planes_(x, y) = texel_plane(nearness, center, out_.picture.object, x, y);
        // A cable thinner than a texel passes between centres for many texels.
        if (!shows && any_sample_sees(x, y)) edge_(x, y) = Edge::beside;
        for (int k = 0; k < 9; ++k) {
          const glm::ivec2 step(k % 3 - 1, k / 3 - 1), at = glm::ivec2(x, y) + step;
          if (k == 4 || at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) continue;
          if (shows
                  ? !planes_(x, y).shows(step, center(at.x, at.y), out_.picture.object(at.x, at.y))
                  : out_.picture.covered(at.x, at.y))
            edge_(x, y) = shows ? Edge::inside : Edge::beside;
        }
      }
    });
  }

  // The samples [from, to) of all texels, from 1; of those at silhouettes the first, too.
  void more_samples(int from, int to) {
    parallel_for(0, camera_.height, [&](int y) {
      for (int x = 0; x < camera_.width; ++x) {
        const Edge edge = edge_(x, y);
        if (edge == Edge::none && !out_.picture.covered(x, y)) continue;
        if (edge == Edge::inside && from == 1)
          out_.picture.color(x, y) = glm::vec4(0), covered_(x, y) = 0;
        for (int s = edge != Edge::none && from == 1 ? 0 : from; s < to && !halted(); ++s) {
          const glm::vec4 light = sampled(x, y, s);
          if (edge == Edge::beside && light.a > 0 && !out_.picture.covered(x, y))
            start_beside(x, y, s);
          if (!out_.picture.covered(x, y)) continue;
          covered_(x, y) += light.a;
          if (edge == Edge::none || shows_own(x, y, s)) out_.picture.color(x, y) += light;
        }
        // No sample shows what the centre does.
        if (edge == Edge::inside && to == request_.samples && !(out_.picture.color(x, y).a > 0) &&
            !halted()) {
          out_.picture.color(x, y) = shader_.light(x, y, glm::dvec2(0.5), 0);
          covered_(x, y) = std::max(covered_(x, y), out_.picture.color(x, y).a);
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
        // The colour of the texel's surface; its alpha is that of all samples.
        const glm::vec4 sum = out_.picture.color(from_x, from_y);
        const float covered = covered_(from_x, from_y);
        out.picture.color(x, y) =
            share * (sum.a > 0 && sum.a != covered ? covered / sum.a * sum : sum);
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
    covered_(x, y) = out_.picture.color(x, y).a;
  }
  // Of a texel whose centre shows nothing, do the first samples?
  [[nodiscard]] bool any_sample_sees(int x, int y) const {
    for (int s = 0; s < std::min(request_.samples, 4) && !halted(); ++s) {
      const glm::dvec2 place = place_of_sample(s, request_.samples);
      if (shader_.nearest({x + place.x, y + 1 - place.y})) return true;
    }
    return false;
  }
  // What a sample shows of a texel whose centre shows nothing.
  void start_beside(int x, int y, int sample) {
    const glm::dvec2 place = place_of_sample(sample, request_.samples);
    const auto seen = shader_.nearest({x + place.x, y + 1 - place.y});
    if (!seen) return;
    out_.picture.depth(x, y) = seen->eye_z;
    out_.picture.object(x, y) = seen->object;
    const Nearness nearness(camera_);
    TexelPlane& plane = planes_(x, y);
    plane.nearness = nearness.of_eye_z(double(seen->eye_z));
    plane.room = nearness.noise + kUnknownSlope * nearness.texel(plane.nearness);
    plane.object = seen->object;
  }
  // Does a sample show the texel's surface, or what it hides in part?
  [[nodiscard]] bool shows_own(int x, int y, int sample) const {
    const glm::dvec2 place = place_of_sample(sample, request_.samples);
    const auto seen = shader_.nearest({x + place.x, y + 1 - place.y});
    if (!seen) return false;
    const Nearness nearness(camera_);
    const glm::vec2 from_center(place.x - 0.5, 0.5 - place.y);
    const float at = nearness.of_eye_z(double(seen->eye_z));
    return planes_(x, y).shows(from_center, at, seen->object) ||
           planes_(x, y).hides(from_center, at);
  }
  [[nodiscard]] glm::vec4 sampled(int x, int y, int sample) const {
    return shader_.light(x, y, place_of_sample(sample, request_.samples), sample);
  }

  const RayShader& shader_;
  const CaptureRequest& request_;
  const Camera& camera_;
  CapturedPicture out_;   // colours: sums over the samples of the texel's surface
  Image<float> covered_;  // the sum of alphas of all samples
  enum class Edge : std::uint8_t {
    none,
    beside,  // the centre shows nothing
    inside,
  };
  Image<Edge> edge_;
  Image<TexelPlane> planes_;
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
