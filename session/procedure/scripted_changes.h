#pragma once

#include <string>
#include <utility>

#include "base/clock.h"

namespace osteon::session {

/// Presses the buttons of a session for the scripted operator, who only moves the hand. Once a tool has been
/// at work, is retracted and is at rest, the script pauses the loop, takes the next tool, and resumes. The
/// script depends only on the tool's motion, so it works in wall time and in virtual time.
class ScriptedChanges {
 public:
  enum class Action { kNone, kPause, kNext, kResume };

  /// Heights of the head's centre over the plan's centre [m]: a tool is at work below `down_m`, and retracted
  /// above `retracted_m`.
  struct Heights {
    double down_m{0.015}, retracted_m{0.025};
  };
  /// @param rest  time at rest before the next tool is taken
  explicit ScriptedChanges(const Heights& heights, rt::Nanoseconds rest = 0)
      : heights_(heights), rest_(rest) {}

  /// @param height_m  height of the head's centre over the plan's centre, along the plan's axis
  /// @param paused  the loop is at rest  @param next_is_ready  a further tool is planned
  /// @returns the button to press now; each is returned once
  Action Step(rt::Nanoseconds stamp, double height_m, bool paused, bool next_is_ready);
  /// Takes the answer to the request for the next tool. If it was refused, the change is given up: the cell
  /// resumes with the old tool.  @param refusal  the reason; empty: the request was carried out
  void OnNextAnswered(std::string refusal) {
    answered_ = true;
    refusal_ = std::move(refusal);
  }
  /// Says why the next change of tool has not been made: the last refusal, or the condition that is still
  /// missing.
  [[nodiscard]] std::string WhyNotChanged() const;

 private:
  enum class Phase { kReaming, kPausing, kChanging, kResuming };
  Heights heights_;
  rt::Nanoseconds rest_;  // time at rest in a pause before the next tool is taken
  Phase phase_{Phase::kReaming};
  bool been_down_{false};  // the tool in use was below down_m
  bool answered_{false};   // the request for the next tool was answered
  std::string refusal_;
  double rest_height_m_{0.0};                        // height at rest_since_
  rt::Nanoseconds rest_since_{0}, paused_since_{0};  // 0: not yet
};

}  // namespace osteon::session
