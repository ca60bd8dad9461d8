#pragma once

#include "base/clock.h"
#include "base/marker.h"
#include "safety/fault.h"

namespace osteon::safety {

/// Age that stands for "no value" [s]. Finite, so that it can be recorded.
inline constexpr double kNoAge_s = 1e6;

/// Age of a value [s], 0 … kNoAge_s. The age is kNoAge_s also for a stamp that is negative or more than 1 ms
/// ahead of now.
[[nodiscard]] double AgeSeconds(rt::Nanoseconds now, rt::Nanoseconds stamp) OSTEON_RT;

/// Age of a value [s], as AgeSeconds; for a stamp of 0 ("no value") the age is kNoAge_s as well.
[[nodiscard]] double StampAge(rt::Nanoseconds now, rt::Nanoseconds stamp) OSTEON_RT;

/// Weight of a value by its age: 1 up to full_s, then linearly down to 0 at gone_s.
[[nodiscard]] double AgeFade(double age_s, double full_s, double gone_s) OSTEON_RT;

/// Largest accepted ages of the loop's inputs.
struct WatchdogParams {
  double model_stop_s{0.250};   ///< Stop 1 if the contact model is older
  double sensor_full_s{0.020};  ///< the operator's force is used in full up to this age
  /// at this age the operator's force has faded to 0; Stop 1 if the reading is older
  double sensor_stop_s{0.100};
  double spindle_stop_s{0.100};    ///< Stop 1 if the drive's status is older
  double interlock_stop_s{0.100};  ///< Stop 1 if the PLC's status is older
  int arm_misses{5};               ///< Stop 0 after this many consecutive missed arm messages
};

/// Ages of the loop's inputs [s]; 0 for an input that the cell does not have.
struct Ages {
  double model_s{0.0}, sensor_s{0.0}, spindle_s{0.0}, interlock_s{0.0};
};

/// Monitors the ages of the loop's inputs. After Start each source has its full time until its first value
/// must arrive.
class Watchdog {
 public:
  /// @throws std::invalid_argument if a time is not positive, or if two times are in the wrong order.
  explicit Watchdog(const WatchdogParams& params);

  /// Call it when motion or rendering starts.
  void Start(rt::Nanoseconds now) OSTEON_RT { start_ = now; }
  /// Returns the faults of inputs that are too old.
  [[nodiscard]] FaultSet Check(rt::Nanoseconds now, const Ages& ages) const OSTEON_RT;
  /// Factor 0 … 1 on the operator's force for the age of the sensor's reading.
  [[nodiscard]] double SensorFade(double sensor_age_s) const OSTEON_RT {
    return AgeFade(sensor_age_s, params_.sensor_full_s, params_.sensor_stop_s);
  }

 private:
  WatchdogParams params_;
  rt::Nanoseconds start_{0};
};

}  // namespace osteon::safety
