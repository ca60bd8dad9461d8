#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/capability/capability_result.h"
#include "studies/charts/chart_scaling.h"
#include "studies/charts/chart_speed_accuracy.h"
#include "studies/plan/plan_result.h"
#include "studies/transparency/transparency.h"
#include "studies/tune/tune_result.h"

// The verdicts of the studies: every level (good, warning, bad) with the reason that it must state.

namespace osteon::studies {
namespace {

bool HasReason(const session::Verdict& verdict, const std::string& part) {
  return std::ranges::any_of(
      verdict.reasons, [&](const std::string& reason) { return reason.find(part) != std::string::npos; });
}

// Results that are good; each test then makes one figure bad.
TuneResult GoodTuning() {
  TuneResult r;
  r.task.loop.mass_kg = 1.7;
  r.task.loop.damping_Ns_per_m = 30.0;
  r.recommended = {1.7, 25.0};
  r.recommended_margin = 1.1;
  r.own_margin = 1.3;
  r.check.runs = 60;
  StiffHandRun calm{.hand = {.name = "fixture"}, .contact = "free", .run = {}};
  calm.run.valid = true;
  calm.run.one_s_N = 0.1;
  r.stiff_hands = {calm, calm};
  return r;
}

TEST(TuneVerdict, EachLevelHasItsReasons) {
  EXPECT_EQ(Judge(GoodTuning()).level, session::VerdictLevel::kGood);
  EXPECT_TRUE(Judge(GoodTuning()).reasons.empty());

  TuneResult heavy = GoodTuning();
  heavy.recommended.damping_Ns_per_m = 60.0;
  EXPECT_EQ(Judge(heavy).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(heavy), "not light")) << Judge(heavy).reasons.front();

  TuneResult own = GoodTuning();
  own.own_margin = 1.02;
  EXPECT_EQ(Judge(own).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(own), "gain margin of 1.02")) << Judge(own).reasons.front();

  TuneResult silent = GoodTuning();
  silent.task.index_acts = false;
  EXPECT_EQ(Judge(silent).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(silent), "does not act"));

  TuneResult nothing = GoodTuning();
  nothing.recommended = {};
  EXPECT_EQ(Judge(nothing).level, session::VerdictLevel::kBad);

  TuneResult grew = GoodTuning();
  grew.check.grew = {"firm at the wall"};
  EXPECT_EQ(Judge(grew).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(grew), "firm at the wall"));
}

TEST(TuneVerdict, NamesAHandThatKeepsOscillatingWithItsForce) {
  TuneResult unquiet = GoodTuning();
  unquiet.stiff_hands[1].run.one_s_N = 1.5;
  EXPECT_EQ(Judge(unquiet).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(unquiet), "1.50 N between 5 and 40 Hz"));
  TuneResult shaken = GoodTuning();
  shaken.stiff_hands[1].run.one_s_N = 109.0;
  EXPECT_EQ(Judge(shaken).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(shaken), "with 1 of 2 hands stiffer than 3000 N/m"))
      << Judge(shaken).reasons[0];
  EXPECT_TRUE(HasReason(Judge(shaken), "fixture (free), with 109.00 N"));
  TuneResult ended = GoodTuning();
  ended.stiff_hands[0].run.valid = false;
  EXPECT_EQ(Judge(ended).level, session::VerdictLevel::kBad);
}

TEST(PlanVerdict, EachLevelHasItsReasons) {
  session::FidelityPlan plan;
  plan.calibration = {{.frames = 1000, .interrupted = 100}};
  EXPECT_EQ(Judge(plan, {}).level, session::VerdictLevel::kGood);
  EXPECT_EQ(Judge(plan, session::PlanCheck{}).level, session::VerdictLevel::kGood);

  session::FidelityPlan slow = plan;
  slow.unmet = {{.what = "rate", .asked = 1000.0, .predicted = 712.0}};
  EXPECT_EQ(Judge(slow, {}).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(slow, {}), "rate: 712 Hz of 1000")) << Judge(slow, {}).reasons.front();

  session::FidelityPlan busy = plan;
  busy.calibration.front().interrupted = 400;
  EXPECT_EQ(Judge(busy, {}).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(busy, {}), "400 of the 1000 frames"));

  session::PlanCheck missed;
  missed.missed = {"error 0.2 mm, promised 0.1"};
  EXPECT_EQ(Judge(plan, missed).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(plan, missed), "promised 0.1"));
}

CapabilityResult EnoughForce() {
  CapabilityResult r;
  r.need.axial_N = 100.0;
  r.need.lateral_N = 20.0;
  r.best_angle = {.force = {.factor = 1.6}, .poses = 40, .unreachable = 0};
  r.own_angle = {.force = {.factor = 1.2}, .poses = 40, .unreachable = 0};
  r.searched = true;
  r.base = BaseFigure{};
  r.base_force.factor = 2.0;
  return r;
}

