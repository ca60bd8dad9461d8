#include "report/report.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <system_error>

#include <fmt/format.h>

#include "report/bone_view.h"
#include "report/run_charts.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

// Most quads of the surfaces from which the pictures are made. These surfaces are not stored in the page, so
// the grid can be as fine as that for the tool, except for the largest bones.
constexpr std::size_t kMaxPictureQuads = 2'000'000;

std::string FaultsHtml(const ReportInput& input) {
  if (input.faults.empty()) return {};
  std::string out =
      "<h2>Faults</h2>\n<table>\n<tr><th class=\"n\">time [s]</th><th>fault</th><th>what was "
      "seen</th><th>reaction</th></tr>\n";
  for (const FaultRow& fault : input.faults)
    out +=
        fmt::format("<tr><td class=\"n\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                    Number(fault.time_s, 3), Escape(fault.name), Escape(fault.seen), Escape(fault.reaction));
  return out + "</table>\n";
}

/// Makes a table of the limits that acted; the limit with the longest total time comes first.
std::string LimitsHtml(std::vector<LimitRow> limits) {
  if (limits.empty()) return {};
  std::stable_sort(limits.begin(), limits.end(),
                   [](const LimitRow& a, const LimitRow& b) { return a.total_s > b.total_s; });
  std::string out =
      "<h2>Limits that acted</h2>\n<table>\n<tr><th>limit</th><th class=\"n\">first at [s]</th>"
      "<th class=\"n\">acted for [s]</th><th class=\"n\">longest in a row [s]</th><th "
      "class=\"n\">times</th></tr>\n";
  for (const LimitRow& row : limits)
    out += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td></tr>\n",
        Escape(row.name), Number(row.first_s, 3), Number(row.total_s, 3), Number(row.longest_s, 3),
        row.times);
  return out + "</table>\n";
}

/// Makes the table of the cavity's errors, one row for each way of measuring them.
std::string ErrorTable(const ReportFigures& figures, bool planned) {
  std::string out =
      "<table>\n<tr><th>cavity [mm]</th><th class=\"n\">mean, signed</th><th "
      "class=\"n\">mean size</th>"
      "<th class=\"n\">95 % below</th><th class=\"n\">most over-cut</th><th class=\"n\">most "
      "under-cut</th></tr>\n";
  const auto row = [&out](const char* name, const CavityError& error) {
    out += fmt::format("<tr><td>{}</td>", name);
    for (const double value_m :
         {error.mean_m, error.mean_abs_m, error.p95_m, error.max_over_m, error.max_under_m})
      out += fmt::format("<td class=\"n\">{}</td>",
                         error.samples > 0 ? Number(1e3 * value_m, 3) : "nothing cut");
    out += "</tr>\n";
  };
  row("against the swept tool, along this section", figures.cavity_section);
  row("against the swept tool, over directions in space", figures.cavity_direction);
  row(planned ? "against the planned cavity" : "against the tool's ideal cavity", figures.cavity_ideal);
  return out + "</table>\n";
}

/// Plots the error of the cut surface over the angle about the head's centre.
std::string ErrorChart(const Section& section) {
  Series series{.color = "#0072b2", .width_px = 1.1};
  for (const ErrorSample& sample : section.samples) {
    // the line is interrupted over an uncut range of more than 2°
    const double angle_deg = sample.angle_rad * 180.0 / std::numbers::pi;
    if (!series.x.empty() && angle_deg - series.x.back() > 2.0) {
      series.x.push_back(angle_deg);
      series.y.push_back(std::nan(""));
    }
    series.x.push_back(angle_deg);
    series.y.push_back(1e3 * sample.error_m);
  }
  LineChart chart{.title = "Cavity against swept tool along this section",
                  .x_label = "angle about the head's centre, 0 along the axis into the bone [°]",
                  .y_label = "error [mm]",
                  .series = {std::move(series)},
                  .plot_height_px = 150.0};
  // At the rim whole balls are removed, so the error there has the size of a ball. The axis is cut off below
  // such a peak, so that the rest of the curve can be read.
  const CavityError& error = section.error;
  const double shown_m = 4.0 * error.p95_m;  // largest error that the axis shows if it is cut off
  if (shown_m > 0.0 && std::max(error.max_over_m, -error.max_under_m) > 1.5 * shown_m) {
    chart.y = NiceRange({1e3 * std::max(-shown_m, std::min(error.max_under_m, 0.0)),
                         1e3 * std::min(shown_m, error.max_over_m)},
                        4);
    chart.title += fmt::format(" (peaks run off the axis: {} to {} mm)", Number(1e3 * error.max_under_m, 2),
                               Number(1e3 * error.max_over_m, 2));
  }
  return Svg(chart);
}

/// Makes the histograms of tick and frame times; in virtual time, a note that there are none.
std::string TimingHtml(const ReportInput& input) {
  const std::string wakeup = WakeupHistogram(input.run), compute = ComputeHistogram(input.run);
  const std::string frame = FrameTimeHistogram(input.run);
  std::string out = "<h2>Timing</h2>\n";
  if (wakeup.empty() && compute.empty() && frame.empty())
    return out + "<p>Virtual time: not measured. Ticks and frames ran in lockstep, without a clock.</p>\n";
  out += "<div class=\"pair\">\n";
  for (const std::string* svg : {&wakeup, &compute, &frame})
    if (!svg->empty()) out += Figure(*svg, "");
  return out +
         "</div>\n<p class=\"sub\">Counts on a logarithmic axis, so that a single late tick is seen.</p>\n";
}

