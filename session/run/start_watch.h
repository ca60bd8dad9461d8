#pragma once

#include <string>

#include "base/latest_value.h"
#include "control/loop/run_servo.h"
#include "control/loop/servo_loop.h"
#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Checks the path to the start while the arm waits, and again if somebody has moved the arm since. Until the
/// path is found free, the loop may not start.
class StartWatch {
 public:
  /// @param setup, loop  outlive this
  StartWatch(const CellSetup& setup, control::ServoLoop& loop);

  /// The arm's position: written by the servo thread, read by Poll.
  [[nodiscard]] rt::LatestValue<control::StandingArm>& standing() { return standing_; }

  /// Checks the path from where the arm stands now. One thread only; takes up to some seconds.
  void Poll();

  /// The obstacle, named for the user; empty: none, or nothing is known yet.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }

 private:
  const CellSetup& setup_;
  control::ServoLoop& loop_;
  rt::LatestValue<control::StandingArm> standing_;
  // position from which the path was last checked
  kinematics::JointVector checked_q_{kinematics::JointVector::Zero()};
  bool checked_{false};
  std::string why_not_;
};

}  // namespace osteon::session
