#include "safety/watchdog.h"

#include <algorithm>
#include <stdexcept>

namespace osteon::safety {

double AgeSeconds(rt::Nanoseconds now, rt::Nanoseconds stamp) OSTEON_RT {
  if (now < 0 || stamp < 0) return kNoAge_s;  // both are >= 0 now, so their difference cannot overflow
  if (stamp - now > rt::kMillisecond) return kNoAge_s;
  return std::clamp(rt::ToSeconds(now - stamp), 0.0, kNoAge_s);
}

double StampAge(rt::Nanoseconds now, rt::Nanoseconds stamp) OSTEON_RT {
  return stamp == 0 ? kNoAge_s : AgeSeconds(now, stamp);
}

double AgeFade(double age_s, double full_s, double gone_s) OSTEON_RT {
  if (!(age_s < gone_s)) return 0.0;
  return age_s <= full_s ? 1.0 : (gone_s - age_s) / (gone_s - full_s);
}

Watchdog::Watchdog(const WatchdogParams& params) : params_(params) {
  if (!(params.model_stop_s > 0.0)) throw std::invalid_argument("model_stop_s: accepted > 0");
  if (!(params.sensor_full_s > 0.0 && params.sensor_stop_s > params.sensor_full_s))
    throw std::invalid_argument("sensor_full_s, sensor_stop_s: accepted 0 < full < stop");
  if (!(params.spindle_stop_s > 0.0 && params.interlock_stop_s > 0.0))
    throw std::invalid_argument("spindle_stop_s, interlock_stop_s: accepted > 0");
  if (params.arm_misses < 1) throw std::invalid_argument("arm_misses: accepted >= 1");
}

FaultSet Watchdog::Check(rt::Nanoseconds now, const Ages& ages) const OSTEON_RT {
  FaultSet faults;
  const double running_s = AgeSeconds(now, start_);
  const auto watch = [&](double age_s, double max_s, Fault fault) {
    if (std::min(age_s, running_s) > max_s) faults.Latch(fault);
  };
  watch(ages.model_s, params_.model_stop_s, Fault::kModelStale);
  watch(ages.sensor_s, params_.sensor_stop_s, Fault::kSensorStale);
  watch(ages.spindle_s, params_.spindle_stop_s, Fault::kSpindle);
  watch(ages.interlock_s, params_.interlock_stop_s, Fault::kInterlock);
  return faults;
}

}  // namespace osteon::safety
