#include "session/summary/chart_files.h"

#include <sys/utsname.h>

#include <fstream>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "base/write_text.h"
#include "report/png_file.h"
#include "report/svg_raster.h"
#include "report/svg_text.h"

namespace osteon::session {
namespace {

// Returns the processor's name as the kernel reports it.
std::string ProcessorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name"))
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown processor";
}

// Whether all cells of a column, except its head, begin like numbers. Such a column is aligned to the right
// and does not wrap. False for the first column.
bool HasNumbers(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (column >= rows[i].size() || rows[i][column].empty()) continue;
    const char first = rows[i][column].front();
    if (!(first >= '0' && first <= '9') && first != '-' && first != '+' && first != '<' && first != '>')
      return false;
  }
  return column > 0;
}

// Makes an HTML table; the first row is the head.
std::string Table(const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<div class=\"wide\">\n<table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const char* tag = i == 0 ? "th" : "td";
    html += "<tr>";
    for (std::size_t column = 0; column < rows[i].size(); ++column)
      html += fmt::format("<{}{}>{}</{}>", tag, HasNumbers(rows, column) ? " class=\"n\"" : "",
                          report::Escape(rows[i][column]), tag);
    html += "</tr>\n";
  }
  return html + "</table>\n</div>\n";
}

}  // namespace

std::string MachineName() {
  utsname system{};
  uname(&system);
  return fmt::format("{}, {} cores, {} {}", ProcessorName(), std::thread::hardware_concurrency(),
                     system.sysname, system.machine);
}

std::string ValidateOutputFolder(const char* option, const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error) || std::filesystem::is_directory(folder, error)) return {};
  return fmt::format("{} {}: found a file, accepted a folder", option, folder.string());
}

std::string ValidateParentFolder(const char* option, const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path parent = file.parent_path();
  if (parent.empty() || std::filesystem::is_directory(parent, error)) return {};
  return fmt::format("{} {}: no folder {}", option, file.string(), parent.string());
}

std::string ValidateOutputFile(const char* option, const std::filesystem::path& file) {
  std::error_code error;
  if (std::string wrong = ValidateParentFolder(option, file); !wrong.empty()) return wrong;
  if (!std::filesystem::is_directory(file, error)) return {};
  return fmt::format("{} {}: found a folder, accepted a file", option, file.string());
}

tl::expected<void, std::string> WriteDrawing(const std::string& svg, const std::filesystem::path& file) {
  if (const auto written = base::WriteText(file.string() + ".svg", svg); !written) return written;
  const auto picture = report::Rasterise(svg);
  if (!picture) return tl::unexpected(file.string() + ".png: " + picture.error());
  return report::WritePng(*picture, file.string() + ".png");
}

tl::expected<void, std::string> WriteChart(const ChartFiles& chart, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return tl::unexpected(folder.string() + ": " + error.message());
  const auto path = [&](const char* extension) { return folder / (chart.name + extension); };
  const auto picture = report::Rasterise(chart.svg);
  if (!picture) return tl::unexpected(path(".png").string() + ": " + picture.error());

  std::string html = report::PageBegin({.title = chart.title, .verdict = chart.verdict});
  html += report::Figure(chart.svg, chart.caption);
  for (const std::string& note : chart.notes) html += fmt::format("<p>{}</p>\n", report::Escape(note));
  html += Table(chart.table);
  for (const ChartPart& part : chart.parts) {
    html += fmt::format("<h2>{}</h2>\n", report::Escape(part.heading));
    if (!part.name.empty()) html += report::Figure(part.svg, part.caption);
    if (!part.table.empty()) html += Table(part.table);
  }
  html += report::PageEnd();

  const std::pair<const char*, const std::string*> texts[] = {
      {".svg", &chart.svg}, {".csv", &chart.csv}, {".json", &chart.json}, {".html", &html}};
  for (const auto& [extension, text] : texts)
    if (const auto written = base::WriteText(path(extension), *text); !written) return written;
  if (!chart.json_copy.empty())
    if (const auto written = base::WriteText(chart.json_copy, chart.json); !written) return written;
  for (const ChartPart& part : chart.parts)
    if (!part.name.empty())
      if (const auto written = WriteDrawing(part.svg, folder / part.name); !written) return written;
  return report::WritePng(*picture, path(".png"));
}

}  // namespace osteon::session
