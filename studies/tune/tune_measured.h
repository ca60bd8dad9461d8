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

/// Gives a task what was measured of its cell: the arm of the slowest axis and speed with its dead time as
/// measured, the mass by which the hand moves it, jitter beyond its mean (which the dead time has in it), the
/// share of lost answers, the sensor's delay, the hands, and the response. Whole ticks of the sensor's delay
/// go to the loop, the rest to the arm's dead time, where it acts alike. Without a measured arm its lag stays
/// assumed, and so does the jitter, whose mean no measured dead time holds; sensor and hands are the measured
/// ones.
void UseIdentified(const config::IdentifiedCell& identified, TuneTask& task);
/// The figures of a file besides the arm's motion, for people: "the force sensor's noise, a dead zone".
[[nodiscard]] std::string FiguresBesideArm(const config::IdentifiedCell& identified);
/// Adds the measured hands, each with the ends of its interval.
void UseHands(const config::IdentifiedCell& identified, TuneTask& task);
/// Jitter beyond its mean, which the measured dead time holds already [whole periods].
[[nodiscard]] int JitterOf(const config::IdentifiedLink& link, double period_s);

/// A cell's task, with the lags that are assumed where nothing was measured: one millisecond of the sensor's
/// delay and of the commands' jitter, in whole ticks; and with `cell.identified`, if there is one.
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

/// One for each hand and contact, those whose own loops were measured as well; empty without a response.
[[nodiscard]] std::vector<TuneMargin> MeasuredMargins(const TuneTask& task, const std::string& name,
                                                      const TuneGains& gains,
                                                      const std::vector<hil::GridHand>& hands);
/// The one nearest to instability: unstable ones first, then the least distance of -1. Null: there are none.
[[nodiscard]] const TuneMargin* WorstOf(const std::vector<TuneMargin>& margins, const std::string& gains);

/// Whether these gains are stable by the response with every hand and contact, to 95 %; true without one.
[[nodiscard]] bool StandsByMargins(const std::vector<TuneMargin>& margins, const std::string& gains);

/// "stable; least with firm (free): gain …, phase …, |1 + L| …", or that it is unstable.
[[nodiscard]] std::string MarginText(const TuneMargin& margin);

/// Bad if the recommended gains are unstable by the response, or its discs of 95 % hold -1; to be looked at
/// if the cell's own are.
void JudgeMargins(const std::vector<TuneMargin>& margins, session::Verdict& verdict);
[[nodiscard]] std::vector<report::SummaryRow> RowsOfMeasured(const TuneTask& task,
                                                             const std::vector<TuneMargin>& margins);
/// Adds the worst margin of each of the gains.
void AddMarginRows(const std::vector<TuneMargin>& margins, std::vector<report::SummaryRow>& rows);
[[nodiscard]] nlohmann::json ToJson(const std::vector<TuneMargin>& margins);
/// The five nearest to instability for each of the gains, as an HTML table.
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
