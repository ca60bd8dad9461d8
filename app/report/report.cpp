#include "app/report/report.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <system_error>

#include <fmt/format.h>

#include "app/report/png_file.h"
#include "app/report/run_charts.h"
#include "app/report/svg_plot.h"
#include "app/report/svg_text.h"

namespace osteon::app {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #fff; color: #1b1f24; line-height: 1.5; font-size: 15px;
  font-family: system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif; }
main { width: 984px; max-width: 100%; margin: 0 auto; padding: 36px 32px 64px; }
h1 { font-size: 27px; line-height: 1.2; margin: 0 0 4px; letter-spacing: -0.01em; }
h2 { font-size: 18px; margin: 44px 0 10px; padding-bottom: 6px; border-bottom: 1px solid #d9dee3; }
p { margin: 8px 0; max-width: 76ch; }
.sub { color: #59636e; margin: 0 0 18px; }
.verdict { display: inline-block; padding: 5px 13px; border-radius: 999px; font-weight: 600; font-size: 14px; }
.good { background: #e2f2ea; color: #0b5a3c; } .bad { background: #fbe5e3; color: #8c1d18; }
.summary { columns: 2; column-gap: 40px; margin: 18px 0 0; padding: 0; list-style: none; }
.summary li { display: flex; justify-content: space-between; gap: 18px; padding: 5px 0; border-bottom: 1px solid #eceff2;
  break-inside: avoid; }
.summary span { color: #59636e; flex: none; max-width: 60%; }
.summary b { font-weight: 600; text-align: right; overflow-wrap: anywhere; min-width: 0;
  font-variant-numeric: tabular-nums; }
figure { margin: 14px 0 0; break-inside: avoid; }
figure svg, figure img { display: block; max-width: 100%; height: auto; }
figcaption { color: #59636e; font-size: 13.5px; margin-top: 6px; max-width: 92ch; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 20px; }
table { border-collapse: collapse; width: 100%; margin-top: 10px; }
th, td { text-align: left; padding: 6px 14px 6px 0; border-bottom: 1px solid #eceff2; vertical-align: top; }
th { color: #59636e; font-weight: 500; font-size: 13.5px; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
pre { background: #f5f7f9; border-radius: 6px; padding: 12px 14px; font-size: 12.5px; line-height: 1.45;
  white-space: pre-wrap; overflow-wrap: anywhere; }
footer { margin-top: 44px; color: #59636e; font-size: 13px; }
@media (max-width: 700px) { .summary { columns: 1; } .pair { grid-template-columns: 1fr; } main { padding: 20px 16px; } }
@page { size: A4; margin: 14mm; }
@media print { main { width: auto; padding: 0; } body { font-size: 10.5pt; } h2 { break-after: avoid; margin-top: 24px; }
  .verdict { border: 1px solid currentColor; } pre { font-size: 8pt; } }
)";

std::string Figure(const std::string& content, const std::string& caption) {
  return fmt::format("<figure>\n{}{}</figure>\n", content,
                     caption.empty() ? "" : "<figcaption>" + Escape(caption) + "</figcaption>\n");
}

tl::expected<std::string, std::string> Picture(const Image& image, const std::string& caption) {
  const auto png = EncodePng(image);
  if (!png) return tl::unexpected(png.error());
  return Figure(fmt::format(R"(<img width="{}" height="{}" alt="{}" src="data:image/png;base64,{}"/>)"
                            "\n",
                            image.width, image.height, Escape(caption), Base64(*png)),
                caption);
}

std::string Head(const ReportInput& input) {
  std::string out = fmt::format("<header>\n<h1>{}</h1>\n", Escape(input.title));
  if (!input.subtitle.empty()) out += fmt::format("<p class=\"sub\">{}</p>\n", Escape(input.subtitle));
  const std::size_t count = input.faults.size();
  out += fmt::format("<div class=\"verdict {}\">{}</div>\n", count == 0 ? "good" : "bad",
                     count == 0   ? "no faults"
                     : count == 1 ? "1 fault"
                                  : fmt::format("{} faults", count));
  if (!input.summary.empty()) {
    out += "<ul class=\"summary\">\n";
    for (const SummaryRow& row : input.summary)
      out += fmt::format("<li><span>{}</span> <b>{}</b></li>\n", Escape(row.key), Escape(row.value));
    out += "</ul>\n";
  }
  return out + "</header>\n";
}

std::string Faults(const ReportInput& input) {
  if (input.faults.empty()) return {};
  std::string out =
      "<h2>Faults</h2>\n<table>\n<tr><th class=\"n\">time [s]</th><th>fault</th><th>reaction</th></tr>\n";
  for (const FaultRow& fault : input.faults)
    out += fmt::format("<tr><td class=\"n\">{}</td><td>{}</td><td>{}</td></tr>\n", Number(fault.time_s, 3),
                       Escape(fault.name), Escape(fault.reaction));
  return out + "</table>\n";
}

std::string ErrorTable(const ReportFigures& figures) {
  std::string out =
      "<table>\n<tr><th>cavity against swept tool [mm]</th><th class=\"n\">mean, signed</th><th "
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
  row("along this section", figures.cavity_section);
  row("over directions in space", figures.cavity_direction);
  return out + "</table>\n";
}

/// Error of the cut surface over the angle about the head's centre.
std::string ErrorChart(const Section& section) {
  Series series{.color = "#0072b2", .width_px = 1.1};
  for (const ErrorSample& sample : section.samples) {
    // a stretch that was not cut interrupts the line
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
  // at the rim whole balls go with the edge: such a peak must not flatten the rest
  const CavityError& error = section.error;
  const double shown_m = 4.0 * error.p95_m;
  if (shown_m > 0.0 && std::max(error.max_over_m, -error.max_under_m) > 1.5 * shown_m) {
    chart.y = NiceRange({1e3 * std::max(-shown_m, std::min(error.max_under_m, 0.0)),
                         1e3 * std::min(shown_m, error.max_over_m)},
                        4);
    chart.title += fmt::format(" (peaks run off the axis: {} to {} mm)", Number(1e3 * error.max_under_m, 2),
                               Number(1e3 * error.max_over_m, 2));
  }
  return Svg(chart);
}

std::string Timing(const ReportInput& input) {
  const std::string wakeup = WakeupHistogram(input.ticks), compute = ComputeHistogram(input.ticks);
  const std::string frame = FrameTimeHistogram(input.frames);
  std::string out = "<h2>Timing</h2>\n";
  if (wakeup.empty() && compute.empty() && frame.empty())
    return out + "<p>Virtual time: not measured. Ticks and frames ran in lockstep, without a clock.</p>\n";
  out += "<div class=\"pair\">\n";
  for (const std::string* svg : {&wakeup, &compute, &frame})
    if (!svg->empty()) out += Figure(*svg, "");
  return out +
         "</div>\n<p class=\"sub\">Counts on a logarithmic axis, so that a single late tick is seen.</p>\n";
}

/// Figures of the materials that no source was found for.
std::string Assumed(const simulation::Bone& bone) {
  const std::vector<std::string> assumptions = simulation::Assumptions(bone.materials);
  if (assumptions.empty()) return {};
  std::string out =
      "<h2>Assumed</h2>\n<p>No source was found for these figures; in brackets, what was gone "
      "by.</p>\n<ul>\n";
  for (const std::string& line : assumptions) out += "<li>" + Escape(line) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace

tl::expected<Report, std::string> MakeReport(const ReportInput& input) {
  Report report;
  const std::vector<Pose> X_GP = ProxyPath(input.frames, input.X_WG);

  // pictures
  const MaterialMap materials(input.bone.points, input.solid);
  const Camera camera = CupCamera(input.bone, input.pictures);
  const auto before = Picture(RenderBone(input.bone, input.bone.balls, materials, camera), "Before");
  if (!before) return tl::unexpected(before.error());
  const auto after =
      Picture(RenderBone(input.bone, CarvedBalls(input.bone, input.after), materials, camera), "After");
  if (!after) return tl::unexpected(after.error());

  // section
  const Section section = ComputeSection(input.bone, input.after, input.tool, X_GP, {.solid = input.solid});
  report.figures.cavity_section = section.error;
  report.figures.cavity_direction = CavityErrorByDirection(input.bone, input.after, input.tool, X_GP);

  std::string& html = report.html;
  html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n"
      "<style>{}</style>\n</head>\n<body>\n<main>\n",
      Escape(input.title), kStyle);
  html += Head(input);
  html += Faults(input);
  html += "<h2>The bone</h2>\n<div class=\"pair\">\n" + *before + *after + "</div>\n";
  std::string tints;
  for (const simulation::Material& material : input.bone.materials)
    tints += (tints.empty() ? "" : ", ") + material.name;
  if (!tints.empty())
    html += fmt::format(
        "<p class=\"sub\">Coloured by material: {}. The surface is smoothed for the picture; the section "
        "below shows the balls as they are.</p>\n",
        Escape(tints));
  html += "<h2>Section</h2>\n";
  html += Figure(SectionSvg(section, input.bone),
                 "In the plane of the site's axis and of the path's farthest point from it. Balls cut by the "
                 "plane; the swept "
                 "tool is the union of the tool's head over every recorded proxy pose.");
  if (section.error.samples > 0)
    html += Figure(SectionDetailSvg(section, input.bone), "") +
            Figure(ErrorChart(section),
                   "Positive: the cavity is larger than the swept tool. Only where bone was cut; at the rim "
                   "the balls that made up the edge are gone.");
  html += ErrorTable(report.figures);
  html += "<h2>Force</h2>\n" + Figure(ForceChart(input.ticks, input.force_limit_N), "");
  html += "<h2>Progress</h2>\n" + Figure(ProgressChart(input.ticks, input.frames), "");
  html += "<h2>Motion</h2>\n" + Figure(MotionChart(input.ticks, input.tool_speed_limit_m_per_s), "");
  html += Timing(input);
  html += Assumed(input.bone);
  if (!input.command_line.empty())
    html += "<h2>How to repeat it</h2>\n<pre>" + Escape(input.command_line) + "</pre>\n";
  if (!input.config_text.empty())
    html += "<h2>Configuration</h2>\n<pre>" + Escape(input.config_text) + "</pre>\n";
  if (!input.version.empty()) html += "<footer>Osteon " + Escape(input.version) + "</footer>\n";
  html += "</main>\n</body>\n</html>\n";
  return report;
}

tl::expected<ReportFigures, std::string> WriteReport(const ReportInput& input,
                                                     const std::filesystem::path& path) {
  const auto report = MakeReport(input);
  if (!report) return tl::unexpected(path.string() + ": " + report.error());
  std::filesystem::path part = path;
  part += ".part";
  std::ofstream file(part, std::ios::binary);
  file << report->html;
  file.close();
  if (!file) return tl::unexpected(path.string() + ": cannot write the report");
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error) return tl::unexpected(path.string() + ": " + error.message());
  return report->figures;
}

}  // namespace osteon::app
