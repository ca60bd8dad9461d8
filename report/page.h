#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/png_file.h"

// The parts of every page. A page is one HTML file, which a browser can open without a network. The file
// contains its scripts; without scripts it shows the same facts.

namespace osteon::report {

/// The verdict on a result, with its reasons.
struct ReportVerdict {
  std::string level{"good"};  ///< "good", "look" or "bad"
  std::vector<std::string> reasons{};
  std::string text{};  ///< text on the badge; empty: the name of the level
};

/// A row of the summary: a name, and a value with its unit.
struct SummaryRow {
  std::string key, value;
  std::string file{};  ///< name of a file beside the page, to which the value is a link; empty: none
};

/// The head of every page.
struct PageHead {
  std::string title;
  std::string subtitle{};                  ///< e.g. engine, device, date
  std::optional<ReportVerdict> verdict{};  ///< nothing: the page has no verdict
  std::vector<SummaryRow> summary{};
};

/// Makes the beginning of a page from <!DOCTYPE on: style sheet, title, verdict, summary.
[[nodiscard]] std::string PageBegin(const PageHead& head);
/// Makes the end of a page, with the script that moves a common cursor over all plots that can zoom.
[[nodiscard]] std::string PageEnd();
/// Makes the section with the command that made the page.
[[nodiscard]] std::string RepeatSection(const std::string& command_line);
/// Makes the markup of a script within the page. @param script  must not contain "</script"
[[nodiscard]] std::string ScriptHtml(const char* script);

/// Makes a <figure>. @param content  markup  @param caption  text, or empty
[[nodiscard]] std::string Figure(const std::string& content, const std::string& caption);

/// Makes a link to a file in the page's own folder. @param file  the file's name
[[nodiscard]] std::string FileLink(const std::string& file);

/// Makes the markup of a verdict: the level as a badge, the reasons below it.
[[nodiscard]] std::string VerdictBadge(const ReportVerdict& verdict);

/// Makes the markup of a picture, which is embedded as PNG. The error is libpng's message.
[[nodiscard]] tl::expected<std::string, std::string> Picture(const Image& image, const std::string& caption);

/// Writes a page's file, completely or not at all. The error names the file.
[[nodiscard]] tl::expected<void, std::string> WritePage(const std::string& html,
                                                        const std::filesystem::path& path);

}  // namespace osteon::report
