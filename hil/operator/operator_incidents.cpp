#include "hil/operator/operator_incidents.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "hil/operator/quintic.h"

namespace osteon::hil {
namespace {

// Time at which the hand begins to grasp again.
double EndOf(const StartledRelease& r) { return r.begin_s + r.jerk_s + r.release_s + r.away_s; }

// Smooth progress, from 0 to 1, of a transition that takes `takes_s` and began `since_s` ago.
double Progress(double since_s, double takes_s) {
  // clamped, because rounding may exceed 1
  return std::clamp(Quintic(std::clamp(since_s / takes_s, 0.0, 1.0)).s, 0.0, 1.0);
}

// Sets moment's jerk and grip to those of a startled release at time_s.
void ApplyRelease(const StartledRelease& release, double time_s, IncidentMoment& moment) {
  const double since_s = time_s - release.begin_s;
  if (since_s < release.jerk_s) {
    const double wave = std::sin(std::numbers::pi * since_s / release.jerk_s);
    moment.jerk_C_N = release.jerk_N * wave * wave * Vector3(release.jerk_C);
    return;
  }
  const double end_s = EndOf(release);
  moment.grip = time_s < end_s ? 1.0 - Progress(since_s - release.jerk_s, release.release_s)
                               : Progress(time_s - end_s, release.return_s);
}

// Checks the values of incident `number`; throws std::invalid_argument with the value's name.
class Checker {
 public:
  explicit Checker(std::size_t number) : number_(number) {}

  void Require(bool accepted, std::string_view name, double found, std::string_view range) const {
    if (accepted) return;
    throw std::invalid_argument(
        fmt::format("operator's incident {}: {}: found {}, accepted {}", number_, name, found, range));
  }
  void Positive(std::string_view name, double found) const {
    Require(std::isfinite(found) && found > 0.0, name, found, "> 0");
  }
  void NotNegative(std::string_view name, double found) const {
    Require(std::isfinite(found) && found >= 0.0, name, found, ">= 0");
  }

  template <typename Held>  // GripStep or RigidClamp
  void operator()(const Held& held) const {
    Require(held.end_s > held.begin_s, "end_s", held.end_s, "more than begin_s");
    NotNegative("stiffness_N_per_m", held.spring.stiffness_N_per_m);
    NotNegative("damping_Ns_per_m", held.spring.damping_Ns_per_m);
    NotNegative("stiffness_Nm_per_rad", held.spring.stiffness_Nm_per_rad);
    NotNegative("damping_Nms_per_rad", held.spring.damping_Nms_per_rad);
  }
  void operator()(const StartledRelease& release) const {
    NotNegative("jerk_N", release.jerk_N);
    NotNegative("jerk_s", release.jerk_s);
    const double length = Vector3(release.jerk_C).norm();
    Require(std::abs(length - 1.0) < 1e-6, "length of jerk_C", length, "1");
    Positive("release_s", release.release_s);
    Require(release.away_s >= 0.0, "away_s", release.away_s, ">= 0");
  }

 private:
  std::size_t number_;
};

}  // namespace

IncidentTimes TimesOf(const HandIncident& incident) noexcept {
  if (const auto* release = std::get_if<StartledRelease>(&incident))
    return {release->begin_s, EndOf(*release), EndOf(*release) + release->return_s};
  if (const auto* clamp = std::get_if<RigidClamp>(&incident))
    return {clamp->begin_s, clamp->end_s, clamp->end_s + clamp->return_s};
  const auto& step = *std::get_if<GripStep>(&incident);
  return {step.begin_s, step.end_s, step.end_s + step.return_s};
}

void CheckIncidents(const HandIncidents& incidents) {
  if (incidents.count > HandIncidents::kMax)
    throw std::invalid_argument(fmt::format("operator's incidents: found {}, accepted at most {}",
                                            incidents.count, HandIncidents::kMax));
  double free_s = 0.0;  // earliest begin of the next incident
  for (std::size_t i = 0; i < incidents.count; ++i) {
    const HandIncident& incident = incidents.list[i];
    const Checker check(i + 1);
    const auto [begin_s, end_s, over_s] = TimesOf(incident);
    check.Require(std::isfinite(begin_s) && begin_s >= free_s, "begin_s", begin_s,
                  fmt::format(">= {}", free_s));
    std::visit(check, incident);
    check.Positive("return_s", std::visit([](const auto& any) { return any.return_s; }, incident));
    free_s = over_s;
  }
}

const HandSpring& SpringOf(const HandIncident& incident) noexcept {
  if (const auto* clamp = std::get_if<RigidClamp>(&incident)) return clamp->spring;
  return std::get_if<GripStep>(&incident)->spring;
}

IncidentMoment MomentOf(const HandIncidents& incidents, double time_s) noexcept {
  // The caller sums periods in floating point. One nanosecond more lets the rounded sum reach the intended
  // times.
  time_s += 1e-9;
  IncidentMoment moment;
  for (std::size_t i = 0; i < incidents.count; ++i) {
    const auto [begin_s, end_s, over_s] = TimesOf(incidents.list[i]);
    if (time_s < begin_s || time_s >= over_s) continue;
    if (const auto* release = std::get_if<StartledRelease>(&incidents.list[i])) {
      ApplyRelease(*release, time_s, moment);
      break;
    }
    const bool clamp = std::holds_alternative<RigidClamp>(incidents.list[i]);
    if (time_s < end_s) {
      moment.holding = i;
      moment.clamped = clamp;
      moment.back = 0.0;
    } else {
      moment.after_clamp = clamp;
      moment.back = Progress(time_s - end_s, over_s - end_s);
    }
    break;
  }
  return moment;
}

}  // namespace osteon::hil
