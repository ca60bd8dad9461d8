#include "control/sensing/bias_estimator.h"

#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::control {
namespace {

constexpr double kDt_s = 1e-3;

const ForceSensorParams kSensor{.X_FS =
                                    [] {
                                      Pose X = Pose::Identity();
                                      X.linear() = ExpRotation({0.2, -0.1, 0.7});
                                      X.translation() << 0.01, -0.02, 0.03;
                                      return X;
                                    }(),
                                .tool_mass_kg = 1.2,
                                .tool_center_F_m = Vector3(0.01, 0.02, 0.12)};

// Pose of the flange at a fixed position, rotated by turn_rad about a fixed oblique axis.
Pose Flange(double turn_rad) {
  Pose X_WF = Pose::Identity();
  X_WF.linear() = ExpRotation(turn_rad * Vector3(1.0, 2.0, -2.0) / 3.0);
  X_WF.translation() << 0.5, 0.1, 0.6;
  return X_WF;
}

Wrench Sum(const Wrench& a, const Wrench& b) { return {.f = a.f + b.f, .t = a.t + b.t}; }

const Wrench kBias{.f = {3.0, -4.0, 0.0}, .t = {0.2, 0.1, -0.3}};

// Gives the estimator the readings of a tool at rest, with this bias and noise. The torque's noise is 0.05 Nm
// for 1 N of force noise.
void HangStill(BiasEstimator& estimator, double seconds, const Wrench& bias, double noise_N = 0.0,
               double turn_rad = 0.3) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int i = 0; i < static_cast<int>(seconds / kDt_s); ++i) {
    Wrench F_S = Sum(bias, ToolWeight(kSensor, Flange(turn_rad)));
    for (int k = 0; k < 3; ++k) {
      F_S.f[k] += noise_N * noise(random);
      F_S.t[k] += 0.05 * noise_N * noise(random);
    }
    estimator.AddReading(F_S, Flange(turn_rad));
  }
}

// Checks ToolWeight and HandWrench against each other: if the sensor reads the tool's weight alone, the
// hand's wrench must be zero.
TEST(BiasEstimator, HandWrenchOfTheToolsWeightAloneIsZero) {
  const Pose X_WF = Flange(1.1);
  const Wrench F = HandWrench(kSensor, ToolWeight(kSensor, X_WF), X_WF, X_WF * Vector3(0.0, 0.0, 0.3));
  EXPECT_LT(F.f.norm(), 1e-14);
  EXPECT_LT(F.t.norm(), 1e-14);
}

// HandWrench already subtracts the calibrated bias. So the estimate may contain only the change of the bias
// since the calibration.
TEST(BiasEstimator, ACalibratedBiasIsNotSubtractedTwice) {
  ForceSensorParams calibrated = kSensor;
  calibrated.bias_S = kBias;
  const Wrench since{.f = {0.0, 0.5, 0.0}, .t = {0.0, 0.0, 0.1}};
  BiasEstimator estimator({}, calibrated, kDt_s);
  HangStill(estimator, 1.0, Sum(kBias, since));
  EXPECT_LT((estimator.bias().f - since.f).norm(), 1e-9);
  EXPECT_LT((estimator.bias().t - since.t).norm(), 1e-9);
  const Pose X_WF = Flange(0.3);
  const Wrench F_S = Sum(Sum(kBias, since), ToolWeight(kSensor, X_WF));
  const Wrench hand =
      HandWrench(calibrated, {.f = F_S.f - estimator.bias().f, .t = F_S.t - estimator.bias().t}, X_WF,
                 X_WF * Vector3(0.0, 0.0, 0.3));
  EXPECT_LT(hand.f.norm(), 1e-9) << "nobody is there";
  EXPECT_LT(hand.t.norm(), 1e-9);
}

TEST(BiasEstimator, EstimatesTheBiasAtRestToWithinTheNoisesMean) {
  BiasEstimator estimator({}, kSensor, kDt_s);
  HangStill(estimator, 1.0, kBias, 0.1);
  // the mean of 500 samples (rest_s) has a standard deviation of 0.1 / sqrt(500) per axis; up to four
  // standard deviations are accepted
  EXPECT_LT((estimator.bias().f - kBias.f).norm(), 4.0 * std::sqrt(3.0) * 0.1 / std::sqrt(500.0));
  EXPECT_LT((estimator.bias().t - kBias.t).norm(), 4.0 * std::sqrt(3.0) * 0.005 / std::sqrt(500.0));
}

