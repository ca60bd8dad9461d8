#include "studies/regress/trace_diff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/studies/regress/sample_trace.h"

namespace osteon::studies {
namespace {

const config::TraceTolerances kTolerances;

// The explanation of a difference, in lines.
std::string ExplanationOf(const TraceDifference& difference) {
  std::string text;
  for (const std::string& line : Explain(difference, SampleTrace())) text += line + "\n";
  return text;
}

TEST(TraceDifference, IsEmptyForEqualTraces) {
  const TraceDifference same = Compare(SampleTrace(), SampleTrace(), kTolerances);
  EXPECT_TRUE(same.identical);
  EXPECT_TRUE(same.passed);
  EXPECT_EQ(ExplanationOf(same), "");
}

// Two digests differ by a bit each, but no sample differs. The comparison must pass without being identical.
TEST(TraceDifference, ADifferentBitPassesWithoutBeingIdentical) {
  ScenarioTrace now = SampleTrace();
  now.hash ^= 1u;
  now.digests[12][static_cast<std::size_t>(TracePart::kCoupling)] ^= 0x800u;
  now.digests[14][static_cast<std::size_t>(TracePart::kCommand)] ^= 1u;
  const TraceDifference difference = Compare(SampleTrace(), now, kTolerances);
  EXPECT_FALSE(difference.identical);
  EXPECT_TRUE(difference.passed);
  ASSERT_EQ(difference.parts.size(), 2u);
  EXPECT_EQ(difference.parts[0].part, TracePart::kCoupling);
  EXPECT_EQ(difference.parts[0].tick, 17u);
  EXPECT_EQ(difference.parts[1].tick, 19u);
  EXPECT_NE(ExplanationOf(difference)
                .find("0.018 s (tick 17): the coupling (of equal inputs: the loop itself does otherwise); "
                      "ticks later: the command +2"),
            std::string::npos)
      << ExplanationOf(difference);
}

TEST(TraceDifference, NamesFirstTheQuantityThatLeftItsToleranceFirst) {
  const std::size_t force = QuantityNamed("coupling_z_N"), place = QuantityNamed("tool_x_mm"),
                    small = QuantityNamed("tool_y_mm");
  ScenarioTrace now = SampleTrace();
  now.hash ^= 1u;
  now.digests[3][static_cast<std::size_t>(TracePart::kArm)] ^= 4u;
  now.samples[1].values[force] += 0.02;    // tick 20, beyond 0.01 N
  now.samples[2].values[force] -= 0.5;     // tick 30
  now.samples[2].values[place] += 0.004;   // tick 30, beyond 0.001 mm
  now.samples[0].values[small] += 0.0005;  // within
  const TraceDifference difference = Compare(SampleTrace(), now, kTolerances);
  EXPECT_FALSE(difference.passed);
  EXPECT_EQ(difference.Beyond(), 2u);
  ASSERT_EQ(difference.quantities.size(), 3u);
  EXPECT_EQ(difference.quantities[0].quantity, force);
  EXPECT_EQ(difference.quantities[0].left_tick, 20u);
  EXPECT_EQ(difference.quantities[0].worst_tick, 30u);
  EXPECT_NEAR(difference.quantities[0].worst, 0.5, 1e-9);
  EXPECT_NEAR(difference.quantities[0].ratio(), 50.0, 1e-6);
  EXPECT_EQ(difference.quantities[1].quantity, place);
  EXPECT_EQ(difference.quantities[2].quantity, small);
  EXPECT_FALSE(difference.quantities[2].beyond());
  const std::string text = ExplanationOf(difference);
  EXPECT_NE(text.find("coupling_z_N: left at 0.021 s (tick 20); at most 0.5 (50 tolerances) at 0.031 s (tick "
                      "30): golden"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("the loop itself"), std::string::npos) << "an input differed: " << text;
}

// The text must be "4030 tolerances", not "4.03e+03".
TEST(TraceDifference, WritesLargeRatiosWithoutAnExponent) {
  ScenarioTrace now = SampleTrace();
  now.samples[2].values[QuantityNamed("coupling_z_N")] -= 40.3;
  const std::string text = ExplanationOf(Compare(SampleTrace(), now, kTolerances));
  EXPECT_NE(text.find("at most 40.3 (4030 tolerances)"), std::string::npos) << text;
}

// A peak between two samples changes no sample, only the recorded extremes.
TEST(TraceDifference, DetectsAPeakBetweenTheSamples) {
  ScenarioTrace now = SampleTrace();
  const std::size_t force = QuantityNamed("hand_x_N");
  now.greatest[force] += 1.0;
  const TraceDifference difference = Compare(SampleTrace(), now, kTolerances);
  EXPECT_FALSE(difference.passed);
  ASSERT_EQ(difference.quantities.size(), 1u);
  EXPECT_TRUE(difference.quantities[0].between_samples);
  EXPECT_NE(ExplanationOf(difference).find("left between two samples"), std::string::npos);
}

TEST(TraceDifference, NonFiniteValuesAreBeyondAnyTolerance) {
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ScenarioTrace now = SampleTrace();
    now.samples[1].values[0] = wrong;
    EXPECT_FALSE(Compare(SampleTrace(), now, kTolerances).passed) << wrong;
  }
}

TEST(TraceDifference, EventsMustAgreeInOrderAndTime) {
  const auto lines = [](const std::vector<TraceEvent>& events, double event_s) {
    ScenarioTrace now = SampleTrace();
    now.events = events;
    return Compare(SampleTrace(), now, {.event_s = event_s}).others;
  };
  const std::vector<TraceEvent> golden = SampleTrace().events;
  EXPECT_TRUE(lines(golden, 0.0).empty());
  auto late = golden;
  late[2].tick += 2;
  ASSERT_EQ(lines(late, 1e-3).size(), 1u);
  EXPECT_EQ(lines(late, 1e-3)[0],
            "event: golden \"state off\" at 0.039 s (tick 38), now \"state off\" at 0.041 s (tick 40)");
  EXPECT_TRUE(lines(late, 2e-3).empty());
  auto other = golden;
  other[1].what = "fault sensor_silent";
  EXPECT_EQ(lines(other, 1.0).size(), 1u);
  auto less = golden;
  less.pop_back();
  ASSERT_EQ(lines(less, 1.0).size(), 1u);
  EXPECT_NE(lines(less, 1.0)[0].find("now none more"), std::string::npos);
  auto more = golden;
  more.push_back({.tick = 39, .what = "fault more"});
  EXPECT_NE(lines(more, 1.0)[0].find("golden none more"), std::string::npos);
}

TEST(TraceDifference, TheEndAndTheCountOfTicksMustAgree) {
  ScenarioTrace now = SampleTrace();
  now.ended = "fault";
  EXPECT_FALSE(Compare(SampleTrace(), now, kTolerances).passed);
  now = SampleTrace();
  now.active += 1;
  EXPECT_FALSE(Compare(SampleTrace(), now, kTolerances).passed);
  EXPECT_TRUE(Compare(SampleTrace(), now, {.event_s = 1e-3}).passed);
}

// A golden file that was edited by hand still has the original run's hash.
TEST(TraceDifference, AnEditedGoldenFileIsNotIdentical) {
  ScenarioTrace golden = SampleTrace();
  golden.samples[1].values[0] += 0.3;
  const TraceDifference difference = Compare(golden, SampleTrace(), kTolerances);
  EXPECT_FALSE(difference.identical);
  EXPECT_FALSE(difference.passed);
  EXPECT_NE(ExplanationOf(difference).find("the golden file itself was changed"), std::string::npos);
}

// A change of any field of a tick must change the hash, and the digest of exactly the part to which the field
// belongs.
TEST(TraceRecorder, EveryPartOfATickIsInTheHash) {
  const auto trace_of = [](const auto& change) {
    TraceRecorder recorder(1e-3, 0.01);
    control::TickRecord record;
    simulation::ContactModel model;
    record.phase = control::Phase::kHaptic;
    change(record, model);
    recorder.Tick(record, model);
    return recorder.Finish("completed", 1, 0);
  };
  const ScenarioTrace plain = trace_of([](auto&, auto&) {});
  const auto expect_change = [&](TracePart part, const auto& change) {
    const ScenarioTrace changed = trace_of(change);
    EXPECT_NE(changed.hash, plain.hash) << NameOf(part);
    const TraceDifference difference = Compare(plain, changed, kTolerances);
    ASSERT_EQ(difference.parts.size(), 1u) << NameOf(part);
    EXPECT_EQ(difference.parts[0].part, part);
  };
  using Record = control::TickRecord;
  using Model = simulation::ContactModel;
  expect_change(TracePart::kArm, [](Record& r, Model&) { r.q_meas[6] = 1e-300; });
  expect_change(TracePart::kArm, [](Record& r, Model&) { r.input.tau_ext[3] = 1; });
  expect_change(TracePart::kDevices, [](Record& r, Model&) { r.input.F_sensor_S.t.z = 1e-18; });
  expect_change(TracePart::kBone, [](Record&, Model& m) { m.removed_mass_kg = 1e-9; });
  expect_change(TracePart::kBone, [](Record&, Model& m) { m.contact_count = 1; });
  expect_change(TracePart::kHand, [](Record& r, Model&) { r.F_operator_T_W.f.x = -0.0; });
  expect_change(TracePart::kCoupling, [](Record& r, Model&) { r.tank_J = 0.5; });
  expect_change(TracePart::kState, [](Record& r, Model&) { r.limits = 1u << 31u; });
  expect_change(TracePart::kCommand, [](Record& r, Model&) { r.tau_cmd[0] = 1; });
  EXPECT_NE(TraceRecorder(1e-3, 0.01).Finish("completed", 1, 0).hash,
            TraceRecorder(1e-3, 0.01).Finish("completed", 1, 1).hash)
      << "the carved bone";
}

TEST(TraceRecorder, SamplesFromTheStartOfMotionAndKeepsTheExtremes) {
  TraceRecorder recorder(1e-3, 0.01);
  control::TickRecord record;
  for (int i = 0; i < 40; ++i) {
    record.phase = i < 15 ? control::Phase::kWaiting : control::Phase::kHaptic;
    record.q_cmd[0] = i == 23 ? 5.0 : 1e-3 * i;
    recorder.Tick(record, {});
  }
  recorder.SceneEvent(31'000'000, "through");
  const ScenarioTrace trace = recorder.Finish("completed", 25, 0);
  EXPECT_EQ(trace.ticks, 40u);
  EXPECT_EQ(trace.first_tick, 15u);
  EXPECT_EQ(trace.digests.size(), 25u);
  ASSERT_EQ(trace.samples.size(), 2u);
  EXPECT_EQ(trace.samples[0].tick, 20u);
  EXPECT_EQ(trace.samples[1].tick, 30u);
  EXPECT_DOUBLE_EQ(trace.greatest[0], 5.0);
  EXPECT_DOUBLE_EQ(trace.least[0], 0.015);
  EXPECT_EQ(trace.events.back().what, "scene through");
  EXPECT_EQ(trace.events.back().tick, 30u) << "the first tick is at one period";
}

}  // namespace
}  // namespace osteon::studies
