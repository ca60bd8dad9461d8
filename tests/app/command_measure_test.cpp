#include <algorithm>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs `bench frame`, `bench kinematics`, `bench tick`, `chart scaling` and `chart speed-accuracy` as a user
// does, at small sizes. No time is judged.

namespace osteon::app {
namespace {

// Expects the percentiles of a duration to be above 0 and in ascending order.
void ExpectTimes(const nlohmann::json& times) {
  for (const char* key : {"p50", "p95", "p99", "p999", "max"})
    EXPECT_GT(times.at(key).get<double>(), 0.0) << key;
  EXPECT_LE(times.at("p50"), times.at("p99"));
  EXPECT_LE(times.at("p999"), times.at("max"));
}

TEST(BenchFrame, WritesTheDocumentedKeys) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(),
      {"bench", "frame", "--spheres", "1000", "--tool-spheres", "4", "--frames", "20", "--json", "f.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "f.json");
  EXPECT_EQ(json.at("schema"), "osteon.bench.frame/1");
  EXPECT_EQ(json.at("spheres"), 1000);
  EXPECT_EQ(json.at("tool_spheres"), 4);
  EXPECT_EQ(json.at("method"), "ours");
  EXPECT_EQ(json.at("frames"), 20);
  EXPECT_EQ(json.at("scene"), "acetabulum");
  EXPECT_FALSE(json.at("device").get<std::string>().empty());
  ExpectTimes(json.at("frame_us"));
  EXPECT_FALSE(json.at("pass_us").empty());
  EXPECT_NEAR(json.at("rate_hz").get<double>() * json.at("frame_us").at("p50").get<double>(), 1e6, 1.0);
  // the hand presses with 100 N and the tool is seated in bone
  EXPECT_NEAR(json.at("mean_force_N").get<double>(), 100.0, 5.0);
  EXPECT_GT(json.at("active_spheres_mean").get<double>(), 50.0);
  EXPECT_LE(json.at("active_spheres_mean").get<double>(), 1000.0);
  EXPECT_GT(json.at("removed_mm3").get<double>(), 0.0);
}

TEST(BenchFrame, ComparesTwoMethodsFrameByFrame) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"bench", "frame", "--spheres", "1000", "--frames",
                                                       "20", "--compare", "reference", "--json", "f.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "f.json"), other = json.at("compare");
  EXPECT_EQ(other.at("method"), "reference");
  EXPECT_EQ(other.at("frames"), 20);
  EXPECT_EQ(other.at("active_spheres_mean"), 1000);
  // both methods start from the same state, and a simulated hand of its own presses each tool: both must
  // remove the same volume
  EXPECT_NEAR(other.at("removed_mm3").get<double>(), json.at("removed_mm3").get<double>(),
              0.02 * json.at("removed_mm3").get<double>() + 1.0);
  EXPECT_NE(run.out.find("times as long as"), std::string::npos);
}

TEST(BenchFrame, TimesSeveralEnginesInTurn) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"bench", "frame", "--spheres", "1000", "--frames", "20", "--engines",
                                 "cpu,reference", "--json", "f.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json engines = ReadJson(folder.path() / "f.json").at("engines");
  ASSERT_EQ(engines.size(), 2u);
  EXPECT_EQ(engines[0].at("engine"), "cpu");
  EXPECT_EQ(engines[0].at("ratio"), 1.0);
  EXPECT_FALSE(engines[0].at("pass_us").empty());
  EXPECT_EQ(engines[1].at("engine"), "reference");
  for (const nlohmann::json& engine : engines) ExpectTimes(engine.at("frame_us"));
  EXPECT_EQ(engines[0].at("removed_mm3"), engines[1].at("removed_mm3")) << "the same bits";
  EXPECT_NE(run.out.find("times as long as cpu"), std::string::npos) << run.out;
}

