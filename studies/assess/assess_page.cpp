#include "studies/assess/assess_page.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/units.h"
#include "report/bone_view.h"
#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "studies/assess/assess_pictures.h"
#include "studies/assess/unfinished.h"

namespace osteon::studies {
namespace {

// Inclination and anteversion of an axis, by the plan's definition: "40.0° / 15.0° (radiographic)".
std::string AnglesText(const procedure::SurgicalPlan& plan, const Vector3& axis_G) {
  const procedure::CupAngles angles = procedure::AnglesOf(plan.definition, plan.pelvis.FromG(axis_G));
  return fmt::format("{:.1f}° / {:.1f}° ({})", angles.inclination_rad / kDegree,
                     angles.anteversion_rad / kDegree, procedure::NameOf(plan.definition));
}

// Says where the cup's axis lies relative to the plan's cup_cone, as the end of a sentence. Empty if the plan
// has no cup_cone.
std::string CupConeText(const procedure::SurgicalPlan& plan, const procedure::Assessment& found) {
  const std::string place = CupConePlace(plan, found);
  const procedure::GuidanceGains::CupCone& cone = plan.guidance.cup_cone;
  if (place.empty()) return "";
  if (place == "free") return fmt::format("; within {:g}°, as planned", cone.free_rad / kDegree);
  return fmt::format("; {} the plan's {:g}°", place == "within stop" ? "within" : "beyond",
                     cone.stop_rad / kDegree);
}

// Adds the rows that the summary has only for the plan of an opening: axis, place, floor and roof.
void AddOpening(const procedure::SurgicalPlan& plan, const procedure::Assessment& found,
                std::vector<report::SummaryRow>& rows) {
  const procedure::OpeningResult& opening = *found.opening;
  if (const auto error_rad = procedure::AxisError(plan, found))
    rows.push_back({"Axis", fmt::format("{:.1f}° off the plan", *error_rad / kDegree)});
  if (opening.shift_m)
    rows.push_back({"Opening", fmt::format("{:.2f} mm aside of the planned axis", 1e3 * *opening.shift_m)});
  if (const auto& error_m = opening.depth_error_m)
    rows.push_back({"Floor", fmt::format("{:.2f} mm {} planned", 1e3 * std::abs(*error_m),
                                         *error_m < 0.0 ? "less deep than" : "deeper than")});
  if (opening.unroofed)
    rows.push_back({fmt::format("Roof over the {}", plan.target),
                    fmt::format("{:.0f} % of it is open within the plan", 1e2 * *opening.unroofed)});
}

// Says how much bone of the planned cavity is left, and why.
std::string BoneLeftText(const AssessedSession& session) {
  const procedure::SurgicalPlan& plan = session.plan.plan;
  const procedure::CavityResult& cavity = session.assessment.cavity;
  const double planned_m3 = cavity.PlannedVolume_m3();
  std::string text = fmt::format("{:.0f} of {:.0f} mm³ that the plan takes away are still there",
                                 1e9 * cavity.under_m3, 1e9 * planned_m3);
  if (!session.assessment.opening) {
    const double hemisphere_m2 = 2.0 * std::numbers::pi * plan.cavity().radius_m * plan.cavity().radius_m;
    text += fmt::format(", as much as a layer of {:.2f} mm over the whole planned hemisphere",
                        1e3 * cavity.under_m3 / hemisphere_m2);
  }
  const auto to_go_mm = ToGoOfLastTool_mm(plan, session.file.passes);
  if (!to_go_mm) return text;
  const char* tool = session.assessment.opening ? "burr" : "reamer";
  return *to_go_mm >= 0.05 ? text + fmt::format("; the last {} stopped {:.1f} mm short of its planned depth",
                                                tool, *to_go_mm)
                           : text + fmt::format("; the last {} came to its planned depth", tool);
}

// The rows of the page's summary.
std::vector<report::SummaryRow> Rows(const AssessResult& result) {
  const AssessedSession& session = result.session;
  const procedure::SurgicalPlan& plan = session.plan.plan;
  const procedure::Assessment& found = session.assessment;
  std::vector<report::SummaryRow> rows{
      {"Score", fmt::format("{:.1f} of 100, {}", result.score.total,
                            result.guided ? fmt::format("guided (gain {:g}): not to be ranked with sessions "
                                                        "without guidance",
                                                        session.guidance_gain)
                                          : "without guidance")},
      {"Plan", found.opening ? fmt::format("{}, an opening of {:.4g} mm to the {}", plan.name,
                                           2e3 * plan.cavity().opening_radius_m(), plan.target)
                             : fmt::format("{}, {} hip, {}", plan.name, procedure::NameOf(plan.side),
                                           AnglesText(plan, plan.axis_G))}};
  if (found.opening)
    AddOpening(plan, found, rows);
  else if (found.axis_G)
    rows.push_back({found.axis_of_cup ? "Axis of the cup" : "Reamed axis",
                    fmt::format("{}, {:.1f}° off{}", AnglesText(plan, *found.axis_G),
                                *procedure::AxisError(plan, found) / kDegree, CupConeText(plan, found))});
  if (const auto& fit = found.cavity.fit) {
    rows.push_back({"Diameter", fmt::format("{:.2f} ± {:.2f} mm, planned {:g} mm", 2e3 * fit->radius_m,
                                            2e3 * fit->radius_sd_m, 2e3 * plan.cavity().radius_m)});
    const auto along = [](double shift_m, const char* ahead, const char* behind) {
      return fmt::format("{:.1f} mm {}", 1e3 * std::abs(shift_m), shift_m < 0.0 ? behind : ahead);
    };
    const auto shift = [&along](const procedure::AnatomicShift& s) {
      return fmt::format("{}, {}, {}", along(s.medial_m, "medial", "lateral"),
                         along(s.superior_m, "superior", "inferior"),
                         along(s.posterior_m, "posterior", "anterior"));
    };
    rows.push_back({"Centre against the plan", shift(found.cavity.from_plan)});
    rows.push_back({"Centre against the native one", shift(found.cavity.from_native)});
  }
  rows.push_back({"Thinnest wall", found.min_wall_m ? fmt::format("{:.1f} mm", 1e3 * *found.min_wall_m)
                                                    : std::string("not watched")});
  rows.push_back({"Removed", fmt::format("{:.0f} mm³, {:.0f} mm³ of it outside of the plan (over-reamed)",
                                         1e9 * found.cavity.removed_m3, 1e9 * found.cavity.over_m3)});
  rows.push_back({"Bone left (under-reamed)", BoneLeftText(session)});
  rows.push_back({"Time", fmt::format("{:.1f} s, {:.1f} s cutting, passes: {}", found.process.time_s,
                                      found.process.cutting_s, session.passes.size())});
  return rows;
}

// Begins a table with its heading. Wide tables scroll by themselves on a narrow screen.
std::string TableHead(std::initializer_list<const char*> names) {
  std::string html = "<div style=\"overflow-x:auto\"><table><thead><tr>";
  for (const char* name : names) html += fmt::format("<th>{}</th>", name);
  return html + "</tr></thead><tbody>\n";
}

// The table of all metrics with their points; below it the published shifts and the deductions.
std::string ItemsTable(const AssessResult& result) {
  std::string html = TableHead({"figure", "value", "full points, none", "points", "experts here", "source"});
  for (const procedure::Metric& metric : procedure::Metrics()) {
    const auto value = result.values.find(metric.name);
    const auto scored = std::ranges::find_if(result.score.items, [&](const procedure::ScoredItem& item) {
      return item.item.metric == metric.name;
    });
    const bool has_norm = scored != result.score.items.end();
    const auto norm = result.norms.find(metric.name);
    if (value == result.values.end() && !has_norm) continue;  // the metric belongs to the other kind of plan
    html += fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        report::Escape(metric.text),
        value != result.values.end() ? report::Escape(ValueText(value->second, metric)) : "not measured",
        has_norm ? report::Escape(ValueText(scored->item.full, metric) + ", " +
                                  ValueText(scored->item.zero, metric))
                 : "no norm",
        has_norm && scored->item.weight > 0.0
            ? fmt::format("{:.1f} of {:g}", scored->points, scored->item.weight)
            : "shown only",
        norm != result.norms.end()
            ? fmt::format("{} (median of {})", report::Escape(ValueText(norm->second.median, metric)),
                          norm->second.sessions)
            : "",
        has_norm ? report::Escape(scored->item.source) : "");
  }
  for (const procedure::PublishedShift& published : procedure::PublishedShifts(result.session.assessment))
    html += fmt::format(
        "<tr><td>{} shift, as published</td><td>{}</td><td>peripheral reaming {:.1f} ± {:.1f} mm, standard "
        "{:.1f} "
        "± {:.1f} mm</td><td>shown only</td><td></td><td>{}</td></tr>\n",
        published.direction, report::Number(1e3 * published.value_m) + " mm",
        1e3 * published.peripheral.mean_m, 1e3 * published.peripheral.sd_m, 1e3 * published.standard.mean_m,
        1e3 * published.standard.sd_m, published.source);
  for (const procedure::Deduction& deduction : result.score.deductions)
    html += fmt::format("<tr><td>{}</td><td></td><td></td><td>-{:g}</td><td></td><td>{}</td></tr>\n",
                        report::Escape(deduction.name), deduction.points, report::Escape(deduction.source));
  return html + "</tbody></table></div>\n";
}

std::string PassTable(const AssessedSession& session) {
  std::string html =
      TableHead({"pass", "tool", "time", "removed", "mean force", "peak", "across the axis", "outside"});
  for (const PassFigures& pass : session.passes)
    html += fmt::format(
        "<tr><td>{}{}</td><td>{:g} mm</td><td>{:.1f} s</td><td>{:.0f} mm³</td><td>{:.0f} N</td><td>{:.0f} "
        "N</td><td>{:.2f}</td><td>{:.1f} s</td></tr>\n",
        pass.pass.number, pass.pass.undone ? " (undone)" : "",
        session.file.diameters_mm[static_cast<std::size_t>(pass.pass.tool_index)], pass.figures.time_s,
        pass.pass.removed_mm3, pass.figures.force_mean_N, pass.figures.force_peak_N, pass.figures.wrong_way,
        pass.figures.outside_s);
  return html + "</tbody></table></div>\n";
}

// Curves of height, distance from the axis, force and tilt over the session, with its passes.
std::string Curves(const AssessedSession& session) {
  const SessionTrace& trace = session.trace;
  const procedure::GuidanceGains& gains = session.plan.plan.guidance;
  std::vector<report::NamedSpan> spans;
  for (const PassFigures& pass : session.passes)
    spans.push_back({.begin = pass.begin_s,
                     .end = pass.end_s,
                     .name = fmt::format(
                         "{:g}", session.file.diameters_mm[static_cast<std::size_t>(pass.pass.tool_index)])});
  std::vector<report::LimitLine> tilts;
  if (gains.cone.stop_rad > 0.0)
    tilts = {{gains.cone.free_rad / kDegree, "free"}, {gains.cone.stop_rad / kDegree, "stop"}};
  const auto panel = [&](const char* label, const std::vector<double>& y,
                         std::vector<report::LimitLine> limits) {
    return report::LineChart{.y_label = label,
                             .series = {{.x = trace.t_s, .y = y}},
                             .limits = std::move(limits),
                             .spans = spans,
                             .legend = false,
                             .plot_height_px = 130.0};
  };
  std::vector<report::LineChart> panels{panel("height [mm]", trace.height_mm, {{0.0, "planned centre"}}),
                                        panel("aside [mm]", trace.aside_mm, {}),
                                        panel("hand's force [N]", trace.force_N, {}),
                                        panel("tilt [°]", trace.tilt_deg, std::move(tilts))};
  // Limit the drawn range: far retractions would flatten the rest of the curve.
  const bool is_cup = session.plan.plan.kind == procedure::PlanKind::kCup;
  const double shown_aside_mm = is_cup ? 15.0 : 4.0;
  panels[0].y = is_cup ? report::Range{-10.0, 40.0} : report::Range{-2.0, 14.0};
  panels[0].series[0].name = "handle";
  panels[0].series.push_back({.name = "simulated tool", .x = trace.t_s, .y = trace.proxy_mm});
  panels[0].legend = true;
  panels[1].y = report::Range{0.0, shown_aside_mm};
  if (!trace.free_mm.empty()) {
    panels[1].series[0].name = "handle";
    panels[1].series.push_back(
        {.name = "corridor, free", .x = trace.t_s, .y = trace.free_mm, .color = report::kPalette[2]});
    panels[1].series.push_back({.name = "corridor, the spindle stops",
                                .x = trace.t_s,
                                .y = trace.stop_mm,
                                .color = report::kPalette[1],
                                .dash = "5 4"});
    panels[1].legend = true;
  }
  panels[0].zooms = true;
  panels.back().x_label = "time [s]";
  return report::Figure(
      report::Svg(panels),
      "Height of the head's centre over the planned one, its distance from the axis, the hand's force, "
      "the tool's tilt. Shaded: the passes, by the tool's diameter in mm. The corridor widens with the "
      "height, so its lines move with the tool.");
}

std::string TrendSection(const AssessResult& result) {
  if (result.trend.points.size() < 2) return "";
  report::Series free{.name = "without guidance", .marker = report::Marker::kCircle},
      guided{.name = "guided", .marker = report::Marker::kCircle};
  for (std::size_t i = 0; i < result.trend.points.size(); ++i) {
    const TrendPoint& point = result.trend.points[i];
    report::Series& series = point.guided ? guided : free;
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(point.score);
    series.labels.push_back(point.session + (point.finished.value_or(true) ? "" : " (not finished)"));
  }
  report::LineChart chart{
      .x_label = result.trend.by_time ? "session, by its beginning" : "session, by the folder's name",
      .y_label = "score",
      .x = report::Range{0.5, static_cast<double>(result.trend.points.size()) + 0.5},
      .y = report::Range{0.0, 100.0}};
  for (report::Series* series : {&free, &guided})
    if (!series->x.empty()) chart.series.push_back(std::move(*series));
  return "<h2>Trend</h2>\n" +
         report::Figure(
             report::Svg(chart),
             "Sessions of the same plan in the folders beside this one, and those that were named.") +
         "<p>Table: " + report::FileLink(kTrendName) + "</p>\n";
}

std::string Assumptions(procedure::PlanKind kind) {
  const char* of_kind =
      kind == procedure::PlanKind::kCup
          ? "<li>Norms are published figures of real operations and of other simulators; none was measured "
            "with Osteon. The norm of over-reaming is assumed.</li>\n"
            "<li>A sphere has no axis: the reamed axis is that of the tool, weighted by the volume that the "
            "last reamer removed.</li>\n"
          : "<li>Norms of axis and place lean on published access cavities; depth, roof and volumes are "
            "assumed. None was measured with Osteon.</li>\n"
            "<li>The axis is that of the tool, weighted by the volume that the last burr removed. The "
            "target's own tissue counts as neither over-reamed nor left.</li>\n";
  return fmt::format(
      "<h2>Assumptions</h2>\n<ul>\n{}"
      "<li>Volumes are sums of mass points: exact to about 2 % of a few cubic centimetres.</li>\n"
      "<li>Undone passes count for time and force, and not for the result.</li>\n"
      "<li>Osteon is no medical device; a score says nothing of a patient.</li>\n</ul>\n",
      of_kind);
}

// The carved bone as a picture that the reader can turn, coloured by the surface's distance from the planned
// cavity.
std::string CarvedBone(const AssessedSession& session) {
  const std::vector<simulation::ToolPath> paths = session.cut->paths();
  if (paths.empty()) return "";
  const procedure::PlannedCavity cavity = session.plan.plan.cavity();
  // half of the limit for a run's page, because this page should open on a phone
  constexpr std::size_t kMaxQuads = 60'000;
  const report::CarvedSurface carved =
      report::CarveSurface({.bone = session.bone,
                            .solid = session.solid.get(),
                            .materials = report::MaterialMap(session.bone.points, session.solid.get()),
                            .paths = paths,
                            .planned = [cavity](const Vector3& p_m) { return cavity.DistanceTo(p_m); },
                            .max_quads = kMaxQuads});
  return report::BoneViewHtml(
      carved, session.bone, {},
      {.shows_deviation = true, .range_mm = DeviationScale_mm(session.plan.plan.kind)});
}

// The section of the page with the carved bone and the slices. Returns an error if a picture could not be
// encoded.
tl::expected<std::string, std::string> Pictures(const AssessedSession& session) {
  const std::string& target = session.plan.plan.target;
  std::string html =
      "<h2>The cavity</h2>\n" + CarvedBone(session) +
      "<p>Line: the plan. Sand: bone left. Pale: removed as planned. Orange: removed beyond the plan. Blue: "
      "left within it." +
      (target.empty() ? "" : " Pink: " + report::Escape(target) + ".") +
      "</p>\n<div "
      "style=\"display:grid;grid-template-columns:repeat(auto-fit,minmax(260px,1fr));gap:16px\">\n";
  for (const CavityPicture& shown : CavityPictures(session)) {
    const auto picture = report::Picture(shown.image, shown.caption);
    if (!picture) return picture;
    html += *picture;
  }
  return html + "</div>\n";
}

}  // namespace

