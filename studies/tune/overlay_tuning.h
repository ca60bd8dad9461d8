#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/identified_cell.h"
#include "hil/operator/hand_grid.h"
#include "report/page.h"
#include "session/summary/verdict.h"
#include "studies/stability/overlay_loop.h"
#include "studies/tune/overlay_measured.h"
#include "studies/tune/tune.h"
#include "studies/tune/tune_study.h"

// The result of `osteon tune` for a cell with the impedance law, and its output as rows, page and files.

namespace osteon::studies {

/// The stiffest wall that is stable with the worst hand, for one damping of the law.
struct OverlayBoundary {
  double damping_Ns_per_m{0.0};
  // predicted by the linear loop, and by simulation in time; 0: unstable without a wall
  double predicted_N_per_m{0.0}, simulated_N_per_m{0.0};
  std::size_t hand{0};  // the worst hand, as index in OverlayTuning::hands
};

/// Simulations in time with the recommended gains.
struct OverlayCheck {
  std::size_t runs{0};
  std::vector<std::string> grew{};  // hand and contact of each run in which the motion grew
};

/// A cell with the impedance law, and all results for it.
struct OverlayTuning {
  std::string cell;
  TuneTask task;
  OverlayLoopParams loop;
  std::vector<hil::GridHand> hands{};
  // mass that the arm's model has at the tool along the tool's axis
  double mass_kg{0.0};
  std::optional<config::IdentifiedArm> measured{};  // the measured axis with the longest dead time
  double along_tool_kg{0.0};                        // measured mass along z; 0: not measured
  // along some axis, the measurement found that the mount of the arm yields
  bool on_mount{false};
  double own_margin{0.0};            // gain margin of the cell's own gains; 0: not stable with all hands
  double recommended_Ns_per_m{0.0};  // recommended damping of the law; 0: none is recommended
  double recommended_N_per_m{0.0}, recommended_margin{0.0};
  // stiffest stable planes at the task's age; searched up to the task's plane stiffness
  double planes_N_per_m{0.0};
  std::vector<OverlayBoundary> boundary{};
  OverlayCheck check{};
  // the arm's measured response, by which gains are judged in addition to the model; empty: none was measured
  std::vector<MeasuredAxis> response{};
  // margins by `response`, for the cell's own and the recommended gains
  std::vector<TuneMargin> margins{};
  std::string nyquist_svg{};  // empty if there are no margins
  [[nodiscard]] bool HasRecommendation() const { return recommended_Ns_per_m > 0.0; }
  /// Whether the recommended gains may be used: they must also be stable in the simulations in time and with
  /// the measured response.
  [[nodiscard]] bool MayBeUsed() const {
    return HasRecommendation() && check.grew.empty() && IsStableByMargins(margins, "recommended");
  }
  [[nodiscard]] double own_damping() const { return loop.law.damping_Ns_per_m.z(); }
};

/// Bad if the recommended gains may not be used. Each remark gives a warning.
[[nodiscard]] session::Verdict Judge(const OverlayTuning& t);
/// The result as rows for the terminal and the HTML page.
[[nodiscard]] std::vector<report::SummaryRow> Rows(const OverlayTuning& t);
/// Writes tune.svg, .csv, .json, .html and, if they may be used, gains.yaml.
/// @returns an error that names the file
[[nodiscard]] tl::expected<void, std::string> Write(const OverlayTuning& t, const TuneOptions& options);

}  // namespace osteon::studies