TEST(BenchFrame, TimesEnginesOnNamedWorkloadsInRounds) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"bench", "frame", "--engines", "cpu,vulkan", "--workloads", "burr-200,reamer-30k",
                      "--spheres", "1000", "--frames", "20", "--rounds", "2", "--json", "f.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "f.json"), workloads = json.at("workloads");
  ASSERT_EQ(workloads.size(), 2u);
  EXPECT_EQ(json.at("rounds"), 2);
  EXPECT_EQ(workloads[0].at("name"), "reamer-30k") << "in the order of the table";
  EXPECT_EQ(workloads[1].at("name"), "burr-200");
  EXPECT_EQ(workloads[1].at("scene"), "molar");
  EXPECT_EQ(workloads[1].at("tool_spheres"), 200);
  for (const nlohmann::json& workload : workloads) {
    EXPECT_EQ(workload.at("spheres"), 1000);
    EXPECT_TRUE(workload.at("left_out").empty());
    const nlohmann::json& engines = workload.at("engines");
    ASSERT_EQ(engines.size(), 2u);
    const nlohmann::json &cpu = engines[0], &vulkan = engines[1];
    EXPECT_EQ(cpu.at("engine"), "cpu");
    EXPECT_EQ(vulkan.at("engine"), "vulkan");
    EXPECT_EQ(cpu.at("device"), "one thread, " + cpu.at("instruction_set").get<std::string>());
    EXPECT_TRUE(vulkan.at("instruction_set").is_null());
    EXPECT_EQ(vulkan.at("ratio_to_last"), 1.0);
    EXPECT_DOUBLE_EQ(
        cpu.at("ratio_p999_to_last").get<double>(),
        cpu.at("frame_us").at("p999").get<double>() / vulkan.at("frame_us").at("p999").get<double>());
    EXPECT_LE(cpu.at("ratio_to_last_range")[0], cpu.at("ratio_to_last_range")[1]);
    for (const nlohmann::json& engine : engines) {
      EXPECT_EQ(engine.at("frames"), 40) << "of both rounds";
      ExpectTimes(engine.at("frame_us"));
      ASSERT_EQ(engine.at("rounds").size(), 2u);
      ExpectTimes(engine.at("rounds")[1]);
    }
  }
  EXPECT_EQ(json.at("engines"), workloads[0].at("engines")) << "the first workload stands at the top too";
  EXPECT_EQ(json.at("scene"), "acetabulum");
  EXPECT_NE(run.out.find("reamer-30k: acetabulum, 1000 spheres"), std::string::npos) << run.out;
}

TEST(BenchFrame, ComparesWithPlainVoxels) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"bench", "frame", "--method", "cpu", "--compare", "voxel-128,reference",
                                 "--spheres", "1000", "--frames", "20", "--json", "f.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "f.json"),
                       methods = json.at("workloads")[0].at("engines");
  ASSERT_EQ(methods.size(), 3u);
  EXPECT_EQ(json.at("compare").at("method"), "voxel-128");
  EXPECT_EQ(methods[1].at("method"), "voxel-128");
  EXPECT_GT(methods[1].at("ratio").get<double>(), 0.0);
  // each method has its own simulated hand, which presses with 100 N
  for (const nlohmann::json& method : methods)
    EXPECT_NEAR(method.at("mean_force_N").get<double>(), 100.0, 5.0) << method.at("method");
  EXPECT_EQ(methods[0].at("removed_mm3"), methods[2].at("removed_mm3")) << "the same bits";
}

