#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "base/clock.h"
#include "control/arm/arm_follower.h"
#include "control/coupling/virtual_coupling.h"
#include "control/setup/servo_params.h"
#include "kinematics/differential_inverse.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/redundancy.h"
#include "kinematics/serial_chain.h"
#include "safety/joint_guard.h"
#include "safety/limits.h"

namespace osteon::studies {

/// The inputs of a tick of the loop that the timed parts need.
struct TickPartsInput {
  /// Commanded joint positions before the tick [rad]
  kinematics::JointVector q{kinematics::JointVector::Zero()};
  Pose X_WT{Pose::Identity()};  ///< the tool's pose at q
  Twist V_WT;                   ///< twist of the tool in this tick
  rt::Nanoseconds now{0};
};

/// Times the expensive parts of ServoLoop::Tick: each is called once more on a tick's inputs, since the loop
/// itself has no points at which to time them. The functions are those that the loop calls, with the loop's
/// parameters. The code between them is only part of the whole tick's time.
class TickParts {
 public:
  static constexpr std::size_t kCount = 6;
  static constexpr std::array<std::string_view, kCount> kNames{"kinematics", "coupling", "limits",
                                                               "elbow",      "inverse",  "guard"};

  /// @param X_WB robot base in world  @param X_FT tool on the flange; servo.arm_body must have a value
  TickParts(const control::ServoParams& servo, const kinematics::LbrParams& robot, const Pose& X_WB,
            const Pose& X_FT);

  /// @returns each part's time [us], including the reading of the clock.
  std::array<double, kCount> Time(const TickPartsInput& input, const simulation::ContactModel& model);

  /// Number of contacts that pressed in the last call.
  [[nodiscard]] int active_contacts() const { return active_contacts_; }

 private:
  control::ServoParams servo_;
  kinematics::LbrArm arm_;
  Pose X_WB_, X_BW_, X_FT_;
  kinematics::SerialChain<7> body_;
  kinematics::LoadTarget<7> wanted_load_;
  safety::WrenchLimiter limiter_;
  kinematics::DifferentialInverse<7> motion_;
  safety::JointGuard<7> guard_;
  control::CouplingState coupling_;
  // Results of the last call that the next one needs: joint velocities, direction of the elbow's motion, and
  // directions of the inverse (MotionInput::U_before).
  kinematics::JointVector qd_before_{kinematics::JointVector::Zero()};
  kinematics::JointVector null_direction_{kinematics::JointVector::Zero()};
  Eigen::Matrix<double, 6, 6> directions_{Eigen::Matrix<double, 6, 6>::Identity()};
  int active_contacts_{0};
  volatile double sink_{0.0};  // receives results, so that the compiler drops no call
};

}  // namespace osteon::studies
