#include "procedure/assessment/sphere_fit.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "procedure/assessment/cavity_result.h"
#include "tests/procedure/reamed_cup.h"

namespace osteon::procedure {
namespace {

using simulation::Ball;

const Vector3 kCentre_m(0.0015, 0.0008, -0.0025);

// Balls that touch a sphere of 25 mm radius from outside, evenly over a cap of this half angle, with Gaussian
// noise along the radius.
std::vector<Ball> BallsTouchingASphere(double cap_rad, int count, double noise_m, std::mt19937_64& random) {
  constexpr double kRadius_m = 0.025;
  std::uniform_real_distribution<double> height(std::cos(cap_rad), 1.0), turn(0.0, 2.0 * M_PI),
      size(0.3e-3, 2e-3);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<Ball> balls;
  for (int i = 0; i < count; ++i) {
    const double z = -height(random), across = std::sqrt(1.0 - z * z), phi = turn(random), r_m = size(random);
    const Vector3 direction(across * std::cos(phi), across * std::sin(phi), z);
    balls.push_back(
        {.center_m = kCentre_m + (kRadius_m + r_m + noise_m * noise(random)) * direction, .radius_m = r_m});
  }
  return balls;
}

TEST(SphereFit, FindsExactBallsExactly) {
  std::mt19937_64 random(1);
  const auto fit =
      FitSphere(BallsTouchingASphere(1.3, 500, 0.0, random), Vector3::UnitZ(), {0.0, 0.0, -0.002}, 0.024);
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_LT((fit->centre_m - kCentre_m).norm(), 1e-9);
  EXPECT_NEAR(fit->radius_m, 0.025, 1e-9);
  EXPECT_LT(fit->residual_p95_m, 1e-9);
  EXPECT_NEAR(fit->cap_rad, 1.3, 0.01);
}

TEST(SphereFit, ACapBelow45DegreesIsRefused) {
  std::mt19937_64 random(2);
  const auto near_m = Vector3(0.0, 0.0, -0.002);
  EXPECT_FALSE(FitSphere(BallsTouchingASphere(44.0 * M_PI / 180.0, 500, 0.0, random), Vector3::UnitZ(),
                         near_m, 0.025));
  EXPECT_TRUE(FitSphere(BallsTouchingASphere(47.0 * M_PI / 180.0, 500, 0.0, random), Vector3::UnitZ(), near_m,
                        0.025));
}

TEST(SphereFit, TooFewBallsAreRefused) {
  std::mt19937_64 random(3);
  EXPECT_FALSE(FitSphere(BallsTouchingASphere(1.3, 20, 0.0, random), Vector3::UnitZ(), kCentre_m, 0.025));
  EXPECT_FALSE(FitSphere({}, Vector3::UnitZ(), kCentre_m, 0.025));
}

TEST(SphereFit, StandardDeviationsEqualThoseOfRepeatedFits) {
  std::mt19937_64 random(4);
  constexpr int kFits = 600, kBalls = 400;
  for (const double cap_rad : {48.0 * M_PI / 180.0, 60.0 * M_PI / 180.0, 85.0 * M_PI / 180.0}) {
    double radius2 = 0.0, depth2 = 0.0, radius_sd_m = 0.0, depth_sd_m = 0.0;
    for (int i = 0; i < kFits; ++i) {
      const auto fit = FitSphere(BallsTouchingASphere(cap_rad, kBalls, 0.05e-3, random), Vector3::UnitZ(),
                                 kCentre_m, 0.025);
      ASSERT_TRUE(fit) << fit.error();
      radius2 += std::pow(fit->radius_m - 0.025, 2) / kFits;
      depth2 += std::pow(fit->centre_m.z() - kCentre_m.z(), 2) / kFits;
      radius_sd_m += fit->radius_sd_m / kFits;
      depth_sd_m += fit->depth_sd_m / kFits;
    }
    // 600 fits give a standard deviation to 3 %. The fit sees a slightly smaller cap, as the outermost of 400
    // balls lies a little inside the cap's edge.
    EXPECT_NEAR(std::sqrt(radius2), radius_sd_m, 0.12 * radius_sd_m) << cap_rad;
    EXPECT_NEAR(std::sqrt(depth2), depth_sd_m, 0.12 * depth_sd_m) << cap_rad;
  }
}

TEST(SphereFit, FindsTheReamersSphereOnEveryPacking) {
  for (const double spacing_m : {1.1e-3, 1.5e-3, 2.5e-3}) {
    const simulation::Bone bone = CupBone(spacing_m);
    const auto cut = CutBalls(bone, Ream(bone, 0.025, {kCentre_m}));
    const auto fit = FitSphere(cut, Vector3::UnitZ(), {0.0, 0.0, -0.002}, 0.025);
    ASSERT_TRUE(fit) << fit.error();
    EXPECT_NEAR(1e3 * fit->radius_m, 25.0, 0.005) << bone.balls.size() << " balls";
    EXPECT_LT(1e3 * (fit->centre_m - kCentre_m).norm(), 0.01) << bone.balls.size() << " balls";
  }
}

}  // namespace
}  // namespace osteon::procedure
