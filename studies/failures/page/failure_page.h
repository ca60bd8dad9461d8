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
  std::string error{};  ///< why there is no result; empty: there is a result
  double seconds{0.0};
};

/// Head and foot of the page: the engine and device of our method, and the data of the run.
struct FailurePageHead {
  std::string engine, device, command_line, version;
  bool quick{false};
};

/// Draws one scenario's chart: the baseline's lines, our lines, and the bound if it is a value of y. The
/// chart's title names the plotted quantity: the metric if the bound is a value of y, otherwise the quantity
/// of the y axis.
[[nodiscard]] std::string FailureSvg(const FailureResult& result);

/// Writes files into an existing folder: failures.html (table, every sketch and every chart), and for each
/// scenario its chart NN_name.svg and its sketch NN_name_scene.svg (failure_scenes.h). Each file appears
/// complete or not at all. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteFailurePage(std::span<const FailurePageEntry> entries,
                                                               const FailurePageHead& head,
                                                               const std::filesystem::path& folder);

/// Makes the page as Markdown. @param pictures  the folder of the pictures, relative to the page's folder
[[nodiscard]] std::string FailureMarkdown(std::span<const FailurePageEntry> entries,
                                          const FailurePageHead& head, const std::string& pictures);

}  // namespace osteon::studies
