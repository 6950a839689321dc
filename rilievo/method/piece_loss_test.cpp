#include "rilievo/method/piece_loss.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "rilievo/method/darker_test_helpers.h"
#include "rilievo/method/direct.h"
#include "rilievo/method/good_enough.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class PieceLossTest : public ::testing::Test {
 protected:
  static constexpr int kPieces = PieceLoss::kAcross * PieceLoss::kAcross;

  void SetUp() override {
    auto built = make_builtin("builtin:teapots?triangles=20000");
    ASSERT_TRUE(built.ok());
    scene_ = std::move(built->scene);
    camera_ = camera_at(built->path, 0, 323, 181);  // no multiples of eight
    backend_ = std::make_unique<SoftwareBackend>(scene_, 4);
  }
  Rgba8Image draw(const Camera& camera, double time) {
    SoftwareFrames frames(*backend_, std::make_unique<DirectChooser>());
    EXPECT_TRUE(frames.draw(camera, time).ok());
    return frames.software_target()->color();
  }
  std::optional<double> loss_of(const Rgba8Image& color, double time, int pieces = kPieces) {
    PieceLoss loss(*backend_);
    for (int i = 0; i < pieces; ++i) EXPECT_TRUE(loss.add(camera_, time, color).ok());
    return loss.db();
  }

  Scene scene_;
  Camera camera_;
  std::unique_ptr<SoftwareBackend> backend_;
};

TEST_F(PieceLossTest, pieces_make_up_the_frame) {
  const Rgba8Image whole = draw(camera_, 0);
  Image<int> seen(camera_.width, camera_.height, 0);
  int differ = 0;
  for (int i = 0; i < kPieces; ++i) {
    const FramePiece piece = piece_of(camera_, i);
    EXPECT_EQ(piece.camera.width, (camera_.width + 7) / 8);
    EXPECT_EQ(piece.camera.height, (camera_.height + 7) / 8);
    const Rgba8Image part = draw(piece.camera, 0);
    for (int y = 0; y < part.height(); ++y)
      for (int x = 0; x < part.width(); ++x) {
        ++seen(piece.x + x, piece.y + y);
        const glm::ivec4 off = glm::ivec4(part(x, y)) - glm::ivec4(whole(piece.x + x, piece.y + y));
        for (int c = 0; c < 3; ++c) differ += std::abs(off[c]) > 2;
      }
  }
  // The last ones overlap.
  for (const int times : seen.texels()) EXPECT_GE(times, 1);
  // Edges are rounded to a grid of each picture's own.
  EXPECT_LT(differ, 3 * camera_.width * camera_.height / 200);
}

TEST_F(PieceLossTest, direct_drawing_loses_nothing_and_a_darker_frame_much) {
  const Rgba8Image own = draw(camera_, 0);
  EXPECT_FALSE(loss_of(own, 0, PieceLoss::kEnough - 1));
  EXPECT_NEAR(loss_of(own, 0).value(), 0, 0.1);
  EXPECT_GT(loss_of(darker(own, 40), 0).value(), 8);
}

// The slow twin compares whole frames: the truth is of twice the size. Pieces count the less the
// older they are, the first by 0.97^63, which the tolerance allows for.
TEST_F(PieceLossTest, all_pieces_say_what_the_whole_frame_says) {
  const Rgba8Image own = draw(camera_, 0), shown = darker(own, 6);
  Camera fine = camera_;
  fine.width *= 2, fine.height *= 2;
  const Rgba8Image many = draw(fine, 0);
  double of_shown = 0, of_own = 0;
  for (int y = 0; y < own.height(); ++y)
    for (int x = 0; x < own.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        double truth = 0;
        for (int k = 0; k < 4; ++k) truth += many(2 * x + k % 2, 2 * y + k / 2)[c] / 4.0;
        of_shown += std::pow(shown(x, y)[c] - truth, 2);
        of_own += std::pow(own(x, y)[c] - truth, 2);
      }
  const double unseen = 3.0 * own.width() * own.height();
  const double slow = without_own_noise(10 * std::log10(of_shown / std::max(of_own, unseen)));
  EXPECT_NEAR(loss_of(shown, 0).value(), slow, 1);
  EXPECT_GT(slow, 3);
}

// A ring slides through one of the teapots.
TEST_F(PieceLossTest, what_moves_counts_where_it_is) {
  const Rgba8Image then = draw(camera_, 0), later = draw(camera_, 1);
  EXPECT_NEAR(loss_of(later, 1).value(), 0, 0.1);
  EXPECT_GT(loss_of(then, 1).value(), 2);
}

}  // namespace
}  // namespace rilievo
