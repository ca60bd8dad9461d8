#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/svg_plot.h"

namespace osteon::studies {

/// A scenario that differs from its golden trace.
struct RegressPageEntry {
  /// A quantity that differs.
  struct Row {
    std::string name{};
    bool beyond{false};              ///< whether it is beyond its tolerance
    std::optional<double> left_s{};  ///< time at which a sample first left the tolerance
    /// Largest difference, its tolerance, and the golden and the new value at that difference.
    double worst{0.0}, tolerance{0.0}, golden{0.0}, now{0.0};
  };
  std::string name{}, shows{}, verdict{};  ///< `shows`: the purpose of the scenario, as its file states it
  bool good{false};
  std::vector<std::string> lines{};    ///< explanation, the most informative line first
  std::vector<std::string> reasons{};  ///< reasons with which the golden trace was accepted, the oldest first
  std::vector<Row> rows{};
  std::vector<report::LineChart> panels{};  ///< in pairs: values, and their difference
};

/// The content of the page.
struct RegressPage {
  std::vector<RegressPageEntry> entries{};
  std::size_t passed{0}, scenarios{0};  ///< number of scenarios that passed; number of all scenarios
  std::string command_line{}, version{};
};

/// Writes the page as HTML. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteRegressPage(const RegressPage& page,
                                                               const std::filesystem::path& file);

}  // namespace osteon::studies
