#include "studies/charts/chart_compliance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/no_alloc_scope.h"
#include "config/reading/load.h"
#include "config/reading/strict/config_error.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"

namespace osteon::studies {
namespace {

constexpr double kMaxAdded_us = 3.0;    // accepted increase of the loop's median time when all levels are on
constexpr double kNoticedShare = 0.07;  // smallest relative change of a force that a person notices
constexpr double kPush_N = 20.0;        // mean of the force about which it is varied
constexpr double kSettle_s = 4.0;       // time after which a displacement counts as at rest
// Distance of frequencies [decades]; small, since a mount's resonance is narrow.
constexpr double kDecadeStep = 0.02;
// Each compliant level, and the shipped cell that has only this level.
constexpr std::array<std::pair<const char*, const char*>, 3> kCells{
    {{"tool", "long_drill"}, {"layer", "cartilage_cup"}, {"mount", "pelvis_mount"}}};

// The one compliant level of a cell (tool, layer or mount), under a force along a fixed direction: across the
// feed for a tool, along the feed for a layer or mount.
class PressedLevel {
 public:
  PressedLevel(const config::CellConfig& cell, const control::ComplianceParams& params)
      : compliance_(params, cell.servo.period_s),
        direction_(params.tool ? Vector3::UnitX() : Vector3::UnitZ()) {
    model_.contact_count = 1;
    model_.contacts[0].weight = 1.0;
    // the force acts at the mount's centre, so the mount does not turn
    if (params.mount) X_WT_.translation() = params.mount->p_WMo_m;
    if (params.layer) model_.engaged_area_m2 = params.layer->touch_area_m2;
    if (params.layer)
      for (std::size_t i = 0; i < params.layer->kappa_N_per_m3.size(); ++i)
        if (params.layer->kappa_N_per_m3[i] > 0.0)
          model_.contacts[0].material = static_cast<simulation::MaterialIndex>(i);
  }
  // Displacement of the head along the force, out of the bone.
  [[nodiscard]] double Displacement_m() const {
    const Vector3 moved = compliance_.X_ME(X_WT_).translation() - X_WT_.translation();
    return direction_.dot(moved);
  }
  [[nodiscard]] bool beyond_limit() const { return compliance_.beyond_limit(); }
  void Step(double force_N) {
    compliance_.Step({.f = force_N * direction_, .t = Vector3::Zero()}, model_, X_WT_);
  }

 private:
  control::Compliance compliance_;
  Vector3 direction_;
  Pose X_WT_{Pose::Identity()};
  simulation::ContactModel model_;
};

// Displacement at rest under a force [m], after kSettle_s of simulation. None if the displacement is beyond
// the limit at which the cell stops.
std::optional<double> DisplacementAtRest_m(const config::CellConfig& cell,
                                           const control::ComplianceParams& params, double force_N) {
  PressedLevel level(cell, params);
  for (double t = 0.0; t < kSettle_s; t += cell.servo.period_s) level.Step(force_N);
  if (level.beyond_limit()) return std::nullopt;
  return level.Displacement_m();
}

// Stiffness that the hand feels at one frequency (amplitude of the force over that of the hand's motion),
// divided by the coupling's stiffness.
// @param at_rest_m  displacement at rest under kPush_N
double FeltRatio(const config::CellConfig& cell, const control::ComplianceParams& params, double at_rest_m,
                 double hz) {
  const double K = cell.servo.coupling.max_stiffness_N_per_m, T = cell.servo.period_s;
  const double mean_depth_m = kPush_N / K + at_rest_m, amplitude_m = 0.02 * mean_depth_m;
  const int ticks_per_cycle = static_cast<int>(std::lround(1.0 / (hz * T)));
  const int cycles = std::max(2, static_cast<int>(std::lround(hz)));
  const int settling_ticks = ticks_per_cycle * static_cast<int>(std::ceil(kSettle_s / (ticks_per_cycle * T)));
  PressedLevel level(cell, params);
  std::complex<double> force_component;  // Fourier sum of the force at this frequency, over whole cycles
  for (int i = 0; i < settling_ticks + cycles * ticks_per_cycle; ++i) {
    const double phase_rad = 2.0 * std::numbers::pi * i / ticks_per_cycle;
    const double force_N =
        std::max(0.0, K * (mean_depth_m + amplitude_m * std::sin(phase_rad) - level.Displacement_m()));
    level.Step(force_N);
    if (i >= settling_ticks) force_component += force_N * std::polar(1.0, -phase_rad);
  }
  return 2.0 * std::abs(force_component) / (cycles * ticks_per_cycle) / (K * amplitude_m);
}

std::vector<std::vector<std::string>> CostTable(const ComplianceChart& chart) {
  std::vector<std::vector<std::string>> rows{
      {"level", "loop, median [us]", "99th [us]", "99.9th [us]", "added [us]", "force [N]"}};
  for (const LevelCost& cost : chart.costs)
    rows.push_back({cost.name, report::Number(cost.loop.p50_us), report::Number(cost.loop.p99_us),
                    report::Number(cost.loop.p999_us),
                    fmt::format("{:.2f}", AddedMedian_us(cost, chart.costs.front())),
                    report::Number(cost.force_N)});
  return rows;
}

// Returns y of a curve at x = `at`, by linear interpolation; beyond the last point, the last point's y.
double ValueAt(const std::vector<double>& x, const std::vector<double>& y, double at) {
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] >= at) return y[i - 1] + (y[i] - y[i - 1]) * (at - x[i - 1]) / (x[i] - x[i - 1]);
  return y.back();
}

