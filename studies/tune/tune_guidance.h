#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "config/reading/cell_config.h"
#include "control/guidance/guidance_field.h"
#include "report/report.h"
#include "session/summary/verdict.h"
#include "studies/stability/guided_loop.h"
#include "studies/tune/tune_study.h"

namespace osteon::studies {

/// The stability of a cell's loop with the guidance of a plan (studies/stability/guided_loop.h).
struct GuidanceMap {
  static constexpr double kMargin = 2.0;  ///< the plan's gains may be at most the boundary divided by kMargin
  static constexpr int kNodes = 5;        ///< number of stiffnesses along each side of the map

  control::GuidanceParams guidance;
  /// number of hands (each with the lever at which it holds the tool) that are stable without guidance
  std::size_t hands{0};
  std::vector<std::string> unstable{};  ///< the hands that the plan's guidance makes unstable
  hil::Boundary factor{};         ///< largest stable factor on the plan's stiffnesses of funnel and cone
  hil::Boundary depth_N_per_m{};  ///< largest stable stiffness of the depth spring
  /// Number of hands that become unstable, for each lateral stiffness (rows) and cone stiffness (columns).
  /// Both range from 0 to kMargin times the plan's stiffness.
  std::vector<std::vector<int>> counts{};

  [[nodiscard]] bool Accepted() const {
    return unstable.empty() && factor.value >= kMargin &&
           depth_N_per_m.value >= kMargin * guidance.depth.stiffness;
  }
};

/// Computes the map with the cell's arm, delays and virtual tool, at full gain of the guidance.
/// @param stopped  called between the results; true ends the computation early
[[nodiscard]] GuidanceMap MapGuidance(const TuneTask& task, const control::AdmittanceParams& law,
                                      const control::GuidanceParams& guidance, bool (*stopped)());

/// Bad if the plan's gains exceed the boundary divided by kMargin.
void JudgeGuidance(const GuidanceMap& map, session::Verdict& verdict);
/// The map as rows of a summary.
[[nodiscard]] std::vector<report::SummaryRow> RowsOf(const GuidanceMap& map);
[[nodiscard]] nlohmann::json ToJson(const GuidanceMap& map);
/// The counts as an HTML table.
[[nodiscard]] std::string TableOf(const GuidanceMap& map);

}  // namespace osteon::studies