/// Lists the figures that are assumed, because no source was found for them.
std::string AssumptionsHtml(const ReportInput& input) {
  const std::vector<std::string> assumptions =
      input.assumptions ? *input.assumptions : simulation::Assumptions(input.bone.materials);
  if (assumptions.empty()) return {};
  std::string out =
      "<h2>Assumed</h2>\n<p>These figures are assumptions, because no source was found; in "
      "brackets, what they are based on.</p>\n<ul>\n";
  for (const std::string& line : assumptions) out += "<li>" + Escape(line) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace

tl::expected<Report, std::string> MakeReport(const ReportInput& input) {
  Report report;

  // make the pictures
  const MaterialMap materials(input.bone.points, input.solid);
  const Camera camera = CupCamera(input.bone, input.pictures);
  std::vector<simulation::ToolPath> paths = input.earlier;
  paths.push_back({.tool = &input.tool, .X_GP = input.X_GP});
  CarveInput carve{.bone = input.bone, .solid = input.solid, .materials = materials, .paths = paths};
  carve.max_quads = kMaxPictureQuads;
  const BoneMeshes meshes = MeshBone(carve);
  const auto before = Picture(RenderBone(input.bone, meshes.before, materials, camera), "Before");
  if (!before) return tl::unexpected(before.error());
  const auto after = Picture(RenderBone(input.bone, meshes.after, materials, camera), "After");
  if (!after) return tl::unexpected(after.error());

  // make the section
  const SectionParams params{.solid = input.solid, .earlier = input.earlier};
  const Section section = ComputeSection(input.bone, input.after, input.tool, input.X_GP, params);
  report.figures.cavity_section = section.error;
  report.figures.cavity_direction =
      CavityErrorByDirection(input.bone, input.after, input.tool, input.X_GP, params);

  const CarvedSurface carved = CarveSurface({.bone = input.bone,
                                             .solid = input.solid,
                                             .materials = materials,
                                             .paths = paths,
                                             .planned = input.planned});
  report.figures.cavity_ideal = carved.error;

  std::string& html = report.html;
  html = PageBegin(
      {.title = input.title, .subtitle = input.subtitle, .verdict = input.verdict, .summary = input.summary});
  html += FaultsHtml(input);
  html += LimitsHtml(input.limits);
  html += "<h2>The bone</h2>\n" + BoneViewHtml(carved, input.bone, input.pictures) +
          "<div class=\"pair\">\n" + *before + *after + "</div>\n";
  std::string tints;
  for (const simulation::Material& material : input.bone.materials)
    tints += (tints.empty() ? "" : ", ") + material.name;
  if (!tints.empty())
    html += fmt::format(
        "<p class=\"sub\">Coloured by material: {}. The pictures show the bone's solid, and the solid less "
        "what the tool's cutting parts swept; the section below shows the balls as they are.</p>\n",
        Escape(tints));
  html += "<h2>Section</h2>\n";
  html +=
      Figure(SectionSvg(section, input.bone),
             "A cut through the bone along the site's axis, in the plane where the tool went farthest from "
             "this axis. The orange line bounds all that the tool's head has swept; a black line on it is a "
             "cut as an ideal tool would leave it.");
  if (section.error.samples > 0)
    html += Figure(SectionDetailSvg(section, input.bone), "") +
            Figure(ErrorChart(section),
                   "Positive: the cavity is larger than the swept tool. Only where bone was cut; at the rim "
                   "the balls that made up the edge are gone.");
  html += ErrorTable(report.figures, static_cast<bool>(input.planned));
  html += "<h2>Force</h2>\n" + Figure(ForceChart(input.run, input.force_limit_N), "");
  html += "<h2>Progress</h2>\n" +
          Figure(ProgressChart(input.run), "Below 0 mm, the tool has not reached the first floor yet.");
  html +=
      "<h2>Motion</h2>\n" +
      Figure(MotionChart(input.run, input.tool_speed_limit_m_per_s, input.max_tool_in_bone_m),
             "The contact model is the simulation's latest picture of the bone. Its age grows until the next "
             "frame arrives, many times a second, and so its line fills a band.");
  if (const std::string chart = ComplianceChart(input.run); !chart.empty())
    html += "<h2>What gave way</h2>\n" +
            Figure(chart, "Sizes of the displacements. A level that never moved in this run is not drawn.");
  html += TimingHtml(input);
  html += AssumptionsHtml(input);
  if (!input.command_line.empty()) html += RepeatSection(input.command_line);
  if (!input.config_text.empty())
    html += "<h2>Configuration</h2>\n<pre>" + Escape(input.config_text) + "</pre>\n";
  if (!input.version.empty()) html += "<footer>Osteon " + Escape(input.version) + "</footer>\n";
  html += PageEnd();
  return report;
}

tl::expected<ReportFigures, std::string> WriteReport(const ReportInput& input,
                                                     const std::filesystem::path& path) {
  const auto report = MakeReport(input);
  if (!report) return tl::unexpected(path.string() + ": " + report.error());
  if (const auto written = WritePage(report->html, path); !written) return tl::unexpected(written.error());
  return report->figures;
}

}  // namespace osteon::report