TEST(CapabilityVerdict, EachLevelHasItsReasons) {
  EXPECT_EQ(Judge(EnoughForce()).level, session::VerdictLevel::kGood);

  CapabilityResult turned = EnoughForce();
  turned.own_angle.force.factor = 0.9;
  EXPECT_EQ(Judge(turned).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(turned), "90 N with 18 N are the most")) << Judge(turned).reasons.front();

  CapabilityResult nowhere = EnoughForce();
  nowhere.base.reset();
  EXPECT_EQ(Judge(nowhere).level, session::VerdictLevel::kWarning);

  CapabilityResult weak = EnoughForce();
  weak.best_angle.force.factor = weak.own_angle.force.factor = 0.5;
  EXPECT_EQ(Judge(weak).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(weak), "at the best arm angles: 100 N along the tool"));

  CapabilityResult unreachable = EnoughForce();
  unreachable.best_angle.unreachable = 3;
  EXPECT_EQ(Judge(unreachable).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(unreachable), "3 of 40 poses"));
}

TransparencyResult Faithful() {
  TransparencyResult r;
  for (int i = 0; i < 6; ++i)
    r.axes.push_back({.axis = i,
                      .points = {},
                      .fit = {.mass = 2.0, .drag = 30.0},
                      .asked_mass = 1.7,
                      .asked_drag = 30.0,
                      .residual = 0.1});
  r.asked_stiffness_N_per_m = 20e3;
  r.stiffness_N_per_m = 19.9e3;
  return r;
}

TEST(TransparencyVerdict, EachLevelHasItsReasons) {
  EXPECT_EQ(Judge(Faithful()).level, session::VerdictLevel::kGood);

  TransparencyResult heavy = Faithful();
  heavy.axes[1].residual = 0.5;
  EXPECT_EQ(Judge(heavy).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(heavy), "50 % off")) << Judge(heavy).reasons.front();

  TransparencyResult soft = Faithful();
  soft.stiffness_N_per_m = 12e3;
  EXPECT_EQ(Judge(soft).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(soft), "12.00 N/mm for 20.00 N/mm"));

  TransparencyResult other = Faithful();
  other.axes[0].residual = 1.5;
  EXPECT_EQ(Judge(other).level, session::VerdictLevel::kBad);

  TransparencyResult stopped = Faithful();
  stopped.axes[2].points.emplace_back().fault = true;
  EXPECT_EQ(Judge(stopped).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(stopped), "void"));
}

TEST(ScalingVerdict, EachLevelHasItsReasons) {
  ScalingResult r;
  r.max_spheres = 1'000'000;
  r.frames = 1000;
  ScalingPoint point{.series = "ours, cut zone as it is", .spheres = 1000, .cut_zone_m = 1e-3, .timing = {}};
  point.timing.frames = 1000;
  r.points = {point, point};
  EXPECT_EQ(Judge(r).level, session::VerdictLevel::kGood);
  r.left_out = {"the same without culling, 1000000 spheres: 20 frames would take 300 s"};
  EXPECT_EQ(Judge(r).level, session::VerdictLevel::kGood) << "that is what the series is to show";

  ScalingResult few = r;
  few.points[1].timing.frames = 400;
  EXPECT_EQ(Judge(few).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(few), "fewer frames than the 1000"));

  ScalingResult missing = r;
  missing.ours_left_out = 2;
  EXPECT_EQ(Judge(missing).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(missing), "2 of our own points"));

  ScalingResult ended = r;
  ended.interrupted = true;
  EXPECT_EQ(Judge(ended).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(ended), "incomplete"));
}

TEST(SpeedAccuracyVerdict, EachLevelHasItsReasons) {
  SpeedAccuracyResult r;
  r.wanted_seeds = 2;
  r.points.push_back({.method = "ours", .device = {}, .seeds = {SeedScores{}, SeedScores{}}});
  EXPECT_EQ(Judge(r).level, session::VerdictLevel::kGood);

  SpeedAccuracyResult slow = r;
  slow.left_out = {"voxel at 0.1 mm: ream was not done within 60 s"};
  EXPECT_EQ(Judge(slow).level, session::VerdictLevel::kWarning);
  EXPECT_TRUE(HasReason(Judge(slow), "not done within 60 s"));

  SpeedAccuracyResult few = r;
  few.points.front().seeds.pop_back();
  EXPECT_EQ(Judge(few).level, session::VerdictLevel::kWarning);

  SpeedAccuracyResult ended = r;
  ended.interrupted = true;
  EXPECT_EQ(Judge(ended).level, session::VerdictLevel::kBad);
  EXPECT_TRUE(HasReason(Judge(ended), "incomplete"));
  const nlohmann::ordered_json json = nlohmann::ordered_json::parse(SpeedAccuracyJson(ended));
  EXPECT_EQ(json.begin().key(), "verdict") << "before anything else";
  EXPECT_EQ(json.at("verdict").at("level"), "bad");
}

}  // namespace
}  // namespace osteon::studies
