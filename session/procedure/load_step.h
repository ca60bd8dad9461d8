#pragma once

#include "control/sensing/hand_wrench.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"

namespace osteon::session {

/// Largest accepted difference between the step of the force sensor's reading in a physical change of tool
/// and the difference of the tools' weights. A missing reamer of 0.9 kg is found; two neighbouring sizes (5 g
/// apart) cannot be told apart.
inline constexpr double kMaxLoadError_N = 0.5;

/// Difference between the step of the sensor's force and the step of the weights [N].
/// @param f_before_S, f_after_S  readings at rest, with the old tool and with the new one
/// @param before, after  sensor parameters with the load of the old and of the new tool  @param X_WF  pose of
/// the flange in both readings
[[nodiscard]] double LoadStepError_N(const Vector3& f_before_S, const Vector3& f_after_S,
                                     const control::ForceSensorParams& before,
                                     const control::ForceSensorParams& after, const Pose& X_WF);

/// Two means of the sensor's force in a pause: the first mean, with the old tool, and the newest mean, with
/// the new tool.
class PausedReadings {
 public:
  void Add(const control::TickRecord& tick);
  /// Whether both means are known, that is, whether the pause has lasted for kTicksUntilKnown ticks.
  [[nodiscard]] bool known() const { return newest_count_ >= kTicks; }
  /// The two means [N], in the sensor's frame S.
  [[nodiscard]] Vector3 first_S() const { return first_sum_ / kTicks; }
  [[nodiscard]] Vector3 newest_S() const { return newest_; }
  /// Begins anew with the next reading, after another tool was mounted.
  void Restart() { *this = {}; }

  static constexpr int kTicks = 300;  ///< number of ticks in each mean
  static constexpr int kTicksUntilKnown = 2 * kTicks;

 private:
  Vector3 first_sum_{Vector3::Zero()}, sum_{Vector3::Zero()}, newest_{Vector3::Zero()};
  int first_count_{0}, count_{0}, newest_count_{0};
};

}  // namespace osteon::session
