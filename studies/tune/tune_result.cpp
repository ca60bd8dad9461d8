#include "studies/tune/tune_result.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "report/svg_text.h"

namespace osteon::studies {
namespace {

// Mass and drag of these gains as text.
std::string MassAndDragText(const TuneGains& gains) {
  return fmt::format("{:.3g} kg, {:.0f} N s/m", gains.mass_kg, gains.damping_Ns_per_m);
}

// A least drag as text. Infinity means that the largest drag of the search was not enough.
std::string DragText(double drag_Ns_per_m) {
  return std::isfinite(drag_Ns_per_m) ? fmt::format("{:.0f} N s/m", drag_Ns_per_m)
                                      : std::string("more than 3000 N s/m");
}

nlohmann::json ToJson(const TuneGains& gains) {
  return {{"mass_kg", gains.mass_kg}, {"damping_Ns_per_m", gains.damping_Ns_per_m}};
}

nlohmann::json ToJson(const std::vector<TuneBoundary>& boundaries, const std::vector<hil::GridHand>& hands) {
  nlohmann::json list = nlohmann::json::array();
  for (const TuneBoundary& b : boundaries)
    list.push_back({{"damping", b.damping_Ns_per_m},
                    {"stiffness_predicted", b.predicted_N_per_m},
                    {"stiffness_simulated", b.simulated_N_per_m},
                    {"stiffness_lost_and_late", b.degraded_N_per_m},
                    {"hand", hands[b.hand].name}});
  return list;
}

// Force between 5 and 40 Hz. An oscillation that remains above it is bad; below it, a warning.
constexpr double kShaken_N = 5.0;

// Adds a reason if a stiff hand keeps oscillating although the vibration index acts.
void JudgeStiffHands(const TuneResult& r, session::Verdict& verdict) {
  const StiffHandRun* worst = r.WorstStiffHand();
  if (worst == nullptr || worst->Calm()) return;
  const auto calm = std::ranges::count_if(r.stiff_hands, &StiffHandRun::Calm);
  const bool shaken = !worst->run.valid || worst->run.one_s_N > kShaken_N;
  verdict.Add(
      shaken ? session::VerdictLevel::kBad : session::VerdictLevel::kWarning,
      fmt::format("oscillation remains 1 s after the grip closed with {} of {} hands stiffer than {:g} N/m, "
                  "though the vibration index acts: the worst, {} ({}), {}",
                  static_cast<std::ptrdiff_t>(r.stiff_hands.size()) - calm, r.stiff_hands.size(),
                  r.task.human_grip_N_per_m, worst->hand.name, worst->contact,
                  worst->run.valid ? fmt::format("with {:.2f} N between 5 and 40 Hz, {:.2g} N accepted",
                                                 worst->run.one_s_N, worst->calm_N)
                                   : std::string("ended the run")));
}

// The number, or null if it is infinite: JSON has no infinity.
nlohmann::json FiniteOrNull(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace

const StiffHandRun* TuneResult::WorstStiffHand() const {
  if (stiff_hands.empty()) return nullptr;
  return &*std::ranges::max_element(stiff_hands, {}, [](const StiffHandRun& c) {
    return c.run.valid ? c.run.one_s_N : std::numeric_limits<double>::infinity();
  });
}

bool TuneResult::MayBeUsed() const {
  return HasRecommendation() && check.grew.empty() && IsStableByMargins(margins, "recommended");
}

bool TuneResult::OwnGainsAreStable() const {
  return own_margin >= task.margin && IsStableByMargins(margins, "own");
}

session::Verdict Judge(const TuneResult& r) {
  session::Verdict verdict;
  if (r.guidance) JudgeGuidance(*r.guidance, verdict);
  JudgeMargins(r.margins, verdict);
  if (!r.HasRecommendation()) {
    verdict.Add(session::VerdictLevel::kBad, "no gains stand what was asked, whatever the drag");
    return verdict;
  }
  if (!r.check.grew.empty())
    verdict.Add(session::VerdictLevel::kBad,
                fmt::format("run in time with the recommended gains, {} of {} runs grew: {}",
                            r.check.grew.size(), r.check.runs, fmt::join(r.check.grew, "; ")));
  JudgeStiffHands(r, verdict);
  if (!r.task.index_acts && !r.stiff_hands.empty())
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("hands stiffer than {:g} N/m need the vibration index, which does not act in this cell "
                    "(vibration: acts: false)",
                    r.task.human_grip_N_per_m));
  if (r.task.identified && !r.task.arm_measured)
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("identified: found {}, and no arm: how the arm follows is assumed ({:g} Hz, {:.3g} "
                    "ms dead time); measure it by `osteon identify {}`",
                    FiguresBesideArm(*r.task.identified), r.task.loop.arm.bandwidth_hz,
                    1e3 * r.task.loop.arm.dead_cycles * r.task.loop.period_s, r.cell));
  else if (r.task.identified && !r.task.response)
    verdict.Add(session::VerdictLevel::kWarning,
                "identified: found no frequency response along the axis on which the arm is slowest: its "
                "measured bandwidth, damping and dead time alone say how it follows");
  if (!(r.own_margin >= r.task.margin))
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format("the cell's own gains, {:.3g} kg and {:.0f} N s/m, {}", r.task.loop.mass_kg,
                    r.task.loop.damping_Ns_per_m,
                    r.own_margin > 0.0 ? fmt::format("have a gain margin of {:.2f}, {:g} asked for",
                                                     r.own_margin, r.task.margin)
                                       : std::string("are not stable with all of these hands and contacts")));
  if (!r.IsLight())
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("the recommended tool is not light: {}, against {:g} kg and {:g} N s/m",
                            MassAndDragText(r.recommended), r.task.max_mass_kg, r.task.max_drag_Ns_per_m));
  return verdict;
}

