#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "studies/sharding/part_set.h"
#include "tests/app/command.h"

// Runs studies in two ways: whole, and in shards that `osteon merge` puts together, as a user with several
// machines does. Both ways must give the same files, except for measured times.

namespace osteon::app {
namespace {

// Removes all measured times, which differ between runs.
nlohmann::json WithoutTimes(nlohmann::json json) {
  static const std::vector<std::string> times{"seconds",        "seconds_wall",    "seconds_cpu",
                                              "seconds_set_up", "times_real_time", "frame_us"};
  if (json.is_object())
    for (const std::string& key : times) json.erase(key);
  if (json.is_structured())
    for (nlohmann::json& value : json) value = WithoutTimes(std::move(value));
  return json;
}

// The text of a shard's file with this content and the digest that belongs to it.
std::string TextOfPart(const nlohmann::json& json) {
  studies::Part part{.file = {},
                     .shard = {.index = json.at("shard").at("index"), .of = json.at("shard").at("of")},
                     .items = json.at("shard").at("items"),
                     .build = json.at("build"),
                     .checksum = json.at("checksum"),
                     .words = json.at("command")};
  for (const nlohmann::json& result : json.at("results"))
    part.results[result.at("item")] = result.at("result");
  return studies::PartText(part);
}

// Runs commands of `osteon` in one folder.
class Merge : public testing::Test {
 protected:
  CommandResult Run(const std::vector<std::string>& arguments) {
    return RunCommand(folder_.path(), arguments);
  }
  /// Runs all shards of a command. Each may end with exit code 0 or `exit_code`. @returns the shards' files,
  /// the last shard first.
  std::vector<std::string> RunShards(const std::vector<std::string>& command, int of, int exit_code) {
    std::vector<std::string> files;
    for (int index = of; index >= 1; --index) {
      files.push_back("part_" + std::to_string(index) + ".json");
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(),
                       {"--shard", std::to_string(index) + "/" + std::to_string(of), "--json", files.back()});
      const CommandResult run = Run(arguments);
      EXPECT_TRUE(run.exit_code == 0 || run.exit_code == exit_code) << run.out << run.err;
    }
    return files;
  }
  CommandResult MergeFiles(std::vector<std::string> files, const std::vector<std::string>& more = {}) {
    files.insert(files.begin(), "merge");
    files.insert(files.end(), more.begin(), more.end());
    return Run(files);
  }
  [[nodiscard]] std::string Text(const std::string& name) const {
    return io::test::ReadAll(folder_.path() / name);
  }

  TemporaryFolder folder_;
};

// Some scenarios differ from their golden traces, so the page has plots of them. The plots need samples,
// which the shards' files contain.
TEST_F(Merge, MergedRegressEqualsOneRun) {
  const std::vector<std::string> command{"regress", "wall_reamer",           "wall_kr", "pause",
                                         "--set",   "limits.max_force_N=50", "--junit", "out/junit.xml"};
  std::filesystem::create_directories(folder_.path() / "out");
  std::vector<std::string> whole = command;
  whole.insert(whole.end(), {"--out", "out", "--json", "r.json"});
  const CommandResult one = Run(whole);
  ASSERT_EQ(one.exit_code, 1) << one.out << one.err;
  const nlohmann::json json = ReadJson(folder_.path() / "r.json");
  const std::string page = Text("out/regress.html");
  const std::regex time("time=\"[0-9.]*\"");
  const std::string junit = std::regex_replace(Text("out/junit.xml"), time, "");

  std::vector<std::string> shards = command;
  shards.insert(shards.end(), {"--out", "out"});
  const auto files = RunShards(shards, 2, 1);
  std::filesystem::remove(folder_.path() / "r.json");
  std::filesystem::remove(folder_.path() / "out/regress.html");
  std::filesystem::remove(folder_.path() / "out/junit.xml");
  const CommandResult merged = MergeFiles(files, {"--out", "out", "--json", "r.json"});
  EXPECT_EQ(merged.exit_code, 1) << merged.out << merged.err;
  const nlohmann::json merged_json = ReadJson(folder_.path() / "r.json");
  EXPECT_EQ(WithoutTimes(merged_json).dump(), WithoutTimes(json).dump());
  double seconds = 0.0;  // sum over the scenarios, without the time of the merge
  for (const nlohmann::json& scenario : merged_json.at("scenarios"))
    seconds += scenario.at("seconds_wall").get<double>();
  EXPECT_GT(seconds, 0.0);
  EXPECT_NEAR(merged_json.at("seconds_wall").get<double>(), seconds, 1e-9);
  EXPECT_NE(page.find("now - golden"), std::string::npos);
  EXPECT_EQ(Text("out/regress.html"), page);
  EXPECT_EQ(std::regex_replace(Text("out/junit.xml"), time, ""), junit);
}

TEST_F(Merge, MergedFailuresEqualOneRun) {
  const std::vector<std::string> command{"failures", "18", "19", "--quick", "--engine", "cpu"};
  std::vector<std::string> whole = command;
  whole.insert(whole.end(), {"--out", "one", "--json", "f.json"});
  const CommandResult one = Run(whole);
  const nlohmann::json json = ReadJson(folder_.path() / "f.json");
  const auto files = RunShards(command, 2, one.exit_code);
  const CommandResult merged = MergeFiles(files, {"--out", "merged", "--json", "m.json"});
  EXPECT_EQ(merged.exit_code, one.exit_code) << merged.out << merged.err;
  EXPECT_EQ(WithoutTimes(ReadJson(folder_.path() / "m.json")).dump(), WithoutTimes(json).dump());
  std::size_t pictures = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_.path() / "one"))
    if (file.path().extension() == ".svg") {
      ++pictures;
      const std::string name = file.path().filename().string();
      EXPECT_EQ(Text("merged/" + name), Text("one/" + name)) << name;
    }
  EXPECT_EQ(pictures, 4u);
}

