#include "studies/tune/overlay_tuning.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/write_text.h"
#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "session/summary/chart_files.h"
#include "studies/tune/tune_page.h"

namespace osteon::studies {
namespace {

// Accepted relative difference between the measured mass along z and the mass of the arm's model.
constexpr double kMaxMassOff = 0.15;

}  // namespace

session::Verdict Judge(const OverlayTuning& t) {
  session::Verdict verdict;
  if (!t.HasRecommendation()) {
    verdict.Add(session::VerdictLevel::kBad, "no stiffness and damping stand what was asked");
    return verdict;
  }
  if (!t.check.grew.empty())
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("run in time with the recommended gains, {} of {} runs grew: {}",
                            t.check.grew.size(), t.check.runs, fmt::join(t.check.grew, "; ")));
  JudgeMargins(t.margins, verdict);
  if (t.recommended_N_per_m < t.task.wall_N_per_m)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("the cell's coupling of {:g} N/mm stands with no damping, {:.3g} N/mm does",
                            1e-3 * t.task.wall_N_per_m, 1e-3 * t.recommended_N_per_m));
  if (t.planes_N_per_m < t.task.plane_N_per_m)
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("planes that move with the tool and are {:g} ms old stand {:.3g} N/mm of the {:.3g} "
                    "that the force limit over the head's radius makes: across the contact press with "
                    "at most {:.0f} % of the force limit, or keep the model younger",
                    1e3 * t.task.worst_age_s, 1e-3 * t.planes_N_per_m, 1e-3 * t.task.plane_N_per_m,
                    100.0 * t.planes_N_per_m / t.task.plane_N_per_m));
  if (t.along_tool_kg > 0.0 && !(std::abs(t.along_tool_kg / t.mass_kg - 1.0) <= kMaxMassOff))
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("a force was measured to move {:.2f} kg along z, and the arm's masses give {:.2f} "
                    "kg: the tool's mass, or the robot's file, is off",
                    t.along_tool_kg, t.mass_kg));
  if (t.task.identified && !t.measured && t.task.identified->response.empty())
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format(
            "identified: found {}, and no arm: dead time and springs are the cell's, assumed; measure "
            "them by `osteon identify {}`",
            FiguresBesideArm(*t.task.identified), t.cell));
  else if (t.task.identified && !t.measured)
    verdict.Add(session::VerdictLevel::kWarning,
                "identified: found no model of the arm that holds: dead time and springs are the cell's, "
                "assumed; measure again, faster");
  if (t.on_mount)
    verdict.Add(
        session::VerdictLevel::kWarning,
        "the arm was measured on a mount that gives way, and stands on a rigid one here: make the mount "
        "stiffer, or try the gains in small steps");
  if (!(t.own_margin >= t.task.margin))
    verdict.Add(
        session::VerdictLevel::kWarning,
        t.own_margin > 0.0
            ? fmt::format("the cell's own gains have a gain margin of {:.2f}, {:g} asked for", t.own_margin,
                          t.task.margin)
            : std::string("the cell's own gains are not stable with all of these hands and contacts"));
  return verdict;
}

std::vector<report::SummaryRow> Rows(const OverlayTuning& t) {
  const TuneTask& task = t.task;
  std::vector<report::SummaryRow> rows{
      {"Cell",
       fmt::format(
           "{}: impedance law, overlay of {}, {:g} ms dead time, {:.2f} kg along the tool without the "
           "hand, period {:g} ms",
           t.cell, t.loop.torque ? "torques" : "a wrench", 1e3 * t.loop.arm.dead_cycles * t.loop.period_s,
           t.mass_kg, 1e3 * t.loop.period_s)},
      {"Must be stable with",
       fmt::format("hands up to {:g} N/m, free and at a wall of {:g} N/mm; {:g} ms jitter; gain margin {:g}",
                   task.human_grip_N_per_m, 1e-3 * task.wall_N_per_m,
                   1e3 * task.command_jitter * t.loop.period_s, task.margin)},
      {"The cell's own gains",
       fmt::format("coupling {:g} N/mm, damping {:.0f} N s/m: {}", 1e-3 * task.wall_N_per_m, t.own_damping(),
                   t.own_margin > 0.0 ? fmt::format("gain margin {:.2f}", t.own_margin)
                                      : std::string("not stable with all of these"))},
      {"Recommended",
       t.HasRecommendation()
           ? fmt::format("coupling {:.3g} N/mm, damping {:.0f} N s/m, gain margin {:.2f}",
                         1e-3 * t.recommended_N_per_m, t.recommended_Ns_per_m, t.recommended_margin)
           : std::string("none")}};
  if (t.measured)
    rows.push_back(
        {"Measured arm",
         fmt::format("along {}: a force moves {:.2f} kg, with {:.2f} Hz and damping {:.2f} of the arm's own "
                     "impedance, after {:.2f} ms; {}",
                     t.measured->axis, *t.measured->felt_mass_kg, t.measured->bandwidth_hz,
                     t.measured->damping_ratio, 1e3 * t.measured->dead_time_s,
                     t.loop.torque
                         ? fmt::format("joints' springs {:.4g} N m/rad", t.loop.arm.stiffness_Nm_per_rad[0])
                         : fmt::format("springs {:.4g} N/m and {:.3g} N m/rad", t.loop.arm.stiffness_N_per_m,
                                       t.loop.arm.stiffness_Nm_per_rad_turn))});
  if (t.HasRecommendation())
    rows.push_back({"Old planes", fmt::format("{}{:.3g} N/mm at {:g} ms",
                                              t.planes_N_per_m < task.plane_N_per_m ? "" : "at least ",
                                              1e-3 * t.planes_N_per_m, 1e3 * task.worst_age_s)});
  AddMarginRows(t.margins, rows);
  if (t.check.runs > 0)
    rows.push_back({"Simulated", t.check.grew.empty()
                                     ? fmt::format("{} runs of the arm with masses; none grew", t.check.runs)
                                     : fmt::format("in {} of {} runs it grew: {}", t.check.grew.size(),
                                                   t.check.runs, fmt::join(t.check.grew, "; "))});
  return rows;
}

