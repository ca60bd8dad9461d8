#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/png_file.h"

// The parts of every page: one HTML file that opens anywhere, without the network. Its scripts are within it;
// without them it says the same.

namespace osteon::report {

/// How good a result was, worst reason first.
struct ReportVerdict {
  std::string level{"good"};  ///< "good", "look" or "bad"
  std::vector<std::string> reasons{};
  std::string text{};  ///< on the badge; empty: the level
};

/// A row of the summary: a name, and a value with its unit.
struct SummaryRow {
  std::string key, value;
  std::string file{};  ///< name of a file beside the page, which the value leads to; empty: none
};

/// What every page begins with.
struct PageHead {
  std::string title;
  std::string subtitle{};                  ///< e.g. engine, device, date
  std::optional<ReportVerdict> verdict{};  ///< nothing: the page judges nothing
  std::vector<SummaryRow> summary{};
};

/// The page from <!DOCTYPE on: style sheet, title, verdict, summary.
[[nodiscard]] std::string PageBegin(const PageHead& head);
/// The end of a page, with the script that moves one cursor over all its plots that zoom.
[[nodiscard]] std::string PageEnd();
/// The section that gives the command which made the page.
[[nodiscard]] std::string RepeatSection(const std::string& command_line);
/// A script within the page. @param script  without "</script"
[[nodiscard]] std::string ScriptHtml(const char* script);

/// @param content  markup;  @param caption  text, or empty
[[nodiscard]] std::string Figure(const std::string& content, const std::string& caption);

/// A link to a file in the page's own folder. @param file  its name
[[nodiscard]] std::string FileLink(const std::string& file);

/// The level as a badge, the reasons below it.
[[nodiscard]] std::string VerdictBadge(const ReportVerdict& verdict);

/// A picture embedded in the page. @returns libpng's message if it fails.
[[nodiscard]] tl::expected<std::string, std::string> Picture(const Image& image, const std::string& caption);

/// Writes a file that appears complete or not at all. The error names it.
[[nodiscard]] tl::expected<void, std::string> WritePage(const std::string& html,
                                                        const std::filesystem::path& path);

}  // namespace osteon::report