// After a merge, every file of `osteon tune` must be the same to the byte.
TEST_F(Merge, MergedTuneEqualsOneRun) {
  const std::vector<std::string> command{"tune",      "demo", "--nodes",         "3",
                                         "--threads", "2",    "--stiffest-grip", "4000"};
  std::vector<std::string> whole = command;
  whole.insert(whole.end(), {"--out", "tuned", "--json", "t.json"});
  const CommandResult one = Run(whole);
  std::filesystem::rename(folder_.path() / "tuned", folder_.path() / "one");
  const std::string json = Text("t.json");
  const auto files = RunShards(command, 2, one.exit_code);
  const CommandResult merged = MergeFiles(files, {"--out", "tuned", "--json", "t.json"});
  EXPECT_EQ(merged.exit_code, one.exit_code) << merged.out << merged.err;
  EXPECT_EQ(merged.out, one.out);
  EXPECT_EQ(Text("t.json"), json);
  for (const char* name : {"tune.json", "tune.csv", "tune.html", "gains.yaml", "results.json", "tune.svg"})
    EXPECT_EQ(Text(std::string("tuned/") + name), Text(std::string("one/") + name)) << name;
}

// One seed in two shards: the first shard's file has all measurements, and the second's has none.
TEST_F(Merge, MergedChartsHaveThePointsOfTheirShards) {
  const auto parts =
      RunShards({"chart", "speed-accuracy", "--quick", "--seeds", "1", "--method", "cpu"}, 2, 0);
  CommandResult merged = MergeFiles(parts, {"--out", "merged", "--json", "c.json"});
  ASSERT_EQ(merged.exit_code, 0) << merged.out << merged.err;
  const nlohmann::json rungs = ReadJson(folder_.path() / "part_1.json")["results"][0]["result"]["rungs"];
  const nlohmann::json chart = ReadJson(folder_.path() / "c.json");
  EXPECT_EQ(ReadJson(folder_.path() / "part_2.json")["results"].size(), 0u);
  EXPECT_EQ(chart["verdict"]["level"], "good");
  ASSERT_EQ(chart["points"].size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const nlohmann::json &point = chart["points"][i], &scores = rungs[i]["scores"];
    EXPECT_EQ(point["depth_error_mm"].get<double>(), scores["depth_error_m"].get<double>() * 1e3);
    EXPECT_EQ(point["volume_error"], scores["volume_error"]);
    EXPECT_EQ(point["frame_us_p50"], rungs[i]["frame_us"]["p50_us"]);
    EXPECT_EQ(point["spheres"], rungs[i]["spheres"]);
    EXPECT_EQ(point["tasks"].size(), 4u);
  }

  const std::vector<std::string> scaling{"chart", "scaling", "--max-spheres", "1000", "--frames", "20"};
  merged = MergeFiles(RunShards(scaling, 2, 0), {"--out", "scaled"});
  ASSERT_EQ(merged.exit_code, 0) << merged.out << merged.err;
  EXPECT_EQ(ReadJson(folder_.path() / "scaled/scaling.json")["points"].size(), 3u);
}

