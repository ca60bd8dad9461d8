#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "report/page.h"
#include "session/summary/verdict.h"
#include "studies/stability/measured_loop.h"
#include "studies/tune/tune_study.h"

// A tuning task with measured figures (`osteon identify`), and the judgement of its gains by the measured
// response.

namespace osteon::studies {

/// Puts the measured figures of a cell into its task:
///  - the arm of the slowest axis and speed, with its dead time and the mass by which the hand moves it,
///  - the jitter beyond its mean (the measured dead time includes the mean) and the share of lost answers,
///  - the sensor's delay: whole ticks in the loop, the rest in the arm's dead time, which has the same
///  effect,
///  - the hands, and the response.
///
/// Without a measured arm, only sensor and hands are used; the arm's lag and the jitter stay assumed.
void UseIdentified(const config::IdentifiedCell& identified, TuneTask& task);
/// Names the measured figures other than the arm's motion, for people: "the force sensor's noise, a dead
/// zone".
[[nodiscard]] std::string FiguresBesideArm(const config::IdentifiedCell& identified);
/// Adds the measured hands to the task, each also at the ends of its confidence interval.
void UseHands(const config::IdentifiedCell& identified, TuneTask& task);
/// Jitter beyond its mean [whole periods]; the measured dead time includes the mean.
[[nodiscard]] int JitterOf(const config::IdentifiedLink& link, double period_s);

/// A cell's task, with the figures of `cell.identified` if there are any. Without them, the sensor's delay
/// and the commands' jitter are assumed to be a millisecond each, rounded to whole ticks.
[[nodiscard]] TuneTask MeasuredTaskOf(const config::CellConfig& cell);

/// Whether the loop with the measured response is stable for all hands and contacts. Hand and wall are
/// multiplied by `gain`.
[[nodiscard]] bool IsStableAsMeasured(const TuneTask& task, const TuneGains& gains,
                                      const std::vector<hil::GridHand>& hands, double gain);

/// The margins of the loop with one hand and contact, by the measured response.
struct TuneMargin {
  std::string gains;  ///< "own" or "recommended"
  hil::GridHand hand;
  TuneContact contact{};
  LoopMargins margins;
};

/// One margin for each hand and contact, also for hands whose own loops were measured; empty without a
/// measured response.
[[nodiscard]] std::vector<TuneMargin> MeasuredMargins(const TuneTask& task, const std::string& name,
                                                      const TuneGains& gains,
                                                      const std::vector<hil::GridHand>& hands);
/// The margin nearest to instability: an unstable loop if there is one, otherwise the loop whose Nyquist
/// curve comes nearest to -1. Null: there is none.
[[nodiscard]] const TuneMargin* WorstOf(const std::vector<TuneMargin>& margins, const std::string& gains);

/// Whether these gains are stable with every hand and contact by the measured response, with 95 %
/// probability. True if no response was measured.
[[nodiscard]] bool IsStableByMargins(const std::vector<TuneMargin>& margins, const std::string& gains);

/// "stable; least with firm (free): gain …, phase …, |1 + L| …", or that it is unstable.
[[nodiscard]] std::string MarginText(const TuneMargin& margin);

/// Bad if the recommended gains are unstable by the measured response, or if a 95 % disc of the Nyquist curve
/// contains -1. A warning if this holds for the cell's own gains.
void JudgeMargins(const std::vector<TuneMargin>& margins, session::Verdict& verdict);
[[nodiscard]] std::vector<report::SummaryRow> RowsOfMeasured(const TuneTask& task,
                                                             const std::vector<TuneMargin>& margins);
/// Adds two rows: the worst margin of the cell's own gains, and that of the recommended gains.
void AddMarginRows(const std::vector<TuneMargin>& margins, std::vector<report::SummaryRow>& rows);
[[nodiscard]] nlohmann::json ToJson(const std::vector<TuneMargin>& margins);
/// HTML table of the five margins nearest to instability, for the cell's own and for the recommended gains
/// each.
[[nodiscard]] std::string TableOf(const std::vector<TuneMargin>& margins);
/// The Nyquist curve of the loop to which a margin belongs. @pre worst is not null
struct NamedCurve {
  const TuneMargin* worst{nullptr};
  std::vector<NyquistPoint> curve;
};
[[nodiscard]] std::string NyquistSvg(const std::vector<NamedCurve>& curves);
/// Draws the Nyquist curves of the worst hand, with the cell's own and with the recommended gains.
[[nodiscard]] std::string NyquistSvg(const TuneTask& task, const TuneGains& own, const TuneGains& recommended,
                                     const std::vector<TuneMargin>& margins);

}  // namespace osteon::studies
