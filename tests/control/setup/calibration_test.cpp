#include "control/setup/calibration.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "control/sensing/hand_wrench.h"
#include "kinematics/serial_chain.h"

namespace osteon::control {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Rotation about the fixed axes x, then y, then z.
Matrix3 Turn(double x_deg, double y_deg, double z_deg) {
  return (Eigen::AngleAxisd(z_deg * kDegree, Vector3::UnitZ()) *
          Eigen::AngleAxisd(y_deg * kDegree, Vector3::UnitY()) *
          Eigen::AngleAxisd(x_deg * kDegree, Vector3::UnitX()))
      .toRotationMatrix();
}

// Orientations of the sensor. Together they rotate gravity about more than one axis, as the fit needs.
const std::vector<Matrix3> kTurns{Turn(180, 0, 0),  Turn(150, 10, 5), Turn(200, -20, 30),
                                  Turn(180, 35, 0), Turn(120, 0, 80), Turn(170, -35, -60)};

// A payload on the sensor, in the sensor's frame S, and the sensor's bias.
struct Load {
  double mass_kg{1.7};
  Vector3 center_S_m{0.01, -0.02, 0.11};
  Wrench bias{.f = {1.5, -4.0, 7.0}, .t = {0.1, -0.2, 0.05}};
};

// Readings of a sensor that carries the load at rest in each orientation, with noise. They are computed from
// the force and moment of the weight in the world, independently of the fit.
std::vector<RestPose> Readings(const Load& load, double noise_N = 0.0, double noise_Nm = 0.0) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto noise = [&](double size) {
    return Vector3(size * normal(random), size * normal(random), size * normal(random));
  };
  std::vector<RestPose> poses;
  for (const Matrix3& R_WS : kTurns) {
    const Vector3 weight_W(0.0, 0.0, -9.81 * load.mass_kg);
    const Vector3 lever_W = R_WS * load.center_S_m;
    poses.push_back(
        {.R_WS = R_WS,
         .F_S = {.f = load.bias.f + R_WS.transpose() * weight_W + noise(noise_N),
                 .t = load.bias.t + R_WS.transpose() * lever_W.cross(weight_W) + noise(noise_Nm)}});
  }
  return poses;
}

TEST(FitPayload, FindsMassCentreAndBias) {
  const Load load;
  const auto fit = FitPayload(Readings(load));
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_NEAR(fit->mass_kg, load.mass_kg, 1e-12);
  EXPECT_LT((fit->center_S_m - load.center_S_m).norm(), 1e-12);
  EXPECT_LT((fit->bias_S.f - load.bias.f).norm(), 1e-12);
  EXPECT_LT((fit->bias_S.t - load.bias.t).norm(), 1e-12);
  EXPECT_LT(fit->residual_N, 1e-12);
  EXPECT_LT(fit->residual_Nm, 1e-12);
}

TEST(FitPayload, ItsResultLeavesNoHandWrenchForTheToolAlone) {
  const Load load;
  const auto fit = FitPayload(Readings(load));
  ASSERT_TRUE(fit);
  // S is at the flange: check the fit with the loop's own compensation, at poses that were not used for the
  // fit
  const ForceSensorParams sensor{.tool_mass_kg = fit->mass_kg, .tool_center_F_m = fit->center_S_m};
  for (const Matrix3& R : {Turn(10, 20, 30), Turn(-90, 0, 0)}) {
    Pose X_WF = Pose::Identity();
    X_WF.linear() = R;
    const Vector3 weight_S = R.transpose() * Vector3(0.0, 0.0, -9.81 * load.mass_kg);
    const Wrench F_S{.f = weight_S, .t = load.center_S_m.cross(weight_S)};
    const Wrench hand = HandWrench(sensor, F_S, X_WF, X_WF * Vector3(0.0, 0.0, 0.2));
    EXPECT_LT(hand.f.norm(), 1e-11);
    EXPECT_LT(hand.t.norm(), 1e-11);
  }
}

TEST(FitPayload, ItsStandardDeviationsCoverTheErrorOfNoise) {
  const Load load;
  const auto fit = FitPayload(Readings(load, 0.1, 0.005));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->residual_N, 0.1, 0.06);
  EXPECT_LT(std::abs(fit->mass_kg - load.mass_kg), 4.0 * fit->mass_sd_kg);
  EXPECT_LT((fit->center_S_m - load.center_S_m).cwiseAbs().maxCoeff(), 4.0 * fit->center_sd_m);
  EXPECT_LT(fit->mass_sd_kg, 0.02);
}

TEST(FitPayload, SaysWhatThePosesLack) {
  std::vector<RestPose> poses = Readings({});
  poses.resize(3);
  EXPECT_NE(FitPayload(poses).error().find("found 3 poses"), std::string::npos);
  poses = Readings({});
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].R_WS = Turn(
        0, 0,
        30.0 *
            static_cast<double>(i));  // rotates about the direction of gravity, which the sensor can't detect
  EXPECT_NE(FitPayload(poses).error().find("two axes"), std::string::npos);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].R_WS = Turn(10.0 * static_cast<double>(i), 0, 0);
  EXPECT_NE(FitPayload(poses).error().find("one axis"), std::string::npos);
  poses = Readings({.mass_kg = -1.0});
  EXPECT_NE(FitPayload(poses).error().find("sign"), std::string::npos);
  poses = Readings({});
  poses[2].F_S.f.x() = std::nan("");
  EXPECT_NE(FitPayload(poses).error().find("pose 3"), std::string::npos);
}

// Flange poses of an arm that keeps the tool's tip at the point p_W, with a random position error of off_m.
std::vector<Pose> FlangePosesWithTipOnAPoint(const Vector3& p_FT, const Vector3& p_W, double off_m) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Pose> poses;
  for (const Matrix3& R : kTurns) {
    Pose X_WF = Pose::Identity();
    X_WF.linear() = R;
    X_WF.translation() = p_W - R * p_FT + off_m * Vector3(normal(random), normal(random), normal(random));
    poses.push_back(X_WF);
  }
  return poses;
}

TEST(FitPivot, FindsTheTipAndThePointItStoodOn) {
  const Vector3 p_FT(0.012, -0.004, 0.183), p_W(0.6, 0.1, 0.2);
  const auto fit = FitPivot(FlangePosesWithTipOnAPoint(p_FT, p_W, 0.0));
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_LT((fit->p_FT_m - p_FT).norm(), 1e-12);
  EXPECT_LT((fit->p_WT_m - p_W).norm(), 1e-12);
  EXPECT_LT(fit->residual_m, 1e-12);

  const auto noisy = FitPivot(FlangePosesWithTipOnAPoint(p_FT, p_W, 2e-4));
  ASSERT_TRUE(noisy);
  EXPECT_LT((noisy->p_FT_m - p_FT).norm(), 4.0 * noisy->sd_m);
  EXPECT_GT(noisy->residual_m, 1e-4);
  EXPECT_GE(noisy->worst_m, noisy->residual_m);
}

TEST(FitPivot, SaysWhatThePosesLack) {
  std::vector<Pose> poses = FlangePosesWithTipOnAPoint(Vector3(0.0, 0.0, 0.2), Vector3::Zero(), 0.0);
  poses.resize(2);
  EXPECT_NE(FitPivot(poses).error().find("found 2 poses"), std::string::npos);
  poses.assign(6, Pose::Identity());
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].linear() = Turn(0, 0, 20.0 * static_cast<double>(i));
  EXPECT_NE(FitPivot(poses).error().find("two axes"), std::string::npos) << "along z nothing is known";
}

}  // namespace
}  // namespace osteon::control
