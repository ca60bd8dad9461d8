#include "studies/identify/identify_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/parallel.h"
#include "control/excitation/excitation_path.h"
#include "hil/loops/admittance_loop.h"
#include "studies/identify/servo_fit.h"

namespace osteon::studies {
namespace {

// Search ranges of the wall's stiffness [N/m] and the drag [N s/m].
constexpr hil::BoundaryScan kWalls{.from = 100.0, .to = 1e6, .factor = 1.05, .tolerance = 1e-4};
constexpr hil::BoundaryScan kDrags{.from = 1.0, .to = 3000.0, .factor = 1.1, .tolerance = 1e-7};
// hands, mass and drag with which the table's predictions are made, as in the design
const hil::GridHand kStiffHand{"3 kN/m", 3000.0, 20.0, 1.5}, kFirmHand{"firm", 500.0, 20.0, 1.5};
constexpr double kMass_kg = 3.0, kDrag_Ns_per_m = 20.0;

// The result of one seed.
struct Found {
  ServoFit fit;
  double least_drag{0.0}, greatest_wall{0.0};  // as in TableRow
};

// The simulated arm with a fitted model's parameters.
hil::ServoArmParams ArmOf(const ServoModel& model, double period_s) {
  return {.bandwidth_hz = model.bandwidth_hz,
          .damping_ratio = model.damping_ratio,
          .dead_cycles = std::max(0.0, model.dead_time_s / period_s)};
}

// Mean, spread and coverage of an estimate over the seeds that have a fit. @param unit  size of the figure's
// unit in SI
TableFigure FigureOf(const std::vector<std::optional<Found>>& seeds, double truth, double unit,
                     const std::function<Estimate(const Found&)>& value) {
  TableFigure figure{.truth = truth / unit};
  int count = 0, inside = 0;
  for (const auto& found : seeds)
    if (found) {
      const Estimate estimate = value(*found);
      figure.mean += estimate.value / unit;
      inside += std::abs(estimate.value - truth) <= estimate.half_width;
      ++count;
    }
  if (count == 0) return figure;
  figure.mean /= count;
  figure.inside = static_cast<double>(inside) / count;
  double squares = 0.0;
  for (const auto& found : seeds)
    if (found) squares += std::pow(value(*found).value / unit - figure.mean, 2);
  figure.two_sd = 2.0 * std::sqrt(squares / std::max(1, count - 1));
  return figure;
}

nlohmann::ordered_json FigureJson(const TableFigure& figure) {
  return {{"truth", figure.truth},
          {"mean", figure.mean},
          {"two_sd", figure.two_sd},
          {"inside",
           std::isnan(figure.inside) ? nlohmann::ordered_json() : nlohmann::ordered_json(figure.inside)}};
}

// Deviation of the mean from the truth, and spread, in percent of the truth.
std::string Relative(const TableFigure& figure) {
  return fmt::format("{:+.2f} ± {:.2f} %", 100.0 * (figure.mean / figure.truth - 1.0),
                     100.0 * figure.two_sd / figure.truth);
}

}  // namespace

ExcitedRun Synthesize(const SyntheticRun& run, const hil::ServoArmParams& arm_params, double period_s,
                      std::uint64_t seed) {
  control::ExcitationPath path({.seed = 100 * seed,
                                .draws = run.draws,
                                .periods = run.periods,
                                .peak_speed_m_per_s = run.peak_m_per_s},
                               period_s);
  std::array<kinematics::JointLimits, 7> limits{};
  for (kinematics::JointLimits& limit : limits) limit.velocity_rad_per_s = 1e3;
  hil::ServoArm arm(arm_params, limits, period_s, kinematics::JointVector::Zero());
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  ExcitedRun samples{.period_s = period_s, .samples = {}};
  double held_m = 0.0;  // the last command that arrived at the arm
  for (int k = 0;; ++k) {
    const control::ExcitationStep step = path.Step(true);
    if (step.part == control::ExcitationPart::kDone) return samples;
    const bool seen = chance(random) >= run.lost, arrives = seen && chance(random) >= run.lost_answers;
    const double y_m = arm.q()[0] + run.noise_m * noise(random) + run.drift_m_per_s * period_s * k;
    if (arrives) held_m = step.x_m;
    samples.samples.push_back({.seen = seen,
                               .u_m = run.as_sent ? step.x_m : held_m,
                               .y_m = y_m,
                               .counted = step.part == control::ExcitationPart::kCounted,
                               .draw = step.draw,
                               .period = step.period});
    arm.Step(kinematics::JointVector::Constant(held_m));
  }
}

std::vector<SyntheticRun> TableRuns() {
  return {{.name = "64 s, 50 mm/s"},
          {.name = "24 s, 50 mm/s", .draws = 2, .periods = 2},
          {.name = "64 s, 20 mm/s", .peak_m_per_s = 0.02},
          {.name = "64 s, 5 mm/s", .peak_m_per_s = 0.005},
          {.name = "1 % of the messages lost", .lost = 0.01},
          {.name = "5 % of the answers lost, as arrived", .lost_answers = 0.05},
          {.name = "5 % of the answers lost, as sent (wrong)", .lost_answers = 0.05, .as_sent = true}};
}

double LeastDrag(const hil::ServoArmParams& arm, double period_s) {
  return hil::MinDrag({.hand = kStiffHand, .mass_kg = kMass_kg, .arm = arm, .period_s = period_s}, kDrags);
}

double GreatestWall(const hil::ServoArmParams& arm, double period_s) {
  return hil::MaxWallStiffness({.hand = kFirmHand,
                                .mass_kg = kMass_kg,
                                .damping_Ns_per_m = kDrag_Ns_per_m,
                                .arm = arm,
                                .period_s = period_s},
                               kWalls)
      .value;
}

TableRow IdentifyRow(const SyntheticRun& run, const IdentifyTableParams& params) {
  TableRow row{.run = run};
  row.seconds = control::Multisine::kPeriod_s * run.draws * (run.periods + 1);
  const double true_drag = LeastDrag(params.arm, params.period_s);
  const double true_wall = GreatestWall(params.arm, params.period_s);
  std::vector<std::optional<Found>> seeds(static_cast<std::size_t>(params.seeds));
  simulation::ParallelFor(
      seeds.size(), params.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const ExcitedRun samples = Synthesize(run, params.arm, params.period_s, i + 1);
          const auto response = MeasureResponse(samples, Signal::kCommand, Signal::kPosition);
          if (!response) continue;
          const auto fit = FitServo(response->lines, params.period_s);
          if (!fit) continue;
          const hil::ServoArmParams arm = ArmOf(fit->model, params.period_s);
          seeds[i] = Found{.fit = *fit,
                           .least_drag = LeastDrag(arm, params.period_s),
                           .greatest_wall = GreatestWall(arm, params.period_s)};
        }
      },
      1);
  for (const auto& found : seeds) row.failed += !found;
  const double w = 2.0 * std::numbers::pi * params.arm.bandwidth_hz;
  const double dead_s = params.arm.dead_cycles * params.period_s;
  row.hz = FigureOf(seeds, params.arm.bandwidth_hz, 1.0, [](const Found& f) { return f.fit.bandwidth_hz; });
  row.damping_ratio =
      FigureOf(seeds, params.arm.damping_ratio, 1.0, [](const Found& f) { return f.fit.damping_ratio; });
  row.dead_time_ms = FigureOf(seeds, dead_s, 1e-3, [](const Found& f) { return f.fit.dead_time_s; });
  row.lag_ms = FigureOf(seeds, dead_s + 2.0 * params.arm.damping_ratio / w, 1e-3,
                        [](const Found& f) { return f.fit.lag_s; });
  row.least_drag_Ns_per_m =
      FigureOf(seeds, true_drag, 1.0, [](const Found& f) { return Estimate{.value = f.least_drag}; });
  row.greatest_wall_N_per_m =
      FigureOf(seeds, true_wall, 1.0, [](const Found& f) { return Estimate{.value = f.greatest_wall}; });
  row.least_drag_Ns_per_m.inside = row.greatest_wall_N_per_m.inside =
      std::numeric_limits<double>::quiet_NaN();
  return row;
}

