#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/png_file.h"

// The parts of every report: one HTML file that opens anywhere, without a script and without the network.

namespace osteon::app {

/// The page from <!DOCTYPE to <main>, with the style sheet.
[[nodiscard]] std::string PageBegin(const std::string& title);
inline constexpr const char* kPageEnd = "</main>\n</body>\n</html>\n";

/// @param content  markup;  @param caption  text, or empty
[[nodiscard]] std::string Figure(const std::string& content, const std::string& caption);

/// A link to a file in the page's own folder. @param file  its name
[[nodiscard]] std::string FileLink(const std::string& file);

/// How good a result was, worst reason first.
struct ReportVerdict {
  std::string level{"good"};  ///< "good", "look" or "bad"
  std::vector<std::string> reasons{};
};

/// The level as a badge, the reasons below it.
[[nodiscard]] std::string VerdictBadge(const ReportVerdict& verdict);

/// A picture embedded in the page. @returns libpng's message if it fails.
[[nodiscard]] tl::expected<std::string, std::string> Picture(const Image& image, const std::string& caption);

/// Writes a file that appears complete or not at all. The error names it.
[[nodiscard]] tl::expected<void, std::string> WritePage(const std::string& html,
                                                        const std::filesystem::path& path);

}  // namespace osteon::app
