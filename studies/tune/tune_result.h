#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/report.h"
#include "session/summary/verdict.h"
#include "studies/tune/tune_guidance.h"
#include "studies/tune/tune_measured.h"
#include "studies/tune/tune_study.h"

// The result of `osteon tune`, and its output: rows, JSON, CSV, pictures, and a gains file for the cell.

namespace osteon::studies {

/// For one virtual mass: the least drag that is stable with every hand at the requested margin; infinite if
/// no drag is.
struct TuneTrade {
  double mass_kg{0.0};
  double human_Ns_per_m{0.0}, stiffest_Ns_per_m{0.0};
};

/// Decay rates of the loop's motion over damping (columns) and wall stiffness (rows). Both are evenly spaced
/// in the logarithm.
struct TuneMap {
  std::string title;
  double damping_from{5.0}, damping_to{500.0}, wall_from{1e3}, wall_to{1e6};
  int dampings{0}, walls{0};
  std::vector<double> decay_per_s;  ///< one row for each wall, with one value for each damping
};

/// A cell's task and all results for it.
struct TuneResult {
  std::string cell;
  TuneTask task;
  double max_wall_N_per_m{1e6};
  std::vector<hil::GridHand> human_hands, stiffest_hands;
  std::vector<TuneTrade> trade;
  TuneGains recommended;  ///< recommended gains; mass 0: no gains are stable with all hands and contacts
  double recommended_margin{0.0};
  double own_margin{0.0};  ///< gain margin of the cell's own gains
  TuneGains within_bar;    ///< the gains with the largest margin among those that count as light
  double within_bar_margin{0.0};
  /// least drag that is stable at the recommended mass, with the stiffest grip and with a clamp
  double stiffest_Ns_per_m{0.0}, clamp_Ns_per_m{0.0};
  double age_bound_Ns_per_m{0.0};  ///< sufficient drag in view of the planes' age: largest age × stiffness
  /// boundaries for each set of hands, at the recommended mass
  std::vector<TuneBoundary> human, stiffest, firm;
  std::vector<TuneMap> maps;
  TuneCheck check;
  /// one simulated run with the vibration index for each hand stiffer than the human grip
  std::vector<StiffHandRun> stiff_hands;
  /// the largest vibration index that a hand within the human grip causes
  double human_index{0.0};
  std::optional<GuidanceMap> guidance;  ///< of the plan, if one is given
  std::vector<TuneMargin> margins;      ///< margins by the measured response; empty: none was measured
  /// number of results read from the cache, and number of results computed
  int found{0}, computed{0};

  /// Whether gains were found that are stable with all hands and contacts.
  [[nodiscard]] bool HasRecommendation() const { return recommended.mass_kg > 0.0; }
  /// Whether the recommended gains may be used: they must be stable with the measured response and in the
  /// simulations in time.
  [[nodiscard]] bool MayBeUsed() const;
  /// Whether the cell's own gains have the requested margin, also by the measured response.
  [[nodiscard]] bool OwnGainsAreStable() const;
  /// The run that keeps oscillating most among the runs with the vibration index; null if there are none.
  [[nodiscard]] const StiffHandRun* WorstStiffHand() const;
  /// Whether the recommended gains count as light: mass and drag are within the task's limits.
  [[nodiscard]] bool IsLight() const {
    return HasRecommendation() && recommended.mass_kg <= task.max_mass_kg &&
           recommended.damping_Ns_per_m <= task.max_drag_Ns_per_m;
  }
};

/// Bad if a plan's guidance is beyond half of its boundary, if no gains are stable with the requested margin,
/// if the motion grew in a simulation, or if a stiff hand keeps oscillating. A warning if the cell's own
/// gains have less than the requested margin, if the tool is not light, or if hands need a vibration index
/// that is switched off in the cell.
[[nodiscard]] session::Verdict Judge(const TuneResult& result);

/// The result as rows for the terminal and the HTML page.
[[nodiscard]] std::vector<report::SummaryRow> Rows(const TuneResult& result);
/// JSON, schema osteon.tune/1.
[[nodiscard]] std::string ToJson(const TuneResult& result, const std::string& command_line);
/// The boundaries as CSV, one line for each damping.
[[nodiscard]] std::string BoundaryCsv(const TuneResult& result);
/// The runs with the vibration index (hands stiffer than the human grip), as rows of an HTML table.
[[nodiscard]] std::string CarriedTable(const TuneResult& result);
/// A gains file for `osteon run --gains`. @pre result.MayBeUsed()
[[nodiscard]] std::string GainsYaml(const TuneResult& result, const std::string& command_line);

/// Draws the decay rate over drag and wall stiffness, one panel for each set of hands.
[[nodiscard]] std::string MapSvg(const TuneResult& result);
/// Draws the stiffest stable wall over the drag, predicted and simulated.
[[nodiscard]] std::string WidthSvg(const TuneResult& result);
/// Draws the least drag over the virtual mass.
[[nodiscard]] std::string TradeSvg(const TuneResult& result);

}  // namespace osteon::studies