namespace {

// The text of gains.yaml with the recommended coupling.
std::string GainsYaml(const OverlayTuning& t, const std::string& command_line) {
  return fmt::format(
      "# {}\n# Stands hands up to {:g} N/m with gain margin {:.2f}. For: osteon run CELL.yaml --gains "
      "THIS_FILE\n"
      "# The law's damping is a key of the cell: impedance: damping_Ns_per_m: [{b:.10g}, {b:.10g}, "
      "{b:.10g}]\n"
      "coupling:\n  stiffness_N_per_mm: {:.10g}\n",
      command_line, t.task.human_grip_N_per_m, t.recommended_margin, 1e-3 * t.recommended_N_per_m,
      fmt::arg("b", t.recommended_Ns_per_m));
}

std::string ToJson(const OverlayTuning& t, const std::string& command_line) {
  const TuneTask& task = t.task;
  nlohmann::json json{{"schema", "osteon.tune/1"},
                      {"subcommand", "tune"},
                      {"command_line", command_line},
                      {"cell", t.cell},
                      {"law", "impedance"},
                      {"arm",
                       {{"mass_kg", t.mass_kg},
                        {"dead_cycles", t.loop.arm.dead_cycles},
                        {"overlay", t.loop.torque ? "torque" : "wrench"},
                        {"period_ms", 1e3 * t.loop.period_s}}},
                      {"stands",
                       {{"grip_N_per_m", task.human_grip_N_per_m},
                        {"wall_N_per_m", task.wall_N_per_m},
                        {"plane_N_per_m", task.plane_N_per_m},
                        {"worst_age_ms", 1e3 * task.worst_age_s},
                        {"jitter_ms", 1e3 * task.command_jitter * t.loop.period_s}}},
                      {"margin", task.margin},
                      {"identified", t.task.identified.has_value()},
                      {"arm_measured", t.measured.has_value()},
                      {"own",
                       {{"damping_Ns_per_m", t.own_damping()},
                        {"stiffness_N_per_m", task.wall_N_per_m},
                        {"margin", t.own_margin}}},
                      {"recommended", nullptr},
                      {"boundary", nlohmann::json::array()},
                      {"margins", ToJson(t.margins)},
                      {"check", {{"runs", t.check.runs}, {"grew", t.check.grew}}}};
  if (t.HasRecommendation())
    json["recommended"] = {{"damping_Ns_per_m", t.recommended_Ns_per_m},
                           {"stiffness_N_per_m", t.recommended_N_per_m},
                           {"margin", t.recommended_margin},
                           {"planes_N_per_m", t.planes_N_per_m}};
  for (const OverlayBoundary& b : t.boundary)
    json["boundary"].push_back({{"damping", b.damping_Ns_per_m},
                                {"stiffness_predicted", b.predicted_N_per_m},
                                {"stiffness_simulated", b.simulated_N_per_m},
                                {"hand", t.hands[b.hand].name}});
  return session::ResultText(Judge(t), json);
}

// Draws the stiffest stable wall over the law's damping: predicted by the linear loop, and simulated.
std::string BoundarySvg(const OverlayTuning& t) {
  report::LineChart chart{.title = "Greatest wall stiffness with the impedance law",
                          .x_label = "damping of the law [N s/m]",
                          .y_label = "stiffness of the wall [kN/m]",
                          .y_from_zero = false,
                          .log_x = true,
                          .log_y = true,
                          .plot_height_px = 330.0};
  report::Series predicted{.name = "predicted", .width_px = 2.0};
  report::Series simulated{.name = "simulated", .width_px = 0.0, .marker = report::Marker::kRing};
  // converts to [kN/m]; draws no point if the loop is unstable without a wall
  const auto shown = [](double N_per_m) {
    return N_per_m > 0.0 ? 1e-3 * N_per_m : std::numeric_limits<double>::quiet_NaN();
  };
  for (const OverlayBoundary& b : t.boundary) {
    predicted.x.push_back(b.damping_Ns_per_m);
    predicted.y.push_back(shown(b.predicted_N_per_m));
    simulated.x.push_back(b.damping_Ns_per_m);
    simulated.y.push_back(shown(b.simulated_N_per_m));
  }
  chart.series = {predicted, simulated};
  if (t.HasRecommendation())
    chart.series.push_back({.name = "recommended",
                            .x = {t.recommended_Ns_per_m},
                            .y = {1e-3 * t.recommended_N_per_m},
                            .color = "#d55e00",
                            .width_px = 0.0,
                            .marker = report::Marker::kDiamond});
  chart.limits = {{.value = 1e-3 * t.task.wall_N_per_m, .label = "the cell's wall"}};
  return report::Svg(chart);
}

// The verdict as the page shows it: in plain words, with the reason and the next step.
report::ReportVerdict PlainVerdict(const OverlayTuning& t) {
  const session::Verdict verdict = Judge(t);
  report::ReportVerdict plain = verdict.ForReport();
  std::vector<std::string> reasons;
  if (!t.HasRecommendation() || verdict.level == session::VerdictLevel::kBad) {
    plain.text = "Not safe";
  } else {
    plain.text = fmt::format("{}: coupling {:.3g} N/mm with damping {:.0f} N s/m",
                             verdict.level == session::VerdictLevel::kGood ? "Safe" : "Safe, with remarks",
                             1e-3 * t.recommended_N_per_m, t.recommended_Ns_per_m);
    reasons.push_back(fmt::format(
        "Why: the loop stays stable with every hand up to {:g} N/m, free and at the wall, {:.2f} times as "
        "stiff and heavy. The arm's dead time and its own damping are {}.{}",
        t.task.human_grip_N_per_m, t.recommended_margin, t.measured ? "measured" : "assumed, not measured",
        t.response.empty() ? "" : " The measured response, without a model of the axis, says so too."));
  }
  for (const std::string& reason : verdict.reasons) reasons.push_back("Remark: " + reason + ".");
  reasons.push_back(t.MayBeUsed()
                        ? fmt::format("Next: run with `osteon run {} --gains gains.yaml`, and set the law's "
                                      "damping in the cell's file (its comment says how).",
                                      t.cell)
                        : std::string("Next: soften the coupling, or ask for less (--grip, --margin)."));
  plain.reasons = std::move(reasons);
  return plain;
}

}  // namespace

