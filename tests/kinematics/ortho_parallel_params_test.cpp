#include "kinematics/ortho_parallel_params.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "kinematics/serial_chain.h"
#include "tests/kinematics/kr_arms.h"

namespace osteon::kinematics {
namespace {

using Joints = JointVectorN<6>;
constexpr double kPi = std::numbers::pi;

Joints RandomPosture(std::mt19937_64& random) {
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = angle(random);
  return q;
}

// The KR 6 R900-2 as in a robot description: stretched forward at zero, all frames aligned with B, the
// flange's z forward.
ChainParams<6> DescribedKr6() {
  const std::array<Vector3, 6> origin{Vector3(0, 0, .400), Vector3(.025, 0, 0), Vector3(.455, 0, 0),
                                      Vector3(0, 0, .025), Vector3(.420, 0, 0), Vector3(.080, 0, 0)};
  const std::array<Vector3, 6> axis{-Vector3::UnitZ(), Vector3::UnitY(), Vector3::UnitY(),
                                    -Vector3::UnitX(), Vector3::UnitY(), -Vector3::UnitX()};
  ChainParams<6> chain;
  for (std::size_t i = 0; i < 6; ++i) {
    chain.joints[i].X_PJ.translation() = origin[i];
    chain.joints[i].axis_J = axis[i];
    chain.joints[i].limits = Kr6R900Params().limits[i];
  }
  chain.X_LF.translation() = Vector3(.010, 0, 0);
  chain.X_LF.linear() = Eigen::AngleAxisd(kPi / 2.0, Vector3::UnitY()).toRotationMatrix();
  return chain;
}

TEST(OrthoParallelParams, ChainEqualsTheProductOfTransformsThatDefinesIt) {
  std::mt19937_64 random(1);
  for (const OrthoParallelParams& params : {Kr6R900Params(), Kr16Params(), CrookedArmParams()}) {
    const SerialChain<6> chain(ChainFrom(params));
    for (int n = 0; n < 100; ++n) {
      const Joints q = RandomPosture(random);
      const auto theta = [&](int i) {
        const auto joint = static_cast<std::size_t>(i);
        return params.sign[joint] * q[i] - params.offset_rad[joint];
      };
      const auto turn = [&](int i, const Vector3& axis) { return Pose(Eigen::AngleAxisd(theta(i), axis)); };
      const auto shift = [](double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); };
      const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
      const Pose X_BF = turn(0, z) * shift(params.a1_m, params.b_m, params.c1_m) * turn(1, y) *
                        shift(0, 0, params.c2_m) * turn(2, y) * shift(params.a2_m, 0, params.c3_m) *
                        turn(3, z) * turn(4, y) * turn(5, z) * shift(0, 0, params.c4_m);
      EXPECT_LT((chain.FlangePose(q).matrix() - X_BF.matrix()).cwiseAbs().maxCoeff(), 1e-14);
    }
  }
}

// One arm from two sources: our lengths, offsets and signs give the poses that KDL finds from the origins and
// axes of a robot description.
TEST(OrthoParallelParams, ChainEqualsTheDescribedArm) {
  const ChainParams<6> described = DescribedKr6();
  KDL::Chain kdl;
  for (const RevoluteJoint& joint : described.joints) {
    const KDL::Vector origin(joint.X_PJ.translation().x(), joint.X_PJ.translation().y(),
                             joint.X_PJ.translation().z());
    const KDL::Vector axis(joint.axis_J.x(), joint.axis_J.y(), joint.axis_J.z());
    kdl.addSegment(KDL::Segment(KDL::Joint(origin, axis, KDL::Joint::RotAxis), KDL::Frame(origin)));
  }
  kdl.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None),
                              KDL::Frame(KDL::Rotation::RotY(kPi / 2.0), KDL::Vector(.010, 0, 0))));
  KDL::ChainFkSolverPos_recursive forward(kdl);
  const SerialChain<6> chain(ChainFrom(Kr6R900Params()));
  std::mt19937_64 random(2);
  for (int n = 0; n < 1000; ++n) {
    const Joints q = RandomPosture(random);
    KDL::JntArray joints(6);
    joints.data = q;
    KDL::Frame frame;
    ASSERT_EQ(forward.JntToCart(joints, frame), 0);
    const Pose X_BF = chain.FlangePose(q);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(X_BF.translation()[i], frame.p(i), 1e-12);
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(X_BF.linear()(i, j), frame.M(i, j), 1e-12);
    }
  }
}

