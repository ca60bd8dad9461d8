#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>

#include "session/run/cell_run.h"
#include "session/summary/summary.h"
#include "tests/app/command.h"
#include "tests/app/short_run.h"

// The demo in virtual time: tests its files, and whether their contents agree with each other.

namespace osteon::app {
namespace {

// Magnitude of the rendered force on the tool, in N.
double ForceOf(const control::TickRecord& tick) { return Vector3(tick.F_coupling_T_W.f).norm(); }

// Expects that the summary has every key that the documentation promises, with the documented type.
void ExpectDocumentedKeys(const nlohmann::json& summary) {
  EXPECT_EQ(summary.at("schema"), "osteon.demo/1");
  for (const char* key : {"engine", "device", "recording", "scene", "tool", "state_hash", "ended", "version"})
    EXPECT_TRUE(summary.at(key).is_string() && !summary.at(key).get<std::string>().empty()) << key;
  for (const char* key : {"ticks", "frames", "spheres", "mass_points", "dropped_records"})
    EXPECT_TRUE(summary.at(key).is_number_unsigned()) << key;
  for (const char* key : {"servo_rate_hz", "simulation_rate_hz", "peak_force_N", "peak_sensor_force_N",
                          "force_limit_N", "removed_volume_mm3", "removed_mass_g", "cup_depth_mm"})
    EXPECT_TRUE(summary.at(key).is_number()) << key;
  EXPECT_TRUE(summary.at("faults").is_array());
}

// Expects that no tick exceeds the force limit, and that the summary and the recording have the same peak
// force.
void ExpectForceWithinLimit(const nlohmann::json& summary, const io::Recording& recording) {
  const double limit_N = summary.at("force_limit_N");
  EXPECT_EQ(limit_N, recording.session.force_limit_N);
  double peak_N = 0.0;
  for (const control::TickRecord& tick : recording.ticks) peak_N = std::max(peak_N, ForceOf(tick));
  // the limiter multiplies a vector by a factor, which rounds each component once
  EXPECT_LE(peak_N, limit_N * (1.0 + 1e-12));
  EXPECT_NEAR(summary.at("peak_force_N").get<double>(), peak_N, 1e-9);
  EXPECT_LE(summary.at("peak_force_N").get<double>(), limit_N * (1.0 + 1e-12));
}

TEST(VirtualDemo, TwoRunsGiveEqualBits) {
  const ShortRun& first = SharedShortRun();
  const ShortRun second;
  for (const CommandResult& run : {first.run, second.run}) {
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.out.find("State hash"), std::string::npos) << run.out;
  }
  const auto a = first.folder.path() / "a/b", b = second.folder.path() / "a/b";
  const std::string bytes = io::test::ReadAll(a / "recording.mcap");
  EXPECT_GT(bytes.size(), 100'000u);
  EXPECT_TRUE(bytes == io::test::ReadAll(b / "recording.mcap"));
  EXPECT_EQ(io::test::ReadAll(a / "summary.json"), io::test::ReadAll(b / "summary.json"));
  EXPECT_TRUE(io::test::ReadAll(a / "report.html") == io::test::ReadAll(b / "report.html"));
  const std::string motion = io::test::ReadAll(first.folder.path() / "motion.csv");
  EXPECT_TRUE(motion == io::test::ReadAll(second.folder.path() / "motion.csv"));
  EXPECT_TRUE(motion.starts_with("# osteon motion 1\n# made by: osteon "));
}

TEST(VirtualDemo, WritesSummaryRecordingAndReportThatAgree) {
  const auto& [folder, run] = SharedShortRun();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto out = folder.path() / "a/b";

  const nlohmann::json summary = ReadJson(out / "summary.json");
  ExpectDocumentedKeys(summary);
  EXPECT_EQ(summary.at("ended"), "completed");
  EXPECT_TRUE(summary.at("faults").empty());
  EXPECT_NEAR(summary.at("servo_rate_hz").get<double>(), 1000.0, 1e-3);
  EXPECT_NEAR(summary.at("seconds").get<double>(), 1.5, 0.2);  // 1.5 s and the time of the orderly stop
  EXPECT_EQ(ReadJson(folder.path() / "copy.json"), summary);

  const io::Recording recording = ReadComplete(out / "recording.mcap");
  EXPECT_EQ(summary.at("ticks"), recording.ticks.size());
  EXPECT_EQ(summary.at("frames"), recording.frames.size());
  EXPECT_NE(recording.session.config_text.find("max_force_N"), std::string::npos);
  ExpectForceWithinLimit(summary, recording);

  const std::string page = io::test::ReadAll(out / "report.html");
  EXPECT_NE(page.find("</html>"), std::string::npos);
  // the page loads nothing from a network: its only address is the namespace of SVG, and its pictures are
  // embedded
  const std::string svg = "http://www.w3.org/2000/svg";
  for (std::size_t at = page.find("://"); at != std::string::npos; at = page.find("://", at + 1))
    EXPECT_EQ(page.substr(at - std::min(at, std::size_t{4}), svg.size()), svg) << "at byte " << at;
  for (const char* outside : {"src=\"//", "href=\"//", "<script ", "@import"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;

  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(out)) files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 5u) << "beside these a page and a table of the run's end, and nothing else";
}

// Acceptance limits of the whole demo, with the engine that `--engine auto` selects on this machine.
TEST(VirtualDemo, ReamsTheWholeCup) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"demo", "--virtual-time"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json summary = ReadJson(folder.path() / "demo_out/summary.json");
  EXPECT_TRUE(summary.at("engine") == "vulkan" || summary.at("engine") == "cpu") << summary.at("engine");
  EXPECT_NE(run.err.find("(--engine auto: "), std::string::npos) << run.err;
  EXPECT_TRUE(summary.at("faults").empty()) << summary.at("faults");
  const double removed_mm3 = summary.at("removed_volume_mm3"), swept_mm3 = summary.at("swept_volume_mm3");
  EXPECT_GE(removed_mm3, 2000.0);
  EXPECT_NEAR(removed_mm3, swept_mm3, 0.05 * swept_mm3);
  EXPECT_GE(summary.at("cup_depth_mm").get<double>(), 1.0);
  EXPECT_LE(summary.at("cavity_error_mean_mm").get<double>(), 0.3);
  // in lockstep every second tick has a frame, however fast the machine is
  EXPECT_NEAR(summary.at("simulation_rate_hz").get<double>(), 500.0, 1e-6);
  // the mean density must lie between those of cancellous and cortical bone
  const double density_g_per_cm3 = summary.at("removed_mass_g").get<double>() / removed_mm3 * 1e3;
  EXPECT_GT(density_g_per_cm3, 0.3);
  EXPECT_LT(density_g_per_cm3, 1.85);
  ExpectForceWithinLimit(summary, ReadComplete(folder.path() / "demo_out/recording.mcap"));
}

// Runs the same demo on each engine. Vulkan must agree with the reference engine within rounding, the CPU
// engine to the bit. 1.5 s are enough: the tool touches the bone after 0.5 s, and its force peaks in the
// first second. For its own engine, the suite's short run is reused.
TEST(VirtualDemo, EachEngineAgreesWithTheReferenceEngine) {
  const TemporaryFolder folder;
  ASSERT_EQ(SharedShortRun().run.exit_code, 0) << SharedShortRun().run.err;
  const nlohmann::json short_run = ReadJson(SharedShortRun().folder.path() / "a/b/summary.json");
  nlohmann::json summaries[3];
  for (const int i : {0, 1, 2}) {
    const std::string engine = i == 0 ? "vulkan" : i == 1 ? "reference" : "cpu";
    if (short_run.at("engine") == engine) {
      summaries[i] = short_run;
    } else {
      const CommandResult run = RunCommand(
          folder.path(), {"demo", "--virtual-time", "--seconds", "1.5", "--engine", engine, "--out", engine});
      ASSERT_EQ(run.exit_code, 0) << engine << ": " << run.err;
      summaries[i] = ReadJson(folder.path() / engine / "summary.json");
    }
    ASSERT_EQ(summaries[i].at("engine"), engine);
    const double removed_mm3 = summaries[i].at("removed_volume_mm3"),
                 swept_mm3 = summaries[i].at("swept_volume_mm3");
    ASSERT_GT(removed_mm3, 200.0) << engine;  // otherwise there is nothing to compare
    EXPECT_NEAR(removed_mm3, swept_mm3, 0.05 * swept_mm3) << engine;
    EXPECT_LE(summaries[i].at("cavity_error_mean_mm").get<double>(), 0.3) << engine;
  }
  const double reference_mm3 = summaries[1].at("removed_volume_mm3");
  EXPECT_NEAR(summaries[0].at("removed_volume_mm3").get<double>(), reference_mm3, 0.05 * reference_mm3);
  EXPECT_NEAR(summaries[0].at("cup_depth_mm").get<double>(), summaries[1].at("cup_depth_mm").get<double>(),
              0.05);
  // both runs have the same arm and hand, so the forces agree, up to the single precision of the contacts
  EXPECT_NEAR(summaries[0].at("peak_force_N").get<double>(), summaries[1].at("peak_force_N").get<double>(),
              5.0);
  for (const char* key : {"state_hash", "removed_volume_mm3", "peak_force_N", "cup_depth_mm"})
    EXPECT_EQ(summaries[2].at(key), summaries[1].at(key)) << key;
}

// A limit on file sizes, which the program inherits, has the effect of a full disk. The command must fail
// without blaming its input.
TEST(VirtualDemo, FailsOnAFullDisk) {
  const TemporaryFolder folder;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit little = before;
  little.rlim_cur = 200'000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  const CommandResult run =
      RunCommand(folder.path(), {"demo", "--virtual-time", "--seconds", "0.5", "--cell", "thin_plate"});
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_NE(run.err.find("recording.mcap: cannot write the recording: File too large"), std::string::npos)
      << run.err;
}

}  // namespace
}  // namespace osteon::app
