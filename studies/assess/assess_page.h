#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "session/summary/verdict.h"
#include "studies/assess/assess_result.h"

namespace osteon::studies {

/// Text of a metric's value, with as many digits as the metric is accurate to: "14.2°", "1.29 mm", "98.4 %".
[[nodiscard]] std::string ValueText(double si, const procedure::Metric& metric);

/// The name of a session in pages and tables, which follows from its folder (NameOfFolder).
[[nodiscard]] std::string NameOfSession(const AssessedSession& session);

/// Writes the page of an assessment: score, sections, map, curves, items, trend, assumptions. The error names
/// the file.
[[nodiscard]] tl::expected<void, std::string> WriteAssessPage(const AssessResult& result,
                                                              const session::Verdict& verdict,
                                                              const std::string& command_line,
                                                              const std::filesystem::path& path);

}  // namespace osteon::studies
