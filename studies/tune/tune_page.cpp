#include "studies/tune/tune_page.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/write_text.h"
#include "report/svg_text.h"
#include "session/summary/chart_files.h"

namespace osteon::studies {
namespace {

// The page's pictures as SVG texts; an empty text: not drawn.
struct Pictures {
  std::string map, width, trade, nyquist;
};

std::string GainsText(const TuneGains& gains) {
  return fmt::format("{:.3g} kg and {:.0f} N s/m", gains.mass_kg, gains.damping_Ns_per_m);
}

std::string BoundariesSection(const Pictures& pictures) {
  return "<h2>How stiff a wall may be</h2>\n" +
         report::Figure(pictures.width,
                        "Below a line the tool is calm at the wall, above it the tool oscillates; all at the "
                        "recommended mass. Left of a line's left end the tool oscillates without any wall.") +
         report::Figure(
             pictures.map,
             "How fast the slowest motion of the worst hand dies out; in the grey part it grows. Above a "
             "grey band the loop may be stable again, at walls stiffer than any in use.");
}

std::string MeasuredSection(const TuneResult& r, const Pictures& pictures) {
  return "<h2>By the measured response</h2>\n<p>Within the measured band the arm's own response is used, and "
         "no model. The loop is "
         "stable if its curve does not go around -1; the margins say how far it stays away, ± the radius of "
         "95 %. Every command is as late as the latest.</p>\n" +
         report::Figure(pictures.nyquist, "") + TableOf(r.margins);
}

std::string StiffHandsSection(const TuneResult& r) {
  return "<h2>Stiffer hands, with the vibration index</h2>\n<p>The grip closes on a tool that moves with 40 "
         "mm/s. Force: what the hand feels between 5 and 40 Hz, the greatest effective value over 0.2 s. "
         "Drag: as a multiple of the recommended drag, the greatest, and the mean from 1 s to 10 s.</p>\n" +
         CarriedTable(r);
}

std::string TunePage(const TuneResult& r, const TuneOptions& options, const Pictures& pictures) {
  std::string html =
      report::PageBegin({.title = "Gains for " + r.cell, .verdict = PlainVerdict(r), .summary = Rows(r)});
  if (!pictures.nyquist.empty()) html += MeasuredSection(r, pictures);
  if (!pictures.map.empty()) html += BoundariesSection(pictures);
  html += "<h2>What it costs</h2>\n" +
          report::Figure(
              pictures.trade,
              "The least drag with which the tool is stable in all of these cases, by its virtual mass. A "
              "tool that is too light follows the hand's own mass; a heavy one responds slower than the "
              "arm's lag. A tool below and to the left of both red lines counts as light to the hand.");
  if (!r.stiff_hands.empty()) html += StiffHandsSection(r);
  if (r.MayBeUsed())
    html += "<h2>The recommended gains, as a file (gains.yaml)</h2>\n<pre>" +
            report::Escape(GainsYaml(r, options.command_line)) + "</pre>\n";
  if (r.guidance)
    html +=
        fmt::format(
            "<h2>Guidance of the plan</h2>\n<p>Hands and levers, of {}, that are stable without guidance and "
            "unstable with it. The plan's own gains stand in the middle.</p>\n",
            r.guidance->hands) +
        TableOf(*r.guidance);
  return html + report::RepeatSection(options.command_line) + report::PageEnd();
}

// Says why these gains are safe. @param margin  their gain margin
std::string WhySafeText(const TuneResult& r, double margin) {
  const TuneTask& t = r.task;
  const std::string arm = t.arm_measured ? std::string("the arm's lag is measured")
                                         : std::string("the arm's lag is assumed, not measured");
  return fmt::format(
      "Why: the loop stays stable with every hand up to {:g} N/m, free and at a wall of {:g} N/mm, {:.2f} "
      "times as stiff and heavy; {}.",
      t.human_grip_N_per_m, 1e-3 * t.wall_N_per_m, margin, arm);
}

// Says what to do next. @param own_stable  true: the cell's own gains have the requested margin
std::string NextStepText(const TuneResult& r, bool own_stable) {
  const std::string cell = r.cell;
  if (!own_stable && !r.MayBeUsed())
    return fmt::format(
        "Next: lower what was asked for (--grip, --margin, a softer wall), or make the arm faster, and "
        "run `osteon tune {}` again. Do not let a hand take the handle with these gains.",
        cell);
  const std::string run =
      own_stable ? fmt::format("keep the cell's gains; `osteon run {}` may be used as it is", cell)
                 : fmt::format(
                       "run with `osteon run {} --gains gains.yaml`, or write them into the "
                       "cell's file",
                       cell);
  if (r.task.arm_measured) return "Next: " + run + ".";
  return fmt::format(
      "Next: {}. Before a real arm moves, measure it (`osteon identify {}`) and tune again with "
      "--identified.",
      run, cell);
}

tl::expected<void, std::string> WritePictures(const Pictures& pictures, const TuneOptions& options) {
  for (const auto& [name, svg] : {std::pair{"tune", &pictures.map},
                                  {"tune_width", &pictures.width},
                                  {"tune_trade", &pictures.trade},
                                  {"tune_nyquist", &pictures.nyquist}}) {
    if (svg->empty()) continue;
    if (const auto written = session::WriteDrawing(*svg, options.out / name); !written) return written;
  }
  return {};
}

}  // namespace

report::ReportVerdict PlainVerdict(const TuneResult& r) {
  const session::Verdict verdict = Judge(r);
  const bool own_stable = r.OwnGainsAreStable();
  const TuneGains own{r.task.loop.mass_kg, r.task.loop.damping_Ns_per_m};
  report::ReportVerdict plain = verdict.ForReport();
  std::vector<std::string> reasons;
  if (!r.HasRecommendation()) {
    plain.text = "Not safe: no gains are stable with everything that was asked for";
  } else if (verdict.level == session::VerdictLevel::kBad) {
    plain.text = "Not safe";
  } else {
    plain.text =
        fmt::format("{}: {}", verdict.level == session::VerdictLevel::kGood ? "Safe" : "Safe, with remarks",
                    own_stable ? "the cell's own gains, " + GainsText(own) : GainsText(r.recommended));
  }
  if (own_stable || r.MayBeUsed()) {
    reasons.push_back(
        own_stable ? fmt::format("Which gains: the cell's own, with a gain margin of {:.2f}.{}", r.own_margin,
                                 r.MayBeUsed()
                                     ? fmt::format(" The lightest with the margin that was asked for are {} "
                                                   "(gains.yaml).",
                                                   GainsText(r.recommended))
                                     : "")
                   : fmt::format("Which gains: {} instead of the cell's {}.", GainsText(r.recommended),
                                 GainsText(own)));
    reasons.push_back(WhySafeText(r, own_stable ? r.own_margin : r.recommended_margin));
  }
  for (const std::string& reason : verdict.reasons) reasons.push_back("Remark: " + reason + ".");
  reasons.push_back(NextStepText(r, own_stable));
  plain.reasons = std::move(reasons);
  return plain;
}

tl::expected<void, std::string> WriteGains(const std::filesystem::path& folder, const std::string& yaml) {
  const std::filesystem::path file = folder / "gains.yaml";
  if (!yaml.empty()) return base::WriteText(file, yaml);
  std::error_code none;
  std::filesystem::remove(file, none);
  return {};
}

tl::expected<void, std::string> WriteTuning(const TuneResult& r, const TuneOptions& options) {
  Pictures pictures{.map = r.maps.empty() ? "" : MapSvg(r),
                    .width = r.maps.empty() ? "" : WidthSvg(r),
                    .trade = TradeSvg(r),
                    .nyquist = {}};
  if (!r.margins.empty())
    pictures.nyquist =
        NyquistSvg(r.task, {r.task.loop.mass_kg, r.task.loop.damping_Ns_per_m}, r.recommended, r.margins);
  if (const auto written = WritePictures(pictures, options); !written) return written;
  const std::string json = ToJson(r, options.command_line);
  if (const auto written = base::WriteText(options.out / "tune.csv", BoundaryCsv(r)); !written)
    return written;
  if (const auto written = base::WriteText(options.out / "tune.json", json); !written) return written;
  if (const auto written = WriteGains(options.out, r.MayBeUsed() ? GainsYaml(r, options.command_line) : "");
      !written)
    return written;
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, json); !written) return written;
  return report::WritePage(TunePage(r, options, pictures), options.out / "tune.html");
}

}  // namespace osteon::studies
