#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool_motion.h"

namespace osteon::simulation {

/// The curve through a motion's samples, twice continuously differentiable: natural cubic splines of the
/// position's and the quaternion's elements, the quaternion then normalised (consecutive samples are taken to
/// the same half of the sphere). Between samples h apart the error is at most h^4/384 times the fourth
/// derivative.
class MotionCurve {
 public:
  /// @pre at least two samples, whose times ascend strictly
  explicit MotionCurve(std::span<const MotionSample> samples);

  /// Pose at a time; before the first and after the last sample, that sample's pose.
  [[nodiscard]] Pose X_GT(double time_s) const;
  /// Spindle speed [rad/s]: that of the last sample at or before the time.
  [[nodiscard]] double SpindleAt(double time_s) const;
  [[nodiscard]] double duration_s() const { return knots_.back().time_s; }

 private:
  using Channels = Eigen::Matrix<double, 7, 1>;  // x y z, w x y z
  struct Knot {
    double time_s, spindle_rad_per_s;
    Channels value, second;  // the pose's elements and their second derivatives
  };
  // Index of the knot at which the interval of a time starts; at most the last but one.
  [[nodiscard]] std::size_t IndexBefore(double time_s) const;
  std::vector<Knot> knots_;
};

/// Result of thinning a motion, with its errors.
struct FittedMotion {
  std::vector<MotionSample> samples;  ///< kept samples, rounded as a file stores them
  double position_error_m{0.0};       ///< largest distance of the curve from a recorded sample
  double rotation_error_rad{0.0};
};

/// Limits of FitMotion.
struct FitParams {
  double tolerance_m{2e-6};
  double tolerance_rad{2e-5};   ///< 2 um at 100 mm from the apex
  double longest_step_s{0.05};  ///< longest time between two kept samples
};

/// Selects recorded samples so that the curve through them stays within the tolerances of all samples. First
/// it keeps one sample every longest_step_s, and those at which the spindle's speed changes. Then, as long as
/// an error is too large, it adds the sample with the largest error from each stretch between kept samples.
/// The result depends on the arguments alone.
/// @pre at least two samples, whose times ascend strictly; the first at 0
[[nodiscard]] FittedMotion FitMotion(std::span<const MotionSample> recorded, const FitParams& params = {});

/// Plays a motion as frames at any rate: the inputs of a cutting engine.
class MotionPlayer {
 public:
  /// @param X_WG  pose of the bone
  /// @throws std::invalid_argument if the rate is outside 1 … 100 000 Hz.
  MotionPlayer(const ToolMotion& motion, double rate_hz, const Pose& X_WG = Pose::Identity());

  /// Number of frames. Frame i is at the time i / rate, up to the motion's end.
  [[nodiscard]] std::size_t frame_count() const { return frame_count_; }
  [[nodiscard]] FrameInput Frame(std::size_t index) const;

 private:
  MotionCurve curve_;
  double rate_hz_;
  Pose X_WG_;
  std::size_t frame_count_;
};

}  // namespace osteon::simulation