std::string TableText(const std::vector<TableRow>& rows) {
  std::string text = fmt::format("  {:<42} {:>15} {:>17} {:>18} {:>19} {:>17} {:>7}\n", "recording", "Hz",
                                 "dead time [ms]", "lag [ms]", "least drag", "greatest wall", "inside");
  for (const TableRow& row : rows) {
    const double inside =
        std::min({row.hz.inside, row.damping_ratio.inside, row.dead_time_ms.inside, row.lag_ms.inside});
    text += fmt::format("  {:<42} {:>15} {:>17} {:>18} {:>19} {:>17} {:>5.0f} %{}\n", row.run.name,
                        fmt::format("{:.2f} ± {:.2f}", row.hz.mean, row.hz.two_sd),
                        fmt::format("{:.3f} ± {:.3f}", row.dead_time_ms.mean, row.dead_time_ms.two_sd),
                        fmt::format("{:.3f} ± {:.3f}", row.lag_ms.mean, row.lag_ms.two_sd),
                        Relative(row.least_drag_Ns_per_m), Relative(row.greatest_wall_N_per_m),
                        100.0 * inside, row.failed > 0 ? fmt::format(", {} without a fit", row.failed) : "");
  }
  return text;
}

std::string TableJson(const std::vector<TableRow>& rows, const IdentifyTableParams& params,
                      const std::string& command_line) {
  nlohmann::ordered_json json{{"schema", "osteon.identify/1"},
                              {"subcommand", "identify"},
                              {"command_line", command_line},
                              {"seeds", params.seeds},
                              {"table", nlohmann::ordered_json::array()}};
  for (const TableRow& row : rows)
    json["table"].push_back({{"recording", row.run.name},
                             {"seconds", row.seconds},
                             {"failed", row.failed},
                             {"hz", FigureJson(row.hz)},
                             {"damping_ratio", FigureJson(row.damping_ratio)},
                             {"dead_time_ms", FigureJson(row.dead_time_ms)},
                             {"lag_ms", FigureJson(row.lag_ms)},
                             {"least_drag_Ns_per_m", FigureJson(row.least_drag_Ns_per_m)},
                             {"greatest_wall_N_per_m", FigureJson(row.greatest_wall_N_per_m)}});
  return base::JsonText(json);
}

}  // namespace osteon::studies
