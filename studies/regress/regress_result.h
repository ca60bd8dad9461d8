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
  double seconds{0.0};  ///< wall time of the whole run; if parts are merged, the sum of the scenarios' times
};

/// Table with a line per scenario. Below it, those scenarios are explained that are not bit-identical.
[[nodiscard]] std::string RegressTable(const RegressSummary& summary);

/// JSON, schema osteon.regress/1.
[[nodiscard]] std::string RegressJson(const RegressSummary& summary);

/// JUnit XML, in the form that JUnit's ant task writes and CI servers read: one suite, a test case per
/// scenario. A missing run or golden trace is an error, a difference is a failure. A scenario that passed
/// without being bit-identical states this in its output.
[[nodiscard]] std::string RegressJunit(const RegressSummary& summary);

/// Writes OUT/regress.html for the scenarios that are not bit-identical. It shows which quantity left its
/// tolerance first, and golden and new values over time.
/// @returns the page's path, empty if there is nothing to show; or an error that says what could not be
/// written.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> WriteRegressReport(
    const RegressSummary& summary);

}  // namespace osteon::studies
