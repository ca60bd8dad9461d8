#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "report/page.h"
#include "session/summary/verdict.h"
#include "studies/stability/measured_loop.h"
#include "studies/tune/tune_study.h"

// A task with measured figures (`osteon identify`), and its judgement by the measured response alone.

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
/// The figures of a file besides the arm's motion, for people: "the force sensor's noise, a dead zone".
[[nodiscard]] std::string FiguresBesideArm(const config::IdentifiedCell& identified);
/// Adds the measured hands, each with the ends of its interval.
void UseHands(const config::IdentifiedCell& identified, TuneTask& task);
/// Jitter beyond its mean [whole periods]; the measured dead time includes the mean.
[[nodiscard]] int JitterOf(const config::IdentifiedLink& link, double period_s);

/// A cell's task, with the figures of `cell.identified` if there are some. Without them, the sensor's delay
/// and the commands' jitter are assumed to be a millisecond each, in whole ticks.
[[nodiscard]] TuneTask MeasuredTaskOf(const config::CellConfig& cell);

/// Whether the measured response is stable with all hands and contacts; hand and wall are multiplied by
/// `gain`.
[[nodiscard]] bool StandsMeasured(const TuneTask& task, const TuneGains& gains,
                                  const std::vector<hil::GridHand>& hands, double gain);

/// The loop of one hand and contact, judged by the measured response.
struct TuneMargin {
  std::string gains;  ///< "own" or "recommended"
  hil::GridHand hand;
  TuneContact contact{};
  LoopMargins margins;
};

/// One margin for each hand and contact, including hands whose own loops were measured; empty without a
/// response.
[[nodiscard]] std::vector<TuneMargin> MeasuredMargins(const TuneTask& task, const std::string& name,
                                                      const TuneGains& gains,
                                                      const std::vector<hil::GridHand>& hands);
/// The margin nearest to instability: an unstable one first, otherwise the one whose curve is nearest to -1.
/// Null: there is none.
[[nodiscard]] const TuneMargin* WorstOf(const std::vector<TuneMargin>& margins, const std::string& gains);

/// Whether these gains are stable by the response with every hand and contact, with 95 % probability; true
/// without a response.
[[nodiscard]] bool StandsByMargins(const std::vector<TuneMargin>& margins, const std::string& gains);

/// "stable; least with firm (free): gain …, phase …, |1 + L| …", or that it is unstable.
[[nodiscard]] std::string MarginText(const TuneMargin& margin);

/// Bad if the recommended gains are unstable by the response, or a 95 % disc of its curve contains -1; a
/// warning if this is so for the cell's own gains.
void JudgeMargins(const std::vector<TuneMargin>& margins, session::Verdict& verdict);
[[nodiscard]] std::vector<report::SummaryRow> RowsOfMeasured(const TuneTask& task,
                                                             const std::vector<TuneMargin>& margins);
/// Adds a row with the worst margin of the own and of the recommended gains.
void AddMarginRows(const std::vector<TuneMargin>& margins, std::vector<report::SummaryRow>& rows);
[[nodiscard]] nlohmann::json ToJson(const std::vector<TuneMargin>& margins);
/// HTML table of the five margins nearest to instability, for each of the two gains.
[[nodiscard]] std::string TableOf(const std::vector<TuneMargin>& margins);
/// The Nyquist curve of a margin. @pre worst points to it
struct NamedCurve {
  const TuneMargin* worst{nullptr};
  std::vector<NyquistPoint> curve;
};
[[nodiscard]] std::string NyquistSvg(const std::vector<NamedCurve>& curves);
/// Nyquist curves of the worst hand of each of the gains.
[[nodiscard]] std::string NyquistSvg(const TuneTask& task, const TuneGains& own, const TuneGains& recommended,
                                     const std::vector<TuneMargin>& margins);

}  // namespace osteon::studies
