#include "rilievo/serve/forecast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rilievo {
namespace {

constexpr double kPoseSeconds = 1 / 30.0;

// A head at yaw(t), which walks along -z by `speed`.
LivePose pose_at(double t, const std::function<double(double)>& yaw, double speed) {
  LivePose pose;
  pose.client_ms = 1e3 * t;
  pose.eye = {0, 0, -speed * t};
  pose.velocity = {0, 0, -speed};
  pose.orientation = glm::angleAxis(yaw(t), glm::dvec3(0, 1, 0));
  pose.turn_rate = {0, (yaw(t) - yaw(t - 0.02)) / 0.02, 0};
  return pose;
}

PoseHistory seen_for(double seconds, const std::function<double(double)>& yaw, double speed) {
  PoseHistory history;
  for (double t = 0; t < seconds; t += kPoseSeconds) history.see(pose_at(t, yaw, speed));
  return history;
}

double yaw_of(const LivePose& pose) {
  const glm::dvec3 look = pose.orientation * glm::dvec3(0, 0, -1);
  return std::atan2(-look.x, -look.z);
}

// A pose goes on as it moves, for a second, and a turn slows down.
TEST(Forecast, AnEyeIsPredictedToGoOn) {
  LivePose pose;
  pose.velocity = {2, 0, 0}, pose.turn_rate = {0, 1, 0};
  EXPECT_NEAR(predicted(pose, 0.5).eye.x, 1, 1e-12);
  EXPECT_NEAR(predicted(pose, 9).eye.x, 2, 1e-12);
  const double turned = 2 * std::acos(std::min(predicted(pose, 0.1).orientation.w, 1.0));
  // 0.4 (1 - exp(-0.25)) rad.
  EXPECT_NEAR(turned, 0.0885, 1e-3);
}

TEST(Forecast, WhatIsNewGoesOnAndWhoStandsStays) {
  const auto turning = [](double t) { return 0.5 * t; };
  PoseHistory history = seen_for(0.19, turning, 1.4);
  const LivePose newest = pose_at(5 * kPoseSeconds, turning, 1.4);
  const Forecast of = history.forecast(0.2, 0.2);
  EXPECT_NEAR(yaw_of(of.pose), yaw_of(predicted(newest, 0.2)), 1e-9);
  EXPECT_NEAR(of.pose.eye.z, newest.eye.z - 0.28, 1e-9);
  EXPECT_GT(of.yaw, 0.02);
  EXPECT_EQ(of.pitch, 0);
  const Forecast stands = seen_for(
                              3, [](double) { return 0.3; }, 0)
                              .forecast(0.5, 0.8);
  EXPECT_NEAR(yaw_of(stands.pose), 0.3, 1e-9);
  EXPECT_NEAR(stands.yaw, 0, 1e-6);
  EXPECT_EQ(stands.pose.eye, glm::dvec3(0));
  // After a walk, too.
  PoseHistory stopped = seen_for(
      3, [](double t) { return 0.5 * std::sin(3 * t); }, 1.4);
  LivePose last = pose_at(
      3, [](double) { return 0.7; }, 1.4);
  last.velocity = glm::dvec3(0), last.turn_rate = glm::dvec3(0);
  stopped.see(last);
  EXPECT_NEAR(yaw_of(stopped.forecast(0.7, 0.7).pose), 0.7, 1e-9);
  EXPECT_EQ(stopped.forecast(0.7, 0.7).pose.eye, last.eye);
}

// Half a swing later a head that swings looks the other way: the mean is the best guess, and nine
// looks of ten are off it by no more than what is told.
TEST(Forecast, OfAHeadThatSwingsOneKnowsTheMean) {
  const auto swings = [](double t) { return 0.2 + 0.45 * std::sin(4 * t); };
  double guessed = 0, went_on = 0;
  int within = 0, count = 0;
  PoseHistory history;
  for (int i = 0; i < 240; ++i) {
    const double t = i * kPoseSeconds;
    const LivePose pose = pose_at(t, swings, 1.4);
    history.see(pose);
    if (t < 3) continue;
    const Forecast of = history.forecast(0.7, 0.7);
    const double true_yaw = swings(t + 0.7);
    guessed += std::pow(yaw_of(of.pose) - true_yaw, 2);
    went_on += std::pow(yaw_of(predicted(pose, 0.7)) - true_yaw, 2);
    within += std::abs(yaw_of(of.pose) - true_yaw) <= of.yaw + 0.02;
    ++count;
  }
  EXPECT_LT(guessed, 0.3 * went_on);
  EXPECT_GE(within, 0.85 * count);
  // A quarter of a tenth of a swing ahead the turn goes on.
  const double near = 0.04, t = 239 * kPoseSeconds;
  const Forecast soon = history.forecast(near, near);
  EXPECT_NEAR(yaw_of(soon.pose), swings(t + near), 0.03);
  EXPECT_LT(soon.yaw, 0.1);
}

// The slow twin: the angles of every guess at every pose that is kept.
TEST(Forecast, NineLooksOfTenAreWithinWhatIsTold) {
  const auto wanders = [](double t) { return 0.6 * std::sin(2 * t) + 0.3 * std::sin(5.1 * t + 1); };
  PoseHistory history = seen_for(4, wanders, 1);
  for (const double lead : {0.1, 0.4, 0.8}) {
    const Forecast of = history.forecast(lead, lead);
    double best = HUGE_VAL;
    for (const bool on : {true, false}) {
      double sum = 0;
      int count = 0;
      for (double t = 0; t + lead < 4 - kPoseSeconds; t += 2 * kPoseSeconds, ++count) {
        const LivePose pose = pose_at(t, wanders, 1);
        const double guess = on ? yaw_of(predicted(pose, lead)) : yaw_of(pose);
        sum += std::pow(guess - wanders(t + lead), 2);
      }
      best = std::min(best, std::sqrt(sum / count));
    }
    // Nine of ten are within twice the root mean square of the best guess, or of a better one.
    EXPECT_LT(of.yaw, 2 * best + 0.02) << lead;
    EXPECT_GT(of.yaw, 0.2 * best) << lead;
  }
}

TEST(Forecast, AJumpAndAClockThatGoesBackBeginAnew) {
  const auto swings = [](double t) { return 0.45 * std::sin(4 * t); };
  PoseHistory history = seen_for(3, swings, 1.4);
  LivePose elsewhere = pose_at(3.1, swings, 1.4);
  elsewhere.eye.x += 50;
  history.see(elsewhere);
  const Forecast of = history.forecast(0.7, 0.7);
  EXPECT_NEAR(yaw_of(of.pose), yaw_of(predicted(elsewhere, 0.7)), 1e-9);
  EXPECT_NEAR(of.pose.eye.x, 50, 1e-9);
  history.see(pose_at(1, swings, 1.4));
  EXPECT_NEAR(history.forecast(0, 0).pose.eye.z, -1.4, 1e-9);
}

}  // namespace
}  // namespace rilievo