std::vector<std::vector<std::string>> ChangeTable(const ComplianceChart& chart) {
  std::vector<std::vector<std::string>> rows{{"level (cell)", "coupling [N/mm]", "gives at 20 N [mm]",
                                              "reported from [mm]", "felt at 0.2 Hz", "at 2 Hz", "at 10 Hz"}};
  for (const LevelChange& c : chart.changes) {
    const auto felt = [&](double hz) { return fmt::format("{:.2f}", ValueAt(c.hz, c.felt_ratio, hz)); };
    rows.push_back({fmt::format("{} ({})", c.name, c.cell), report::Number(1e-3 * c.stiffness_N_per_m),
                    fmt::format("{:.3f}", 1e3 * ValueAt(c.force_N, c.gives_m, kPush_N)),
                    fmt::format("{:.3f}", 1e3 * c.error_m), felt(0.2), felt(2.0), felt(10.0)});
  }
  return rows;
}

// Draws the stiffness that the hand feels over the frequency, for each level.
std::string FeltSvg(const ComplianceChart& chart) {
  report::LineChart plot{.title = "Felt stiffness over the coupling's own",
                         .x_label = "frequency of a small motion about a push of 20 N [Hz]",
                         .y_label = "ratio",
                         .log_x = true,
                         .log_y = true,
                         .plot_height_px = 300.0};
  for (const LevelChange& change : chart.changes)
    plot.series.push_back({.name = fmt::format("{} ({})", change.name, change.cell),
                           .x = change.hz,
                           .y = change.felt_ratio,
                           .width_px = 1.8});
  plot.limits.push_back({.value = 1.0, .label = "rigid"});
  plot.limits.push_back({.value = 1.0 - kNoticedShare, .label = "7 % less"});
  return report::Svg(plot, 860.0);
}

// Draws the displacement at rest over the force, for each level.
std::string GivesSvg(const ComplianceChart& chart) {
  report::LineChart plot{.title = "Displacement at rest",
                         .x_label = "force [N]",
                         .y_label = "displacement [mm]",
                         .log_x = true,
                         .log_y = true,
                         .plot_height_px = 300.0};
  for (const LevelChange& change : chart.changes) {
    report::Series series{.name = fmt::format("{} ({})", change.name, change.cell), .x = change.force_N};
    series.width_px = 1.8;
    for (const double gives_m : change.gives_m) series.y.push_back(1e3 * gives_m);
    plot.series.push_back(std::move(series));
  }
  plot.limits.push_back({.value = 0.1, .label = "error 0.1 mm"});
  return report::Svg(plot, 860.0);
}

