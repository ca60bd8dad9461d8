#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "app/regress.h"

namespace osteon::app {

/// All that a run of the suite leaves.
struct RegressSummary {
  std::span<const RegressResult> results;
  const RegressOptions& options;
  double seconds{0.0};  ///< wall time of all of them together
};

/// A line a scenario, and below those that are not bit-identical why.
[[nodiscard]] std::string RegressTable(const RegressSummary& summary);

/// osteon.regress/1
[[nodiscard]] std::string RegressJson(const RegressSummary& summary);

/// As JUnit's ant task writes it and CI servers read it: one suite, a test case a scenario. A scenario that
/// has no run or no golden trace is an error, one that differs a failure; what passed without being
/// bit-identical says so in its output.
[[nodiscard]] std::string RegressJunit(const RegressSummary& summary);

/// OUT/regress.html of every scenario that is not bit-identical: what left first, and golden and new values
/// over time.
/// @returns where it is, empty where there is nothing to show; or what could not be written.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> WriteRegressReport(
    const RegressSummary& summary);

}  // namespace osteon::app
