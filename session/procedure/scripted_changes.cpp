#include "session/procedure/scripted_changes.h"

#include <cmath>

#include <fmt/format.h>

namespace osteon::session {
namespace {

// A tool is at rest if its height has changed by at most kStill_m during kStillFor.
constexpr double kStill_m = 0.2e-3;
constexpr rt::Nanoseconds kStillFor = 300 * rt::kMillisecond;

}  // namespace

ScriptedChanges::Action ScriptedChanges::Step(rt::Nanoseconds stamp, double height_m, bool paused,
                                              bool next_is_ready) {
  switch (phase_) {
    case Phase::kReaming:
      been_down_ |= height_m < heights_.down_m;
      if (rest_since_ == 0 || std::abs(height_m - rest_height_m_) > kStill_m) {
        rest_height_m_ = height_m;
        rest_since_ = stamp;
      }
      if (!been_down_ || !next_is_ready || height_m < heights_.retracted_m || stamp - rest_since_ < kStillFor)
        return Action::kNone;
      phase_ = Phase::kPausing;
      return Action::kPause;
    case Phase::kPausing:
      if (!paused) return Action::kNone;
      if (paused_since_ == 0) paused_since_ = stamp;
      if (stamp - paused_since_ < rest_) return Action::kNone;
      paused_since_ = 0;
      phase_ = Phase::kChanging;
      answered_ = false;
      return Action::kNext;
    case Phase::kChanging:
      if (!answered_) return Action::kNone;
      phase_ = Phase::kResuming;
      return Action::kResume;
    case Phase::kResuming:
      if (paused) return Action::kNone;
      phase_ = Phase::kReaming;
      been_down_ = false;
      rest_since_ = 0;
      return Action::kNone;
  }
  return Action::kNone;
}

std::string ScriptedChanges::WhyNotChanged() const {
  if (!refusal_.empty()) return refusal_;
  switch (phase_) {
    case Phase::kReaming:
      if (!been_down_)
        return fmt::format("the tool before was not led below {:g} mm over the plan", 1e3 * heights_.down_m);
      return fmt::format(
          "the tool before was not retracted to {:g} mm over the plan and held at rest there for {:g} s",
          1e3 * heights_.retracted_m, rt::ToSeconds(kStillFor));
    case Phase::kPausing:
      return "the tool before was retracted and at rest only as the run ended";
    case Phase::kChanging:
      return "the run ended before the request for the next tool was answered";
    case Phase::kResuming:
      break;
  }
  return "the run ended before the cell resumed";
}

}  // namespace osteon::session
