#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "report/svg_plot.h"
#include "studies/soak/episode_figures.h"
#include "studies/soak/soak.h"

// Functions that the soak in virtual time and the soak in wall time share.

namespace osteon::studies {

/// Reports the text `what` as an error if the condition does not hold.
using Require = std::function<void(bool holds, const std::string& what)>;

/// Requires the bounds that hold for every episode's recording: rendered force, momentum, removed volume.
void RequireFigures(const EpisodeFigures& figures, const Require& require);

/// Appends the figures of a recording to an episode's JSON. @param debt_J  see EpisodeFigures::EnergyResidual
void AddFigures(nlohmann::ordered_json& json, const EpisodeFigures& figures, double debt_J);

/// Growth of a quantile from the second quarter of the values to the last quarter; 0 with fewer than 8
/// values.
/// @param share  of the quantile, below 1; 0: the smallest value, 0.5: the median
[[nodiscard]] double QuarterGrowth(const std::vector<double>& values, double share);

/// A chart of a figure over the hours of a soak. @param hours  label of the time axis
[[nodiscard]] report::LineChart SoakChart(const char* title, const char* hours, const char* unit,
                                          std::vector<report::Series> series);
/// A series of points without a line, still empty.
[[nodiscard]] report::Series SoakPoints(const char* name);

/// Number of episodes of one kind, and how many of them had an error.
struct EpisodeCount {
  std::string_view name;
  std::ptrdiff_t episodes{0}, wrong{0};
};
/// HTML table of the episodes by kind. @param head  heading of the first column
[[nodiscard]] std::string KindTable(const char* head, const std::vector<EpisodeCount>& counts);

/// Checks --out and --json before anything runs. @returns the error, or an empty string
[[nodiscard]] std::string ValidateOutputs(const SoakOptions& options);
/// Writes the JSON and the page to the files that the options name. @returns the error, or an empty string
[[nodiscard]] std::string WriteSoakFiles(const SoakOptions& options, const std::string& json,
                                         const std::string& page);

}  // namespace osteon::studies
