#include "report/page.h"

#include <string_view>

#include <fmt/format.h>

#include "base/output_file.h"
#include "report/page_scripts.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

// The style sheet of every page.
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
.look { background: #fdf0d5; color: #7a4b00; }
.reasons { margin: 10px 0 0; padding-left: 20px; max-width: 92ch; }
.summary { columns: 2; column-gap: 40px; margin: 18px 0 0; padding: 0; list-style: none; }
.summary li { display: flex; justify-content: space-between; gap: 18px; padding: 5px 0; border-bottom: 1px solid #eceff2;
  break-inside: avoid; }
.summary span { color: #59636e; flex: none; max-width: 60%; }
.summary b { font-weight: 600; text-align: right; overflow-wrap: anywhere; min-width: 0;
  font-variant-numeric: tabular-nums; }
figure { margin: 14px 0 0; break-inside: avoid; }
figure svg, figure img { display: block; max-width: 100%; height: auto; }
figcaption { color: #59636e; font-size: 13.5px; margin-top: 6px; max-width: 92ch; }
button { font: inherit; font-size: 13.5px; padding: 4px 12px; border: 1px solid #c6cdd4; border-radius: 6px;
  background: #f5f7f9; color: inherit; cursor: pointer; }
button[aria-pressed="true"] { background: #0072b2; border-color: #0072b2; color: #fff; }
[hidden] { display: none !important; }
.turn canvas { display: block; width: 100%; height: 560px; max-height: 72vh; touch-action: none; cursor: grab;
  border: 1px solid #d9dee3; border-radius: 6px; }
.bar { display: flex; flex-wrap: wrap; gap: 8px; align-items: center; margin-top: 8px; font-size: 13.5px; }
.scale i { display: inline-block; width: 110px; height: 11px; margin: 0 6px; border: 1px solid #c6cdd4;
  vertical-align: -1px; }
.cursor { stroke: #1b1f24; stroke-dasharray: 2 2; pointer-events: none; }
.band { fill: #0072b2; fill-opacity: 0.15; }
.readout { font-size: 12px; font-weight: 600; fill: #59636e; paint-order: stroke; stroke: #fff; stroke-width: 4px;
  stroke-linejoin: round; pointer-events: none; }
.whole-run { position: fixed; right: 18px; bottom: 18px; box-shadow: 0 2px 8px #0003; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 20px; }
table { border-collapse: collapse; width: 100%; margin-top: 10px; }
th, td { text-align: left; padding: 6px 14px 6px 0; border-bottom: 1px solid #eceff2; vertical-align: top; }
th { color: #59636e; font-weight: 500; font-size: 13.5px; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td.n { white-space: nowrap; }
.wide { overflow-x: auto; }
pre { background: #f5f7f9; border-radius: 6px; padding: 12px 14px; font-size: 12.5px; line-height: 1.45;
  white-space: pre-wrap; overflow-wrap: anywhere; }
footer { margin-top: 44px; color: #59636e; font-size: 13px; }
@media screen and (max-width: 700px) { .summary { columns: 1; } .pair { grid-template-columns: 1fr; } main { padding: 20px 16px; }
  table { display: block; overflow-x: auto; } figure { overflow-x: auto; } figure svg { max-width: none;
  mix-blend-mode: multiply; }
  /* a shadow at each side where a plot or a table goes on: white sheets that scroll along cover it at the ends;
  blended, because a plot has a white ground of its own */
  figure, table { background: linear-gradient(90deg, #fff 40%, #fff0) 0 0 / 40px 100% no-repeat local,
    linear-gradient(270deg, #fff 40%, #fff0) 100% 0 / 40px 100% no-repeat local,
    linear-gradient(90deg, #1b1f2440, #1b1f2400) 0 0 / 12px 100% no-repeat,
    linear-gradient(270deg, #1b1f2440, #1b1f2400) 100% 0 / 12px 100% no-repeat; } }
@page { size: A4; margin: 14mm; }
@media print { main { width: auto; padding: 0; } body { font-size: 10.5pt; } h2 { break-after: avoid; margin-top: 24px; }
  .turn, .bar, .hint, .whole-run { display: none !important; }
  table { font-size: 9pt; } td, th { padding-right: 7px; overflow-wrap: anywhere; } td.n { white-space: normal; }
  .verdict { border: 1px solid currentColor; } pre { font-size: 8pt; } }
)";

// Makes a file's name a part of a URL: every byte except letters, digits and -._~ becomes %XX.
std::string PercentEncoded(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       std::string_view("-._~").find(c) != std::string_view::npos;
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

}  // namespace

std::string PageBegin(const PageHead& head) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n"
      "<style>{}</style>\n</head>\n<body>\n<main>\n<header>\n<h1>{}</h1>\n",
      Escape(head.title), kStyle, Escape(head.title));
  if (!head.subtitle.empty()) out += fmt::format("<p class=\"sub\">{}</p>\n", Escape(head.subtitle));
  if (head.verdict) out += VerdictBadge(*head.verdict);
  if (!head.summary.empty()) {
    out += "<ul class=\"summary\">\n";
    for (const SummaryRow& row : head.summary)
      out += fmt::format("<li><span>{}</span> <b>{}</b></li>\n", Escape(row.key),
                         row.file.empty() ? Escape(row.value) : FileLink(row.file));
    out += "</ul>\n";
  }
  return out + "</header>\n";
}

std::string ScriptHtml(const char* script) { return fmt::format("<script>\n{}</script>\n", script); }

std::string RepeatSection(const std::string& command_line) {
  return "<h2>How to repeat it</h2>\n<pre>" + Escape(command_line) + "</pre>\n";
}

std::string PageEnd() { return "</main>\n" + ScriptHtml(kPlotCursorScript) + "</body>\n</html>\n"; }

std::string FileLink(const std::string& file) {
  // begins with "./", because without it a browser would take a name with a colon for a protocol
  return fmt::format(R"(<a href="./{}">{}</a>)", PercentEncoded(file), Escape(file));
}

std::string VerdictBadge(const ReportVerdict& verdict) {
  std::string out = fmt::format("<div class=\"verdict {}\">{}</div>\n", Escape(verdict.level),
                                Escape(verdict.text.empty() ? verdict.level : verdict.text));
  if (verdict.reasons.empty()) return out;
  out += "<ul class=\"reasons\">\n";
  for (const std::string& reason : verdict.reasons) out += "<li>" + Escape(reason) + "</li>\n";
  return out + "</ul>\n";
}

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

tl::expected<void, std::string> WritePage(const std::string& html, const std::filesystem::path& path) {
  const auto with_path = [&](const simulation::FileError& error) {
    return tl::unexpected(path.string() + ": cannot write the report: " + error.found);
  };
  auto file = simulation::OutputFile::Create(path);
  if (!file) return with_path(file.error());
  file->Write(html);
  if (const auto written = file->Commit(); !written) return with_path(written.error());
  return {};
}

}  // namespace osteon::report