std::string ValueText(double si, const procedure::Metric& metric) {
  const std::string_view unit = metric.unit;
  const double value = si * metric.to_unit;
  if (unit == "ratio") return report::Number(1e2 * value, 1) + " %";
  if (unit == "deg") return report::Number(value, 1) + "°";
  if (unit == "mm3") return report::Number(value, std::abs(value) < 10.0 ? 1 : 0) + " mm³";
  return report::Number(value, unit == "mm" ? 2 : 1) + " " + metric.unit;
}

std::string NameOfSession(const AssessedSession& session) { return NameOfFolder(session.folder); }

tl::expected<void, std::string> WriteAssessPage(const AssessResult& result, const session::Verdict& verdict,
                                                const std::string& command_line,
                                                const std::filesystem::path& path) {
  const auto pictures = Pictures(result.session);
  if (!pictures) return tl::make_unexpected(pictures.error());
  std::string html = report::PageBegin({.title = fmt::format("Assessment: {}", result.session.plan.plan.name),
                                        .subtitle = result.session.folder.filename().string(),
                                        .verdict = verdict.ForReport(),
                                        .summary = Rows(result)});
  html += *pictures;
  html += "<h2>The session</h2>\n" + Curves(result.session) + PassTable(result.session);
  html += fmt::format("<h2>The score: {:.1f}</h2>\n", result.score.total) + ItemsTable(result);
  html += TrendSection(result) + Assumptions(result.session.plan.plan.kind);
  if (!command_line.empty()) html += report::RepeatSection(command_line);
  return report::WritePage(html + report::PageEnd(), path);
}

}  // namespace osteon::studies
