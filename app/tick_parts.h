#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "control/arm_follower.h"
#include "control/rt/clock.h"
#include "control/servo_params.h"
#include "control/virtual_coupling.h"
#include "kinematics/differential_inverse.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/redundancy.h"
#include "kinematics/serial_chain.h"
#include "safety/joint_guard.h"
#include "safety/limits.h"

namespace osteon::app {

/// What a tick of the loop was given, as far as its parts need it.
struct TickPartsInput {
  kinematics::JointVector q{kinematics::JointVector::Zero()};  ///< commanded, before the tick [rad]
  Pose X_WT{Pose::Identity()};                                 ///< the tool there
  Twist V_WT;                                                  ///< of the tool, in this tick
  rt::Nanoseconds now{0};
};

/// The parts of ServoLoop::Tick that take time, each called once more on a tick's inputs and timed by itself:
/// the loop has no seams to time them in. They are the functions that the loop calls, with its parameters;
/// what glues them together is in the tick's own time alone.
class TickParts {
 public:
  static constexpr std::size_t kCount = 6;
  static constexpr std::array<std::string_view, kCount> kNames{"kinematics", "coupling", "limits",
                                                               "elbow",      "inverse",  "guard"};

  /// @param X_WB robot base in world  @param X_FT tool on the flange; servo.arm_body must be there
  TickParts(const control::ServoParams& servo, const kinematics::LbrParams& robot, const Pose& X_WB,
            const Pose& X_FT);

  /// @returns what each took [us], the clock's own reading in it.
  std::array<double, kCount> Time(const TickPartsInput& input, const simulation::ContactModel& model);

  /// Of the last call: contacts that press.
  [[nodiscard]] int active_contacts() const { return active_contacts_; }

 private:
  control::ServoParams servo_;
  kinematics::LbrArm arm_;
  Pose X_WB_, X_BW_, X_FT_;
  kinematics::SerialChain<7> body_;
  kinematics::WantedLoad<7> wanted_load_;
  safety::WrenchLimiter limiter_;
  kinematics::DifferentialInverse<7> motion_;
  safety::JointGuard<7> guard_;
  control::CouplingState coupling_;
  kinematics::JointVector qd_before_{kinematics::JointVector::Zero()};
  kinematics::JointVector null_direction_{kinematics::JointVector::Zero()};
  Eigen::Matrix<double, 6, 6> directions_{Eigen::Matrix<double, 6, 6>::Identity()};
  int active_contacts_{0};
  volatile double sink_{0.0};  // where results go, so that none is left out
};

}  // namespace osteon::app
