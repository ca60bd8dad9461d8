#include "studies/capability/rendering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/reading/apply_identified.h"
#include "config/reading/tool_mobility.h"
#include "studies/tune/tune_measured.h"
#include "studies/tune/tune_study.h"

namespace osteon::studies {
namespace {

constexpr double kDeviations = 3.0;  // the force floor is this many standard deviations of noise and drift
constexpr double kNoFloor_N = 1e-3;  // only a simulated sensor without errors has a smaller floor
// The search for the stiffest wall begins at kMinWall_N_per_m and goes up by this factor.
constexpr double kMinWall_N_per_m = 100.0, kWallFactor = 1.1;
constexpr std::array<const char*, 3> kAxisNames{"x", "y", "z"};

// Lag of a simulated arm behind its commands [s]: the dead time, plus the lag of a second-order response at
// low frequency.
double LagOf(const hil::ServoArmParams& arm, double period_s) {
  return arm.dead_cycles * period_s + arm.damping_ratio / (std::numbers::pi * arm.bandwidth_hz);
}

// Returns the measurement of the arm along one axis that has the largest lag; null if there is none.
const config::IdentifiedArm* MeasuredArm(const config::CellConfig& cell, const std::string& axis) {
  const config::IdentifiedArm* slowest = nullptr;
  if (cell.identified)
    for (const config::IdentifiedArm& arm : cell.identified->arm)
      if (arm.axis == axis && (slowest == nullptr || arm.lag_s > slowest->lag_s)) slowest = &arm;
  return slowest;
}

// Whether the arm's model, or at least its response without a hand, was measured along an axis.
bool IsMeasured(const config::CellConfig& cell, const std::string& axis) {
  if (MeasuredArm(cell, axis) != nullptr) return true;
  return cell.identified && std::ranges::any_of(cell.identified->response, [&](const auto& response) {
           return response.axis == axis && response.hand.empty();
         });
}

// The tuning task of the cell's loop along one axis: its gains, and the measurements of `identified:` along
// that axis. If that axis was not measured, all measured axes stay, and the slowest of them is used.
TuneTask TaskAlong(const config::CellConfig& cell, std::size_t axis) {
  config::CellConfig own = cell;
  const std::string name = kAxisNames[axis];
  if (IsMeasured(cell, name)) {
    const auto is_other_axis = [&](const auto& entry) { return entry.axis != name; };
    std::erase_if(own.identified->arm, is_other_axis);
    std::erase_if(own.identified->response, is_other_axis);
  }
  TuneTask task = MeasuredTaskOf(own);
  const auto i = static_cast<Eigen::Index>(axis);
  task.loop.mass_kg = cell.servo.admittance.mass_kg[i];
  task.loop.damping_Ns_per_m = cell.servo.admittance.damping_Ns_per_m[i];
  return task;
}

// The stiffest wall with which the loop is stable with all hands, when every command has its largest delay.
double GreatestWallOf(const TuneTask& task, const std::vector<hil::GridHand>& hands) {
  double max_stable_N_per_m = kMaxWall_N_per_m;
  for (const hil::GridHand& hand : hands) {
    hil::AdmittanceLoopParams loop = task.loop;
    loop.arm.dead_cycles += task.command_jitter;
    loop.hand = hand;
    if (!(hil::AdmittanceLoop(loop).SpectralRadius() < 1.0)) return 0.0;
    loop.wall.stiffness_N_per_m = max_stable_N_per_m;
    if (hil::AdmittanceLoop(loop).SpectralRadius() < 1.0 && max_stable_N_per_m < kMaxWall_N_per_m) continue;
    max_stable_N_per_m =
        std::min(max_stable_N_per_m,
                 hil::MaxWallStiffness(
                     loop, {.from = kMinWall_N_per_m, .to = max_stable_N_per_m, .factor = kWallFactor})
                     .value);
  }
  return max_stable_N_per_m;
}

// Fills in the drag and wall that the cell's file states, the least drag and the stiffest wall with which the
// loop is stable, and whether it is stable with the file's values.
void FillLoop(const TuneTask& task, RenderedAxis& axis) {
  const std::vector<hil::GridHand> hands = HandsUpTo(task, task.human_grip_N_per_m);
  const TuneGains own{task.loop.mass_kg, task.loop.damping_Ns_per_m};
  axis.asked_drag_Ns_per_m = own.damping_Ns_per_m;
  axis.asked_wall_N_per_m = task.wall_N_per_m;
  axis.least_drag_Ns_per_m = MinDragFor(task, own.mass_kg, hands);
  if (!task.measured_only) axis.greatest_wall_N_per_m = GreatestWallOf(task, hands);
  axis.stands = own.damping_Ns_per_m >= *axis.least_drag_Ns_per_m &&
                axis.greatest_wall_N_per_m.value_or(kMaxWall_N_per_m) >= task.wall_N_per_m &&
                IsStableByMargins(MeasuredMargins(task, "own", own, hands), "own");
}

// Whether two tasks have the same result. Tasks with measurements are always treated as different.
bool IsAlike(const TuneTask& a, const TuneTask& b) {
  return !a.identified && !b.identified && a.loop.mass_kg == b.loop.mass_kg &&
         a.loop.damping_Ns_per_m == b.loop.damping_Ns_per_m;
}

// Fills in the arm's effective mass along the i-th axis of the tool: measured, or computed from the arm's
// masses.
void FillMass(const config::CellConfig& cell, const config::IdentifiedArm* arm, Eigen::Index i,
              RenderedAxis& axis) {
  if (arm != nullptr && arm->felt_mass_kg) {
    axis.felt_mass_kg = {.value = *arm->felt_mass_kg, .measured = true};
    return;
  }
  const auto mobility = config::ToolMobility(cell);
  if (!mobility) return;
  const Vector3 axis_B = cell.X_WB.linear().transpose() * cell.start.X_WT.linear().col(i);
  axis.felt_mass_kg = {.value = 1.0 / axis_B.dot(*mobility * axis_B)};
}

// Fills in dead zone, noise, drift and delay of the force sensor.
void FillForces(const config::CellConfig& cell, Rendering& rendering) {
  const auto& identified = cell.identified;
  const bool at_rest = identified && identified->sensor &&
                       (identified->sensor->noise_N > 0.0 || identified->sensor->drift_N > 0.0);
  // The dead zone counts as measured if the drift at rest was measured, even if that drift needs no dead
  // zone.
  rendering.dead_zone_N = {.value = cell.servo.admittance.dead_zone_N,
                           .measured = at_rest || (identified && identified->dead_zone_N)};
  rendering.noise_N = {.value = std::visit([](const auto& device) { return device.model.noise_N; },
                                           cell.simulated_devices.sensor)};
  if (at_rest) {
    rendering.noise_N = {.value = identified->sensor->noise_N, .measured = true};
    rendering.drift_N = {.value = identified->sensor->drift_N, .measured = true};
  }
  // the same assumption as in `osteon tune`
  rendering.sensor_delay_s = {.value = std::max(1e-3, cell.servo.period_s)};
  if (identified && identified->sensor && identified->sensor->delay_s)
    rendering.sensor_delay_s = {.value = *identified->sensor->delay_s, .measured = true};
}

// "12 ms (measured)": the value in a unit with its name, and the source.
std::string Sourced(const SourcedFigure& figure, double unit, const char* name) {
  const double value = figure.value / unit;
  return fmt::format("{:.3g} {} ({})", std::abs(value) < 1e-6 ? 0.0 : value, name, SourceOf(figure));
}

std::string WallText(double wall_N_per_m) {
  return wall_N_per_m >= kMaxWall_N_per_m ? fmt::format("{:.0f} N/mm or more", 1e-3 * wall_N_per_m)
                                          : fmt::format("{:.3g} N/mm", 1e-3 * wall_N_per_m);
}

nlohmann::json JsonOf(const SourcedFigure& figure, double unit) {
  return {{"value", figure.value / unit}, {"source", SourceOf(figure)}};
}

// JSON has no infinity.
nlohmann::json JsonOf(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

// The results for one axis, as one line.
std::string AxisText(const RenderedAxis& axis) {
  std::string text = "lag " + Sourced(axis.lag_s, 1e-3, "ms");
  if (axis.felt_mass_kg) text += "; a force moves the arm as " + Sourced(*axis.felt_mass_kg, 1.0, "kg");
  if (!axis.least_drag_Ns_per_m) return text + "; drag and walls under the impedance law: osteon tune";
  text += std::isfinite(*axis.least_drag_Ns_per_m)
              ? fmt::format("; least drag {:.3g} N s/m", *axis.least_drag_Ns_per_m)
              : std::string("; no drag is stable");
  if (axis.greatest_wall_N_per_m)
    text += fmt::format(", walls up to {}", WallText(*axis.greatest_wall_N_per_m));
  return text +
         fmt::format("; the cell asks for {:g} N s/m and {:g} N/mm: {}", axis.asked_drag_Ns_per_m,
                     1e-3 * axis.asked_wall_N_per_m, axis.stands ? "it stands" : "it does not stand") +
         (axis.loop_measured ? " (measured)" : " (assumed)");
}

}  // namespace

const char* SourceOf(const SourcedFigure& figure) { return figure.measured ? "measured" : "assumed"; }

double Rendering::force_floor_N() const {
  return std::max(dead_zone_N.value, kDeviations * std::hypot(noise_N.value, drift_N.value));
}

bool Rendering::floor_measured() const {
  return dead_zone_N.measured && noise_N.measured && drift_N.measured;
}

Rendering RenderingOf(const config::CellConfig& cell) {
  Rendering rendering;
  rendering.admittance = cell.servo.law == control::Law::kAdmittance;
  FillForces(cell, rendering);
  std::vector<std::pair<TuneTask, std::size_t>> judged;
  for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
    RenderedAxis axis{.axis = kAxisNames[i][0]};
    const config::IdentifiedArm* arm = MeasuredArm(cell, kAxisNames[i]);
    FillMass(cell, arm, static_cast<Eigen::Index>(i), axis);
    const double period_s = cell.servo.period_s;
    if (arm != nullptr)
      axis.lag_s = {.value = rendering.admittance ? arm->lag_s : arm->dead_time_s, .measured = true};
    else
      axis.lag_s.value = rendering.admittance ? LagOf(cell.simulated.servo, period_s)
                                              : cell.simulated.dynamic.dead_cycles * period_s;
    if (rendering.admittance) {
      axis.loop_measured = IsMeasured(cell, kAxisNames[i]);
      const TuneTask task = TaskAlong(cell, i);
      const auto known =
          std::ranges::find_if(judged, [&](const auto& entry) { return IsAlike(entry.first, task); });
      if (known == judged.end()) {
        FillLoop(task, axis);
        judged.emplace_back(task, i);
      } else {
        const RenderedAxis& same = rendering.axes[known->second];
        axis.least_drag_Ns_per_m = same.least_drag_Ns_per_m;
        axis.greatest_wall_N_per_m = same.greatest_wall_N_per_m;
        axis.asked_drag_Ns_per_m = same.asked_drag_Ns_per_m;
        axis.asked_wall_N_per_m = same.asked_wall_N_per_m;
        axis.stands = same.stands;
      }
    }
    rendering.axes.push_back(axis);
  }
  return rendering;
}

void JudgeRendering(const Rendering& rendering, session::Verdict& verdict) {
  for (const RenderedAxis& axis : rendering.axes)
    if (axis.loop_measured && !axis.stands)
      verdict.Add(session::VerdictLevel::kWarning,
                  fmt::format("along {}, by the measured arm: {}; osteon tune CELL --identified recommends "
                              "gains that do",
                              axis.axis, AxisText(axis)));
}

std::vector<report::SummaryRow> RenderingRows(const Rendering& rendering, double greatest_N) {
  const double floor_N = rendering.force_floor_N();
  const bool has_floor = floor_N >= kNoFloor_N;
  std::string smallest =
      fmt::format("{}, from dead zone {}, noise {}, drift {}",
                  has_floor ? fmt::format("{:.3g} N", floor_N) : fmt::format("below {:g} N", kNoFloor_N),
                  Sourced(rendering.dead_zone_N, 1.0, "N"), Sourced(rendering.noise_N, 1.0, "N"),
                  Sourced(rendering.drift_N, 1.0, "N"));
  if (has_floor && std::isfinite(greatest_N))
    smallest += fmt::format("; the arm's {:.0f} N along the tool are {:.0f} times as much", greatest_N,
                            greatest_N / floor_N);
  std::vector<report::SummaryRow> rows{
      {"Smallest force that is felt", smallest},
      {"Force sensor's delay", Sourced(rendering.sensor_delay_s, 1e-3, "ms")}};
  for (const RenderedAxis& axis : rendering.axes)
    rows.push_back({fmt::format("Rendered along {}", axis.axis), AxisText(axis)});
  return rows;
}

nlohmann::json RenderingJson(const Rendering& rendering, double greatest_N) {
  const double floor_N = rendering.force_floor_N();
  nlohmann::json json{{"smallest_force_N", floor_N},
                      {"smallest_force_source", rendering.floor_measured() ? "measured" : "assumed"},
                      {"dead_zone_N", JsonOf(rendering.dead_zone_N, 1.0)},
                      {"noise_N", JsonOf(rendering.noise_N, 1.0)},
                      {"drift_N", JsonOf(rendering.drift_N, 1.0)},
                      {"sensor_delay_ms", JsonOf(rendering.sensor_delay_s, 1e-3)},
                      {"force_range_ratio", JsonOf(floor_N >= kNoFloor_N ? std::optional(greatest_N / floor_N)
                                                                         : std::optional<double>())},
                      {"axes", nlohmann::json::array()}};
  for (const RenderedAxis& axis : rendering.axes)
    json["axes"].push_back(
        {{"axis", std::string(1, axis.axis)},
         {"lag_ms", JsonOf(axis.lag_s, 1e-3)},
         {"felt_mass_kg", axis.felt_mass_kg ? JsonOf(*axis.felt_mass_kg, 1.0) : nlohmann::json()},
         {"least_drag_Ns_per_m", JsonOf(axis.least_drag_Ns_per_m)},
         {"greatest_wall_N_per_m", JsonOf(axis.greatest_wall_N_per_m)},
         {"asked_drag_Ns_per_m",
          rendering.admittance ? nlohmann::json(axis.asked_drag_Ns_per_m) : nlohmann::json()},
         {"asked_wall_N_per_m",
          rendering.admittance ? nlohmann::json(axis.asked_wall_N_per_m) : nlohmann::json()},
         {"stands", rendering.admittance ? nlohmann::json(axis.stands) : nlohmann::json()},
         {"loop_source", axis.loop_measured ? "measured" : "assumed"}});
  return json;
}

}  // namespace osteon::studies
