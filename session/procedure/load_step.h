#pragma once

#include "control/sensing/hand_wrench.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"

namespace osteon::session {

/// The step of the force sensor's reading in a physical change of tool may differ from the tools' weights by
/// this much: a missing reamer of 0.9 kg is found, two neighbouring sizes (5 g) are not told apart.
inline constexpr double kMaxLoadError_N = 0.5;

/// Difference between the step of the sensor's force and the step of the weights [N].
/// @param f_before_S, f_after_S  readings at rest, with the old tool and with the new one
/// @param before, after  the sensor with the load of either tool  @param X_WF  flange, the same for both
[[nodiscard]] double LoadStepError_N(const Vector3& f_before_S, const Vector3& f_after_S,
                                     const control::ForceSensorParams& before,
                                     const control::ForceSensorParams& after, const Pose& X_WF);

/// Means of the sensor's force in a pause: the first mean, with the old tool, and the newest one.
class PausedReadings {
 public:
  void Add(const control::TickRecord& tick);
  /// Whether both means are known: the pause has lasted for kTicksUntilKnown.
  [[nodiscard]] bool known() const { return newest_count_ >= kTicks; }
  /// The two means [N], in the sensor's frame S.
  [[nodiscard]] Vector3 first_S() const { return first_sum_ / kTicks; }
  [[nodiscard]] Vector3 newest_S() const { return newest_; }
  /// Begins anew with the next reading: another tool is on.
  void Restart() { *this = {}; }

  static constexpr int kTicks = 300;  ///< number of ticks in each mean
  static constexpr int kTicksUntilKnown = 2 * kTicks;

 private:
  Vector3 first_sum_{Vector3::Zero()}, sum_{Vector3::Zero()}, newest_{Vector3::Zero()};
  int first_count_{0}, count_{0}, newest_count_{0};
};

}  // namespace osteon::session