// Draws the loop's time for each level.
std::string CostSvg(const ComplianceChart& chart) {
  report::LineChart plot{.title = "Servo loop's time a tick, from the median to the 99th percentile",
                         .x_label = "what gives way: 0 nothing, 1 tool, 2 layer, 3 mount, 4 all",
                         .y_label = "time [us]",
                         .x = report::Range{-0.5, 4.5},
                         .plot_height_px = 240.0};
  report::Series series{.name = "median", .width_px = 0.0, .marker = report::Marker::kCircle};
  for (std::size_t i = 0; i < chart.costs.size(); ++i) {
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(chart.costs[i].loop.p50_us);
    series.y_low.push_back(chart.costs[i].loop.p50_us);
    series.y_high.push_back(chart.costs[i].loop.p99_us);
    series.labels.push_back(chart.costs[i].name);
  }
  plot.series.push_back(std::move(series));
  plot.limits.push_back({.value = chart.costs.front().loop.p50_us + kMaxAdded_us, .label = "off + 3 us"});
  plot.legend = false;
  plot.y = report::Range{0.0, 1.05 * std::ranges::max(plot.series.front().y_high)};
  return report::Svg(plot, 860.0);
}

std::string Csv(const ComplianceChart& chart) {
  std::string csv = "kind,level,cell,x,y\n";
  for (const LevelCost& cost : chart.costs)
    csv += fmt::format("loop_us_p50,{},demo,,{:.3f}\nloop_us_p99,{},demo,,{:.3f}\n", cost.name,
                       cost.loop.p50_us, cost.name, cost.loop.p99_us);
  for (const LevelChange& change : chart.changes) {
    for (std::size_t i = 0; i < change.force_N.size(); ++i)
      csv += fmt::format("gives_mm_by_force_N,{},{},{:.4g},{:.5g}\n", change.name, change.cell,
                         change.force_N[i], 1e3 * change.gives_m[i]);
    for (std::size_t i = 0; i < change.hz.size(); ++i)
      csv += fmt::format("felt_ratio_by_hz,{},{},{:.4g},{:.5g}\n", change.name, change.cell, change.hz[i],
                         change.felt_ratio[i]);
  }
  return csv;
}

std::string Json(const ComplianceChart& chart) {
  nlohmann::ordered_json json{{"schema", "osteon.chart.compliance/1"},
                              {"subcommand", "chart compliance"},
                              {"machine", chart.machine},
                              {"ticks", chart.ticks},
                              {"costs", nlohmann::ordered_json::array()},
                              {"changes", nlohmann::ordered_json::array()}};
  for (const LevelCost& cost : chart.costs)
    json["costs"].push_back({{"level", cost.name},
                             {"loop_us_p50", cost.loop.p50_us},
                             {"loop_us_p99", cost.loop.p99_us},
                             {"loop_us_p999", cost.loop.p999_us},
                             {"added_us", AddedMedian_us(cost, chart.costs.front())},
                             {"allocations", cost.allocations}});
  for (const LevelChange& change : chart.changes)
    json["changes"].push_back({{"level", change.name},
                               {"cell", change.cell},
                               {"stiffness_N_per_mm", 1e-3 * change.stiffness_N_per_m},
                               {"force_N", change.force_N},
                               {"gives_m", change.gives_m},
                               {"hz", change.hz},
                               {"felt_ratio", change.felt_ratio}});
  return session::ResultText(Judge(chart), json);
}