TEST(BiasEstimator, ARestThatIsTooShortGivesNoBias) {
  BiasEstimator estimator({}, kSensor, kDt_s);
  HangStill(estimator, 0.4, kBias);
  EXPECT_EQ(estimator.bias().f, Vector3::Zero());
}

TEST(BiasEstimator, AMovingOrTouchedToolGivesNoBias) {
  BiasEstimator moved({}, kSensor, kDt_s);
  for (int i = 0; i < 2000; ++i)
    moved.AddReading(Sum(kBias, ToolWeight(kSensor, Flange(1e-5 * i))),
                     Flange(1e-5 * i));  // rotates at 0.01 rad/s
  EXPECT_EQ(moved.bias().f, Vector3::Zero());

  BiasEstimator touched({}, kSensor, kDt_s);
  for (int i = 0; i < 2000; ++i) {
    const Wrench hand{.f = Vector3(0.0, 0.0, (i / 200) % 2 == 0 ? 0.0 : 4.0), .t = Vector3::Zero()};
    touched.AddReading(Sum(Sum(kBias, hand), ToolWeight(kSensor, Flange(0.3))), Flange(0.3));
  }
  EXPECT_EQ(touched.bias().f, Vector3::Zero());
}

TEST(BiasEstimator, KeepsTheBiasOfTheLastAcceptedRest) {
  BiasEstimator estimator({}, kSensor, kDt_s);
  HangStill(estimator, 1.0, kBias);
  const Wrench accepted = estimator.bias();
  EXPECT_LT((accepted.f - kBias.f).norm(), 1e-12);
  HangStill(
      estimator, 2.0,
      {.f = {20.0, 0.0, 0.0}, .t = Vector3::Zero()});  // a hand that leans on the tool, or a broken sensor
  EXPECT_EQ(estimator.bias().f, accepted.f);
  estimator.AddReading(
      {.f = Vector3::Constant(std::numeric_limits<double>::quiet_NaN()), .t = Vector3::Zero()}, Flange(0.3));
  EXPECT_EQ(estimator.bias().f, accepted.f);
}

TEST(BiasEstimator, ABiasBeyondTheBoundIsInDoubtUntilARestWithinIt) {
  BiasEstimator estimator({.max_bias_N = 2.0}, kSensor, kDt_s);
  HangStill(estimator, 1.0, kBias);
  EXPECT_TRUE(estimator.in_doubt());
  EXPECT_EQ(estimator.bias().f.norm(), 0.0);
  HangStill(estimator, 0.3, {});
  EXPECT_TRUE(estimator.in_doubt()) << "too short";
  HangStill(estimator, 0.3, {});
  EXPECT_FALSE(estimator.in_doubt());
}

TEST(BiasEstimator, TheBoundIsTheDeadZonePlusTheSmallestDragAtCreepSpeed) {
  AdmittanceParams law;
  law.damping_Ns_per_m = {30.0, 20.0, 40.0};
  law.dead_zone_N = 0.5;
  const BiasParams bound = CreepBound({.max_creep_m_per_s = 0.05}, law);
  EXPECT_DOUBLE_EQ(bound.max_bias_N, 0.5 + 20.0 * 0.05);
  EXPECT_EQ(CreepBound({.max_bias_N = 0.7, .max_creep_m_per_s = 0.05}, law).max_bias_N, 0.7);
}

TEST(BiasEstimator, EstimatesNoBiasWhenSwitchedOff) {
  BiasEstimator estimator({.acts = false}, kSensor, kDt_s);
  HangStill(estimator, 2.0, kBias);
  EXPECT_EQ(estimator.bias().f, Vector3::Zero());
}

TEST(BiasEstimator, RefusesParametersOutOfRange) {
  EXPECT_THROW(BiasEstimator({.rest_s = 0.0}, kSensor, kDt_s), std::invalid_argument);
  EXPECT_THROW(BiasEstimator({.max_bias_N = -1.0}, kSensor, kDt_s), std::invalid_argument);
}

TEST(BiasEstimator, DoesNotAllocate) {
  BiasEstimator estimator({}, kSensor, kDt_s);
  rt::CheckedNoAllocScope no_alloc;
  for (int i = 0; i < 100; ++i) estimator.AddReading(kBias, Flange(0.3));
}

}  // namespace
}  // namespace osteon::control