namespace {

// Says which part of the dead time belongs to the sensor: the part of the sensor's measured delay that
// exceeds the whole ticks of the loop's sensor_delay. Empty if there is no such part.
std::string SensorPart(const TuneTask& t) {
  if (!t.identified || !t.identified->sensor || !t.identified->sensor->delay_s) return "";
  const double part_s = *t.identified->sensor->delay_s - t.loop.sensor_delay * t.loop.period_s;
  return part_s > 0.0 ? fmt::format(" ({:.2g} ms of it the sensor's)", 1e3 * part_s) : "";
}

}  // namespace

std::vector<report::SummaryRow> Rows(const TuneResult& r) {
  const TuneTask& t = r.task;
  std::vector<report::SummaryRow> rows{
      {"Cell",
       fmt::format("{}: arm of {:g} Hz, {:.3g} ms dead time{}, sensor {:g} ms late, period {:g} ms", r.cell,
                   t.loop.arm.bandwidth_hz, 1e3 * t.loop.arm.dead_cycles * t.loop.period_s, SensorPart(t),
                   1e3 * t.loop.sensor_delay * t.loop.period_s, 1e3 * t.loop.period_s)},
      {"Must be stable with",
       fmt::format(
           "hands up to {:g} N/m, free and at a wall of {:g} N/mm; planes that move with {:.1f} N/mm, "
           "{:g} ms old; {:g} % of the commands lost, {:g} ms jitter; gain margin {:g}",
           t.human_grip_N_per_m, 1e-3 * t.wall_N_per_m, 1e-3 * t.plane_N_per_m, 1e3 * t.worst_age_s,
           100.0 * t.command_loss, 1e3 * t.command_jitter * t.loop.period_s, t.margin)},
      {"The cell's own gains",
       fmt::format("{:.3g} kg, {:.0f} N s/m: {}", t.loop.mass_kg, t.loop.damping_Ns_per_m,
                   r.own_margin > 0.0 ? fmt::format("gain margin {:.2f}", r.own_margin)
                                      : std::string("not stable with all of these"))}};
  for (report::SummaryRow& row : RowsOfMeasured(t, r.margins)) rows.push_back(std::move(row));
  if (r.guidance)
    for (report::SummaryRow& row : RowsOf(*r.guidance)) rows.push_back(std::move(row));
  if (!r.HasRecommendation()) {
    rows.push_back({"Recommended", "none: no mass of those tried is stable, whatever the drag"});
    return rows;
  }
  rows.push_back({"Recommended", fmt::format("{}, gain margin {:.2f}", MassAndDragText(r.recommended),
                                             r.recommended_margin)});
  rows.push_back(
      {"Which to use",
       r.OwnGainsAreStable()
           ? std::string("the cell's own: they have the margin; the recommended ones are the lightest "
                         "that have it")
       : r.MayBeUsed() ? std::string("the recommended ones: gains.yaml")
                       : std::string("none of these: the verdict says why")});
  if (r.check.runs > 0)
    rows.push_back(
        {"Simulated",
         r.check.grew.empty()
             ? fmt::format("{} runs{}; no oscillation grew", r.check.runs,
                           t.command_loss > 0.0 || t.command_jitter > 0 ? " with commands lost and late" : "")
             : fmt::format("in {} of {} runs an oscillation grew: {}", r.check.grew.size(), r.check.runs,
                           fmt::join(r.check.grew, "; "))});
  rows.push_back({"Light to the hand",
                  r.IsLight()
                      ? fmt::format("yes: at most {:g} kg and {:g} N s/m", t.max_mass_kg, t.max_drag_Ns_per_m)
                      : (r.within_bar_margin > 0.0
                             ? fmt::format("no: with at most {:g} kg and {:g} N s/m the greatest gain margin "
                                           "is {:.2f}, with {}",
                                           t.max_mass_kg, t.max_drag_Ns_per_m, r.within_bar_margin,
                                           MassAndDragText(r.within_bar))
                             : fmt::format("no: with at most {:g} kg and {:g} N s/m nothing is stable "
                                           "with these hands",
                                           t.max_mass_kg, t.max_drag_Ns_per_m))});
  rows.push_back(
      {fmt::format("Grips up to {:g} N/m", t.stiffest_grip_N_per_m),
       fmt::format(
           "need {} at this mass, {:.1f} times the recommended drag, and a clamp of 50 kN/m needs {}: the "
           "vibration index adds this drag while the tool shakes",
           DragText(r.stiffest_Ns_per_m), r.stiffest_Ns_per_m / r.recommended.damping_Ns_per_m,
           DragText(r.clamp_Ns_per_m))});
  if (const StiffHandRun* worst = r.WorstStiffHand()) {
    const auto calm = std::ranges::count_if(r.stiff_hands, &StiffHandRun::Calm);
    const double max_mean_damping = std::ranges::max(r.stiff_hands, {}, [](const StiffHandRun& c) {
                                      return c.run.mean_damping;
                                    }).run.mean_damping;
    rows.push_back(
        {"With the vibration index",
         fmt::format("{} of {} stiffer hands are calm 1 s after the grip closed (below {:g} N between 5 and "
                     "40 Hz); the worst hand, {} ({}), keeps {:.2f} N; their drag is on average up to {:.0f} "
                     "times the recommended one; hands up to {:g} N/m raise the index (0 to 1) to {:.2g}{}",
                     calm, r.stiff_hands.size(), worst->calm_N, worst->hand.name, worst->contact,
                     worst->run.one_s_N, max_mean_damping, t.human_grip_N_per_m, r.human_index,
                     t.index_acts ? "" : "; in this cell it does not act (vibration: acts: false)")});
  }
  rows.push_back({"For the planes' age",
                  fmt::format("{:.0f} N s/m of drag suffice: largest age × stiffness of the planes",
                              r.age_bound_Ns_per_m)});
  rows.push_back(
      {"Computed", fmt::format("{} results; {} more kept from an earlier tune", r.computed, r.found)});
  return rows;
}

