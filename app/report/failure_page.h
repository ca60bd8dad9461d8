#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "hil/failures/failure.h"

namespace osteon::app {

/// A scenario on the page.
struct FailurePageEntry {
  hil::FailureResult result;
  bool passed{false};
  std::string error{};  ///< instead of a result; may be empty
  double seconds{0.0};
};

struct FailurePageHead {
  std::string engine, device, command_line, version;
  bool quick{false};
};

/// One scenario's chart: the baseline's lines, ours, and the bound where it is one of y's. Its title says
/// what is plotted: the metric where the bound is y's, else the y axis.
[[nodiscard]] std::string FailureSvg(const hil::FailureResult& result);

/// failures.html (table, every scene and every chart) and for each scenario NN_name.svg, its chart, and
/// NN_name_scene.svg, its sketch (failure_scenes.h), in a folder that exists. Files appear whole or not at
/// all. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteFailurePage(std::span<const FailurePageEntry> entries,
                                                               const FailurePageHead& head,
                                                               const std::filesystem::path& folder);

/// A paragraph of Markdown in lines of 120 characters at most, broken at single spaces outside of `code`.
[[nodiscard]] std::string WrapMarkdown(std::string_view paragraph);

/// The same as a Markdown page, whose pictures lie in a folder that it names from its own.
[[nodiscard]] std::string FailureMarkdown(std::span<const FailurePageEntry> entries,
                                          const FailurePageHead& head, const std::string& pictures);

}  // namespace osteon::app
