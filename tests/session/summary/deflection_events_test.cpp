#include "session/summary/deflection_events.h"

#include <gtest/gtest.h>

#include "io/recording/recording_reader.h"
#include "safety/acting_limits.h"
#include "session/run/fault_events.h"
#include "session/summary/assumed_figures.h"
#include "session/summary/limit_rows.h"
#include "tests/io/temporary_folder.h"

// A run's information on compliance (bending tool, surface layer, bone's mount): events of deflections and
// faults, limits in force, and assumed figures.

namespace osteon::session {
namespace {

constexpr rt::Nanoseconds kStart = 7 * rt::kSecond;

// A tick in which the tool bends; beyond 0.1 mm the deflection limit is marked as acting.
control::TickRecord Bent(int millisecond, double bend_mm) {
  control::TickRecord tick;
  tick.stamp = kStart + millisecond * rt::kMillisecond;
  tick.compliance.present = true;
  tick.compliance.bend_m = {0.0, 1e-3 * bend_mm, 0.0};
  tick.compliance.layer_m = {0.0, 0.0, 1e-5};
  safety::LimitSet acting;
  acting.Add(safety::Limit::kDeflection, bend_mm > 0.1);
  tick.limits = acting.bits();
  return tick;
}

TEST(DeflectionEvents, BeginWhenADeflectionExceedsTheCellsError) {
  DeflectionEvents events;
  int begun = 0;
  for (int i = 0; i < 4000; ++i) {
    // beyond the error from 1 to 2 s, with interruptions of 1 ms that end no event, and once more at 3 s
    const bool beyond = (i >= 1000 && i < 2000 && i % 100 != 50) || i == 3000;
    const bool begins = events.Add(Bent(i, beyond ? (i == 1500 ? 0.4 : 0.2) : 0.05));
    EXPECT_EQ(begins, i == 1000 || i == 3000) << i;
    begun += begins ? 1 : 0;
  }
  EXPECT_EQ(begun, 2);
  ASSERT_EQ(events.rows().size(), 2u);
  EXPECT_EQ(events.rows()[0].name, "deflection");
  EXPECT_DOUBLE_EQ(events.rows()[0].time_s, 1.0);
  EXPECT_NEAR(events.rows()[0].value, 0.4, 1e-12);
  EXPECT_EQ(events.rows()[0].unit, "mm");
  EXPECT_NEAR(events.rows()[1].value, 0.2, 1e-12);
}

TEST(DeflectionEvents, AreWrittenToTheRecording) {
  const io::test::TemporaryFolder folder;
  DeflectionSink sink(nullptr);
  const auto path = folder.path() / "run.mcap";
  {
    auto recorder = io::Recorder::Open({.path = path, .writer_thread = false, .live = &sink}, {});
    ASSERT_TRUE(recorder) << recorder.error();
    sink.RecordIn(**recorder);
    for (int i = 0; i < 100; ++i) {
      (*recorder)->Push(Bent(i, i >= 40 ? 0.2 : 0.05));
      (*recorder)->Drain();
    }
    ASSERT_TRUE((*recorder)->Close());
  }
  const auto recording = io::ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  ASSERT_EQ(recording->events.size(), 1u);
  EXPECT_EQ(recording->events[0].text,
            "deflection: the tool gives way by 0.200 mm, more than the cell's error");
  EXPECT_EQ(recording->events[0].stamp, kStart + 40 * rt::kMillisecond);
  EXPECT_EQ(recording->ticks.size(), 100u);
}

// A fault is recorded in the tick that has it first. A fault that no tick had is recorded at the run's end.
TEST(FaultEvents, AreRecordedOnceWhenTheyOccur) {
  const io::test::TemporaryFolder folder;
  DeflectionSink deflections(nullptr);
  FaultEvents events;
  FaultSink sink(deflections, events);
  const auto path = folder.path() / "run.mcap";
  {
    auto recorder = io::Recorder::Open({.path = path, .writer_thread = false, .live = &sink}, {});
    ASSERT_TRUE(recorder) << recorder.error();
    sink.RecordIn(**recorder);
    for (int i = 0; i < 100; ++i) {
      control::TickRecord tick = Bent(i, 0.05);
      if (i >= 40) tick.faults = static_cast<std::uint32_t>(safety::Fault::kSensorStale);
      (*recorder)->Push(tick);
      (*recorder)->Drain();
    }
    safety::FaultSet all;
    all.Latch(safety::Fault::kSensorStale);
    all.Latch(safety::Fault::kInterlock);
    events.Record(**recorder, kStart + rt::kSecond, all.bits());
    ASSERT_TRUE((*recorder)->Close());
  }
  const auto recording = io::ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  ASSERT_EQ(recording->events.size(), 2u);
  EXPECT_EQ(recording->events[0].text.rfind("fault: force sensor stale; ", 0), 0u)
      << recording->events[0].text;
  EXPECT_EQ(recording->events[0].stamp, kStart + 40 * rt::kMillisecond);
  EXPECT_EQ(recording->events[1].stamp, kStart + rt::kSecond) << "what no tick had";
}

TEST(PeakDeflection, KeepsTheLargestDeflectionOfEachPart) {
  PeakDeflection peak;
  peak.Add(control::TickRecord{}.compliance);
  EXPECT_FALSE(peak.present) << "a rigid cell";
  peak.Add(Bent(1, 0.2).compliance);
  peak.Add(Bent(2, 0.1).compliance);
  EXPECT_TRUE(peak.present);
  EXPECT_NEAR(peak.bend_m, 0.2e-3, 1e-12);
  EXPECT_NEAR(peak.layer_m, 0.01e-3, 1e-12);
  EXPECT_EQ(peak.mount_m, 0.0);
}

const EffectiveLimit* Find(const std::vector<EffectiveLimit>& limits, const std::string& name) {
  for (const EffectiveLimit& limit : limits)
    if (limit.name == name) return &limit;
  return nullptr;
}

TEST(LimitsInForce, IncludeTheDeflectionsThatStopTheCell) {
  control::ServoParams servo;
  EXPECT_EQ(Find(EffectiveLimits(servo), "bend of the tool"), nullptr);
  servo.compliance.tool = control::ToolLinkParams{.max_bend_m = 6.5e-3, .max_thrust_N = 211.3};
  servo.compliance.mount = control::BoneMountParams{};
  const auto limits = EffectiveLimits(servo);
  struct Row {
    const char *name, *unit, *from;
    double value;
  };
  for (const Row& row : {Row{"bend of the tool", "mm", "tenth of its free length", 6.5},
                         Row{"thrust on the tool", "N", "half of its buckling load", 211.3},
                         Row{"shift of the bone's mount", "mm", "fixed", 10.0},
                         Row{"turn of the bone's mount", "rad", "fixed", 0.1}}) {
    const EffectiveLimit* limit = Find(limits, row.name);
    ASSERT_NE(limit, nullptr) << row.name;
    EXPECT_NEAR(limit->value, row.value, 1e-9) << row.name;
    EXPECT_EQ(limit->unit, row.unit);
    EXPECT_EQ(limit->from, row.from);
  }
}

TEST(AssumedFigures, AreThoseOfTheCompliantPartsOnly) {
  config::CellConfig cell;
  cell.tool.tool.name = "drill";
  cell.compliance.mount_source = "assumed: like a positioner";
  simulation::Material soft;
  soft.name = "soft";
  soft.layer_N_per_m3 = 60e6;
  for (simulation::FigureSource* source :
       {&soft.density_source, &soft.cutting_energy_source, &soft.cutting_force_source, &soft.friction_source})
    source->assumed = false;
  EXPECT_TRUE(AssumedFigures(cell, {soft}).empty()) << "nothing gives way";
  cell.servo.compliance.layer = control::SurfaceLayerParams{};
  cell.servo.compliance.tool = control::ToolLinkParams{.tau_s = 0.02};
  cell.servo.compliance.mount = control::BoneMountParams{};
  const auto lines = AssumedFigures(cell, {soft});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "soft: layer 0.06 N/mm³, 0 mm, 0 ms");
  EXPECT_EQ(lines[1], "drill: time constant of its bending 20 ms");
  EXPECT_EQ(
      lines[2],
      "mount of the bone: 12 kg, 47.4 N/mm, 2000 N m/rad, damping ratio 0.05 (assumed: like a positioner)");
  cell.compliance.mount_source = "measured on 3 December";
  EXPECT_EQ(AssumedFigures(cell, {soft}).size(), 2u);
}

TEST(AssumedFigures, AreFewerOnceASimulatedCellIsIdentified) {
  config::CellConfig cell;
  cell.simulated.servo = {.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_cycles = 3.0};
  const auto lines = AssumedOfSimulation(cell);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "simulated arm: 15 Hz, damping ratio 1, dead time 3 ms (osteon identify)");
  EXPECT_EQ(lines[1], "own delay of the force sensor: 0 ms (osteon identify)");
  cell.identified = config::IdentifiedCell{};
  EXPECT_EQ(AssumedOfSimulation(cell), lines) << "a file without an arm and a sensor changes neither";
  cell.identified->arm.push_back({.axis = "z", .bandwidth_hz = 16.6});
  EXPECT_EQ(AssumedOfSimulation(cell).size(), 1u);
  cell.identified->sensor = config::IdentifiedSensor{.delay_s = 1.7e-3};
  EXPECT_TRUE(AssumedOfSimulation(cell).empty());
}

}  // namespace
}  // namespace osteon::session