TEST_F(Merge, MergedSweepEqualsOneRun) {
  io::test::WriteAll(folder_.path() / "sweep.yaml",
                     "shows: x\nscenario: tremor\nseed_count: 2\nparameters:\n"
                     "  - {key: coupling.damping_Ns_per_m, takes: \"50, 200\"}\n"
                     "  - {key: operator.tremor_N, takes: uniform 0 to 4}\n"
                     "  - {key: operator.tremor_seed, takes: seed}\n");
  const std::vector<std::string> command{"regress", "--sweep", "sweep.yaml"};
  std::vector<std::string> whole = command;
  whole.insert(whole.end(), {"--out", "out", "--json", "s.json"});
  const CommandResult one = Run(whole);
  ASSERT_EQ(one.exit_code, 0) << one.out << one.err;
  std::filesystem::rename(folder_.path() / "out", folder_.path() / "one");
  const std::string json = Text("s.json");
  const auto files = RunShards(command, 3, 0);
  const CommandResult merged = MergeFiles(files, {"--out", "out", "--json", "s.json"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(merged.out, one.out);
  EXPECT_EQ(Text("s.json"), json);
  for (const char* name : {"sweep.html", "sweep.csv"})
    EXPECT_EQ(Text(std::string("out/") + name), Text(std::string("one/") + name)) << name;

  const nlohmann::json sweep = ReadJson(folder_.path() / "s.json");
  EXPECT_EQ(sweep["schema"], "osteon.sweep/1");
  ASSERT_EQ(sweep["results"].size(), 4u);
  std::set<std::string> hashes;
  for (const auto& run : sweep["results"]) {
    EXPECT_GT(run["peak_force_N"], 1.0);
    hashes.insert(run["hash"].get<std::string>());
  }
  EXPECT_EQ(hashes.size(), 4u);  // all four runs differ
  ASSERT_EQ(sweep["combinations"].size(), 2u);
  EXPECT_EQ(sweep["combinations"][1]["values"]["coupling.damping_Ns_per_m"], "200");
}

TEST_F(Merge, RefusesShardsOfOtherRunsAndNamesTheFile) {
  const auto expect_refused = [&](const std::vector<std::string>& files, const std::string& text) {
    const CommandResult run = MergeFiles(files);
    EXPECT_EQ(run.exit_code, 2) << text;
    EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
  };
  const auto files = RunShards({"regress", "wall_reamer", "wall_kr"}, 2, 0);
  expect_refused({files[0]}, "missing: 1/2");
  expect_refused({files[0], files[0], files[1]}, "found shard 2/2, which part_2.json is too");
  expect_refused({"none.json"}, "none.json: no such file");
  ASSERT_EQ(Run({"regress", "wall_reamer", "wall_kr", "--exact", "--shard", "1/2", "--json", "other.json"})
                .exit_code,
            0);
  expect_refused({files[0], "other.json"},
                 "other.json: found command regress wall_reamer wall_kr --exact, accepted "
                 "regress wall_reamer wall_kr, as in part_2.json");
  io::test::WriteAll(folder_.path() / "half.json", Text(files[0]).substr(0, Text(files[0]).size() / 2));
  expect_refused({"half.json", files[1]}, "half.json: found no complete JSON");
  nlohmann::json damaged = ReadJson(folder_.path() / files[0]);
  damaged["results"][0]["result"]["difference"]["passed"] = false;
  io::test::WriteAll(folder_.path() / "damaged.json", damaged.dump());
  expect_refused({"damaged.json", files[1]}, "damaged.json: digest: found");
  // refuses a file with this wrong value, although its digest is right
  const auto refuse_value = [&](const char* key, const nlohmann::json& value, const std::string& text) {
    nlohmann::json other = ReadJson(folder_.path() / files[0]);
    other["results"][0]["result"]["difference"][key] = value;
    io::test::WriteAll(folder_.path() / "damaged.json", TextOfPart(other));
    expect_refused({"damaged.json", files[1]}, text);
  };
  refuse_value("parts", {{{"part", 99}, {"tick", 1}}}, "damaged.json: item 1: found part 99");
  refuse_value("passed", 1, "damaged.json: item 1: passed: found 1, accepted true or false");
  refuse_value("first_tick", -1,
               "damaged.json: item 1: first_tick: found -1, accepted a whole number from 0 on");
  refuse_value("others", {1}, "damaged.json: item 1: others: found [1], accepted a list of texts");
  // both shards were run with another commit than the merge
  for (const std::string& name : files) {
    nlohmann::json other = ReadJson(folder_.path() / name);
    other["build"] = "commit 0123456";
    io::test::WriteAll(folder_.path() / ("other_" + name), TextOfPart(other));
  }
  expect_refused({"other_" + files[0], "other_" + files[1]},
                 "other_part_2.json: found build commit 0123456, accepted commit ");
  damaged["results"].clear();
  io::test::WriteAll(folder_.path() / "damaged.json", damaged.dump());
  expect_refused({"damaged.json", files[1]}, "damaged.json: found 0 items, accepted the 1 of shard 2/2");
}

TEST_F(Merge, AShardNeedsAJsonFileAndAValidNumber) {
  const auto expect_refused = [&](std::vector<std::string> arguments, const std::string& text) {
    arguments.insert(arguments.begin(), {"regress", "wall_reamer"});
    const CommandResult run = Run(arguments);
    EXPECT_EQ(run.exit_code, 2) << text;
    EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
  };
  expect_refused({"--shard", "1/2"}, "--shard: found without --json");
  for (const char* wrong : {"0/2", "3/2", "1", "1/2/3", "1/", "/2", "a/b", "1/-2", "1/10001"})
    expect_refused({"--shard", wrong, "--json", "p.json"}, "found " + std::string(wrong) + ", accepted I/N");
  expect_refused({"--shard", "1/2", "--json", "p.json", "--update", "--reason", "none"},
                 "--update excludes --shard");
}

}  // namespace
}  // namespace osteon::app
