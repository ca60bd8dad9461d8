#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/arm/servo_arm.h"
#include "studies/identify/measured_response.h"

// Tests how well an arm like a cell's is identified. It uses synthetic recordings of a ServoArm with known
// parameters, and many seeds.

namespace osteon::studies {

/// A synthetic recording: an excited ServoArm of one joint, measured with noise, over a link with losses.
struct SyntheticRun {
  std::string name{};
  int draws{4}, periods{3};
  double peak_m_per_s{0.05};
  double noise_m{10e-6};      ///< noise of the encoders, at the tool
  double drift_m_per_s{0.0};  ///< drift of the encoders
  double lost{0.0};           ///< share of the messages that do not come
  double lost_answers{0.0};   ///< share of the answers that the arm does not get
  /// True: lost answers are ignored in the estimation, a deliberate error for comparison.
  bool as_sent{false};
};

/// Simulates the arm with the excitation of a run. @param seed  of phases, noise and losses
[[nodiscard]] ExcitedRun Synthesize(const SyntheticRun& run, const hil::ServoArmParams& arm, double period_s,
                                    std::uint64_t seed);

/// The arm of the synthetic recordings, and the number of seeds.
struct IdentifyTableParams {
  hil::ServoArmParams arm;  ///< the parameters to be found
  double period_s{0.001};
  int seeds{30};
  int threads{0};  ///< 0: one per core
};

/// A figure over all seeds.
struct TableFigure {
  double truth{0.0}, mean{0.0}, two_sd{0.0};
  /// Share of seeds whose 95 % interval contains the true value; NaN: there is no interval.
  double inside{0.0};
};

/// A row of the table: the recording's settings, and the estimates compared with the truth.
struct TableRow {
  SyntheticRun run;
  double seconds{0.0};
  TableFigure hz{}, damping_ratio{}, dead_time_ms{}, lag_ms{};
  /// Predictions with the estimated arm for a virtual tool of 3 kg. Drag: the least stable one with a hand of
  /// 3 kN/m; infinite if none up to 3000 N s/m is stable. Wall: the stiffest stable one with a firm hand (500
  /// N/m) and a drag of 20 N s/m; 1e6 means at least 1e6.
  TableFigure least_drag_Ns_per_m{}, greatest_wall_N_per_m{};
  int failed{0};  ///< seeds without a fit
};

/// The rows of the table in design and documentation: 64 s at 50, 20 and 5 mm/s; 24 s; lost messages; lost
/// answers.
[[nodiscard]] std::vector<SyntheticRun> TableRuns();

/// Predictions for a given arm, as in TableRow.
[[nodiscard]] double LeastDrag(const hil::ServoArmParams& arm, double period_s);
[[nodiscard]] double GreatestWall(const hil::ServoArmParams& arm, double period_s);

/// Synthesizes, fits and judges a row. The result does not depend on the number of threads.
[[nodiscard]] TableRow IdentifyRow(const SyntheticRun& run, const IdentifyTableParams& params);

/// The table as printed: mean ± two standard deviations over the seeds.
[[nodiscard]] std::string TableText(const std::vector<TableRow>& rows);
/// JSON, osteon.identify/1, with `table`.
[[nodiscard]] std::string TableJson(const std::vector<TableRow>& rows, const IdentifyTableParams& params,
                                    const std::string& command_line);

}  // namespace osteon::studies