void ExpectEqual(const OrthoParallelParams& found, const OrthoParallelParams& expected) {
  EXPECT_NEAR(found.a1_m, expected.a1_m, 1e-14);
  EXPECT_NEAR(found.a2_m, expected.a2_m, 1e-14);
  EXPECT_NEAR(found.b_m, expected.b_m, 1e-14);
  EXPECT_NEAR(found.c1_m, expected.c1_m, 1e-14);
  EXPECT_NEAR(found.c2_m, expected.c2_m, 1e-14);
  EXPECT_NEAR(found.c3_m, expected.c3_m, 1e-14);
  EXPECT_NEAR(found.c4_m, expected.c4_m, 1e-14);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(std::remainder(found.offset_rad[i] - expected.offset_rad[i], 2.0 * kPi), 0.0, 1e-14) << i;
    EXPECT_EQ(found.sign[i], expected.sign[i]) << i;
    EXPECT_EQ(found.limits[i].lower_rad, expected.limits[i].lower_rad) << i;
    EXPECT_EQ(found.limits[i].upper_rad, expected.limits[i].upper_rad) << i;
  }
}

TEST(OrthoParallelParams, FollowFromTheAxesOfADescription) {
  ExpectEqual(OrthoParallelParamsFrom(DescribedKr6()), Kr6R900Params());
}

TEST(OrthoParallelParams, ParamsOfTheChainAreThoseTheChainWasMadeOf) {
  for (const OrthoParallelParams& params : {Kr6R900Params(), Kr16Params(), CrookedArmParams()})
    ExpectEqual(OrthoParallelParamsFrom(ChainFrom(params)), params);
}

// KUKA's data sheets: the wrist reaches 901 mm (KR 6 R900) and 1611 mm (KR 16-2) from A1.
TEST(OrthoParallelParams, ReachIsThatOfTheDataSheet) {
  const auto reach_m = [](const OrthoParallelParams& p) {
    return p.a1_m + p.c2_m + std::hypot(p.a2_m, p.c3_m);
  };
  EXPECT_NEAR(reach_m(Kr6R900Params()), 0.901, 0.0005);
  EXPECT_NEAR(reach_m(Kr16Params()), 1.611, 0.0005);
}

TEST(OrthoParallelParams, ErrorNamesTheAxisThatMissesAndItsOffset) {
  const auto message = [](const ChainParams<6>& chain) -> std::string {
    try {
      static_cast<void>(OrthoParallelParamsFrom(chain));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  struct Case {
    std::size_t joint;
    Vector3 shift;
    Vector3 tilt;
    const char* text;
  };
  const Vector3 none = Vector3::Zero();
  for (const Case& c :
       {Case{0, {.001, 0, 0}, none, "A1 passes beside B's origin"},
        Case{0, none, {.002, 0, 0}, "A1 is not z of B"},
        Case{1, none, {.002, 0, 0}, "A2 at zero is not along y"},
        Case{2, none, {0, 0, .002}, "A3 at zero is not along y"},
        Case{3, none, {0, 0, .002}, "A4 is not square to A3"}, Case{4, {0, 0, .001}, none, "A4 misses A5"},
        Case{4, none, {0, 0, .002}, "A5 is not square to A4"},
        Case{5, {0, .001, 0}, none, "A6 misses where A4 and A5 meet"},
        Case{5, none, {0, 0, .002}, "A6 is not square to A5"}}) {
    ChainParams<6> chain = DescribedKr6();
    RevoluteJoint& joint = chain.joints[c.joint];
    joint.X_PJ.translation() += c.shift;
    if (c.tilt != none) joint.axis_J = Eigen::AngleAxisd(c.tilt.norm(), c.tilt.normalized()) * joint.axis_J;
    EXPECT_NE(message(chain).find(c.text), std::string::npos) << c.text << ": " << message(chain);
    EXPECT_NE(message(chain).find(c.tilt == none ? "found 0.001 m off" : "found 0.002 rad off"),
              std::string::npos)
        << message(chain);
  }
  ChainParams<6> chain = DescribedKr6();
  chain.X_LF.translation().y() = 0.001;
  EXPECT_NE(message(chain).find("flange is beside A6"), std::string::npos) << message(chain);
}

}  // namespace
}  // namespace osteon::kinematics
