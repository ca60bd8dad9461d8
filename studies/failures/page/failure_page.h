#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "studies/failures/failure.h"

namespace osteon::studies {

/// One scenario of the page.
struct FailurePageEntry {
  FailureResult result;
  bool passed{false};
  std::string error{};  ///< instead of a result; may be empty
  double seconds{0.0};
};

/// Head and foot of the page: the engine and device of "ours", and the run.
struct FailurePageHead {
  std::string engine, device, command_line, version;
  bool quick{false};
};

/// One scenario's chart: the baseline's lines, ours, and the bound if it is a value of y. Its title names the
/// plotted quantity: the metric if the bound is a value of y, else the y axis.
[[nodiscard]] std::string FailureSvg(const FailureResult& result);

/// Writes into an existing folder failures.html (table, every scene and every chart) and for each scenario
/// NN_name.svg, its chart, and NN_name_scene.svg, its sketch (failure_scenes.h). Files appear complete or not
/// at all. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteFailurePage(std::span<const FailurePageEntry> entries,
                                                               const FailurePageHead& head,
                                                               const std::filesystem::path& folder);

/// Makes the page as Markdown. @param pictures  the folder of the pictures, relative to the page's folder
[[nodiscard]] std::string FailureMarkdown(std::span<const FailurePageEntry> entries,
                                          const FailurePageHead& head, const std::string& pictures);

}  // namespace osteon::studies
