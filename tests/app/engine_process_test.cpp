#include <signal.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/app/engine_cell.h"
#include "tests/app/first_port.h"
#include "tests/app/machine_lateness.h"
#include "tests/app/patient_cell.h"

// A run that starts its cutting engine as a process of its own. In engine_lockstep_test.cpp the user starts
// the engine.

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

// The process id of a run's engine, read from the text "…: local, process 1234" in the run's output; 0 if the
// text is missing.
pid_t EnginePid(const std::string& err) {
  const std::string words = "local, process ";
  const std::size_t at = err.find(words);
  return at == std::string::npos ? 0 : std::stoi(err.substr(at + words.size()));
}

// Number of folders that engines have in shared memory.
int EngineFolders() {
  int count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev/shm"))
    count += entry.path().filename().string().starts_with("osteon_engine_") ? 1 : 0;
  return count;
}

using EngineProcess = EngineCellTest;

// Every frame is computed in the other process. The result must be the same to the bit as with the engine in
// a thread.
TEST_F(EngineProcess, CarvesWhatAThreadCarvesBitForBit) {
  const int before = EngineFolders();
  const nlohmann::json thread = Demo("thin_plate", "thread"),
                       local = Demo(CellWith("local", "thin_plate"), "local");
  EXPECT_TRUE(thread.at("engine_process").is_null());
  const nlohmann::json& process = local.at("engine_process");
  ASSERT_TRUE(process.is_object()) << local.dump(2);
  EXPECT_GT(process.at("frames").get<int>(), 400);  // 1 s at 500 Hz
  EXPECT_EQ(process.at("lost"), 0);
  EXPECT_EQ(process.at("rejected"), 0);
  EXPECT_TRUE(process.at("ended").is_null());
  EXPECT_TRUE(process.at("carved_again").is_null());
  for (const char* key : {"state_hash", "removed_volume_mm3", "peak_force_N", "engine", "device", "frames"})
    EXPECT_EQ(local.at(key), thread.at(key)) << key;
  EXPECT_EQ(EngineFolders(), before) << "nothing is left in shared memory";
}

// Kills the engine in wall time while the loop renders contact. The arm must come to rest.
TEST_F(EngineProcess, KillingTheEngineStopsTheArmAndIsReported) {
  const std::string cell = PatientCell(folder_.path(), "demo", {{"simulation", "{process: local}"}});
  RepeatWhileLate([&](Attempt& attempt) {
    const WakeupWatch watch;
    Command run(folder_.path(),
                {"run", cell, "--simulated", "--port", FirstPort(), "--engine", "cpu", "--seconds", "60",
                 "--record", "r.mcap", "--overwrite", "--json", "run.json"});
    const bool renders = run.WaitUntil([&] { return run.Err().find(" of 60.0 s | ") != std::string::npos; });
    const pid_t engine = EnginePid(run.Err());
    ASSERT_GT(engine, 0) << run.Err();
    const bool killed = renders && kill(engine, SIGKILL) == 0;
    const CommandResult result = run.Wait();
    const nlohmann::json summary = ReadJson(folder_.path() / "run.json");
    EXPECT_EQ(result.exit_code, 1) << result.err;
    ASSERT_FALSE(summary.at("faults").empty()) << result.err;
    if (!killed || summary.at("faults")[0] != "contact model stale")
      return attempt.ExpectLate(result, summary, watch, summary.at("faults").dump());
    EXPECT_NE(result.err.find("the engine's process has ended: signal 9"), std::string::npos) << result.err;
    const nlohmann::json& process = summary.at("engine_process");
    ASSERT_TRUE(process.is_object());
    EXPECT_EQ(process.at("ended").get<std::string>().substr(0, 8), "signal 9");
    EXPECT_TRUE(process.at("carved_again").is_string());
  });
}

// Times three ways to connect the engine: as a thread, over shared memory, and over UDP. No time is judged.
TEST(BenchSimulate, TimesEachWayToRunTheEngine) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(folder.path(), {"bench", "simulate", "--ticks", "300", "--rounds", "1",
                                                       "--engine", "cpu", "--json", "simulate.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json json = ReadJson(folder.path() / "simulate.json");
  EXPECT_EQ(json.at("schema"), "osteon.bench_simulate/1");
  ASSERT_EQ(json.at("ways").size(), 3u);
  for (const nlohmann::json& way : json.at("ways")) {
    const nlohmann::json& age = way.at("age");
    EXPECT_GT(age.at("count"), 200) << way.dump();
    EXPECT_GT(age.at("p50_us"), 0.0);
    EXPECT_LE(age.at("p50_us"), age.at("max_us"));
  }
}

}  // namespace
}  // namespace osteon::app
