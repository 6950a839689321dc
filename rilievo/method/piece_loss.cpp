#include "rilievo/method/piece_loss.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <memory>

#include "rilievo/core/expects.h"
#include "rilievo/keyframes/software/sampled_loss.h"
#include "rilievo/method/direct.h"
#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

constexpr int kPieces = PieceLoss::kAcross * PieceLoss::kAcross;
// From one piece to the next: prime to their number, and far off.
constexpr int kStride = 27;
// Of the sums, when a piece is added: those of a few hundred frames ago are of elsewhere.
constexpr double kRemembered = 0.97;

double square(const glm::dvec3& a) { return glm::dot(a, a); }

}  // namespace

PieceLoss::PieceLoss(SoftwareBackend& backend)
    : direct_frames_(backend, std::make_unique<DirectChooser>()),
      fine_frames_(backend, std::make_unique<DirectChooser>()) {}

FramePiece piece_of(const Camera& camera, int i) {
  RILIEVO_EXPECTS(i >= 0 && i < kPieces);
  RILIEVO_EXPECTS(camera.width >= PieceLoss::kAcross && camera.height >= PieceLoss::kAcross);
  constexpr int kAcross = PieceLoss::kAcross;
  const int width = (camera.width + kAcross - 1) / kAcross,
            height = (camera.height + kAcross - 1) / kAcross;
  const int x = std::min(i % kAcross * width, camera.width - width),
            y = std::min(i / kAcross * height, camera.height - height);
  return {x, y, camera_of_part(camera, x, y, width, height)};
}

Result<> PieceLoss::add(const Camera& camera, double time, const Rgba8Image& color) {
  if (camera.width < kAcross || camera.height < kAcross) return Done{};
  const FramePiece piece = piece_of(camera, next_);
  next_ = (next_ + kStride) % kPieces;
  if (Result<> drawn = direct_frames_.draw(piece.camera, time); !drawn) return drawn;
  const Camera fine = supersampled(piece.camera, 2);
  if (Result<> drawn = fine_frames_.draw(fine, time); !drawn) return drawn;
  const Rgba8Image &few = direct_frames_.software_target()->color(),
                   &many = fine_frames_.software_target()->color();
  for (double* sum : {&shown_, &direct_, &counted_}) *sum *= kRemembered;
  for (int y = 0; y < piece.camera.height; ++y)
    for (int x = 0; x < piece.camera.width; ++x) {
      glm::dvec3 truth(0);
      for (int k = 0; k < 4; ++k) truth += glm::dvec3(many(2 * x + k % 2, 2 * y + k / 2)) / 4.0;
      shown_ += square(glm::dvec3(color(piece.x + x, piece.y + y)) - truth);
      direct_ += square(glm::dvec3(few(x, y)) - truth);
      ++counted_;
    }
  ++pieces_;
  return Done{};
}

std::optional<double> PieceLoss::db() const {
  if (pieces_ < kEnough) return std::nullopt;
  return without_own_noise(SampledLoss::loss_db(shown_, direct_, counted_));
}

}  // namespace rilievo
