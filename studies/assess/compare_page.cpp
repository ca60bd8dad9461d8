#include "studies/assess/compare_page.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_frame.h"
#include "report/svg_raster.h"
#include "report/svg_text.h"
#include "studies/assess/assess_page.h"
#include "studies/assess/assess_pictures.h"

namespace osteon::studies {
namespace {

// Sizes of the drawing [px]: pictures and the gap between them, width of the points' column, head with the
// titles, foot with the legend; then a session's least height, a bar, an item, and the lines with score and
// mark.
constexpr double kPicturePx = 220.0, kPictureGapPx = 14.0, kPointsPx = 330.0, kHeadPx = 34.0, kFootPx = 34.0;
constexpr double kSessionPx = 276.0, kBarPx = 130.0, kItemPx = 35.0, kScorePx = 26.0, kMarkPx = 18.0;
constexpr double kWidthPx = kPointsPx + 3.0 * (kPicturePx + kPictureGapPx) + kPictureGapPx;
constexpr double kComparisonScale = 1.5;  // pixels of the PNG per px of the SVG

// An SVG element of the picture with its upper left corner at (x, y).
tl::expected<std::string, std::string> PictureAt(double x, double y, const report::Image& image) {
  const auto png = report::EncodePng(image);
  if (!png) return tl::make_unexpected(png.error());
  return fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" "
      "href=\"data:image/png;base64,{}\"/>\n",
      report::Pixels(x), report::Pixels(y), report::Pixels(kPicturePx), report::Pixels(kPicturePx),
      report::Base64(*png));
}

// The items of a score, drawn from the height y downwards. Each scored item has a bar whose length is its
// share of the points.
std::string Points(double y, const procedure::Score& score) {
  std::string svg;
  for (const procedure::ScoredItem& scored : score.items) {
    const procedure::Metric& metric = procedure::MetricNamed(scored.item.metric);
    const std::string value = scored.value ? ValueText(*scored.value, metric) : "not measured";
    svg += report::SvgText(kPictureGapPx, y + 11.0, report::Fit(metric.text, kPointsPx - kPictureGapPx));
    if (scored.item.weight == 0.0) {  // an item of weight 0 is shown, but not scored
      svg += report::SvgText(kPictureGapPx, y + 26.0, value + ", shown only", "start", report::kMutedColor);
      y += kItemPx;
      continue;
    }
    svg += report::SvgRect(kPictureGapPx, y + 17.0, kBarPx, 9.0, report::kGridColor);
    const double share = scored.points / scored.item.weight;
    if (share > 0.0)
      svg += report::SvgRect(kPictureGapPx, y + 17.0, kBarPx * share, 9.0,
                             share >= 0.5 ? report::kPalette[2] : report::kPalette[1]);
    svg += report::SvgText(kPictureGapPx + kBarPx + 8.0, y + 26.0,
                           fmt::format("{}, {:.1f} of {:g}", value, scored.points, scored.item.weight),
                           "start", report::kMutedColor);
    y += kItemPx;
  }
  return svg;
}

// One session, drawn from the height y downwards: score and points at the left, pictures at the right.
tl::expected<std::string, std::string> SessionSvg(double y, const AssessResult& result) {
  const AssessedSession& session = result.session;
  std::string svg =
      report::SvgText(kPictureGapPx, y + kScorePx,
                      report::Fit(fmt::format("{}: {:.1f}", NameOfSession(session), result.score.total),
                                  kPointsPx, kScorePx * 0.8),
                      "start", report::kTextColor, kScorePx * 0.8, "font-weight=\"700\"");
  svg += report::SvgText(kPictureGapPx, y + kScorePx + kMarkPx, report::Fit(MarkOf(result), kPointsPx),
                         "start", result.guided ? report::kPalette[1] : report::kMutedColor);
  svg += Points(y + kScorePx + kMarkPx + 12.0, result.score);
  double x = kPointsPx + kPictureGapPx;
  for (const CavityPicture& shown : CavityPictures(session)) {
    const auto picture = PictureAt(x, y + 8.0, shown.image);
    if (!picture) return picture;
    svg += *picture;
    x += kPicturePx + kPictureGapPx;
  }
  return svg;
}

// A table of all metrics that at least one of the two sessions has.
std::string FiguresTable(const AssessResult& first, const AssessResult& second) {
  std::string html = fmt::format(
      "<div style=\"overflow-x:auto\"><table><thead><tr><th>figure</th><th>{}</th><th>{}</th></tr></thead>"
      "<tbody>\n",
      report::Escape(NameOfSession(first.session)), report::Escape(NameOfSession(second.session)));
  html += fmt::format("<tr><td>guidance</td><td>{}</td><td>{}</td></tr>\n", report::Escape(MarkOf(first)),
                      report::Escape(MarkOf(second)));
  const auto value = [](const AssessResult& result, const procedure::Metric& metric) {
    const auto found = result.values.find(metric.name);
    return found != result.values.end() ? report::Escape(ValueText(found->second, metric)) : "not measured";
  };
  for (const procedure::Metric& metric : procedure::Metrics()) {
    if (!first.values.contains(metric.name) && !second.values.contains(metric.name)) continue;
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", report::Escape(metric.text),
                        value(first, metric), value(second, metric));
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace

std::string MarkOf(const AssessResult& result) {
  return GuidanceText(result.session) + (result.unfinished.text.empty() ? "" : ", not finished") +
         (result.session.missing.empty() ? "" : ", recordings not whole");
}

std::string WhyNotRanked(const AssessResult& first, const AssessResult& second) {
  if (first.guided != second.guided)
    return fmt::format("Not to be ranked: {} was reamed {}, {} {}.", NameOfSession(first.session),
                       GuidanceText(first.session), NameOfSession(second.session),
                       GuidanceText(second.session));
  for (const AssessResult* result : {&first, &second})
    if (!result->unfinished.text.empty())
      return fmt::format("Not to be ranked: the plan is not finished in {}: {}.",
                         NameOfSession(result->session), result->unfinished.text);
  return "";
}

tl::expected<std::string, std::string> ComparisonSvg(const AssessResult& first, const AssessResult& second) {
  const bool is_cup = first.session.plan.plan.kind == procedure::PlanKind::kCup;
  const std::array<const char*, 3> titles =
      is_cup ? std::array{"coronal", "axial", "into the opening"}
             : std::array{"along the axis", "along the axis, turned", "across the axis"};
  std::string body;
  for (std::size_t i = 0; i < titles.size(); ++i)
    body += report::SvgText(
        kPointsPx + kPictureGapPx + kPicturePx / 2.0 + static_cast<double>(i) * (kPicturePx + kPictureGapPx),
        kHeadPx - 12.0, titles[i], "middle", report::kMutedColor);
  double y = kHeadPx;
  for (const AssessResult* result : {&first, &second}) {
    const double items_px =
        kScorePx + kMarkPx + 12.0 + kItemPx * static_cast<double>(result->score.items.size());
    const auto session = SessionSvg(y, *result);
    if (!session) return session;
    body += *session;
    y += std::max(kSessionPx, items_px + kPictureGapPx);
  }
  const procedure::SurgicalPlan& plan = first.session.plan.plan;
  std::vector<std::array<std::string, 2>> legend{
      {"removed beyond the plan", "#d55e00"}, {"left within it", "#0072b2"}, {"bone", "#decdb0"}};
  if (plan.kind == procedure::PlanKind::kCup) legend.push_back({"no bone there", "#e4e8ec"});
  if (!plan.target.empty()) legend.push_back({plan.target, "#d89696"});
  double x = kPictureGapPx;
  for (const auto& [text, color] : legend) {
    body += report::SvgRect(x, y + 4.0, 14.0, 14.0, color);
    body += report::SvgText(x + 20.0, y + 16.0, text);
    x += 44.0 + report::TextWidth(text, report::kFontPx);
  }
  body += report::SvgText(x, y + 16.0, "line: the plan");
  return report::SvgDocument(kWidthPx, y + kFootPx, "Two sessions of a plan", body);
}

tl::expected<void, std::string> WriteComparison(const AssessResult& first, const AssessResult& second,
                                                const std::string& command_line,
                                                const std::filesystem::path& folder) {
  const auto svg = ComparisonSvg(first, second);
  if (!svg) return tl::make_unexpected(svg.error());
  const auto image = report::Rasterise(*svg, kComparisonScale);
  if (!image) return tl::make_unexpected(image.error());
  if (const auto written = report::WritePng(*image, folder / "compare.png"); !written) return written;
  std::string html = report::PageBegin(
      {.title = fmt::format("Two sessions of {}", first.session.plan.plan.name),
       .subtitle = fmt::format("{} and {}", NameOfSession(first.session), NameOfSession(second.session))});
  if (const std::string text = WhyNotRanked(first, second); !text.empty())
    html += "<p><strong>" + report::Escape(text) + "</strong></p>\n";
  html += report::Figure(
      *svg,
      "Sections through the planned centre (superior or anterior is up, lateral to the right), and "
      "how much deeper or shallower than planned the bone begins, seen into the opening.");
  html += FiguresTable(first, second);
  if (!command_line.empty()) html += report::RepeatSection(command_line);
  return report::WritePage(html + report::PageEnd(), folder / "compare.html");
}

}  // namespace osteon::studies
