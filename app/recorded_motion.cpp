#include "app/recorded_motion.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace osteon::app {

tl::expected<simulation::ToolMotion, std::string> RecordedMotion(const io::Recording& recording,
                                                                 const Pose& X_WG,
                                                                 simulation::MotionOrigin origin) {
  const Pose X_GW = X_WG.inverse();
  std::vector<simulation::MotionSample> samples;
  std::vector<double> steps_s;
  rt::Nanoseconds start = 0, last = 0;
  for (const control::TickRecord& tick : recording.ticks) {
    if (tick.phase != control::Phase::kHaptic && tick.phase != control::Phase::kStopping) continue;
    if (samples.empty()) start = tick.stamp;
    if (!samples.empty() && tick.stamp <= last) continue;  // a wall clock's tick without a message of its own
    if (!samples.empty()) steps_s.push_back(rt::ToSeconds(tick.stamp - last));
    last = tick.stamp;
    const Pose X_GT = X_GW * Pose(tick.X_WT_cmd);
    samples.push_back({.time_s = rt::ToSeconds(tick.stamp - start),
                       .p_GT_m = X_GT.translation(),
                       .R_GT = Eigen::Quaterniond(X_GT.linear()),
                       .spindle_rad_per_s = tick.spindle_rad_per_s});
  }
  if (samples.size() < 2)
    return tl::make_unexpected(
        fmt::format("motion: found {} ticks that rendered, accepted at least 2", samples.size()));
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());

  simulation::FittedMotion fitted = simulation::FitMotion(samples);
  if (fitted.samples.size() > simulation::kMostMotionRows)
    return tl::make_unexpected(
        fmt::format("motion: found {} samples to keep, accepted at most {}: a shorter run",
                    fitted.samples.size(), simulation::kMostMotionRows));
  origin.error =
      fmt::format("{:.2f} um and {:.2f} urad at most, between {} samples and the {} recorded at {:.0f} Hz",
                  fitted.position_error_m * 1e6, fitted.rotation_error_rad * 1e6, fitted.samples.size(),
                  samples.size(), 1.0 / *middle);
  return simulation::ToolMotion{.origin = std::move(origin), .samples = std::move(fitted.samples)};
}

}  // namespace osteon::app