std::string ToJson(const TuneResult& r, const std::string& command_line) {
  const TuneTask& t = r.task;
  nlohmann::json json{
      {"schema", "osteon.tune/1"},
      {"subcommand", "tune"},
      {"command_line", command_line},
      {"cell", r.cell},
      {"arm",
       {{"bandwidth_hz", t.loop.arm.bandwidth_hz},
        {"damping_ratio", t.loop.arm.damping_ratio},
        {"dead_cycles", t.loop.arm.dead_cycles},
        {"felt_mass_kg", t.loop.felt_mass_kg > 0.0 ? nlohmann::json(t.loop.felt_mass_kg) : nlohmann::json()},
        {"sensor_delay", t.loop.sensor_delay},
        {"period_ms", 1e3 * t.loop.period_s}}},
      {"stands",
       {{"grip_N_per_m", t.human_grip_N_per_m},
        {"wall_N_per_m", t.wall_N_per_m},
        {"plane_N_per_m", t.plane_N_per_m},
        {"worst_age_ms", 1e3 * t.worst_age_s},
        {"loss", t.command_loss},
        {"jitter_ms", 1e3 * t.command_jitter * t.loop.period_s}}},
      {"margin", t.margin},
      {"own",
       {{"mass_kg", t.loop.mass_kg},
        {"damping_Ns_per_m", t.loop.damping_Ns_per_m},
        {"margin", r.own_margin}}},
      {"recommended", nullptr},
      {"within_bar", nullptr},
      {"bar", {{"mass_kg", t.max_mass_kg}, {"damping_Ns_per_m", t.max_drag_Ns_per_m}, {"met", r.IsLight()}}},
      {"age_bound_Ns_per_m", r.age_bound_Ns_per_m},
      {"boundary", ToJson(r.human, r.human_hands)},
      {"boundary_stiffest", ToJson(r.stiffest, r.stiffest_hands)},
      {"boundary_firm", ToJson(r.firm, {hil::NamedHands()[1]})},
      {"results", {{"computed", r.computed}, {"from_before", r.found}}}};
  json["law"] = "admittance";
  json["identified"] = t.identified.has_value();
  json["measured_only"] = t.measured_only;
  json["margins"] = ToJson(r.margins);
  if (r.guidance) json["guidance"] = ToJson(*r.guidance);
  if (r.within_bar_margin > 0.0) {
    json["within_bar"] = ToJson(r.within_bar);
    json["within_bar"]["margin"] = r.within_bar_margin;
  }
  for (const TuneTrade& trade : r.trade)
    json["trade"].push_back({{"mass_kg", trade.mass_kg},
                             {"damping_human", FiniteOrNull(trade.human_Ns_per_m)},
                             {"damping_stiffest", FiniteOrNull(trade.stiffest_Ns_per_m)}});
  if (!r.HasRecommendation()) return session::ResultText(Judge(r), json);
  json["recommended"] = ToJson(r.recommended);
  json["recommended"]["margin"] = r.recommended_margin;
  json["stiff_grips"] = {{"grip_N_per_m", t.stiffest_grip_N_per_m},
                         {"damping_Ns_per_m", FiniteOrNull(r.stiffest_Ns_per_m)},
                         {"clamp_damping_Ns_per_m", FiniteOrNull(r.clamp_Ns_per_m)}};
  json["stiff_hands"] = {
      {"index_acts", t.index_acts}, {"index_of_grips", r.human_index}, {"hands", nlohmann::json::array()}};
  for (const StiffHandRun& c : r.stiff_hands)
    json["stiff_hands"]["hands"].push_back({{"hand", c.hand.name},
                                            {"stiffness_N_per_m", c.hand.stiffness_N_per_m},
                                            {"contact", c.contact},
                                            {"calm", c.Calm()},
                                            {"calm_below_N", c.calm_N},
                                            {"force_from_half_s_N", FiniteOrNull(c.run.half_s_N)},
                                            {"force_from_1_s_N", FiniteOrNull(c.run.one_s_N)},
                                            {"damping_most_ratio", c.run.max_damping},
                                            {"damping_mean_ratio", c.run.mean_damping}});
  json["check"] = {{"runs", r.check.runs}, {"grew", r.check.grew}};
  return session::ResultText(Judge(r), json);
}

