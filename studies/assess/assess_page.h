#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "session/summary/verdict.h"
#include "studies/assess/assess_result.h"

namespace osteon::app {

/// Writes the page of an assessment: score, sections, map, curves, items, trend, assumptions. The error names
/// the file.
[[nodiscard]] tl::expected<void, std::string> WriteAssessPage(const AssessResult& result,
                                                              const Verdict& verdict,
                                                              const std::string& command_line,
                                                              const std::filesystem::path& path);

}  // namespace osteon::app
