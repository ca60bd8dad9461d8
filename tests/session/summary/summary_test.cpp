#include "session/summary/summary.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <nlohmann/json.hpp>

#include "base/write_text.h"
#include "tests/io/temporary_folder.h"

namespace osteon::session {
namespace {

using io::test::ReadAll;
using io::test::TemporaryFolder;

report::DurationCounts CountsOf(const std::vector<rt::Nanoseconds>& durations) {
  report::DurationCounts counts;
  for (const rt::Nanoseconds duration : durations) counts.Add(duration);
  return counts;
}

TEST(Quantiles, AreThoseOfAShuffledListOfKnownDurations) {
  // 0, 1, … 999 ms in any order: the p quantile has p·1000 values below it
  std::vector<rt::Nanoseconds> durations(1000);
  for (std::size_t i = 0; i < durations.size(); ++i)
    durations[i] = static_cast<rt::Nanoseconds>(i) * rt::kMillisecond;
  std::shuffle(durations.begin(), durations.end(), std::mt19937(7));
  const DurationFigures figures = Quantiles(CountsOf(durations));
  EXPECT_EQ(figures.count, 1000u);
  EXPECT_DOUBLE_EQ(figures.p50_s, 0.500);
  EXPECT_DOUBLE_EQ(figures.p99_s, 0.990);
  EXPECT_DOUBLE_EQ(figures.p999_s, 0.999);
  EXPECT_DOUBLE_EQ(figures.max_s, 0.999);
}

TEST(Quantiles, AreWithinTheListIfItHasFewValues) {
  EXPECT_EQ(Quantiles({}).count, 0u);
  EXPECT_EQ(Quantiles({}).max_s, 0.0);
  const DurationFigures one = Quantiles(CountsOf({250 * rt::kMillisecond}));
  EXPECT_EQ(one.p50_s, 0.25);
  EXPECT_EQ(one.p999_s, 0.25);
  const DurationFigures two = Quantiles(CountsOf({3 * rt::kSecond, rt::kSecond}));
  EXPECT_LE(two.p50_s, two.p99_s);
  EXPECT_EQ(two.max_s, 3.0);
}

// The drive is in fault at 0.3 s, is reset at 0.32 s, sends an EMCY at 2 s, and has one more fault at 2.1 s.
TEST(DriveFaultRows, HaveEachNewFaultAndResetWithItsTime) {
  std::vector<control::TickRecord> ticks(3000);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    ticks[i].stamp = static_cast<rt::Nanoseconds>(i + 5) * rt::kMillisecond;
  for (std::size_t i = 300; i < 320; ++i) {
    ticks[i].input.drive_faults = 1u << 3;
    ticks[i].input.drive_emergency_code = ticks[i].input.drive_error_code = 0x3220;
  }
  for (std::size_t i = 2000; i < ticks.size(); ++i) {
    ticks[i].input.drive_faults = i < 2100 ? 1u << 2 : 1u << 2 | 1u << 0;
    ticks[i].input.drive_emergency_code = 0x4310;
  }
  DriveFaultRows gathered;
  for (const control::TickRecord& tick : ticks) gathered.Add(tick);
  const std::vector<DriveFaultRow>& rows = gathered.rows();
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_NEAR(rows[0].time_s, 0.3, 1e-9);
  EXPECT_EQ(rows[0].latched, 1u << 3);
  EXPECT_EQ(
      rows[0].text,
      "in fault by its statusword (bit 3); last EMCY 0x3220 (under-voltage of the DC link); 603F 0x3220 "
      "(under-voltage of the DC link)");
  EXPECT_NEAR(rows[1].time_s, 0.32, 1e-9);
  EXPECT_EQ(rows[1].text, "reset");
  EXPECT_EQ(rows[2].text, "EMCY 0x4310 (excess temperature of the drive) (bit 2)");
  EXPECT_EQ(rows[3].latched, 1u << 0) << "what is new";

  RunSummary summary;
  summary.drive_faults = rows;
  const nlohmann::json json = nlohmann::json::parse(ToJson(summary, "osteon.run/1"));
  ASSERT_EQ(json.at("drive_faults").size(), 4u);
  EXPECT_EQ(json["drive_faults"][0]["emergency_code"], "0x3220");
  EXPECT_EQ(json["drive_faults"][2]["error_code"], nullptr);
  const std::vector<report::SummaryRow> table = Rows(summary);
  const auto row = std::ranges::find(table, "Faults of the drive", &report::SummaryRow::key);
  ASSERT_NE(row, table.end());
  EXPECT_NE(row->value.find("at 2.00 s EMCY 0x4310 (excess temperature of the drive)"), std::string::npos)
      << row->value;
  summary.drive_faults.clear();
  EXPECT_EQ(std::ranges::count(Rows(summary), "Faults of the drive", &report::SummaryRow::key), 0);
}

TEST(RunSummary, SaysThatNoPlcHadToPermitMotion) {
  const auto says = [](bool without_plc) {
    RunSummary summary;
    summary.without_plc = without_plc;
    const std::vector<report::SummaryRow> rows = Rows(summary);
    const bool row = std::any_of(rows.begin(), rows.end(), [](const report::SummaryRow& r) {
      return r.key == "Permission to move" && r.value.find("without a PLC") != std::string::npos;
    });
    EXPECT_EQ(nlohmann::json::parse(ToJson(summary, "osteon.run/1")).at("without_plc"), row);
    return row;
  };
  EXPECT_TRUE(says(true));
  EXPECT_FALSE(says(false));
}

TEST(WriteText, ReplacesTheWholeFileAndLeavesNoOtherFile) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "summary.json";
  ASSERT_TRUE(base::WriteText(path, "first, and longer"));
  ASSERT_TRUE(base::WriteText(path, "second\n"));
  EXPECT_EQ(ReadAll(path), "second\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteText, WritesIntoAPipeWithoutReplacingIt) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const int reader = open(path.c_str(), O_RDWR | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  EXPECT_TRUE(base::WriteText(path, "text\n"));
  char bytes[16]{};
  EXPECT_EQ(read(reader, bytes, sizeof bytes), 5);
  close(reader);
  EXPECT_STREQ(bytes, "text\n");
  EXPECT_TRUE(std::filesystem::is_fifo(path));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteText, TheErrorNamesAPathThatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "nowhere" / "summary.json";
  const auto written = base::WriteText(path, "text");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error(), path.string() + ": can't be written: No such file or directory");
}

TEST(WriteText, FailsIfAFolderHasItsNameAndLeavesNoOtherFile) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "summary.json";
  std::filesystem::create_directories(path / "full");
  const auto written = base::WriteText(path, "text");
  ASSERT_FALSE(written);
  EXPECT_TRUE(written.error().starts_with(path.string() + ": ")) << written.error();
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteText, FailsOnAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "skipped, no /dev/full";
  const TemporaryFolder folder;
  const auto path = folder.path() / "summary.json";
  std::filesystem::create_symlink("/dev/full", path);
  const auto written = base::WriteText(path, "text");
  ASSERT_FALSE(written) << "a full disk was not noticed";
  EXPECT_EQ(written.error(), path.string() + ": can't be written: No space left on device");
  EXPECT_TRUE(std::filesystem::is_symlink(path));
}

