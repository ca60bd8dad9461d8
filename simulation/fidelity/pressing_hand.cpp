#include "simulation/fidelity/pressing_hand.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {

PressingHand::PressingHand(const PressingHandParams& params)
    : params_(params), feed_W_(params.X_WT.linear().col(2)) {
  const auto check = [](const char* name, double value, bool positive) {
    if (!(positive ? value > 0.0 : value >= 0.0) || !std::isfinite(value))
      throw std::invalid_argument(fmt::format("pressing hand: {}: found {:g}, accepted {}", name, value,
                                              positive ? "more than 0" : "0 and more"));
  };
  check("mass [kg]", params.mass_kg, true);
  check("time step [s]", params.dt_s, true);
  check("force [N]", params.force_N, false);
  check("ramp [N/s]", params.ramp_N_per_s, false);
  check("drag [N s/m]", params.drag_Ns_per_m, false);
}

FrameInput PressingHand::Next(const Vector3& F_T_W) {
  const double time_s = static_cast<double>(frame_) * params_.dt_s;
  const double push_N = std::min(params_.force_N, params_.ramp_N_per_s * time_s);
  const double step = params_.dt_s / params_.mass_kg;
  speed_m_per_s_ =
      (speed_m_per_s_ + step * (push_N + F_T_W.dot(feed_W_))) / (1.0 + step * params_.drag_Ns_per_m);
  feed_m_ += params_.dt_s * speed_m_per_s_;
  Pose X_WT = params_.X_WT;
  X_WT.translation() += feed_m_ * feed_W_;
  const auto nanoseconds = static_cast<rt::Nanoseconds>(std::llround(time_s * 1e9));
  ++frame_;
  return {.X_WT = X_WT,
          .spindle_rad_per_s = params_.spindle_rad_per_s,
          .dt_s = params_.dt_s,
          .stamp = nanoseconds};
}

}  // namespace osteon::simulation
