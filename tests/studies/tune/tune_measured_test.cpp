#include "studies/tune/tune_measured.h"

#include <algorithm>
#include <complex>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/apply_identified.h"
#include "config/reading/strict/config_error.h"
#include "studies/tune/overlay_tuning.h"
#include "studies/tune/tune_page.h"
#include "tests/studies/tune/identified_sample.h"
#include "tests/temporary_path.h"

// `osteon tune` of a cell whose arm, sensor, link and hand were measured instead of assumed.

namespace osteon::studies {
namespace {

config::CellConfig LoadDemoCell() {
  return config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml");
}

ResponseModel SlowArm() { return {.arm = {.bandwidth_hz = 13.0, .damping_ratio = 1.2, .dead_cycles = 4.56}}; }

// The demo's task with a perfect identification of `truth`.
TuneTask MeasuredTask(const ResponseModel& truth) {
  const config::CellConfig cell = LoadDemoCell();
  TuneTask task = TuneTaskOf(cell);
  UseIdentified(IdentifiedOf(cell, truth), task);
  return task;
}

TEST(TuneMeasured, UsesTheMeasuredFigures) {
  const TuneTask task = MeasuredTask(SlowArm());
  EXPECT_DOUBLE_EQ(task.loop.arm.bandwidth_hz, 13.0);
  EXPECT_DOUBLE_EQ(task.loop.arm.damping_ratio, 1.2);
  EXPECT_NEAR(task.loop.arm.dead_cycles, 4.56, 1e-9) << "as measured, without a period more";
  EXPECT_EQ(task.loop.sensor_delay, 1);
  EXPECT_EQ(task.command_jitter, 1) << "0.2 ms beyond its mean";
  EXPECT_DOUBLE_EQ(task.command_loss, 0.001);
  ASSERT_EQ(task.measured_hands.size(), 3u) << "the hand, and both ends of its interval";
  EXPECT_EQ(HandsUpTo(task, 100.0).size(), HandsUpTo(100.0).size() + 3);
  EXPECT_FALSE(task.measured_only);
  ASSERT_TRUE(task.response);
  EXPECT_DOUBLE_EQ(task.response_delay_s, 1e-3);
}

TEST(TuneMeasured, APartPeriodOfTheSensorsDelayIsAddedToTheDeadTime) {
  const config::CellConfig cell = LoadDemoCell();
  config::IdentifiedCell identified = IdentifiedOf(cell, SlowArm());
  identified.sensor->delay_s = 1.7e-3;
  identified.link->jitter_p99_s = identified.link->jitter_mean_s;
  TuneTask task = TuneTaskOf(cell);
  UseIdentified(identified, task);
  EXPECT_EQ(task.loop.sensor_delay, 1);
  EXPECT_NEAR(task.loop.arm.dead_cycles, 4.56 + 0.7, 1e-9);
  EXPECT_EQ(task.command_jitter, 0);
}

TEST(TuneMeasured, UsesTheAxisOnWhichTheArmIsSlowest) {
  const config::CellConfig cell = LoadDemoCell();
  config::IdentifiedCell identified = IdentifiedOf(cell, SlowArm());
  config::IdentifiedArm slower = identified.arm[0];
  slower.axis = "x";
  slower.bandwidth_hz = 10.0;
  slower.lag_s += 8e-3;
  identified.arm.push_back(slower);
  EXPECT_EQ(config::SlowestArm(identified)->axis, "x");
  TuneTask task = TuneTaskOf(cell);
  UseIdentified(identified, task);
  EXPECT_DOUBLE_EQ(task.loop.arm.bandwidth_hz, 10.0);
  EXPECT_FALSE(task.response) << "no response was measured along x";
}

// The file has a force sensor and a hand, but no arm: the arm's lag is assumed, and every text must say so.
TEST(TuneMeasured, WithoutAMeasuredArmTheVerdictNamesWhatIsAssumed) {
  const config::CellConfig cell = LoadDemoCell();
  config::IdentifiedCell identified = IdentifiedOf(cell, SlowArm());
  identified.arm.clear();
  identified.response.clear();
  identified.link->jitter_p99_s = identified.link->jitter_mean_s;
  identified.sensor->delay_s = 3e-3;
  TuneTask task = TuneTaskOf(cell);
  const TuneTask assumed = task;
  UseIdentified(identified, task);
  EXPECT_EQ(task.loop.arm.bandwidth_hz, assumed.loop.arm.bandwidth_hz);
  EXPECT_EQ(task.loop.arm.dead_cycles, assumed.loop.arm.dead_cycles);
  EXPECT_EQ(task.command_jitter, assumed.command_jitter) << "no measured dead time has its mean";
  EXPECT_EQ(task.loop.sensor_delay, 3);
  EXPECT_EQ(task.measured_hands.size(), 3u) << "a measured hand has to be stable in any case";

  TuneResult r;
  r.cell = "demo";
  r.task = task;
  r.recommended = {1.7, 28.0};
  r.recommended_margin = r.own_margin = 1.2;
  const auto says = [](const std::vector<std::string>& lines, const std::string& text) {
    return std::ranges::any_of(lines,
                               [&](const std::string& line) { return line.find(text) != std::string::npos; });
  };
  const std::vector<std::string> reasons = Judge(r).reasons;
  EXPECT_TRUE(says(reasons,
                   "found the force sensor's noise, its delay, the link's jitter and losses, a hand, "
                   "and no arm: how the arm follows is assumed"))
      << testing::PrintToString(reasons);
  EXPECT_FALSE(says(reasons, "frequency response"));
  EXPECT_TRUE(says(PlainVerdict(r).reasons, "the arm's lag is assumed, not measured"));
  EXPECT_TRUE(says(PlainVerdict(r).reasons, "Before a real arm moves, measure it"));

  OverlayTuning overlay{.cell = "mine", .task = task, .loop = {}};
  overlay.recommended_Ns_per_m = 50.0;
  overlay.recommended_N_per_m = task.wall_N_per_m;
  EXPECT_TRUE(says(Judge(overlay).reasons, "and no arm: dead time and springs are the cell's, assumed"));

  // an arm's model without the response to which it was fitted
  identified.arm = IdentifiedOf(cell, SlowArm()).arm;
  UseIdentified(identified, r.task);
  EXPECT_TRUE(
      says(Judge(r).reasons, "found no frequency response along the axis on which the arm is slowest"));
  EXPECT_TRUE(says(PlainVerdict(r).reasons, "the arm's lag is measured"));
}

TEST(TuneMeasured, MarginsFollowTheResponseAndDecideTheVerdict) {
  const TuneTask task = MeasuredTask(SlowArm());
  const std::vector<hil::GridHand> hands{{"grip", 3e3, 20.0, 1.5}, {"firm", 500.0, 20.0, 1.5}};
  std::vector<TuneMargin> margins = MeasuredMargins(task, "own", {1.7, 15.0}, hands);
  const std::vector<TuneMargin> good = MeasuredMargins(task, "recommended", {1.7, 60.0}, hands);
  margins.insert(margins.end(), good.begin(), good.end());
  ASSERT_EQ(margins.size(), 12u) << "two gains, two hands, three contacts";
  ASSERT_NE(WorstOf(margins, "own"), nullptr);
  EXPECT_FALSE(WorstOf(margins, "own")->margins.stable);
  EXPECT_EQ(WorstOf(margins, "own")->hand.name, "grip");
  EXPECT_TRUE(WorstOf(margins, "recommended")->margins.robust);
  session::Verdict verdict;
  JudgeMargins(margins, verdict);
  EXPECT_EQ(verdict.level, session::VerdictLevel::kWarning) << "the cell's own gains only";
  for (TuneMargin& margin : margins) margin.gains = "recommended";
  session::Verdict bad;
  JudgeMargins(margins, bad);
  EXPECT_EQ(bad.level, session::VerdictLevel::kBad);
  const nlohmann::json json = ToJson(margins);
  ASSERT_EQ(json.size(), 12u);
  for (const char* key : {"hand", "contact", "stable", "gain", "phase_deg", "modulus", "robust"})
    EXPECT_TRUE(json[0].contains(key)) << key;
  EXPECT_NE(NyquistSvg(task, {1.7, 15.0}, {1.7, 60.0}, good).find("<svg"), std::string::npos);
}

// The arm has a structural resonance of 22 Hz that the encoders don't measure. Gains that are stable with the
// arm's model are unstable with it.
TEST(TuneMeasured, WithAStructuralResonanceOnlyTheResponseDecides) {
  ResponseModel truth = SlowArm();
  truth.structure = {{.hz = 22.0, .damping_ratio = 0.03}};
  truth.delay_s = 1e-3;
  const TuneTask task = MeasuredTask(truth), without = MeasuredTask(SlowArm());
  ASSERT_TRUE(task.measured_only);
  const std::vector<hil::GridHand> hands{{"grip", 3e3, 20.0, 1.5}};
  EXPECT_TRUE(IsStable(without, {2.4, 80.0}, hands, 1.0));
  EXPECT_FALSE(IsStable(task, {2.4, 80.0}, hands, 1.0));
  EXPECT_EQ(IsStable(task, {2.4, 80.0}, hands, 1.0), IsStableAsMeasured(task, {2.4, 80.0}, hands, 1.0));
}

// A hand's measured loop has three times the gain, and 30 ms more delay, than the hand and arm that were
// measured separately. The measured loop must decide, and its margins must name the hand.
TEST(TuneMeasured, AHandIsJudgedByItsMeasuredLoop) {
  const config::CellConfig cell = LoadDemoCell();
  const auto task_with = [&](double factor, double later_s) {
    config::IdentifiedCell identified = IdentifiedOf(cell, SlowArm());
    config::IdentifiedResponse held = identified.response[0];
    held.hand = "mine";
    for (config::IdentifiedLine& line : held.lines) {
      const std::complex<double> value = std::polar(factor, -2.0 * std::numbers::pi * line.hz * later_s) *
                                         std::complex<double>(line.re, line.im);
      line.re = value.real();
      line.im = value.imag();
    }
    identified.response.push_back(held);
    TuneTask task = TuneTaskOf(cell);
    UseIdentified(identified, task);
    return task;
  };
  const TuneTask alike = task_with(1.0, 1e-3), later = task_with(3.0, 31e-3);
  ASSERT_EQ(alike.held.size(), 1u);
  ASSERT_TRUE(alike.response) << "a held run is no arm's";
  const std::vector<TuneMargin> good = MeasuredMargins(alike, "recommended", {1.7, 60.0}, {}),
                                bad = MeasuredMargins(later, "recommended", {1.7, 60.0}, {});
  ASSERT_EQ(good.size(), 3u) << "free, at the wall, on planes";
  EXPECT_TRUE(good[0].margins.stable);
  EXPECT_FALSE(bad[0].margins.stable);
  EXPECT_EQ(bad[0].hand.name, "mine, its own loop as measured");
  EXPECT_TRUE(IsStableAsMeasured(alike, {1.7, 60.0}, {}, 1.0));
  EXPECT_FALSE(IsStableAsMeasured(later, {1.7, 60.0}, {}, 1.0));
  session::Verdict verdict;
  JudgeMargins(bad, verdict);
  EXPECT_EQ(verdict.level, session::VerdictLevel::kBad);
  EXPECT_NE(NyquistSvg(later, {1.7, 60.0}, {1.7, 60.0}, bad).find("its own loop"), std::string::npos);
}

// Under the impedance law, gains that are unstable by the measured response must not be used.
TEST(TuneMeasured, OverlayGainsMustBeStableByTheResponseToo) {
  OverlayTuning t{.cell = "mine", .task = TuneTaskOf(LoadDemoCell()), .loop = {}};
  t.recommended_Ns_per_m = 50.0;
  t.recommended_N_per_m = t.task.wall_N_per_m;
  t.planes_N_per_m = t.task.plane_N_per_m;
  t.own_margin = 1.2;
  EXPECT_TRUE(t.MayBeUsed());
  t.margins = {{.gains = "recommended",
                .hand = {"grip, along z", 3e3, 20.0, 1.5},
                .contact = TuneContact::kWall,
                .margins = {.unstable_poles = 2}}};
  EXPECT_FALSE(t.MayBeUsed());
  EXPECT_EQ(Judge(t).level, session::VerdictLevel::kBad);
  bool told = false;
  for (const report::SummaryRow& row : Rows(t)) told |= row.key == "Measured, recommended gains";
  EXPECT_TRUE(told);
}

TEST(TuneMeasured, TheSimulatedCellUsesTheMeasuredFigures) {
  config::CellConfig cell = LoadDemoCell();
  const std::filesystem::path file = TemporaryPath("identified.yaml");
  std::ofstream(file) << config::WriteIdentified(IdentifiedOf(cell, SlowArm()), "");
  config::ApplyIdentified(file, cell);
  EXPECT_DOUBLE_EQ(cell.simulated.servo.bandwidth_hz, 13.0);
  EXPECT_NEAR(cell.simulated.servo.dead_cycles, 4.56, 1e-9);
  EXPECT_EQ(cell.simulated.dynamic.dead_cycles, 5);
  EXPECT_TRUE(cell.identified);

  config::IdentifiedCell late = IdentifiedOf(cell, SlowArm());
  late.arm[0].dead_time_s = 40e-3;
  late.arm[0].dead_time_interval_s = {.low = 0.039, .high = 0.041};
  late.arm[0].lag_s = 40e-3 + late.arm[0].damping_ratio / (std::numbers::pi * late.arm[0].bandwidth_hz);
  late.arm[0].lag_interval_s = {.low = 0.05, .high = 0.1};
  std::ofstream(file) << config::WriteIdentified(late, "");
  try {
    config::ApplyIdentified(file, cell);
    FAIL() << "40 periods are more than the simulated arm can be late";
  } catch (const config::ConfigError& refused) {
    EXPECT_NE(std::string(refused.what()).find("dead_time_ms: found 40 ms, accepted 0 … 32 ms"),
              std::string::npos)
        << refused.what();
  }
}

TEST(TunePage, VerdictStatesSafetyGainsReasonsAndNextStep) {
  TuneResult r;
  r.cell = "demo";
  r.task = TuneTaskOf(LoadDemoCell());
  r.recommended = {1.7, 28.0};
  r.recommended_margin = 1.12;
  r.own_margin = 1.2;
  const report::ReportVerdict safe = PlainVerdict(r);
  EXPECT_EQ(safe.text, "Safe: the cell's own gains, 1.7 kg and 30 N s/m");
  ASSERT_EQ(safe.reasons.size(), 3u);
  EXPECT_TRUE(safe.reasons[0].starts_with("Which gains: the cell's own")) << safe.reasons[0];
  EXPECT_NE(safe.reasons[1].find("assumed, not measured"), std::string::npos);
  EXPECT_NE(safe.reasons[2].find("osteon identify demo"), std::string::npos);
  r.own_margin = 1.0;
  EXPECT_EQ(PlainVerdict(r).level, "look");
  EXPECT_EQ(PlainVerdict(r).text, "Safe, with remarks: 1.7 kg and 28 N s/m");
  EXPECT_NE(PlainVerdict(r).reasons[0].find("28 N s/m instead of"), std::string::npos);
  r.recommended = {};
  EXPECT_EQ(PlainVerdict(r).level, "bad");
  EXPECT_TRUE(PlainVerdict(r).text.starts_with("Not safe"));
}

}  // namespace
}  // namespace osteon::studies
