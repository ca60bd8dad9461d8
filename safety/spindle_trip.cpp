#include "safety/spindle_trip.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::safety {

SpindleTrip::SpindleTrip(const SpindleLimitParams& params) : params_(params) {
  const auto require = [](const char* name, double value, bool ok, const char* accepted) {
    if (!ok)
      throw std::invalid_argument("spindle limits: " + std::string(name) + ": found " +
                                  base::NumberText(value) + ", accepted " + accepted);
  };
  require("max_torque_Nm", params.max_torque_Nm, params.max_torque_Nm > 0.0, "> 0");
  require("max_speed_rad_per_s", params.max_speed_rad_per_s, params.max_speed_rad_per_s > 0.0, "> 0");
  require("trip_s", params.trip_s, params.trip_s >= 0.0 && params.trip_s <= 10.0, "0 … 10");
}

bool SpindleTrip::Check(double torque_Nm, double speed_rad_per_s, double dt_s) OSTEON_RT {
  const bool within = std::abs(torque_Nm) <= params_.max_torque_Nm &&
                      std::abs(speed_rad_per_s) <= params_.max_speed_rad_per_s;
  beyond_s_ = within ? 0.0 : beyond_s_ + dt_s;
  return beyond_s_ > params_.trip_s;
}

}  // namespace osteon::safety