TEST(BenchFrame, RefusesInvalidArguments) {
  const TemporaryFolder folder;
  struct Case {
    std::vector<std::string> arguments;
    const char* said;
  };
  const std::vector<Case> cases{{{"--spheres", "0"}, "--spheres: found 0, accepted 1"},
                                {{"--method", "magic"}, "found magic, accepted ours, brute"},
                                {{"--frames", "3"}, "--frames: found 3, accepted 20"},
                                {{"--scene", "moon"}, "found moon, accepted acetabulum, molar"},
                                {{"--engines", "cpu,cuda"}, "found cuda, accepted vulkan, cpu, reference"},
                                {{"--compare", "ours"}, "found the method itself"},
                                {{"--engines", "cpu", "--compare", "cpu"}, "found the method itself"},
                                {{"--workloads", "moon"}, "found moon, accepted all, reamer-30k"},
                                {{"--workloads", "all", "--scene", "molar"}, "excludes"},
                                {{"--rounds", "0"}, "--rounds: found 0, accepted 1"},
                                {{"--compare", "paper"}, "works on another packing"},
                                {{"--sphere", "100"}, "did you mean --spheres?"}};
  for (const Case& each : cases) {
    std::vector<std::string> arguments{"bench", "frame"};
    arguments.insert(arguments.end(), each.arguments.begin(), each.arguments.end());
    const CommandResult run = RunCommand(folder.path(), arguments);
    EXPECT_EQ(run.exit_code, 2) << each.said;
    EXPECT_NE(run.err.find(each.said), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("osteon bench frame: "), std::string::npos) << run.err;
  }
  EXPECT_EQ(RunCommand(folder.path(), {"bench"}).exit_code, 2);
  const CommandResult wrong = RunCommand(folder.path(), {"bench", "frme"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("unknown subcommand frme; did you mean frame?"), std::string::npos) << wrong.err;
}

TEST(BenchKinematics, WritesTheDocumentedKeys) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"bench", "kinematics", "--calls", "1000", "--json", "k.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "k.json");
  EXPECT_EQ(json.at("schema"), "osteon.bench.kinematics/1");
  EXPECT_EQ(json.at("robot"), "LBR iiwa 14 R820");
  EXPECT_EQ(json.at("joints"), 7);
  EXPECT_EQ(json.at("calls"), 1000);
  for (const char* key :
       {"fk", "jacobian", "fk_jacobian", "inverse", "dynamics", "mass_matrix", "forward_dynamics"}) {
    const std::string name = std::string(key) + "_ns";
    EXPECT_GT(json.at(name).get<double>(), 0.0) << key;
    EXPECT_GT(json.at("kdl").at(name).get<double>(), 0.0) << key;
    EXPECT_DOUBLE_EQ(json.at("ratio").at(key).get<double>(),
                     json.at("kdl").at(name).get<double>() / json.at(name).get<double>());
  }
  EXPECT_EQ(json.at("kdl").at("version"), "1.5.1");
  // null if a sanitizer has replaced the heap
  if (!json.at("allocations").is_null()) {
    EXPECT_EQ(json.at("allocations"), 0);
  }
}