std::string BoundaryCsv(const TuneResult& r) {
  std::string csv = "hands,damping_Ns_per_m,predicted_N_per_m,simulated_N_per_m,lost_and_late_N_per_m\n";
  const auto add = [&](const std::string& name, const std::vector<TuneBoundary>& boundaries) {
    for (const TuneBoundary& b : boundaries)
      csv += fmt::format("{},{:.3f},{:.0f},{:.0f},{:.0f}\n", name, b.damping_Ns_per_m, b.predicted_N_per_m,
                         b.simulated_N_per_m, b.degraded_N_per_m);
  };
  add("firm", r.firm);
  add(fmt::format("up to {:g} N/m", r.task.human_grip_N_per_m), r.human);
  add(fmt::format("up to {:g} N/m", r.task.stiffest_grip_N_per_m), r.stiffest);
  return csv;
}

std::string CarriedTable(const TuneResult& r) {
  std::string table =
      "<table>\n<tr><th>hand</th><th>worst contact</th><th>force from 0.5 s on [N]</th><th>from 1 s on "
      "[N]</th><th>drag, most</th><th>drag, mean</th></tr>\n";
  for (const StiffHandRun& c : r.stiff_hands)
    table += fmt::format(
        "<tr><th>{}</th><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.0f} ×</td><td>{:.1f} ×</td></tr>\n",
        report::Escape(c.hand.name), c.contact, c.run.half_s_N, c.run.one_s_N, c.run.max_damping,
        c.run.mean_damping);
  return table + "</table>\n";
}

std::string GainsYaml(const TuneResult& r, const std::string& command_line) {
  const TuneTask& t = r.task;
  return fmt::format(
      "# {}\n# Stands hands up to {:g} N/m with gain margin {:.2f}, contact models up to {:g} ms old.\n"
      "# For: osteon run CELL.yaml --gains THIS_FILE\nadmittance:\n  mass_kg: [{m:.10g}, {m:.10g}, "
      "{m:.10g}]\n"
      "  damping_Ns_per_m: [{b:.10g}, {b:.10g}, {b:.10g}]\ncoupling:\n  stiffness_N_per_mm: {:.10g}\n",
      command_line, t.human_grip_N_per_m, r.recommended_margin, 1e3 * t.worst_age_s, 1e-3 * t.wall_N_per_m,
      fmt::arg("m", r.recommended.mass_kg), fmt::arg("b", r.recommended.damping_Ns_per_m));
}

}  // namespace osteon::studies