TEST(WriteText, WritesToTheTargetOfALink) {
  const TemporaryFolder folder, elsewhere;
  const auto file = elsewhere.path() / "kept.json", link = folder.path() / "summary.json";
  std::filesystem::create_symlink(file, link);
  ASSERT_TRUE(base::WriteText(link, "first"));  // the link's target does not exist yet
  ASSERT_TRUE(base::WriteText(link, "second"));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(ReadAll(file), "second");
  for (const TemporaryFolder* each : {&folder, &elsewhere})
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(each->path()), {}), 1);
}

TEST(WriteText, KeepsThePermissionsOfTheFileThatItReplaces) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "summary.json";
  ASSERT_TRUE(base::WriteText(path, "first"));
  std::filesystem::permissions(path,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  ASSERT_TRUE(base::WriteText(path, "second"));
  EXPECT_EQ(std::filesystem::status(path).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

// Each writer's temporary file has its own name, so that two writers do not overwrite each other's file. A
// file that ends in .part therefore belongs to another program.
TEST(WriteText, DoesNotTouchAFileWithTheEndingPart) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "summary.json", other = folder.path() / "summary.json.part";
  io::test::WriteAll(other, "somebody else's");
  ASSERT_TRUE(base::WriteText(path, "text"));
  EXPECT_EQ(ReadAll(other), "somebody else's");
}

// The summary of a complete run in virtual time, without faults.
RunSummary Sample() {
  RunSummary s;
  s.engine = "vulkan";
  s.device = "a \"quoted\" device\\ with\nlines";
  s.scene = "acetabulum";
  s.tool = "reamer";
  s.recording = "out/µ.mcap";
  s.ended = "completed";
  s.balls = 30000;
  s.rendered = true;
  s.ticks = 10000;
  s.frames = 5000;
  s.servo_rate_hz = 1000.0;
  s.simulation_rate_hz = 500.0;
  s.peak_force_N = 123.4;
  s.force_limit_N = 200.0;
  s.removed_volume_m3 = 2.5e-6;
  s.removed_mass_kg = 3.5e-3;
  s.swept_volume_m3 = 2.0e-6;
  s.cup_depth_m = 1.5e-3;
  s.cavity_depth_m = 1.25e-3;
  s.state_hash = "0123456789abcdef";
  return s;
}

// The value of the row with this key in the summary's table.
std::string RowOf(const RunSummary& summary, const std::string& key) {
  for (const report::SummaryRow& row : Rows(summary))
    if (row.key == key) return row.value;
  return "no such row";
}

TEST(SummaryJson, HasTheSummarysValues) {
  const nlohmann::json json = nlohmann::json::parse(ToJson(Sample(), "osteon.demo/1"));
  EXPECT_EQ(json.at("schema"), "osteon.demo/1");
  EXPECT_EQ(json.at("device"), Sample().device);
  EXPECT_EQ(json.at("recording"), Sample().recording);
  EXPECT_EQ(json.at("ticks"), 10000);
  EXPECT_NEAR(json.at("removed_volume_mm3").get<double>(), 2500.0, 1e-9);
  EXPECT_NEAR(json.at("removed_mass_g").get<double>(), 3.5, 1e-12);
  EXPECT_NEAR(json.at("cup_depth_mm").get<double>(), 1.5, 1e-12);
  EXPECT_EQ(json.at("faults"), nlohmann::json::array());
  EXPECT_FALSE(json.contains("frame_us")) << "virtual time measures no durations";
}

TEST(SummaryJson, NamesTheFaults) {
  RunSummary s = Sample();
  s.faults = {{.name = "arm stale", .time_s = std::nan(""), .reaction = "Stop 1"},
              {.name = "model stale", .time_s = 1.0, .reaction = "Stop 1"}};
  const nlohmann::json json = nlohmann::json::parse(ToJson(s, "osteon.demo/1"));
  EXPECT_EQ(json.at("faults"), nlohmann::json({"arm stale", "model stale"}));
  EXPECT_EQ(RowOf(s, "Faults"), "arm stale; model stale");
}

TEST(SummaryJson, ListsTheAssumptions) {
  RunSummary s = Sample();
  EXPECT_EQ(nlohmann::json::parse(ToJson(s, "osteon.demo/1")).at("assumptions"), nlohmann::json::array());
  s.assumptions = {"pulp: friction 0.05 (lubricated)"};
  EXPECT_EQ(nlohmann::json::parse(ToJson(s, "osteon.demo/1")).at("assumptions")[0], s.assumptions[0]);
}

TEST(SummaryJson, IsNullForValuesThatWereNotMeasured) {
  RunSummary s = Sample();
  s.section.cavity_section = {};
  s.cavity_depth_m = -1.0;  // carved through
  const std::string text = ToJson(s, "osteon.demo/1");
  const nlohmann::json json = nlohmann::json::parse(text);
  EXPECT_TRUE(json.at("cavity_error_mean_mm").is_null());
  EXPECT_TRUE(json.at("cavity_depth_mm").is_null());
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_NE(RowOf(s, "Against the first floor").find("carved through"), std::string::npos);
}

TEST(SummaryJson, AcceptsTextThatIsNotUtf8) {
  // a folder's name may have any bytes
  RunSummary s = Sample();
  s.recording = "out\xff/recording.mcap";
  std::string text;
  ASSERT_NO_THROW(text = ToJson(s, "osteon.demo/1"));
  EXPECT_TRUE(nlohmann::json::parse(text).at("recording").is_string());
}

TEST(SummaryRows, HaveNoNanForAnEmptyRun) {
  const std::vector<report::SummaryRow> rows = Rows(RunSummary{});
  EXPECT_GT(rows.size(), 5u);
  for (const report::SummaryRow& row : rows) {
    EXPECT_EQ(row.value.find("nan"), std::string::npos) << row.key << ": " << row.value;
    EXPECT_EQ(row.value.find("inf"), std::string::npos) << row.key << ": " << row.value;
    EXPECT_FALSE(row.key.empty());
  }
}

TEST(SummaryRows, SayHowMuchForceTheLimitsCutOff) {
  RunSummary summary;
  EXPECT_EQ(RowOf(summary, "Force cut off by limits"), "none");
  summary.cut_ticks = 312;
  summary.min_wrench_share = 0.76;
  EXPECT_EQ(RowOf(summary, "Force cut off by limits"),
            "up to 24 %, in 312 ticks; the arm could have held all of it");
  summary.arm_cut_ticks = 110;
  summary.min_arm_share = 0.9;
  EXPECT_EQ(RowOf(summary, "Force cut off by limits"),
            "up to 24 %, in 312 ticks; the arm could not hold up to 10 %, in 110 ticks");
  const nlohmann::json json = nlohmann::json::parse(ToJson(summary, "osteon.demo/1"));
  EXPECT_EQ(json.at("wrench_cut_ticks"), 312);
  EXPECT_EQ(json.at("wrench_share_min"), 0.76);
  EXPECT_EQ(json.at("arm_cut_ticks"), 110);
  EXPECT_EQ(json.at("arm_share_min"), 0.9);
}

TEST(SummaryRows, SayHowOftenTheStabilisersActed) {
  RunSummary summary;
  summary.min_tank_J = 0.75;
  EXPECT_EQ(RowOf(summary, "Stabilisers acted"),
            "age governor: no; passivity: no; tank: no, 0.75 J at least");
  summary.age_governor_ticks = 40;
  summary.max_age_damping = 3.25;
  summary.min_age_share = 0.9;
  summary.passivity_ticks = 2;
  summary.tank_ticks = 3;
  EXPECT_EQ(
      RowOf(summary, "Stabilisers acted"),
      "age governor: 40 ticks, damping × 3.2 at most, coupling × 0.90; passivity: 2 ticks; tank: 3 ticks, "
      "0.75 J at least");
  const nlohmann::json json = nlohmann::json::parse(ToJson(summary, "osteon.demo/1"));
  EXPECT_EQ(json.at("age_governor_ticks"), 40);
  EXPECT_EQ(json.at("passivity_ticks"), 2);
  EXPECT_EQ(json.at("tank_ticks"), 3);
  EXPECT_EQ(json.at("tank_min_J"), 0.75);
}

TEST(SummaryRows, SayWhichLimitsActedAndForHowLong) {
  std::vector<control::TickRecord> ticks(100);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].stamp = rt::kSecond + static_cast<rt::Nanoseconds>(i) * rt::kMillisecond;
    safety::LimitSet acting;
    acting.Add(safety::Limit::kPower, (i >= 20 && i < 30) || (i >= 50 && i < 54));
    acting.Add(safety::Limit::kDepth, i == 99);
    ticks[i].limits = acting.bits();
  }
  RunSummary summary;
  EXPECT_EQ(RowOf(summary, "Limits that acted"), "none");
  ActedLimits acted_limits;
  for (const control::TickRecord& tick : ticks) acted_limits.Add(tick);
  summary.acted_limits = acted_limits.Rows(1e-3);
  EXPECT_EQ(
      RowOf(summary, "Limits that acted"),
      "power into the hand (power) from 0.02 s, 14 ticks, at most 0.010 s in a row; depth limit (depth) "
      "from 0.10 s, 1 ticks, at most 0.001 s in a row");
  const nlohmann::json acted =
      nlohmann::json::parse(ToJson(summary, "osteon.demo/1")).at("limits").at("acted");
  EXPECT_EQ(acted.at(0).at("events"), 2);
  EXPECT_EQ(acted.at(1).at("name"), "depth");
}

