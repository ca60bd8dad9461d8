#include "studies/tune/overlay_measured.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace osteon::studies {
namespace {

// The fitted arm on the response's axis whose speed is nearest to the response's; null if no arm was fitted
// on this axis.
const config::IdentifiedArm* ArmBeside(const config::IdentifiedCell& identified,
                                       const config::IdentifiedResponse& response) {
  const config::IdentifiedArm* nearest = nullptr;
  for (const config::IdentifiedArm& arm : identified.arm)
    if (arm.axis == response.axis &&
        (nearest == nullptr || std::abs(arm.speed_m_per_s - response.speed_m_per_s) <
                                   std::abs(nearest->speed_m_per_s - response.speed_m_per_s)))
      nearest = &arm;
  return nearest;
}

// Stiffness of the spring [N/m] with which `osteon identify` multiplied its response x / f (motion over
// force); empty: not known.
std::optional<double> SpringOf(const config::IdentifiedResponse& response, const config::IdentifiedArm* arm) {
  if (response.spring_N_per_m) return response.spring_N_per_m;
  if (arm == nullptr || !arm->felt_mass_kg) return {};
  const double w = 2.0 * std::numbers::pi * arm->bandwidth_hz;
  return *arm->felt_mass_kg * w * w;
}

// Name of a case's hand and axis. WorstCurve finds the case by this name.
std::string HandName(const OverlayCase& one, const MeasuredAxis& axis) {
  return one.loop.hand.name + ", along " + axis.axis;
}

}  // namespace

std::vector<MeasuredAxis> MeasuredAxesOf(const config::IdentifiedCell& identified,
                                         const OverlayLoopParams& loop) {
  std::vector<MeasuredAxis> axes;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name(1, "xyz"[i]);
    const config::IdentifiedResponse* slowest = nullptr;
    for (const config::IdentifiedResponse& response : identified.response)
      if (response.axis == name && !response.by_force && response.hand.empty() &&
          (slowest == nullptr || response.speed_m_per_s < slowest->speed_m_per_s))
        slowest = &response;
    if (slowest == nullptr) continue;
    const config::IdentifiedArm* arm = ArmBeside(identified, *slowest);
    const std::optional<double> spring_N_per_m = SpringOf(*slowest, arm);
    if (!spring_N_per_m) continue;
    MeasuredOverlayParams measured{.axis_T = Vector3::Unit(static_cast<Eigen::Index>(i)),
                                   .dead_time_s = arm != nullptr ? std::max(0.0, arm->dead_time_s)
                                                                 : loop.arm.dead_cycles * loop.period_s};
    for (const config::IdentifiedLine& line : slowest->lines)
      measured.lines.push_back({.hz = line.hz,
                                .value = std::complex<double>(line.re, line.im) / *spring_N_per_m,
                                .sd = line.sd / *spring_N_per_m});
    axes.push_back({.axis = name, .overlay = std::make_shared<MeasuredOverlay>(loop, measured)});
  }
  return axes;
}

bool IsStableAsMeasured(const std::vector<MeasuredAxis>& axes, const OverlayLoopParams& loop, double late_s) {
  return std::ranges::all_of(axes,
                             [&](const MeasuredAxis& axis) { return axis.overlay->IsStable(loop, late_s); });
}

std::vector<TuneMargin> MeasuredMargins(const std::vector<MeasuredAxis>& axes, const std::string& gains,
                                        const std::vector<OverlayCase>& cases, double late_s) {
  std::vector<TuneMargin> margins;
  for (const MeasuredAxis& axis : axes)
    for (const OverlayCase& one : cases) {
      TuneMargin& margin = margins.emplace_back();
      margin = {.gains = gains,
                .hand = one.loop.hand,
                .contact = one.contact,
                .margins = axis.overlay->Judge(one.loop, late_s)};
      margin.hand.name = HandName(one, axis);
    }
  return margins;
}

std::vector<NyquistPoint> WorstCurve(const std::vector<MeasuredAxis>& axes, const TuneMargin& worst,
                                     const std::vector<OverlayCase>& cases, double late_s) {
  for (const MeasuredAxis& axis : axes)
    for (const OverlayCase& one : cases)
      if (one.contact == worst.contact && HandName(one, axis) == worst.hand.name)
        return axis.overlay->Curve(one.loop, late_s);
  return {};
}

}  // namespace osteon::studies
