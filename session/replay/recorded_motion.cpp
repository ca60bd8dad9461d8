#include "session/replay/recorded_motion.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/recording/recording_reader.h"
#include "report/duration_counts.h"

namespace osteon::session {

tl::expected<simulation::ToolMotion, std::string> RecordedMotion(const std::filesystem::path& recording,
                                                                 const Pose& X_WG,
                                                                 simulation::MotionOrigin origin) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return tl::make_unexpected(stream.error());
  const Pose X_GW = X_WG.inverse();
  std::vector<simulation::MotionSample> samples;
  report::DurationCounts steps;
  rt::Nanoseconds start = 0, last = 0;
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return tl::make_unexpected(topic.error());
    if (*topic == io::RecordedTopic::kOther) break;
    const control::TickRecord& tick = stream->tick;
    if (*topic != io::RecordedTopic::kTick ||
        (tick.phase != control::Phase::kHaptic && tick.phase != control::Phase::kStopping))
      continue;
    if (samples.empty()) start = tick.stamp;
    // skip a tick that had no message of its own, as happens in wall time: its stamp has not advanced
    if (!samples.empty() && tick.stamp <= last) continue;
    if (!samples.empty()) steps.Add(tick.stamp - last);
    last = tick.stamp;
    const Pose X_GT = X_GW * Pose(tick.compliance.present ? tick.compliance.X_ME : tick.X_WT_cmd);
    samples.push_back({.time_s = rt::ToSeconds(tick.stamp - start),
                       .p_GT_m = X_GT.translation(),
                       .R_GT = Eigen::Quaterniond(X_GT.linear()),
                       .spindle_rad_per_s = tick.spindle_rad_per_s});
  }
  if (samples.size() < 2)
    return tl::make_unexpected(
        fmt::format("motion: found {} ticks that rendered, accepted at least 2", samples.size()));
  // median time from one sample to the next
  const double step_s = rt::ToSeconds(steps.At(steps.count() / 2));
  simulation::FittedMotion fitted = simulation::FitMotion(samples);
  if (fitted.samples.size() > simulation::kMaxMotionRows)
    return tl::make_unexpected(
        fmt::format("motion: found {} samples to keep, accepted at most {}: a shorter run",
                    fitted.samples.size(), simulation::kMaxMotionRows));
  origin.error =
      fmt::format("{:.2f} um and {:.2f} urad at most, between {} samples and the {} recorded at {:.0f} Hz",
                  fitted.position_error_m * 1e6, fitted.rotation_error_rad * 1e6, fitted.samples.size(),
                  samples.size(), 1.0 / step_s);
  return simulation::ToolMotion{.origin = std::move(origin), .samples = std::move(fitted.samples)};
}

}  // namespace osteon::session
