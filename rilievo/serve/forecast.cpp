#include "rilievo/serve/forecast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// A turn slows down as if it went on for so many seconds in the end, and by so much at most.
constexpr double kTurnSeconds = 0.4, kMostTurn = 0.6;
constexpr double kMostAhead = 1.0;
// Seconds that are kept, between two that are kept, and of means.
constexpr double kKept = 4, kBetween = 0.05, kMean = 2;
// So many guesses tell how good they are.
constexpr std::size_t kFewest = 6;
constexpr double kMostOff = 0.9;  // the share of looks that were off by at most ...
// Until they do, a turn may end at once or go on.
constexpr double kUnknownTurn = 0.5;
// What moved as far as its velocity takes so many seconds longer has jumped.
constexpr double kJumpSeconds = 0.5;
// A judgement holds for so many seconds, for times that differ by so much.
constexpr double kJudged = 0.2, kSameTimes = 0.25;

// The look of `seen` in the eye's space of `guess`: about y and about x.
std::array<double, 2> angles_off(const glm::dquat& guess, const glm::dquat& seen) {
  const glm::dvec3 look = glm::conjugate(guess) * (seen * glm::dvec3(0, 0, -1));
  return {std::abs(std::atan2(look.x, -look.z)),
          std::abs(std::asin(std::clamp(look.y, -1.0, 1.0)))};
}

double most_of(std::vector<double>& values) {
  const auto at = values.begin() + std::ptrdiff_t(kMostOff * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

bool jumps(const LivePose& from, const LivePose& to, double seconds) {
  const double fastest = std::max(glm::length(from.velocity), glm::length(to.velocity));
  return glm::length(to.eye - from.eye) > (seconds + kJumpSeconds) * fastest;
}

}  // namespace

LivePose predicted(LivePose pose, double seconds) {
  const double ahead = std::clamp(seconds, 0.0, kMostAhead);
  pose.eye += ahead * pose.velocity;
  const double rate = glm::length(pose.turn_rate);
  const double angle =
      std::min(rate * kTurnSeconds * (1 - std::exp(-ahead / kTurnSeconds)), kMostTurn);
  if (angle > 1e-6)
    pose.orientation =
        glm::normalize(glm::angleAxis(angle, pose.turn_rate / rate) * pose.orientation);
  return pose;
}

void PoseHistory::see(const LivePose& pose) {
  const Past now{1e-3 * pose.client_ms, pose};
  if (!poses_.empty()) {
    const Past& last = poses_.back();
    const double passed = now.seconds - last.seconds;
    if (passed < 0 || passed > 1 || jumps(last.pose, pose, passed))
      poses_.clear(), judgements_ = {};
  }
  // The newest is always there; those before it are not too close.
  const std::size_t count = poses_.size();
  if (count > 1 && poses_[count - 1].seconds - poses_[count - 2].seconds < kBetween)
    poses_.pop_back();
  poses_.push_back(now);
  while (poses_.front().seconds < now.seconds - kKept) poses_.pop_front();
}

LivePose PoseHistory::seen_at(double seconds) const {
  const auto after = std::ranges::lower_bound(poses_, seconds, {}, &Past::seconds);
  if (after == poses_.begin()) return poses_.front().pose;
  if (after == poses_.end()) return poses_.back().pose;
  const Past &a = *(after - 1), &b = *after;
  const double t = (seconds - a.seconds) / std::max(b.seconds - a.seconds, 1e-9);
  LivePose pose = a.pose;
  pose.eye = glm::mix(a.pose.eye, b.pose.eye, t);
  pose.orientation = glm::slerp(a.pose.orientation, b.pose.orientation, t);
  return pose;
}

LivePose PoseHistory::guessed(Guess guess, std::size_t i, double after_s) const {
  LivePose pose = poses_[i].pose;
  if (guess == Guess::on) return predicted(pose, after_s);
  if (guess == Guess::mean) {
    glm::dquat sum = pose.orientation;
    std::size_t first = i;
    for (; first > 0 && poses_[first - 1].seconds > poses_[i].seconds - kMean; --first) {
      const glm::dquat& one = poses_[first - 1].pose.orientation;
      sum += glm::dot(one, pose.orientation) < 0 ? -one : one;
    }
    pose.orientation = glm::normalize(sum);
    const double seconds = poses_[i].seconds - poses_[first].seconds;
    // Who stands now stays.
    if (seconds > 0 && glm::length(pose.velocity) > 0)
      pose.velocity = (pose.eye - poses_[first].pose.eye) / seconds;
  }
  pose.eye += std::min(after_s, kMostAhead) * pose.velocity;
  return pose;
}

PoseHistory::Judgement PoseHistory::judged(double from_s, double to_s) const {
  const std::size_t last = poses_.size() - 1;
  const double middle_s = 0.5 * (from_s + to_s);
  const std::array<double, 2> ends{from_s, to_s};
  Judgement best{poses_[last].seconds, from_s, to_s};
  const auto is_over = [&](std::size_t i) {
    return poses_[i].seconds + to_s <= poses_[last].seconds;
  };
  if (last < kFewest || !is_over(kFewest - 1)) {
    const glm::dquat on = guessed(Guess::on, last, middle_s).orientation;
    const auto [yaw, pitch] = angles_off(on, poses_[last].pose.orientation);
    best.yaw = kUnknownTurn * yaw, best.pitch = kUnknownTurn * pitch;
    return best;
  }
  double least = HUGE_VAL;
  for (const Guess guess : {Guess::on, Guess::stay, Guess::mean}) {
    double sum = 0;
    std::vector<double> yaws, pitches;
    for (std::size_t i = 0; i < last && is_over(i); ++i) {
      const glm::dquat look = guessed(guess, i, middle_s).orientation;
      for (const double end : ends) {
        const auto [yaw, pitch] = angles_off(look, seen_at(poses_[i].seconds + end).orientation);
        sum += yaw * yaw + pitch * pitch;
        yaws.push_back(yaw), pitches.push_back(pitch);
      }
    }
    if (sum >= least) continue;
    least = sum;
    best.guess = guess, best.yaw = most_of(yaws), best.pitch = most_of(pitches);
  }
  return best;
}

Forecast PoseHistory::forecast(double from_s, double to_s) {
  RILIEVO_EXPECTS(!poses_.empty() && from_s >= 0 && from_s <= to_s);
  const LivePose& newest = poses_.back().pose;
  const bool stands = newest.velocity == glm::dvec3(0) && newest.turn_rate == glm::dvec3(0);
  const double now = poses_.back().seconds;
  const auto same = [](double a, double b) {
    return std::abs(a - b) <= kSameTimes * std::max(a, b);
  };
  auto found = std::ranges::find_if(judgements_, [&](const Judgement& one) {
    return now - one.at < kJudged && same(one.from_s, from_s) && same(one.to_s, to_s);
  });
  if (found == judgements_.end()) {
    judgements_[1] = judgements_[0];
    judgements_[0] = judged(from_s, to_s);
    found = judgements_.begin();
  }
  const double middle_s = 0.5 * (from_s + to_s);
  const Guess guess = stands ? Guess::stay : found->guess;
  return {guessed(guess, poses_.size() - 1, middle_s), found->yaw, found->pitch};
}

}  // namespace rilievo