// Writes the chart's files and prints its tables. @returns the process's exit code
int Write(const ComplianceChartOptions& options, const ComplianceChart& chart) {
  const session::Verdict verdict = Judge(chart);
  const session::ChartFiles files{
      .name = "compliance",
      .title = "What gives way: what it changes and costs",
      .verdict = verdict.ForReport(),
      .svg = FeltSvg(chart),
      .caption = "Amplitude of the force over that of the hand's motion: coupling and part in series.",
      .csv = Csv(chart),
      .json = Json(chart),
      .json_copy = options.json,
      .table = ChangeTable(chart),
      .notes = {fmt::format(
          "{}. Each level is that of a shipped cell, stepped as the servo loop steps it: the tool "
          "across its feed, tissue and mount along the push.",
          chart.machine)},
      .parts = {
          {.heading = "Displacement",
           .name = "compliance_gives",
           .svg = GivesSvg(chart),
           .caption = "Each part at rest under a force, up to where the cell stops."},
          {.heading = "Cost",
           .name = "compliance_cost",
           .svg = CostSvg(chart),
           .caption = fmt::format("cells/demo.yaml with eight planes at the tool, {} ticks a level, in turn.",
                                  chart.ticks),
           .table = CostTable(chart)}}};
  if (const auto written = session::WriteChart(files, options.out); !written)
    return session::Fail("chart compliance", written.error(), session::kFailed);
  session::PrintVerdict(verdict, 28);
  for (const auto& row : ChangeTable(chart))
    fmt::print("{:<24} {:>16} {:>19} {:>19} {:>15} {:>8} {:>9}\n", row[0], row[1], row[2], row[3], row[4],
               row[5], row[6]);
  for (const auto& row : CostTable(chart))
    fmt::print("{:<24} {:>18} {:>10} {:>12} {:>11} {:>10}\n", row[0], row[1], row[2], row[3], row[4], row[5]);
  fmt::print("{}\n", (options.out / "compliance.html").string());
  return 0;
}

// Checks the options, computes the chart and writes it. @returns the process's exit code
int Run(const ComplianceChartOptions& options) {
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty())
    return session::Fail("chart compliance", wrong);
  if (const std::string wrong = session::ValidateOutputFile("--json", options.json); !wrong.empty())
    return session::Fail("chart compliance", wrong);
  base::InstallInterrupt();
  ComplianceChart chart{
      .machine = session::MachineName(), .ticks = options.ticks, .costs = {}, .changes = {}};
  for (const auto& [name, cell] : kCells)
    chart.changes.push_back(
        ChangeOf(config::LoadCell(options.config_root / "cells" / (std::string(cell) + ".yaml")), name));
  for (std::size_t i = 0; i < kCells.size(); ++i) chart.changes[i].cell = kCells[i].second;
  chart.costs = TimeLevels(options.config_root, options.ticks);
  if (base::Interrupted()) return base::kExitInterrupted;
  return Write(options, chart);
}

}  // namespace

LevelChange ChangeOf(const config::CellConfig& cell, const std::string& name) {
  const control::ComplianceParams& params = cell.servo.compliance;
  if ((params.tool ? 1 : 0) + (params.layer ? 1 : 0) + (params.mount ? 1 : 0) != 1)
    throw std::invalid_argument("cell: accepted one of tool, layer and mount that gives way");
  LevelChange change{.name = name,
                     .cell = {},
                     .stiffness_N_per_m = cell.servo.coupling.max_stiffness_N_per_m,
                     .error_m = params.noticed_m};
  for (const double force_N : {1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 120.0}) {
    const std::optional<double> gives_m = DisplacementAtRest_m(cell, params, force_N);
    if (!gives_m) break;
    change.force_N.push_back(force_N);
    change.gives_m.push_back(*gives_m);
  }
  const double at_rest_m = DisplacementAtRest_m(cell, params, kPush_N).value();
  for (double hz = 0.2; hz < 51.0; hz *= std::pow(10.0, kDecadeStep)) {
    change.hz.push_back(hz);
    change.felt_ratio.push_back(FeltRatio(cell, params, at_rest_m, hz));
  }
  return change;
}

session::Verdict Judge(const ComplianceChart& chart) {
  session::Verdict verdict;
  int allocations = 0;
  for (const LevelCost& cost : chart.costs) allocations += cost.allocations;
  if (rt::NoAllocScope::Counts() && allocations > 0)
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("{} heap calls or locks in the ticks, accepted none", allocations));
  if (const double added_us = AddedMedian_us(chart.costs.back(), chart.costs.front());
      added_us > kMaxAdded_us)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("all levels together add {:.2f} us to the loop's median, accepted {:g}", added_us,
                            kMaxAdded_us));
  return verdict;
}

int RunChartCompliance(const ComplianceChartOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return session::Fail("chart compliance", error.what());
  } catch (const std::invalid_argument& error) {
    return session::Fail("chart compliance", error.what());
  } catch (const std::runtime_error& error) {
    return session::Fail("chart compliance", error.what(), session::kFailed);
  }
}

}  // namespace osteon::studies
