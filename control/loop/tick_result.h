#pragma once

#include "control/laws/admittance_renderer.h"
#include "control/loop/safety_checks.h"
#include "kinematics/spatial.h"
#include "safety/acting_limits.h"

namespace osteon::control {

/// Results of a tick that no part of the loop stores. The loop makes the tick's record from them and from the
/// data of its parts.
struct TickResult {
  InputAges ages;       ///< ages of contact model and force reading
  Wrench F_hand_T_W{};  ///< the hand's wrench on T at To, in W; zero if there is none or it is not finite
  double arm_speed_m_per_s{0.0};  ///< measured speed of the apex while the loop commands the arm; else 0
  bool coupling_evaluated{false};
  bool rendered{false};  ///< a wrench was rendered, not only evaluated
  /// The rendered wrench. In a tick whose fault prevented rendering, the limited wrench that would have been
  /// rendered.
  Wrench F_coupling_T_W{};
  /// shares of the wrench left by all limits; by what the arm can hold
  double wrench_scale{1.0}, arm_share{1.0};
  VibrationRecord vibration{};  ///< vibration in the admittance law
  safety::LimitSet acting{};    ///< limits that act
};

}  // namespace osteon::control
