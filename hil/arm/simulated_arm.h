#pragma once

#include <memory>

#include "hil/arm/arm_model.h"
#include "hil/arm/dynamic_arm.h"
#include "hil/arm/servo_arm.h"
#include "kinematics/lbr_params.h"

namespace osteon::hil {

struct SimulatedArmParams {
  ArmLevel level{ArmLevel::kServo};
  kinematics::LbrParams lbr{};  ///< for kKinematic and kServo
  ServoArmParams servo{};       ///< for kServo
  DynamicArmParams dynamic{};   ///< for kDynamic
  /// For kDynamic: the same arm as lbr, with masses; includes the load on its flange.
  kinematics::ChainParams<7> chain{};
  Vector3 gravity_B_m_per_s2{kinematics::kGravity_W_m_per_s2};
  Vector3 p_FT_m{Vector3::Zero()};  ///< the motion's centre (the tool), in the flange's frame
  kinematics::JointVectorN<7> q_start{kinematics::JointVectorN<7>::Zero()};
};

/// @throws std::invalid_argument from the constructor of the level's arm.
[[nodiscard]] std::unique_ptr<SimulatedArm> MakeSimulatedArm(const SimulatedArmParams& params,
                                                             double period_s);

}  // namespace osteon::hil
