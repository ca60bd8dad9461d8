#include "simulation/fidelity/recarve.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace osteon::simulation {
namespace {

// Upper bound of the distance that any point of a tool moves from pose a to pose b.
double WayBetween(const Pose& a, const Pose& b, double lever_m) {
  const double turn = RotationAngle(a.linear().transpose() * b.linear());
  return (b.translation() - a.translation()).norm() + lever_m * turn;
}

}  // namespace

ProxyTrail::ProxyTrail(double lever_m, double step_m) : lever_m_(lever_m), step_m_(step_m) {}

void ProxyTrail::Reserve(std::size_t places) {
  const std::size_t kept = places_.size();
  places_.resize(std::max(places, kept));  // resizing writes to the memory
  places_.resize(kept);
}

void ProxyTrail::Add(const Pose& X_GP) {
  // the last place is replaced as long as the tool is within step_m_ of the place before the last one
  if (places_.size() >= 2 && WayBetween(places_[places_.size() - 2], X_GP, lever_m_) <= step_m_)
    places_.back() = PlainPose(X_GP);
  else
    places_.emplace_back(X_GP);
}

bool CarveTrail(CuttingEngine& engine, std::span<const PlainPose> places) {
  constexpr double kSpindle_rad_per_s = 100.0, kFrame_s = 1e-3;  // any spindle speed that cuts
  for (const PlainPose& X_GP : places)
    if (engine.Step({.X_WT = X_GP, .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = kFrame_s}).status !=
        EngineStatus::kOk)
      return false;
  return true;
}

bool ReachedPose(const CarvedState& carved, const Pose& X_GP, double lever_m, double tolerance_m) {
  return carved.has_proxy && WayBetween(Pose(carved.X_GP), X_GP, lever_m) <= tolerance_m;
}

CarvedState MergeCarvedStates(CarvedState carved, const CarvedState& counted) {
  if (carved.cleared.size() != counted.cleared.size())
    throw std::invalid_argument(fmt::format("carved state: found {} mass points, accepted {}",
                                            counted.cleared.size(), carved.cleared.size()));
  carved.cleared = counted.cleared;
  carved.X_GP = counted.X_GP;
  carved.has_proxy = counted.has_proxy;
  carved.removed_volume_m3 = counted.removed_volume_m3;
  carved.removed_mass_kg = counted.removed_mass_kg;
  carved.cutting_work_J = counted.cutting_work_J;
  carved.cutting_debt_J = counted.cutting_debt_J;
  carved.frame = counted.frame;
  return carved;
}

}  // namespace osteon::simulation
