#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "studies/regress/regress.h"

namespace osteon::studies {

/// The result of a run of the suite.
struct RegressSummary {
  std::span<const RegressResult> results;
  const RegressOptions& options;
  double seconds{0.0};  ///< wall time of the whole run; for merged parts, the sum of the scenarios' times
};

/// Table with a line per scenario; those that are not bit-identical are explained below it.
[[nodiscard]] std::string RegressTable(const RegressSummary& summary);

/// JSON, schema osteon.regress/1.
[[nodiscard]] std::string RegressJson(const RegressSummary& summary);

/// JUnit XML as JUnit's ant task writes it and CI servers read it: one suite, a test case per scenario. A
/// scenario without a run or a golden trace is an error, a difference a failure; a scenario that passed
/// without being bit-identical says so in its output.
[[nodiscard]] std::string RegressJunit(const RegressSummary& summary);

/// Writes OUT/regress.html for the scenarios that are not bit-identical: which quantity left its tolerance
/// first, and golden and new values over time.
/// @returns its path, empty if there is nothing to show; or what could not be written.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> WriteRegressReport(
    const RegressSummary& summary);

}  // namespace osteon::studies
