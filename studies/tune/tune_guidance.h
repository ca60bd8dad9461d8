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
  static constexpr double kMargin = 2.0;  ///< gains may be at most the boundary divided by this
  static constexpr int kNodes = 5;        ///< number of values of each stiffness

  control::GuidanceParams guidance;
  std::size_t hands{0};                 ///< number of hands with lever that are stable without guidance
  std::vector<std::string> unstable{};  ///< the hands that the plan's guidance makes unstable
  hil::Boundary factor{};         ///< boundary on funnel and cone, as a factor on the plan's stiffnesses
  hil::Boundary depth_N_per_m{};  ///< boundary of the depth's spring
  /// Number of hands that become unstable, by lateral (rows) and cone stiffness (columns), from 0 to kMargin
  /// times the plan's.
  std::vector<std::vector<int>> counts{};

  [[nodiscard]] bool Accepted() const {
    return unstable.empty() && factor.value >= kMargin &&
           depth_N_per_m.value >= kMargin * guidance.depth.stiffness;
  }
};

/// Computes the map with the cell's arm, delays and virtual tool, at full gain of the guidance.
/// @param stopped  polled; returns true to end early
[[nodiscard]] GuidanceMap MapGuidance(const TuneTask& task, const control::AdmittanceParams& law,
                                      const control::GuidanceParams& guidance, bool (*stopped)());

/// Bad if the plan's gains are beyond half of the boundary.
void JudgeGuidance(const GuidanceMap& map, session::Verdict& verdict);
/// The map as rows of a summary.
[[nodiscard]] std::vector<report::SummaryRow> RowsOf(const GuidanceMap& map);
[[nodiscard]] nlohmann::json ToJson(const GuidanceMap& map);
/// The counts as an HTML table.
[[nodiscard]] std::string TableOf(const GuidanceMap& map);

}  // namespace osteon::studies
