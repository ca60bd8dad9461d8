#include "safety/joint_torque_limit.h"

#include <limits>

#include <gtest/gtest.h>

namespace osteon::safety {
namespace {

using Joints = kinematics::JointVectorN<7>;

// The arm's largest joint torques [N·m].
Joints MaxTorques() {
  Joints max;
  max << 320, 320, 176, 176, 110, 40, 40;
  return max;
}
// The torque of gravity: `sign` times 90 N·m on the second joint.
Joints Gravity(double sign) { return sign * 90.0 * Joints::Unit(1); }

TEST(JointTorqueLimit, ScalesAllTorquesUntilEachJointHoldsItsOwnBesideGravity) {
  const JointTorqueLimit<7> limit(MaxTorques());
  for (const double sign : {-1.0, 1.0}) {
    Joints tau = Joints::Constant(10.0);
    tau[1] = 230.0;  // 320 - 90, exactly
    EXPECT_EQ(limit.MaxScale(Gravity(sign), tau), 1.0);
    tau[1] = -460.0;
    const double scale = limit.MaxScale(Gravity(sign), tau);
    EXPECT_NEAR(scale, 0.5, 1e-12);
    EXPECT_LE(std::abs(scale * tau[1]) + 90.0, 320.0);
    tau[6] = 400.0;  // the seventh joint can hold a tenth of this
    EXPECT_NEAR(limit.MaxScale(Gravity(sign), tau), 0.1, 1e-12);
  }
  EXPECT_EQ(limit.MaxScale(Gravity(4.0), Joints::Ones()), 0.0)
      << "an arm that can not hold itself holds no more";
  EXPECT_EQ(limit.MaxScale(Gravity(1.0), Joints::Constant(std::numeric_limits<double>::quiet_NaN())), 0.0);
}

TEST(JointTorqueLimit, TripsOneMessageBeforeATorqueExceedsItsLimitAtItsPresentRate) {
  JointTorqueLimit<7> limit(MaxTorques());
  int message = 0;
  for (; message < 100; ++message)  // the sixth joint, which holds 40 N·m, gets 3 N·m more with each message
    if (limit.PredictOverload(Joints::Zero(), -3.0 * message * Joints::Unit(5))) break;
  EXPECT_EQ(message, 13) << "39 is held, 42 would not be";
}

TEST(JointTorqueLimit, HoldsAConstantTorqueUpToTheLimit) {
  JointTorqueLimit<7> limit(MaxTorques());
  for (int message = 0; message < 3; ++message)
    EXPECT_FALSE(limit.PredictOverload(Gravity(1.0), 230.0 * Joints::Unit(1)));
  EXPECT_TRUE(limit.PredictOverload(Gravity(1.0), 230.1 * Joints::Unit(1)));
}

TEST(JointTorqueLimit, AnEstimateThatIsNotFiniteIsIgnored) {
  JointTorqueLimit<7> limit(MaxTorques());
  EXPECT_FALSE(limit.PredictOverload(Joints::Zero(), Joints::Zero()));
  EXPECT_FALSE(
      limit.PredictOverload(Joints::Zero(), Joints::Constant(std::numeric_limits<double>::infinity())));
  EXPECT_FALSE(limit.PredictOverload(Joints::Zero(), 39.0 * Joints::Unit(5)))
      << "no jump from what was forgotten";
}

TEST(JointTorqueLimit, RefusesAnArmWhoseTorquesAreNotKnown) {
  EXPECT_THROW(JointTorqueLimit<7>{Joints::Zero()}, std::invalid_argument);
}

}  // namespace
}  // namespace osteon::safety
