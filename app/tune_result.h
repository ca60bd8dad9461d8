#pragma once

#include <string>
#include <vector>

#include "app/report/report.h"
#include "app/tune_study.h"
#include "app/verdict.h"

// What `osteon tune` found, and how it is said: rows, JSON, CSV, pictures, an overlay for the cell.

namespace osteon::app {

/// For one virtual mass, the least drag that stands every hand with the margin; infinite where none does.
struct TuneTrade {
  double mass_kg{0.0};
  double human_Ns_per_m{0.0}, stiffest_Ns_per_m{0.0};
};

/// Decay rates over damping (rows of it) and wall stiffness, both evenly spaced in the logarithm.
struct TuneMap {
  std::string title;
  double damping_from{5.0}, damping_to{500.0}, wall_from{1e3}, wall_to{1e6};
  int dampings{0}, walls{0};
  std::vector<double> decay_per_s;  ///< one row of dampings a wall
};

struct TuneResult {
  std::string cell;
  TuneTask task;
  double most_wall_N_per_m{1e6};
  std::vector<hil::GridHand> human_hands, stiffest_hands;
  std::vector<TuneTrade> trade;
  TuneGains recommended;  ///< zero: none stand it all
  double recommended_margin{0.0};
  double own_margin{0.0};  ///< of the cell's own gains
  TuneGains within_bar;    ///< of all that count as light, those with the greatest margin
  double within_bar_margin{0.0};
  double stiffest_Ns_per_m{0.0}, clamp_Ns_per_m{0.0};  ///< what these ask for at the recommended mass
  double age_bound_Ns_per_m{0.0};                   ///< a_max K of the planes: enough for any age by itself
  std::vector<TuneBoundary> human, stiffest, firm;  ///< at the recommended mass
  std::vector<TuneMap> maps;
  TuneCheck check;
  std::vector<TuneCarried> carried;  ///< hands that are the vibration index's business
  double human_index{0.0};           ///< the greatest that a hand within the grip raises
  int found{0}, computed{0};

  [[nodiscard]] bool Stands() const { return recommended.mass_kg > 0.0; }
  /// The worst of the hands that the index carries; null where there are none.
  [[nodiscard]] const TuneCarried* WorstCarried() const;
  [[nodiscard]] bool WithinBar() const {
    return Stands() && recommended.mass_kg <= task.most_mass_kg &&
           recommended.damping_Ns_per_m <= task.most_drag_Ns_per_m;
  }
};

/// Bad where no gains stand what was asked, where they grew when run in time, or where a stiff hand keeps
/// oscillating; to be looked at where the cell's own gains stand less, the tool is not light, or hands depend
/// on a vibration index that does not act.
[[nodiscard]] Verdict Judge(const TuneResult& result);

[[nodiscard]] std::vector<SummaryRow> Rows(const TuneResult& result);
/// schema osteon.tune/1
[[nodiscard]] std::string ToJson(const TuneResult& result, const std::string& command_line);
/// The boundaries, one damping a line.
[[nodiscard]] std::string BoundaryCsv(const TuneResult& result);
/// The hands that the index carries, as rows of an HTML table.
[[nodiscard]] std::string CarriedTable(const TuneResult& result);
/// What `osteon run --gains` takes.
[[nodiscard]] std::string GainsYaml(const TuneResult& result, const std::string& command_line);

[[nodiscard]] std::string MapSvg(const TuneResult& result);
[[nodiscard]] std::string WidthSvg(const TuneResult& result);
[[nodiscard]] std::string TradeSvg(const TuneResult& result);

}  // namespace osteon::app
