#include "rilievo/method/auto_trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr int kMostTrialFrames = 64;
// A trial of which a frame takes this much more ends at once; after a warm-up. So one that fails is
// two frames, and not more than a hundredth of a walk of some seconds.
constexpr double kHopeless = 1.25;
// Of what warms up for longer.
constexpr double kHopelessWarmingUp = 1.6;
// So much more than later on its frames take while it warms up again.
constexpr double kWarmUpMore = 0.3;
// What captures, was never measured, and gains nothing by a model that may be off by half counts so
// many times: 10 to 30 s of frames afford it.
constexpr double kUnlikely = 4;
// And one whose frames together take so many frames' time more.
constexpr double kMostMore = 5;
// A frame of a trial is counted as at most so many frames: more is the work of another program.
constexpr double kMostOfFrame = 2;

// The mean without the largest, which may be the work of another program, and of others that take
// much as of frames that are no trial.
double mean_of(std::span<const double> ms) {
  std::array<double, kMostTrialFrames> sorted;
  RILIEVO_EXPECTS(!ms.empty() && ms.size() <= sorted.size());
  const auto end = std::copy(ms.begin(), ms.end(), sorted.begin());
  std::sort(sorted.begin(), end);
  if (ms.size() == 1) return ms[0];
  const double most = AutoTrials::kMuch * sorted[ms.size() / 2];
  double sum = 0;
  for (auto one = sorted.begin(); one != end - 1; ++one) sum += std::min(*one, most);
  return sum / double(ms.size() - 1);
}

}  // namespace

AutoTrials::AutoTrials(int most_warm_up) { ms_.reserve(std::size_t(most_warm_up + kCloseFrames)); }

bool AutoTrials::affords(const TrialOutlook& outlook, double free_ms, double now_ms) const {
  double expense = std::max(0.0, outlook.likely_ms - free_ms) * (outlook.warm_up + kFrames);
  // To return to what warms up for long is an expense, and more so to begin with it for no likely
  // gain.
  const bool begins_for_no_gain = !outlook.measured && outlook.likely_ms > free_ms;
  if (outlook.warm_up >= kWarmsUpLong && (outlook.measured || begins_for_no_gain)) {
    expense += kWarmUpMore * outlook.likely_ms * outlook.warm_up;
    if (begins_for_no_gain) expense *= kUnlikely;
  }
  // The time of two frames is free.
  return expense <= 0 || trials_ms_ + expense <= 2 * now_ms + kShare * all_ms_;
}

void AutoTrials::begin(int method, int warm_up, double expected_ms) {
  RILIEVO_EXPECTS(method >= 0 && !goes_on());
  method_ = method, warm_up_ = warm_up, expected_ms_ = expected_ms;
  ms_.clear();
}

void AutoTrials::add(double ms, double free_ms) {
  all_ms_ += ms;
  ms_.push_back(ms);
  trials_ms_ += std::max(0.0, std::min(ms, kMostOfFrame * free_ms) - free_ms);
}

// Its last frames take so much more that others would, too.
bool AutoTrials::hopeless(double free_ms) const {
  const bool long_warm_up = warm_up_ >= kWarmsUpLong;
  const double much = (long_warm_up ? kHopelessWarmingUp : kHopeless) * free_ms;
  // The first frames of what must warm up say little; of what need not, one says enough, unless it
  // was expected to be no dearer: that may be the work of another program.
  const int measured = int(ms_.size()) - (long_warm_up ? warm_up_ / 2 : warm_up_);
  const bool unlikely = expected_ms_ > 0 && expected_ms_ <= free_ms;
  const int needed = long_warm_up || unlikely ? 2 : 1;
  if (measured >= (long_warm_up ? 1 : needed) &&
      std::all_of(ms_.end() - needed, ms_.end(), [&](double ms) { return ms > much; }))
    return true;
  double more = 0;
  for (const double ms : ms_) more += ms - free_ms;
  return more > kMostMore * free_ms;
}

bool AutoTrials::over(double free_ms, double now_ms) const {
  if (ms_.empty()) return false;
  if (hopeless(free_ms)) return true;
  const int drawn = int(ms_.size()) - warm_up_;
  if (drawn < kFrames) return false;
  const double mean = mean_of(std::span(ms_).subspan(std::size_t(warm_up_)));
  return drawn >= kCloseFrames || std::abs(mean / now_ms - 1) > kClose;
}

std::optional<AutoTrials::Found> AutoTrials::end() {
  method_ = -1;
  if (ms_.empty()) return std::nullopt;
  const int drawn = int(ms_.size());
  const int from = drawn > warm_up_ ? warm_up_ : std::max(0, drawn - 2);
  const Found found{mean_of(std::span(ms_).subspan(std::size_t(from))), drawn - from,
                    drawn - warm_up_ >= kCloseFrames};
  ms_.clear();
  return found;
}

}  // namespace rilievo
