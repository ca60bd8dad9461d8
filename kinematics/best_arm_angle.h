#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinematics/arm_angle_intervals.h"
#include "kinematics/lbr_arm.h"

namespace osteon::kinematics {

/// Resolution of the search over the elbow's circle.
struct ArmAngleSearchParams {
  /// number of samples on the whole circle, >= 4; a maximum narrower than a step may be missed
  int steps{36};
  double tolerance_rad{1e-3};  ///< accuracy to which the best angle is refined
};

/// The best posture among those that keep the flange in place.
struct BestArmAngle {
  bool found{false};  ///< false: out of reach, or a joint is beyond its limits at every arm angle
  double value{0.0};
  double arm_angle_rad{0.0};
  JointVector q{JointVector::Zero()};
};

/// Finds the posture with the greatest value among all that put the flange at X_BF within the joint limits.
/// The search covers all arm angles and all eight configurations. With a force capability as the value, this
/// is the torque-optimal arm angle.
///
/// The circle is sampled at `steps` angles. If no sample is within the limits, the middles of all intervals
/// are sampled instead (FindArmAngleIntervals), so that every reachable pose has a result. The best sample is
/// refined by golden section between its neighbours, within its interval. The result is a local maximum. It
/// is the global maximum if no maximum is narrower than a step. Deterministic; does not allocate.
/// @param value  function double(const JointVector& q) to be maximised; finite
template <class Value>
[[nodiscard]] BestArmAngle FindBestArmAngle(const LbrArm& arm, const Pose& X_BF, const Value& value,
                                            const ArmAngleSearchParams& params = {}) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  BestArmAngle best;
  int configuration = -1;
  // Returns the best value at one arm angle, in the configuration `only` (-1: in any). `best` and
  // `configuration` keep the best posture of all calls.
  const auto evaluate = [&](double angle, int only) {
    const LbrSolutions solutions = arm.Solve(X_BF, angle);
    double best_here = -HUGE_VAL;
    for (int c = 0; solutions.reachable() && c < LbrSolutions::kConfigurations; ++c) {
      const LbrSolution& solution = solutions.configuration[static_cast<std::size_t>(c)];
      if ((only >= 0 && c != only) || !solution.valid()) continue;
      const double found = value(solution.q);
      best_here = std::max(best_here, found);
      if (best.found && !(found > best.value)) continue;
      best = {.found = true, .value = found, .arm_angle_rad = angle, .q = solution.q};
      configuration = c;
    }
    return best_here;
  };

  const int steps = std::max(4, params.steps);
  for (int k = 0; k < steps; ++k) evaluate(kTurn * (static_cast<double>(k) / steps - 0.5), -1);
  if (!best.found) {
    for (int c = 0; c < LbrSolutions::kConfigurations; ++c) {
      const ArmAngleIntervals intervals = FindArmAngleIntervals(arm, X_BF, c);
      for (int i = 0; i < intervals.count; ++i) {
        const ArmAngleInterval& interval = intervals.interval[static_cast<std::size_t>(i)];
        evaluate(0.5 * (interval.from_rad + interval.to_rad), c);
      }
    }
  }
  if (!best.found) return best;

  // refine between the neighbouring samples, within the interval that contains the best angle
  double low = best.arm_angle_rad - kTurn / steps, high = best.arm_angle_rad + kTurn / steps;
  const ArmAngleIntervals intervals = FindArmAngleIntervals(arm, X_BF, configuration);
  for (int i = 0; i < intervals.count; ++i) {
    const ArmAngleInterval& interval = intervals.interval[static_cast<std::size_t>(i)];
    const double shift = kTurn * std::floor((best.arm_angle_rad - interval.from_rad) / kTurn);
    if (best.arm_angle_rad - shift > interval.to_rad) continue;
    low = std::max(low, interval.from_rad + shift);
    high = std::min(high, interval.to_rad + shift);
    break;
  }
  const int refined = configuration;  // the refinement stays in the best sample's configuration
  evaluate(low, refined);
  evaluate(high, refined);
  // Golden section: a < b divide low … high. Each step compares the values at a and b, and drops the end next
  // to the smaller one.
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = evaluate(a, refined), at_b = evaluate(b, refined);
  while (high - low > params.tolerance_rad) {
    if (at_a >= at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = evaluate(a, refined);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = evaluate(b, refined);
    }
  }
  best.arm_angle_rad = std::remainder(best.arm_angle_rad, kTurn);
  return best;
}

}  // namespace osteon::kinematics