TEST(EffectiveLimits, AreTheTightestLimitsAndNameTheOtherOnes) {
  control::ServoParams params;
  params.twist.max_speed_m_per_s = 0.3;
  params.energy.max_kinetic_J = 0.3;
  params.energy.moving_mass_kg = 15.0;
  const auto of = [&](const std::string& name, bool reduced) {
    for (const EffectiveLimit& limit : EffectiveLimits(params, reduced))
      if (limit.name == name) return limit;
    return EffectiveLimit{};
  };
  EXPECT_NEAR(of("tool speed", false).value, 200.0, 1e-9) << "15 kg with .3 J";
  EXPECT_EQ(of("tool speed", false).from, "kinetic energy; cell: 300");
  EXPECT_NEAR(of("measured tool speed", false).value, 300.0, 1e-9) << "half as much again";
  params.energy.max_kinetic_J = 10.0;
  EXPECT_EQ(of("tool speed", true).from, "T1; cell: 300; kinetic energy: 1155");
  EXPECT_TRUE(std::isinf(of("power into the hand", false).value));
  EXPECT_EQ(of("force", false).value, std::min(params.wrench.max_force_N, 200.0));
}

TEST(SummaryRows, NameThePageOfAStopAndTheTableOfItsTicks) {
  RunSummary summary;
  summary.stops = {{.page = "out/recording_stop_1.html",
                    .heading = "What led to the stop",
                    .ticks = "out/recording_stop_1_ticks.csv"}};
  EXPECT_EQ(RowOf(summary, "What led to the stop"), "out/recording_stop_1.html");
  EXPECT_EQ(RowOf(summary, "Its ticks, as a table"), "out/recording_stop_1_ticks.csv");
  for (const report::SummaryRow& row : Rows(summary)) {
    if (row.file.empty()) continue;
    EXPECT_EQ("out/" + row.file, row.value) << "the report, in the same folder, leads to it";
  }
  const nlohmann::json json = nlohmann::json::parse(ToJson(summary, "osteon.demo/1"));
  EXPECT_EQ(json.at("stops").at(0), "out/recording_stop_1.html");
  EXPECT_EQ(json.at("stop_ticks").at(0), "out/recording_stop_1_ticks.csv");
}

