#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "control/compliance/compliance.h"
#include "control/laws/twist_parts.h"

// A random motion is a smooth motion of a compliant tool against elastic planes, which begins and ends at
// rest. The tests check with such motions that a tool never takes out more energy than it has put in.

namespace osteon::control {

/// A plane of bone at rest. Its spring has the coupling's stiffness.
struct SpringPlane {
  Vector3 n{Vector3::UnitZ()};
  double offset_m{0.0};  ///< n·p for each point p of the plane
  double stiffness_N_per_m{20e3};
  Vector3 p_TP_m{Vector3::Zero()};  ///< the tool's point that touches the plane
};

/// Wrench on the tool's head E, at its origin Eo, from the springs of the planes, in the bone's frame M.
/// @param[out] stored_J  energy stored in the springs
inline Wrench PlaneWrench(const std::vector<SpringPlane>& planes, const Pose& X_ME, double& stored_J) {
  Wrench F;
  stored_J = 0.0;
  for (const SpringPlane& plane : planes) {
    const Vector3 lever = X_ME.linear() * plane.p_TP_m;
    const double deep_m = plane.offset_m - plane.n.dot(X_ME.translation() + lever);
    if (!(deep_m > 0.0)) continue;
    const Vector3 f = plane.stiffness_N_per_m * deep_m * plane.n;
    F.f += f;
    F.t += lever.cross(f);
    stored_J += 0.5 * plane.stiffness_N_per_m * deep_m * deep_m;
  }
  return F;
}

/// The tool's pose over time in a random motion. Each axis follows the sum of three random sine waves (0.3 to
/// 8 Hz), multiplied by a window that is zero at both ends.
class RandomMotion {
 public:
  RandomMotion(std::mt19937_64& bits, double seconds, double travel_m, double turn_rad) : seconds_(seconds) {
    std::uniform_real_distribution<double> hz(0.3, 8.0), phase(0.0, 2.0 * std::numbers::pi), size(-1.0, 1.0);
    for (std::size_t axis = 0; axis < 6; ++axis)
      for (Wave& wave : waves_[axis])
        wave = {.hz = hz(bits),
                .phase = phase(bits),
                .size = (axis < 3 ? travel_m : turn_rad) * size(bits) / 2.0};
  }
  [[nodiscard]] Pose At(double t_s) const {
    const double ease = std::sin(std::numbers::pi * t_s / seconds_), window = ease * ease;
    std::array<double, 6> x{};
    for (std::size_t axis = 0; axis < 6; ++axis)
      for (const Wave& wave : waves_[axis])
        x[axis] += window * wave.size * std::sin(2.0 * std::numbers::pi * wave.hz * t_s + wave.phase);
    Pose X = Pose::Identity();
    X.linear() = ExpRotation({x[3], x[4], x[5]});
    X.translation() = Vector3(x[0], x[1], x[2]);
    return X;
  }

 private:
  struct Wave {
    double hz{0.0}, phase{0.0}, size{0.0};
  };
  std::array<std::array<Wave, 3>, 6> waves_{};
  double seconds_;
};

/// The work and the energy balance of a motion.
struct MotionEnergy {
  double work_J{0.0};         ///< work that the motion has put into the compliant parts and planes
  double min_balance_J{0.0};  ///< smallest value of work minus stored energy during the motion
};

/// Moves the tool along a motion, tick by tick.
/// @param stored_in  returns the energy [J] that the elements of a Compliance store
template <class StoredIn>
MotionEnergy RunMotion(Compliance& compliance, const std::vector<SpringPlane>& planes,
                       const RandomMotion& motion, const simulation::ContactModel& model, double seconds,
                       double period_s, const StoredIn& stored_in) {
  MotionEnergy energy;
  Wrench before;
  Pose X_before = motion.At(0.0);
  const int ticks = static_cast<int>(std::round(seconds / period_s));
  for (int i = 0; i <= ticks; ++i) {
    const Pose X_WT = motion.At(i * period_s);
    double stored_J = 0.0;
    const Wrench F_E_M = PlaneWrench(planes, compliance.X_ME(X_WT), stored_J);
    const Wrench F_T_W = compliance.OnTool(F_E_M, X_WT);
    const Twist dx = SmallStep(X_before, X_WT);
    energy.work_J -= 0.5 * (Power(before, dx) + Power(F_T_W, dx));
    energy.min_balance_J = std::min(energy.min_balance_J, energy.work_J - stored_J - stored_in(compliance));
    before = F_T_W;
    X_before = X_WT;
    compliance.Step(F_E_M, model, X_WT);
  }
  return energy;
}

}  // namespace osteon::control
