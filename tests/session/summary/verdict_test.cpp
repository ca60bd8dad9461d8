#include "session/summary/verdict.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "session/summary/summary.h"

// Tests of the verdict on a run: good, to be looked at (warning) or bad, with its reasons.

namespace osteon::session {
namespace {

// The summary of a completed run of 10 s at 1 kHz in which nothing limits the result.
RunSummary RunWithoutRemarks() {
  RunSummary s;
  s.ended = "completed";
  s.rendered = true;
  s.seconds = s.wanted_s = 10.0;
  s.period_s = 1e-3;
  s.ticks = 10000;
  s.force_limit_N = 80.0;
  return s;
}

// Whether one of the verdict's reasons contains the text.
bool Says(const Verdict& verdict, const std::string& part) {
  return std::any_of(verdict.reasons.begin(), verdict.reasons.end(),
                     [&](const std::string& reason) { return reason.find(part) != std::string::npos; });
}

TEST(RunVerdict, ARunWithoutRemarksIsGoodAndHasNoReasons) {
  const Verdict verdict = JudgeRun(RunWithoutRemarks());
  EXPECT_EQ(verdict.level, VerdictLevel::kGood);
  EXPECT_TRUE(verdict.reasons.empty());
}

TEST(RunVerdict, ASessionWithAllPassesUndoneIsAWarning) {
  RunSummary s = RunWithoutRemarks();
  s.passes = {{.number = 1, .undone = true}, {.number = 2}};
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kGood);
  s.passes.back().undone = true;
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kWarning);
  EXPECT_TRUE(Says(JudgeRun(s), "all were undone"));
}

TEST(RunVerdict, AMissedToolChangeIsAWarningThatNamesIt) {
  RunSummary s = RunWithoutRemarks();
  s.diameters_mm = {44.0, 46.0, 48.5};
  s.missed_changes = {{.tool_index = 1, .reason = "the tool before was not retracted"},
                      {.tool_index = 2, .reason = "the tool before was not retracted"}};
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kWarning);
  EXPECT_TRUE(Says(JudgeRun(s), "not made, to 46, 48.5 mm: the tool before was not retracted; a longer run"));
}

TEST(RunVerdict, ACouplingLongAtItsForceLimitIsAWarning) {
  RunSummary s = RunWithoutRemarks();
  s.cut_ticks = 20;
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kGood) << "20 ms are not felt";
  s.cut_ticks = 4000;
  s.min_wrench_share = 0.3;
  s.peak_tool_in_bone_m = 14e-3;
  const Verdict verdict = JudgeRun(s);
  EXPECT_EQ(verdict.level, VerdictLevel::kWarning);
  EXPECT_TRUE(Says(verdict, "force limit 80 N")) << verdict.reasons.front();
  EXPECT_TRUE(Says(verdict, "14.00 mm"));
}

// stale_share: the share of the run in which late frames of the simulation faded the force.
TEST(RunVerdict, AForceFadedByLateFramesIsAWarningAndBadIfOften) {
  RunSummary s = RunWithoutRemarks();
  s.stale_share = 0.01;
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kGood);
  s.stale_share = 0.1;
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kWarning);
  s.stale_share = 0.5;
  EXPECT_EQ(JudgeRun(s).level, VerdictLevel::kBad);
}

TEST(RunVerdict, AFaultOrARunThatNeverBeganIsBad) {
  RunSummary fault = RunWithoutRemarks();
  fault.end = control::RunEnd::kFault;
  fault.faults.push_back({.name = "tool too deep in bone", .time_s = 1.0, .reaction = "Stop 1"});
  EXPECT_EQ(JudgeRun(fault).level, VerdictLevel::kBad);
  EXPECT_TRUE(Says(JudgeRun(fault), "tool too deep in bone"));
  RunSummary never = RunWithoutRemarks();
  never.rendered = false;
  never.end = control::RunEnd::kNeverActive;
  never.ended = "arm never ready";
  EXPECT_EQ(JudgeRun(never).level, VerdictLevel::kBad);
  EXPECT_TRUE(Says(JudgeRun(never), "arm never ready"));
}

// One reason each for: a warning, dropped records, a recovery, passivity damping and a late sensor.
TEST(RunVerdict, EachReductionOfTheRunAddsAReason) {
  RunSummary s = RunWithoutRemarks();
  s.warnings = {"the script pushes with 120 N"};
  s.dropped = 3;
  s.recovered = 1;
  s.passivity_ticks = 5;
  s.sensor_late_share = 0.1;
  const Verdict verdict = JudgeRun(s);
  EXPECT_EQ(verdict.level, VerdictLevel::kWarning);
  EXPECT_EQ(verdict.reasons.size(), 5u);
  RunSummary interrupted = RunWithoutRemarks();
  interrupted.end = control::RunEnd::kStopFlag;
  interrupted.seconds = 3.0;
  EXPECT_EQ(JudgeRun(interrupted).level, VerdictLevel::kWarning);
  interrupted.wanted_s = 0.0;  // asked to run until it is stopped
  EXPECT_EQ(JudgeRun(interrupted).level, VerdictLevel::kGood) << "until it was stopped: it was";
}

TEST(RunVerdict, AFaultWithRecoveryByTheOperatorIsBad) {
  RunSummary s = RunWithoutRemarks();
  s.recovered = s.operator_recoveries = 2;
  s.recovered_from = {"arm message stale"};
  const Verdict verdict = JudgeRun(s);
  EXPECT_EQ(verdict.level, VerdictLevel::kBad);
  EXPECT_EQ(verdict.reasons.size(), 1u);
  EXPECT_TRUE(Says(verdict, "arm message stale"));
  EXPECT_TRUE(Says(verdict, "2 times"));
}

TEST(RunVerdict, ComesFirstInTheTableAndInTheJson) {
  RunSummary s = RunWithoutRemarks();
  s.cut_ticks = 4000;
  s.verdict = JudgeRun(s);
  const std::vector<report::SummaryRow> rows = VerdictRows(s.verdict);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].key, "Verdict");
  EXPECT_EQ(rows[0].value, "look");
  EXPECT_EQ(rows[1].value, s.verdict.reasons.front());
  const std::string text = ToJson(s, "osteon.demo/1");
  EXPECT_EQ(text.find("\"verdict\""), text.find('"')) << "the first key";
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_EQ(json.at("verdict").at("level"), "look");
  EXPECT_EQ(json.at("verdict").at("reasons").size(), 1u);
  EXPECT_TRUE(json.contains("peak_tool_in_bone_mm"));
}

}  // namespace
}  // namespace osteon::session
