#include "kinematics/lbr_params.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tests/kinematics/iiwa14.h"

namespace osteon::kinematics {
namespace {

// The iiwa 14 as robot descriptions (URDF) have it: each joint's origin lies on its axis, but not on the
// arm's centre line. Origins are in the frame of the previous joint.
ChainParams<7> DescribedArm() {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const std::array<Vector3, 7> origin{
      Vector3(0, 0, .1475),      Vector3(0, -.010, .2125),  Vector3(0, .010, .228), Vector3(0, .0105, .192),
      Vector3(0, -.0105, .2075), Vector3(0, -.0707, .1925), Vector3(0, .0707, .091)};
  const std::array<Vector3, 7> axis{z, y, z, -y, z, y, z};
  ChainParams<7> chain;
  for (std::size_t i = 0; i < 7; ++i) {
    chain.joints[i].X_PJ.translation() = origin[i];
    chain.joints[i].axis_J = axis[i];
    chain.joints[i].limits = Iiwa14().limits[i];
  }
  chain.X_LF.translation().z() = .035;
  return chain;
}

std::string ErrorMessage(const ChainParams<7>& chain) {
  try {
    static_cast<void>(LbrParamsFrom(chain));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LbrParams, LengthsFollowFromTheAxesOfADescription) {
  const LbrParams params = LbrParamsFrom(DescribedArm()), expected = Iiwa14();
  EXPECT_NEAR(params.base_to_shoulder_m, expected.base_to_shoulder_m, 1e-15);
  EXPECT_NEAR(params.shoulder_to_elbow_m, expected.shoulder_to_elbow_m, 1e-15);
  EXPECT_NEAR(params.elbow_to_wrist_m, expected.elbow_to_wrist_m, 1e-15);
  EXPECT_NEAR(params.wrist_to_flange_m, expected.wrist_to_flange_m, 1e-15);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(params.limits[i].lower_rad, expected.limits[i].lower_rad);
    EXPECT_EQ(params.limits[i].upper_rad, expected.limits[i].upper_rad);
    EXPECT_EQ(params.limits[i].torque_Nm, expected.limits[i].torque_Nm);
  }
}

// The same arm described by Denavit-Hartenberg frames, in which every joint turns about its z.
TEST(LbrParams, FramesOfTheLinksDoNotMatter) {
  ChainParams<7> chain = DescribedArm();
  Matrix3 R_before =
      Matrix3::Identity();  // the previous link's Denavit-Hartenberg frame in its described one
  for (RevoluteJoint& joint : chain.joints) {
    const Matrix3 R = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), joint.axis_J).toRotationMatrix();
    joint.X_PJ = Pose(R_before.transpose()) * joint.X_PJ * Pose(R);
    joint.axis_J = Vector3::UnitZ();
    R_before = R;
  }
  chain.X_LF = Pose(R_before.transpose()) * chain.X_LF;
  const LbrParams params = LbrParamsFrom(chain);
  EXPECT_NEAR(params.shoulder_to_elbow_m, 0.420, 1e-15);
  EXPECT_NEAR(params.wrist_to_flange_m, 0.126, 1e-15);
}

TEST(LbrParams, ErrorNamesAMisplacedTiltedOrReversedAxis) {
  for (std::size_t i = 0; i < 7; ++i) {
    const std::string name = "axis of A" + std::to_string(i + 1);
    // an axis moved sideways no longer passes through shoulder, elbow or wrist
    ChainParams<7> chain = DescribedArm();
    chain.joints[i].X_PJ.translation().x() += 0.001;
    EXPECT_NE(ErrorMessage(chain).find(name + " passes beside"), std::string::npos) << ErrorMessage(chain);
    EXPECT_NE(ErrorMessage(chain).find("found 0.001 m off"), std::string::npos) << ErrorMessage(chain);
    // tilted
    chain = DescribedArm();
    chain.joints[i].axis_J = Eigen::AngleAxisd(0.002, Vector3::UnitX()) * chain.joints[i].axis_J;
    EXPECT_NE(ErrorMessage(chain).find(name + " at zero"), std::string::npos) << ErrorMessage(chain);
    EXPECT_NE(ErrorMessage(chain).find("found 0.002 rad off"), std::string::npos) << ErrorMessage(chain);
    // reversed
    chain = DescribedArm();
    chain.joints[i].axis_J *= -1.0;
    EXPECT_NE(ErrorMessage(chain).find(name), std::string::npos) << ErrorMessage(chain);
  }
}

TEST(LbrParams, RefusesAFlangeOffItsAxisOrTurnedAndA4BelowA2) {
  ChainParams<7> chain = DescribedArm();
  chain.X_LF.translation().x() = 0.002;
  EXPECT_NE(ErrorMessage(chain).find("flange at zero is beside"), std::string::npos) << ErrorMessage(chain);
  chain = DescribedArm();
  chain.X_LF.linear() = Eigen::AngleAxisd(0.1, Vector3::UnitZ()).toRotationMatrix();
  EXPECT_NE(ErrorMessage(chain).find("flange at zero is turned"), std::string::npos) << ErrorMessage(chain);
  chain = DescribedArm();
  chain.joints[3].X_PJ.translation().z() = -0.6;
  EXPECT_NE(ErrorMessage(chain).find("A4 is not above A2"), std::string::npos) << ErrorMessage(chain);
}

TEST(LbrParams, AChainMadeOfParamsGivesTheSameParamsBack) {
  const LbrParams arm = Iiwa14(), recovered = LbrParamsFrom(ChainFrom(arm));
  EXPECT_EQ(recovered.base_to_shoulder_m, arm.base_to_shoulder_m);
  EXPECT_EQ(recovered.shoulder_to_elbow_m, arm.shoulder_to_elbow_m);
  EXPECT_EQ(recovered.elbow_to_wrist_m, arm.elbow_to_wrist_m);
  EXPECT_EQ(recovered.wrist_to_flange_m, arm.wrist_to_flange_m);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(recovered.limits[i].upper_rad, arm.limits[i].upper_rad);
}

}  // namespace
}  // namespace osteon::kinematics