TEST(SummaryRows, ShowTheRemovedVolumeBesideTheSweptOne) {
  EXPECT_EQ(RowOf(Sample(), "Bone removed"), "2500 mm³, 3.50 g; swept 2000 mm³ (+25.0 %)");
  EXPECT_EQ(RowOf(Sample(), "Peak rendered force"), "123.4 N of 200 N allowed");
}

TEST(SummaryRows, HaveNoRowsOfTheCutForARunThatNeverRendered) {
  RunSummary s = Sample();
  s.rendered = false;
  for (const char* row :
       {"Bone removed", "Reamed since first touch", "Against the first floor", "State hash"})
    EXPECT_EQ(RowOf(s, row), "no such row");
  s.faults = {
      {.name = "motion not permitted", .time_s = 1.5, .reaction = "", .seen = "RUN_PERMITTED (974) is 0"}};
  EXPECT_EQ(RowOf(s, "Faults"), "motion not permitted (RUN_PERMITTED (974) is 0)");
  const nlohmann::json seen = nlohmann::json::parse(ToJson(s, "osteon.run/1")).at("faults_seen");
  EXPECT_EQ(seen,
            nlohmann::json::array(
                {{{"name", "motion not permitted"}, {"time_s", 1.5}, {"seen", "RUN_PERMITTED (974) is 0"}}}));
}

}  // namespace
}  // namespace osteon::session
