#include "rilievo/keyframes/eye_prediction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/keyframes/producer_stage_test_helpers.h"

namespace rilievo {
namespace {

TEST(EyePrediction, ASteadyEyeGoesOnAndAJumpIsNoMotion) {
  EyePrediction prediction;
  for (int i = 0; i < 20; ++i) prediction.follow(ProducerStage::eye(0.02 * i, 0.01 * i));
  EXPECT_FALSE(prediction.jumped());
  const double turning =
      EyePrediction::kTurningFrames * (1 - std::exp(-10 / EyePrediction::kTurningFrames));
  EXPECT_GT(turning, 8);
  const Camera ahead = prediction.after(10),
               expected = ProducerStage::eye(0.02 * 29, 0.19 + 0.01 * turning);
  EXPECT_NEAR(glm::length(ahead.position() - expected.position()), 0, 1e-9);
  EXPECT_NEAR(glm::length(ahead.forward() - expected.forward()), 0, 1e-9);
  EXPECT_TRUE(validate(ahead));
  prediction.follow(ProducerStage::eye(30));
  EXPECT_TRUE(prediction.jumped());
  EXPECT_EQ(prediction.after(10).position(), ProducerStage::eye(30).position());
}

TEST(EyePrediction, AFrameThatTakesLongTellsNothingOfTheEyesSpeed) {
  EyePrediction prediction;
  // The first frame of a walk takes as long as twenty others, and a later one takes as long as six.
  double at = 0;
  for (int i = 0; i < 40; ++i) {
    prediction.follow(ProducerStage::eye(at, at / 2));
    at += i == 0 ? 0.4 : i == 30 ? 0.12 : 0.02;
    EXPECT_EQ(prediction.speed_known(), i != 1);
    if (i < 2) continue;
    const Camera now = ProducerStage::eye(at - (i == 30 ? 0.12 : 0.02)),
                 ahead = prediction.after(10);
    EXPECT_NEAR(ahead.position().x - now.position().x, 0.2, 0.2 * 0.2) << i;
  }
}

TEST(EyePrediction, AnEyeThatMovesOrTurnsInEverySecondFrameOnlyDoesSo) {
  EyePrediction turns, moves;
  for (int i = 0; i < 60; ++i) {
    turns.follow(ProducerStage::eye(0.02 * i, 0.01 * (i / 2)));
    moves.follow(ProducerStage::eye(0.02 * (i / 2)));
    if (i <= 2) continue;
    EXPECT_EQ(moves.speed_known(), i % 2 == 0) << i;
    if (i % 2 == 0) {
      EXPECT_NEAR(moves.after(1).position().x - 0.02 * (i / 2), 0.02, 1e-9) << i;
    }
  }
  // Half of 0.01 a frame.
  EXPECT_NEAR(turns.turning_sideways(), 0.005, 0.001);
}

// What begins with the second frame asks where the eye goes.
TEST(EyePrediction, TheFirstStepSaysWhereTheEyeGoes) {
  EyePrediction prediction;
  for (const int at : {0, 1}) prediction.follow(ProducerStage::eye(at));
  EXPECT_EQ(prediction.after(10).position(), ProducerStage::eye(11).position());
}

}  // namespace
}  // namespace rilievo
