#pragma once

#include <string>

#include "base/latest_value.h"
#include "control/loop/run_servo.h"
#include "control/loop/servo_loop.h"
#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Checks the path to the start while the arm waits, and again if somebody has moved the arm since the last
/// check. The loop may not start until the path is found free.
class StartWatch {
 public:
  /// @param setup, loop  must outlive this object
  StartWatch(const CellSetup& setup, control::ServoLoop& loop);

  /// The waiting arm's position. The servo thread writes it, Poll reads it.
  [[nodiscard]] rt::LatestValue<control::StandingArm>& standing() { return standing_; }

  /// Checks the path from the arm's present position. Call it from one thread only. Takes up to some seconds.
  void Poll();

  /// The obstacle in words for the user; empty: there is none, or the path was not checked yet.
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
