#include "procedure/plan/pelvic_frame.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/units.h"

namespace osteon::procedure {
namespace {

// A pelvis in the patient's axes: x to the left, y backwards, z up. Spines 240 mm apart, pubis 87 mm below.
PelvicLandmarks Patient() {
  return {
      .asis_right_m = {-0.120, 0.0, 0.0}, .asis_left_m = {0.120, 0.0, 0.0}, .pubis_m = {0.0, 0.0, -0.087}};
}

// The cup's axis of radiographic 40 deg inclination and 15 deg anteversion, in N.
Vector3 Axis40_15() { return CupAxis_N(CupDefinition::kRadiographic, {40.0 * kDegree, 15.0 * kDegree}); }

TEST(PelvicFrame, LiesInThePlaneOfSpinesAndPubis) {
  const PelvicFrame left = FrameOf(Patient(), Side::kLeft), right = FrameOf(Patient(), Side::kRight);
  EXPECT_TRUE(left.lateral.isApprox(Vector3(1, 0, 0), 1e-15));
  EXPECT_TRUE(right.lateral.isApprox(Vector3(-1, 0, 0), 1e-15));
  for (const PelvicFrame& frame : {left, right}) {
    EXPECT_TRUE(frame.anterior.isApprox(Vector3(0, -1, 0), 1e-15)) << "forwards on both sides";
    EXPECT_TRUE(frame.superior.isApprox(Vector3(0, 0, 1), 1e-15));
  }
}

TEST(PelvicFrame, APubisOffTheMiddleChangesNothing) {
  PelvicLandmarks aside = Patient();
  aside.pubis_m.x() += 0.015;
  EXPECT_TRUE(FrameOf(aside, Side::kLeft).superior.isApprox(FrameOf(Patient(), Side::kLeft).superior, 1e-15));
}

TEST(PelvicFrame, AxesOfTheOtherSideAreRefused) {
  const PelvicFrame left = FrameOf(Patient(), Side::kLeft);
  EXPECT_NO_THROW(CheckFrame(left, Side::kLeft));
  EXPECT_THROW(CheckFrame(left, Side::kRight), std::invalid_argument);
  PelvicFrame skew = left;
  skew.superior = Vector3(0.01, 0.0, 1.0).normalized();
  EXPECT_THROW(CheckFrame(skew, Side::kLeft), std::invalid_argument);
}

TEST(PelvicFrame, LandmarksThatDefineNoPlaneAreRefused) {
  PelvicLandmarks close = Patient();
  close.asis_left_m = close.asis_right_m + Vector3(0.04, 0.0, 0.0);
  EXPECT_THROW(static_cast<void>(FrameOf(close, Side::kLeft)), std::invalid_argument);
  PelvicLandmarks flat = Patient();
  flat.pubis_m.z() = -0.01;
  EXPECT_THROW(static_cast<void>(FrameOf(flat, Side::kLeft)), std::invalid_argument);
}

// If a plan for the left hip is used for the right hip, the axis is wrong by this angle, because the two axes
// are mirror images.
TEST(PelvicFrame, TheSameAnglesOnTheOtherSideAreAnotherAxis) {
  const Vector3 right = FrameOf(Patient(), Side::kRight).ToG(Axis40_15()),
                left = FrameOf(Patient(), Side::kLeft).ToG(Axis40_15());
  EXPECT_NEAR(std::acos(right.dot(left)) / kDegree, 76.8, 0.05);
}

TEST(PelvicFrame, LandmarkSpreadEqualsTheSpreadOfDrawnLandmarks) {
  constexpr double kNoise_m = 2e-3;
  constexpr int kDraws = 20'000;
  const Vector3 a_G = FrameOf(Patient(), Side::kLeft).ToG(Axis40_15());
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, kNoise_m);
  const auto moved = [&](const Vector3& p_m) {
    return Vector3(p_m + Vector3(noise(random), noise(random), noise(random)));
  };
  double inclination = 0.0, anteversion = 0.0;
  const PelvicLandmarks at = Patient();
  for (int i = 0; i < kDraws; ++i) {
    const PelvicLandmarks drawn{moved(at.asis_right_m), moved(at.asis_left_m), moved(at.pubis_m)};
    const CupAngles read = AnglesOf(CupDefinition::kRadiographic, FrameOf(drawn, Side::kLeft).FromG(a_G));
    inclination += std::pow(read.inclination_rad - 40.0 * kDegree, 2);
    anteversion += std::pow(read.anteversion_rad - 15.0 * kDegree, 2);
  }
  const CupAngles spread = LandmarkSpread(at, Side::kLeft, 0.0, CupDefinition::kRadiographic, a_G, kNoise_m);
  // 20 000 draws give a standard deviation to 0.5 %; the tolerance is four times that plus terms of second
  // order
  EXPECT_NEAR(spread.inclination_rad, std::sqrt(inclination / kDraws), 0.025 * spread.inclination_rad);
  EXPECT_NEAR(spread.anteversion_rad, std::sqrt(anteversion / kDraws), 0.025 * spread.anteversion_rad);
  RecordProperty("inclination_deg", std::to_string(spread.inclination_rad / kDegree));
  RecordProperty("anteversion_deg", std::to_string(spread.anteversion_rad / kDegree));
}

}  // namespace
}  // namespace osteon::procedure