tl::expected<void, std::string> Write(const OverlayTuning& t, const TuneOptions& options) {
  const std::string svg = BoundarySvg(t), json = ToJson(t, options.command_line);
  if (const auto written = session::WriteDrawing(svg, options.out / "tune"); !written) return written;
  std::string csv = "damping_Ns_per_m,predicted_N_per_m,simulated_N_per_m\n";
  for (const OverlayBoundary& b : t.boundary)
    csv +=
        fmt::format("{:.3f},{:.0f},{:.0f}\n", b.damping_Ns_per_m, b.predicted_N_per_m, b.simulated_N_per_m);
  if (const auto written = base::WriteText(options.out / "tune.csv", csv); !written) return written;
  if (const auto written = base::WriteText(options.out / "tune.json", json); !written) return written;
  if (const auto written = WriteGains(options.out, t.MayBeUsed() ? GainsYaml(t, options.command_line) : "");
      !written)
    return written;
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, json); !written) return written;
  std::string html =
      report::PageBegin({.title = "Gains for " + t.cell, .verdict = PlainVerdict(t), .summary = Rows(t)});
  html += "<h2>How stiff a wall may be</h2>\n" +
          report::Figure(
              svg,
              "The stiffest wall with the worst hand. Damping beyond the line's right end oscillates by its "
              "own delay, whatever the wall.");
  if (!t.margins.empty())
    html +=
        "<h2>By the measured response</h2>\n<p>Along each measured axis the arm's own response is used, and "
        "its model in the other directions. The loop is stable if its curve does not go around -1. The "
        "margins "
        "are those of wall and damping, ± the radius of 95 %. Every command is as late as the "
        "latest.</p>\n" +
        report::Figure(t.nyquist_svg, "") + TableOf(t.margins);
  if (t.MayBeUsed())
    html += "<h2>The recommended gains, as a file (gains.yaml)</h2>\n<pre>" +
            report::Escape(GainsYaml(t, options.command_line)) + "</pre>\n";
  html += report::RepeatSection(options.command_line) + report::PageEnd();
  return report::WritePage(html, options.out / "tune.html");
}

}  // namespace osteon::studies
