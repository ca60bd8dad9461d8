#include "studies/tune/tune_measured.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "config/reading/apply_identified.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "studies/identify/servo_fit.h"

namespace osteon::studies {
namespace {

// number of margins in the table, for the own and for the recommended gains each
constexpr std::size_t kTableRows = 5;
constexpr double kAxisEnd = 2.0;  // the Nyquist plot's axes go from -kAxisEnd to kAxisEnd

// The response by which gains are judged; null: none fits. It is measured by the force sensor if a structural
// resonance was found, which encoders do not see; otherwise by the encoders. It has the arm's axis and the
// speed nearest to the arm's.
const config::IdentifiedResponse* ResponseFor(const config::IdentifiedCell& identified,
                                              const config::IdentifiedArm& arm) {
  const config::IdentifiedResponse* best = nullptr;
  const bool by_force = !identified.structure.empty();
  double best_difference = std::numeric_limits<double>::infinity();
  for (const config::IdentifiedResponse& response : identified.response) {
    if (response.axis != arm.axis || response.by_force != by_force || !response.hand.empty()) continue;
    const double difference = std::abs(response.speed_m_per_s - arm.speed_m_per_s);
    if (difference < best_difference) {
      best_difference = difference;
      best = &response;
    }
  }
  return best;
}

std::vector<PlantLine> LinesOf(const config::IdentifiedResponse& response) {
  std::vector<PlantLine> lines;
  for (const config::IdentifiedLine& line : response.lines)
    lines.push_back({.hz = line.hz, .value = {line.re, line.im}, .sd = line.sd});
  return lines;
}

// A rough arm for a cell whose responses no model fits well. It supplies the values below and above the
// measured frequencies. If several responses can be fitted, the one with the largest lag is used.
std::optional<config::IdentifiedArm> RoughArm(const config::IdentifiedCell& identified, double period_s) {
  std::optional<config::IdentifiedArm> slowest;
  for (const config::IdentifiedResponse& response : identified.response) {
    if (response.by_force != !identified.structure.empty() || !response.hand.empty()) continue;
    std::vector<ResponseLine> lines;
    for (const config::IdentifiedLine& line : response.lines)
      lines.push_back({.hz = line.hz, .value = {line.re, line.im}, .sd = std::max(line.sd, 1e-9)});
    const auto fit = FitServo(lines, period_s);
    if (!fit || (slowest && slowest->lag_s >= fit->lag_s.value)) continue;
    slowest = config::IdentifiedArm{.axis = response.axis,
                                    .speed_m_per_s = response.speed_m_per_s,
                                    .bandwidth_hz = fit->model.bandwidth_hz,
                                    .damping_ratio = fit->model.damping_ratio,
                                    .dead_time_s = fit->model.dead_time_s,
                                    .gain = fit->model.gain,
                                    .lag_s = fit->lag_s.value,
                                    .chi2 = fit->chi2};
  }
  return slowest;
}

// Adds the hands that held the handle during a measurement, each with its measured loop. The model matters
// only outside of the measured band.
void UseHeldLoops(const config::IdentifiedCell& identified, ResponseModel model, TuneTask& task) {
  for (const config::IdentifiedResponse& response : identified.response) {
    const auto hand = std::ranges::find(identified.hands, response.hand, &config::IdentifiedHand::name);
    if (response.hand.empty() || hand == identified.hands.end()) continue;
    task.held.push_back({.hand = {hand->name + ", its own loop as measured", hand->stiffness_N_per_m,
                                  hand->damping_Ns_per_m, hand->mass_kg},
                         .response = std::make_shared<MeasuredPlant>(LinesOf(response), model)});
  }
}

// Gives the task its measured response. The model continues the response outside of the measured band.
void UseResponse(const config::IdentifiedCell& identified, const config::IdentifiedArm& arm, TuneTask& task) {
  const config::IdentifiedResponse* found = ResponseFor(identified, arm);
  if (found == nullptr) return;
  const double period_s = task.loop.period_s;
  ResponseModel model{.arm = {.bandwidth_hz = arm.bandwidth_hz,
                              .damping_ratio = arm.damping_ratio,
                              .dead_cycles = arm.dead_time_s / period_s},
                      .period_s = period_s};
  const std::optional<double> delay_s = identified.sensor ? identified.sensor->delay_s : std::nullopt;
  const double sensor_s = delay_s.value_or(task.loop.sensor_delay * period_s);
  ResponseModel by_force = model;
  by_force.delay_s = sensor_s;
  for (const config::IdentifiedResonance& resonance : identified.structure)
    by_force.structure.push_back({.hz = resonance.hz, .damping_ratio = resonance.damping_ratio});
  UseHeldLoops(identified, by_force, task);
  if (found->by_force) model = by_force;
  task.response = std::make_shared<MeasuredPlant>(LinesOf(*found), model);
  task.response_delay_s = found->by_force ? 0.0 : sensor_s;
  task.measured_only = !identified.structure.empty();
}

// The loop's parameters with these gains and this contact, whose wall is multiplied by `gain`.
MeasuredLoopParams LoopOf(const TuneTask& task, const TuneGains& gains, TuneContact contact, double gain) {
  MeasuredLoopParams params{.loop = task.loop, .sensor_delay_s = task.response_delay_s};
  // every command has the largest possible delay
  params.sensor_delay_s += task.command_jitter * task.loop.period_s;
  params.loop.mass_kg = gains.mass_kg;
  params.loop.damping_Ns_per_m = gains.damping_Ns_per_m;
  params.loop.wall = WallOf(task, contact, gain);
  return params;
}

// The loop's parameters for a hand whose own loop was measured.
MeasuredLoopParams LoopOf(const TuneTask& task, const TuneGains& gains, TuneContact contact, double gain,
                          const hil::GridHand& held) {
  MeasuredLoopParams params = LoopOf(task, gains, contact, gain);
  // the measured response includes the sensor's delay
  params.sensor_delay_s = task.command_jitter * task.loop.period_s;
  params.loop.hand = {held.name, gain * held.stiffness_N_per_m, gain * held.damping_Ns_per_m,
                      gain * held.mass_kg};
  return params;
}

// Whether margin a is nearer to instability than b.
bool IsWorse(const TuneMargin& a, const TuneMargin& b) {
  if (a.margins.stable != b.margins.stable) return !a.margins.stable;
  return a.margins.modulus < b.margins.modulus;
}

// The margins of the gains with this name, sorted from the nearest to instability to the farthest.
std::vector<const TuneMargin*> WorstFirst(const std::vector<TuneMargin>& margins, const std::string& gains) {
  std::vector<const TuneMargin*> list;
  for (const TuneMargin& margin : margins)
    if (margin.gains == gains) list.push_back(&margin);
  std::ranges::stable_sort(list, [](const auto* a, const auto* b) { return IsWorse(*a, *b); });
  return list;
}

// The gain margin as text, with the half-width of its 95 % interval.
std::string GainText(const LoopMargins& m) {
  return std::isfinite(m.gain) ? fmt::format("{:.2f} ± {:.2f}", m.gain, m.gain_radius) : std::string("none");
}

}  // namespace

std::string FiguresBesideArm(const config::IdentifiedCell& identified) {
  std::vector<std::string> figures;
  if (identified.sensor) figures.emplace_back("the force sensor's noise");
  if (identified.sensor && identified.sensor->delay_s) figures.emplace_back("its delay");
  if (identified.link) figures.emplace_back("the link's jitter and losses");
  if (!identified.structure.empty()) figures.emplace_back("a structure's resonance");
  if (const std::size_t hands = identified.hands.size(); hands > 0)
    figures.push_back(hands == 1 ? "a hand" : fmt::format("{} hands", hands));
  if (identified.vibration) figures.emplace_back("vibration");
  if (identified.dead_zone_N) figures.emplace_back("a dead zone");
  return figures.empty() ? "nothing else" : fmt::format("{}", fmt::join(figures, ", "));
}

void UseHands(const config::IdentifiedCell& identified, TuneTask& task) {
  for (const config::IdentifiedHand& hand : identified.hands)
    for (const double stiffness :
         {hand.stiffness_N_per_m, hand.stiffness_interval_N_per_m.low, hand.stiffness_interval_N_per_m.high})
      task.measured_hands.push_back({fmt::format("{}, {:.0f} N/m, measured", hand.name, stiffness),
                                     std::max(0.0, stiffness), std::max(0.0, hand.damping_Ns_per_m),
                                     std::max(0.0, hand.mass_kg)});
}

int JitterOf(const config::IdentifiedLink& link, double period_s) {
  const double beyond_s = std::max(0.0, link.jitter_p99_s - link.jitter_mean_s);
  return static_cast<int>(std::ceil(beyond_s / period_s - 1e-9));
}

void UseIdentified(const config::IdentifiedCell& identified, TuneTask& task) {
  task.identified = identified;
  const double period_s = task.loop.period_s;
  const config::IdentifiedArm* arm = config::SlowestArm(identified);
  const std::optional<config::IdentifiedArm> rough =
      arm == nullptr ? RoughArm(identified, period_s) : std::nullopt;
  if (rough) arm = &*rough;
  task.arm_measured = arm != nullptr;
  if (arm != nullptr) {
    task.loop.arm = {.bandwidth_hz = arm->bandwidth_hz,
                     .damping_ratio = arm->damping_ratio,
                     .dead_cycles = std::max(0.0, arm->dead_time_s / period_s)};
    task.loop.felt_mass_kg = arm->felt_mass_kg.value_or(0.0);
  }
  if (identified.sensor && identified.sensor->delay_s) {
    const double ticks = std::max(0.0, *identified.sensor->delay_s / period_s);
    task.loop.sensor_delay = static_cast<int>(std::floor(ticks + 1e-9));
    task.loop.arm.dead_cycles += std::max(0.0, ticks - task.loop.sensor_delay);
  }
  UseHands(identified, task);
  if (arm == nullptr) return;
  if (identified.link) {
    task.command_jitter = JitterOf(*identified.link, period_s);
    task.command_loss = identified.link->loss_ratio;
  }
  UseResponse(identified, *arm, task);
  task.measured_only |= rough.has_value();
}

std::string MarginText(const TuneMargin& m) {
  if (!m.margins.stable)
    return fmt::format("unstable with {} ({}), which the curve encircles {} times", m.hand.name,
                       NameOf(m.contact), m.margins.unstable_poles / 2);
  return fmt::format(
      "{}; least with {} ({}): gain {}, phase {:.0f} ± {:.0f}°, |1 + L| {:.2f} ± {:.2f} at {:.1f} Hz",
      m.margins.robust ? "stable" : "stable by the measured values, not within their error", m.hand.name,
      NameOf(m.contact), GainText(m.margins), m.margins.phase_deg, m.margins.phase_radius_deg,
      m.margins.modulus, m.margins.modulus_radius, m.margins.modulus_hz);
}

TuneTask MeasuredTaskOf(const config::CellConfig& cell) {
  TuneTask task = TuneTaskOf(cell);
  task.command_jitter = task.loop.sensor_delay =
      std::max(1, static_cast<int>(std::ceil(1e-3 / task.loop.period_s - 1e-9)));
  if (cell.identified) UseIdentified(*cell.identified, task);
  return task;
}

bool IsStableAsMeasured(const TuneTask& task, const TuneGains& gains, const std::vector<hil::GridHand>& hands,
                        double gain) {
  std::vector<hil::GridHand> stiffer = hands;
  for (hil::GridHand& hand : stiffer) {
    hand.stiffness_N_per_m *= gain;
    hand.damping_Ns_per_m *= gain;
    hand.mass_kg *= gain;
  }
  return std::ranges::all_of(kTuneContacts, [&](TuneContact contact) {
    return AreAllStable(*task.response, LoopOf(task, gains, contact, gain), stiffer) &&
           std::ranges::all_of(task.held, [&](const HeldLoop& held) {
             const MeasuredLoopParams loop = LoopOf(task, gains, contact, gain, held.hand);
             return AreAllStable(*held.response, loop, {{loop.loop.hand}});
           });
  });
}

std::vector<TuneMargin> MeasuredMargins(const TuneTask& task, const std::string& name, const TuneGains& gains,
                                        const std::vector<hil::GridHand>& hands) {
  std::vector<TuneMargin> list;
  if (!task.response) return list;
  for (const TuneContact contact : kTuneContacts)
    for (const hil::GridHand& hand : hands) {
      MeasuredLoopParams params = LoopOf(task, gains, contact, 1.0);
      params.loop.hand = hand;
      list.push_back({.gains = name,
                      .hand = hand,
                      .contact = contact,
                      .margins = JudgeMeasuredLoop(*task.response, params)});
    }
  for (const TuneContact contact : kTuneContacts)
    for (const HeldLoop& held : task.held)
      list.push_back(
          {.gains = name,
           .hand = held.hand,
           .contact = contact,
           .margins = JudgeMeasuredLoop(*held.response, LoopOf(task, gains, contact, 1.0, held.hand))});
  return list;
}

const TuneMargin* WorstOf(const std::vector<TuneMargin>& margins, const std::string& gains) {
  const std::vector<const TuneMargin*> list = WorstFirst(margins, gains);
  return list.empty() ? nullptr : list.front();
}

bool IsStableByMargins(const std::vector<TuneMargin>& margins, const std::string& gains) {
  const TuneMargin* worst = WorstOf(margins, gains);
  return worst == nullptr || (worst->margins.stable && worst->margins.robust);
}

void JudgeMargins(const std::vector<TuneMargin>& margins, session::Verdict& verdict) {
  const auto judge = [&](const char* gains, session::VerdictLevel level, const char* whose) {
    if (IsStableByMargins(margins, gains)) return;
    verdict.Add(level, fmt::format("by the measured response {} are {}", whose,
                                   MarginText(*WorstOf(margins, gains))));
  };
  judge("recommended", session::VerdictLevel::kBad, "the recommended gains");
  judge("own", session::VerdictLevel::kWarning, "the cell's own gains");
}

void AddMarginRows(const std::vector<TuneMargin>& margins, std::vector<report::SummaryRow>& rows) {
  for (const auto& [gains, key] :
       {std::pair{"own", "Measured, the cell's own gains"}, {"recommended", "Measured, recommended gains"}})
    if (const TuneMargin* worst = WorstOf(margins, gains)) rows.push_back({key, MarginText(*worst)});
}

std::vector<report::SummaryRow> RowsOfMeasured(const TuneTask& task, const std::vector<TuneMargin>& margins) {
  if (!task.identified) return {};
  std::vector<report::SummaryRow> rows;
  const config::IdentifiedCell& cell = *task.identified;
  if (const config::IdentifiedArm* arm = config::SlowestArm(cell))
    rows.push_back(
        {"Measured arm",
         fmt::format(
             "axis {} at {:.3g} mm/s: {:.2f} Hz, damping ratio {:.2f}, dead time {:.2f} ms, total lag "
             "{:.1f} ms ({:.1f} … {:.1f}){}; {} measured hands",
             arm->axis, 1e3 * arm->speed_m_per_s, arm->bandwidth_hz, arm->damping_ratio,
             1e3 * arm->dead_time_s, 1e3 * arm->lag_s, 1e3 * arm->lag_interval_s.low,
             1e3 * arm->lag_interval_s.high,
             arm->felt_mass_kg ? fmt::format(", moved by the hand as {:.2f} kg", *arm->felt_mass_kg) : "",
             cell.hands.size())});
  AddMarginRows(margins, rows);
  if (task.measured_only)
    rows.push_back(
        {"Structure",
         fmt::format("{}: gains are judged by the measured response alone, without the arm's model",
                     cell.structure.empty() ? "no model of second order fits the arm"
                                            : "a resonance between encoders and tool was measured")});
  return rows;
}

nlohmann::json ToJson(const std::vector<TuneMargin>& margins) {
  nlohmann::json list = nlohmann::json::array();
  for (const TuneMargin& m : margins)
    list.push_back(
        {{"gains", m.gains},
         {"hand", m.hand.name},
         {"contact", NameOf(m.contact)},
         {"stable", m.margins.stable},
         {"unstable_poles", m.margins.unstable_poles},
         {"gain", std::isfinite(m.margins.gain) ? nlohmann::json(m.margins.gain) : nlohmann::json()},
         {"gain_radius", m.margins.gain_radius},
         {"phase_deg", m.margins.phase_deg},
         {"phase_radius_deg", m.margins.phase_radius_deg},
         {"modulus", m.margins.modulus},
         {"modulus_radius", m.margins.modulus_radius},
         {"modulus_hz", m.margins.modulus_hz},
         {"robust", m.margins.robust}});
  return list;
}

std::string TableOf(const std::vector<TuneMargin>& margins) {
  std::string table =
      "<table>\n<tr><th>gains</th><th>hand</th><th>contact</th><th>stable</th><th>gain margin</th><th>phase "
      "margin [°]</th><th>least |1 + L|</th><th>at [Hz]</th></tr>\n";
  for (const char* gains : {"recommended", "own"}) {
    const std::vector<const TuneMargin*> list = WorstFirst(margins, gains);
    for (std::size_t i = 0; i < std::min(kTableRows, list.size()); ++i) {
      const TuneMargin& m = *list[i];
      table += fmt::format(
          "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.0f} ± {:.0f}</td><td>{:.2f} ± "
          "{:.2f}</td><td>{:.1f}</td></tr>\n",
          gains, report::Escape(m.hand.name), NameOf(m.contact),
          !m.margins.stable ? "no" : (m.margins.robust ? "yes" : "not surely"), GainText(m.margins),
          m.margins.phase_deg, m.margins.phase_radius_deg, m.margins.modulus, m.margins.modulus_radius,
          m.margins.modulus_hz);
    }
  }
  return table + "</table>\n";
}

namespace {

// The Nyquist curve of the loop to which a margin belongs.
std::vector<NyquistPoint> CurveOf(const TuneTask& task, const TuneGains& gains, const TuneMargin& margin) {
  for (const HeldLoop& held : task.held)
    if (held.hand.name == margin.hand.name)
      return NyquistCurve(*held.response, LoopOf(task, gains, margin.contact, 1.0, held.hand));
  MeasuredLoopParams params = LoopOf(task, gains, margin.contact, 1.0);
  params.loop.hand = margin.hand;
  return NyquistCurve(*task.response, params);
}

}  // namespace

std::string NyquistSvg(const std::vector<NamedCurve>& curves) {
  report::LineChart chart{.title = "Nyquist curves of the worst hands, by the measured response",
                          .x_label = "real part of L",
                          .y_label = "imaginary part of L",
                          .x = report::Range{-kAxisEnd, kAxisEnd},
                          .y = report::Range{-kAxisEnd, kAxisEnd},
                          .y_from_zero = false,
                          .plot_height_px = 480.0};
  for (const NamedCurve& named : curves) {
    report::Series curve{.name =
                             fmt::format("{} gains, {} ({})",
                                         named.worst->gains == "own" ? "the cell's own" : named.worst->gains,
                                         named.worst->hand.name, NameOf(named.worst->contact))};
    for (const NyquistPoint& point : named.curve) {
      const bool in_plot = std::abs(point.loop.real()) <= kAxisEnd && std::abs(point.loop.imag()) <= kAxisEnd;
      curve.x.push_back(in_plot ? point.loop.real() : std::numeric_limits<double>::quiet_NaN());
      curve.y.push_back(in_plot ? point.loop.imag() : std::numeric_limits<double>::quiet_NaN());
    }
    chart.series.push_back(curve);
  }
  chart.series.push_back({.name = "-1: a curve around it is an oscillation that grows",
                          .x = {-1.0},
                          .y = {0.0},
                          .color = "#d55e00",
                          .width_px = 0.0,
                          .marker = report::Marker::kCross});
  return report::Svg(chart, 620.0);
}

std::string NyquistSvg(const TuneTask& task, const TuneGains& own, const TuneGains& recommended,
                       const std::vector<TuneMargin>& margins) {
  std::vector<NamedCurve> curves;
  for (const auto& [name, gains] : {std::pair{"recommended", recommended}, {"own", own}})
    if (const TuneMargin* worst = WorstOf(margins, name))
      curves.push_back({.worst = worst, .curve = CurveOf(task, gains, *worst)});
  return NyquistSvg(curves);
}

}  // namespace osteon::studies