TEST(BenchKinematics, ReportsNoDynamicsForARobotWithoutMasses) {
  const TemporaryFolder folder;
  const std::string robot = std::string(OSTEON_SOURCE_DIR) + "/config/robots/kr_6_r900_2.yaml";
  const CommandResult run = RunCommand(
      folder.path(), {"bench", "kinematics", "--robot", robot, "--calls", "1000", "--json", "k.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "k.json");
  EXPECT_EQ(json.at("robot"), "KR 6 R900-2");
  EXPECT_EQ(json.at("joints"), 6);
  EXPECT_GT(json.at("fk_ns").get<double>(), 0.0);
  EXPECT_GT(json.at("inverse_ns").get<double>(), 0.0);
  EXPECT_TRUE(json.at("dynamics_ns").is_null());
  EXPECT_TRUE(json.at("kdl").at("mass_matrix_ns").is_null());
}

TEST(BenchKinematics, RefusesInvalidArguments) {
  const TemporaryFolder folder;
  const CommandResult few = RunCommand(folder.path(), {"bench", "kinematics", "--calls", "3"});
  EXPECT_EQ(few.exit_code, 2);
  EXPECT_NE(few.err.find("--calls: found 3, accepted 1000"), std::string::npos) << few.err;
  const CommandResult none = RunCommand(folder.path(), {"bench", "kinematics", "--robot", "no_such.yaml"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("osteon bench kinematics: no_such.yaml: no such file"), std::string::npos)
      << none.err;
}

TEST(BenchTick, WritesTheDocumentedKeys) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"bench", "tick", "--ticks", "200", "--json", "t.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "t.json");
  EXPECT_EQ(json.at("schema"), "osteon.bench.tick/1");
  EXPECT_EQ(json.at("ticks"), 200);
  EXPECT_EQ(json.at("contacts"), 8);
  ExpectTimes(json.at("tick_us"));
  for (const char* stage : {"receive", "devices", "loop", "send", "record", "kinematics", "coupling",
                            "limits", "elbow", "inverse", "guard"})
    ExpectTimes(json.at("stage_us").at(stage));
  ExpectTimes(json.at("kernel_alone_us"));
  EXPECT_GT(json.at("kernel_alone_us").at("p50").get<double>(), 0.0);
  // the loop had real work: the hand pressed the tool onto contact planes
  EXPECT_GT(json.at("mean_force_N").get<double>(), 1.0);
  EXPECT_GE(json.at("contacts_pressing_mean").get<double>(), 1.0);
  EXPECT_LE(json.at("contacts_pressing_mean").get<double>(), 8.0);
  // null if a sanitizer has replaced the heap
  if (!json.at("allocations").is_null()) {
    EXPECT_EQ(json.at("allocations"), 0);
  }
  const CommandResult few = RunCommand(folder.path(), {"bench", "tick", "--ticks", "3"});
  EXPECT_EQ(few.exit_code, 2);
  EXPECT_NE(few.err.find("--ticks: found 3, accepted 100"), std::string::npos) << few.err;
}

TEST(BenchTick, TimesEachComplianceLevel) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"bench", "tick", "--compliance", "--ticks", "100", "--json", "t.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "t.json");
  EXPECT_EQ(json.at("schema"), "osteon.bench.tick_levels/1");
  for (const char* level : {"off", "tool", "layer", "mount", "all"}) {
    const nlohmann::json& row = json.at("levels").at(level);
    ExpectTimes(row.at("loop_us"));
    ExpectTimes(row.at("tick_us"));
    EXPECT_GT(row.at("mean_force_N").get<double>(), 1.0) << level;
    if (!row.at("allocations").is_null()) {
      EXPECT_EQ(row.at("allocations"), 0) << level;
    }
  }
}

TEST(BenchTick, TimesTheTickWithAndWithoutGuidance) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"bench", "tick", "--plan", "acetabulum", "--ticks", "2000", "--json", "t.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "t.json");
  EXPECT_EQ(json.at("plan"), "acetabulum");
  const nlohmann::json& levels = json.at("levels");
  for (const char* level : {"none", "gain 0", "guided"}) {
    ExpectTimes(levels.at(level).at("loop_us"));
    EXPECT_GT(levels.at(level).at("ratio").get<double>(), 0.0) << level;
    EXPECT_EQ(levels.at(level).at("guided").get<double>() > 0.0, level == std::string("guided"));
    if (!levels.at(level).at("allocations").is_null()) {
      EXPECT_EQ(levels.at(level).at("allocations"), 0) << level;
    }
  }
  const CommandResult other =
      RunCommand(folder.path(), {"bench", "tick", "--plan", "molar", "--ticks", "100"});
  EXPECT_EQ(other.exit_code, 1) << "the demo's reamer is no tool of that plan";
  EXPECT_EQ(RunCommand(folder.path(), {"bench", "tick", "--plan", "nosuch"}).exit_code, 2);
}

TEST(BenchFrame, ExitsWithOneIfThereIsNoSuchDevice) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"bench", "frame", "--spheres", "500", "--device", "no such device"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("no such device"), std::string::npos) << run.err;
}

// Expects a chart's pictures, data and page in the folder. The minimum of 100 bytes excludes empty files.
void ExpectFiles(const std::filesystem::path& folder, const std::string& name) {
  for (const char* extension : {".svg", ".png", ".csv", ".json", ".html"}) {
    const std::filesystem::path file = folder / (name + extension);
    ASSERT_TRUE(std::filesystem::is_regular_file(file)) << file;
    EXPECT_GT(std::filesystem::file_size(file), 100u) << file;
  }
}

TEST(ChartScaling, WritesItsFilesAndPoints) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"chart", "scaling", "--max-spheres", "1000", "--frames", "20", "--out", "chart"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectFiles(folder.path() / "chart", "scaling");
  const nlohmann::json json = ReadJson(folder.path() / "chart" / "scaling.json");
  EXPECT_EQ(json.at("schema"), "osteon.chart.scaling/1");
  EXPECT_FALSE(json.at("machine").get<std::string>().empty());
  std::set<std::string> series;
  for (const nlohmann::json& point : json.at("points")) {
    series.insert(point.at("series").get<std::string>());
    EXPECT_NEAR(point.at("spheres").get<double>(), 1000.0, 20.0);
    EXPECT_GT(point.at("rate_hz").get<double>(), 0.0);
    EXPECT_GT(point.at("frame_us_p50").get<double>(), 0.0);
  }
  EXPECT_EQ(series.size(), 3u);  // three cases: the cut zone unchanged, uniform, and without culling
}

