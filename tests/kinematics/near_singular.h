#pragma once

#include <array>
#include <cmath>
#include <random>

#include "kinematics/lbr_arm.h"

namespace osteon::kinematics {

/// Random postures of an LBR within its limits. Every tenth is placed near a singularity: 1e-6 to 1e-2 rad
/// (log-uniform, either sign) from elbow straight, wrist straight, upper arm vertical, all three, or the
/// wrist above the shoulder.
class LbrPostures {
 public:
  LbrPostures(const LbrParams& params, std::uint64_t seed) : params_(params), random_(seed) {}

  JointVector Next() {
    JointVector q;
    for (int i = 0; i < 7; ++i) {
      const JointLimits& limit = params_.limits[static_cast<std::size_t>(i)];
      q[i] = limit.lower_rad + (limit.upper_rad - limit.lower_rad) * unit_(random_);
    }
    if (count_++ % 10 != 0) return q;
    switch (count_ / 10 % 5) {
      case 0:
        q[3] = Small();
        break;
      case 1:
        q[5] = Small();
        break;
      case 2:
        q[1] = Small();
        break;
      case 3:
        for (const int i : {1, 3, 5}) q[i] = Small();
        break;
      default: {
        // wrist above the shoulder: A2 leans back by as much as the bent elbow leads forward
        q[2] = Small();
        const double fore = params_.elbow_to_wrist_m;
        q[1] =
            std::atan2(fore * std::sin(q[3]), params_.shoulder_to_elbow_m + fore * std::cos(q[3])) + Small();
        const JointLimits& limit = params_.limits[1];
        if (q[1] < limit.lower_rad || q[1] > limit.upper_rad) q[1] = Small();
      }
    }
    return q;
  }

  /// Uniform in -1 … 1.
  double Unit() { return 2.0 * unit_(random_) - 1.0; }

  /// Either sign, with a log-uniform magnitude in 1e-6 … 1e-2.
  double Small() {
    const double size = std::pow(10.0, -6.0 + 4.0 * unit_(random_));
    return unit_(random_) < 0.5 ? -size : size;
  }

 private:
  LbrParams params_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
  int count_{0};
};

}  // namespace osteon::kinematics