TEST(ChartCompliance, WritesItsFilesAndFigures) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"chart", "compliance", "--ticks", "100", "--out", "chart"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectFiles(folder.path() / "chart", "compliance");
  for (const char* name : {"compliance_gives.svg", "compliance_cost.svg"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "chart" / name)) << name;
  const nlohmann::json json = ReadJson(folder.path() / "chart" / "compliance.json");
  EXPECT_EQ(json.at("schema"), "osteon.chart.compliance/1");
  EXPECT_EQ(json.at("costs").size(), 5u);
  ASSERT_EQ(json.at("changes").size(), 3u);
  // in slow motion the coupling (60 N/mm for the drill, 20 N/mm for the mount) and the part (7.48 and 47.4
  // N/mm) are two springs in series
  EXPECT_NEAR(json.at("changes")[0].at("felt_ratio")[0].get<double>(), 7.48 / (7.48 + 60.0), 0.005);
  EXPECT_NEAR(json.at("changes")[2].at("felt_ratio")[0].get<double>(), 47.4 / (47.4 + 20.0), 0.005);
  EXPECT_NEAR(json.at("changes")[2].at("gives_m")[7].get<double>(), 2.53e-3, 0.03e-3) << "under 120 N";
}

TEST(ChartSpeedAccuracy, WritesItsFilesAndPoints) {
  const TemporaryFolder folder;
  const CommandResult run =
      RunCommand(folder.path(), {"chart", "speed-accuracy", "--quick", "--seeds", "1", "--method", "ours",
                                 "--method", "voxel", "--method", "cpu", "--out", "chart"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectFiles(folder.path() / "chart", "speed_accuracy");
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "chart" / "speed_accuracy_depth.svg"));
  const nlohmann::json json = ReadJson(folder.path() / "chart" / "speed_accuracy.json");
  EXPECT_EQ(json.at("schema"), "osteon.chart.speed-accuracy/1");
  for (const char* name : {"speed_accuracy_worst.svg", "speed_accuracy_worst.png"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "chart" / name)) << name;
  ASSERT_EQ(json.at("points").size(), 6u);
  for (const nlohmann::json& point : json.at("points")) {
    for (const char* key : {"frame_us_p50", "frame_us_p999", "depth_error_mm", "volume_error", "force_error",
                            "normal_error_deg", "ripple", "r_max_mm", "spheres"})
      EXPECT_GE(point.at(key).get<double>(), 0.0) << key;
    EXPECT_EQ(point.at("tasks").size(), 4u);
  }
  // each method has two points, coarse then fine. The fine cut is closer to the exact cut, and the fine cut
  // of method `cpu` leaves no bone in the tool's path
  const nlohmann::json& points = json.at("points");
  const auto depth = [&](std::size_t i) { return points[i].at("depth_error_mm").get<double>(); };
  for (const std::size_t coarse : {0u, 2u, 4u}) EXPECT_LT(depth(coarse + 1), depth(coarse));
  EXPECT_EQ(points[0].at("method"), "cpu");
  EXPECT_EQ(points[2].at("method"), "ours");
  EXPECT_NEAR(depth(0), depth(2), 0.02 * depth(2)) << "two engines, one model";
  EXPECT_LT(points[1].at("left_mm").get<double>(), 1e-3);
  for (const char* time : {"median", "p999"})
    for (const char* error : {"depth", "volume", "force", "normal", "ripple"})
      for (const char* key : {"beat_all_ours", "beaten", "ahead", "faster_than_all_ours"})
        EXPECT_TRUE(json.at("dominance").at(time).at(error).at(key).is_array()) << error << " " << key;
  EXPECT_NE(run.out.find("by the 99.9th percentile"), std::string::npos) << run.out;
}

}  // namespace
}  // namespace osteon::app
