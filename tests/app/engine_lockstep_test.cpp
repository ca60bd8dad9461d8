#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/app/engine_cell.h"
#include "tests/app/first_port.h"

// A run in virtual time whose cutting engine is a separate process, which the test starts: `osteon simulate`.

namespace osteon::app {
namespace {

using EngineInLockstep = EngineCellTest;

TEST_F(EngineInLockstep, CarvesTheSameOverUdp) {
  const std::string address = "127.0.0.1:" + FirstPort();
  Command engine(folder_.path(),
                 {"simulate", "--listen", address, "--engine", "cpu", "--json", "engine.json"});
  ASSERT_TRUE(engine.WaitUntil([&] { return engine.Out().find("Ctrl-C ends it") != std::string::npos; }))
      << engine.Err();
  // the same demo, with the engine as a thread of the run's process
  const nlohmann::json thread = Demo("thin_plate", "thread");
  EXPECT_GT(thread.at("removed_volume_mm3"), 0.5);
  for (const char* out : {"first", "second"}) {  // one run after the other
    const nlohmann::json udp = Demo(CellWith(address, "thin_plate"), out);
    ASSERT_TRUE(udp.at("engine_process").is_object());
    EXPECT_EQ(udp.at("engine_process").at("where"), address);
    EXPECT_EQ(udp.at("state_hash"), thread.at("state_hash"));
    EXPECT_EQ(udp.at("peak_force_N"), thread.at("peak_force_N"));
  }
  engine.Send(SIGTERM);
  EXPECT_EQ(engine.Wait().exit_code, 0) << engine.Err();
  const nlohmann::json report = ReadJson(folder_.path() / "engine.json");
  EXPECT_EQ(report.at("schema"), "osteon.simulate/1");
  EXPECT_EQ(report.at("runs"), 2);
  EXPECT_GT(report.at("frames").get<int>(), 800);  // two runs of 1 s at 500 Hz
}

TEST_F(EngineInLockstep, AMissingEngineIsReportedBeforeAnythingMoves) {
  const CommandResult run =
      RunCommand(folder_.path(), {"demo", "--virtual-time", "--cell",
                                  CellWith("127.0.0.1:" + FirstPort(), "thin_plate"), "--out", "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("does `osteon simulate --listen` run there"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
}

TEST_F(EngineInLockstep, ListensBeyondTheLoopbackOnlyWithAToken) {
  const CommandResult run = RunCommand(folder_.path(), {"simulate", "--listen", "0.0.0.0:" + FirstPort()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("found no token"), std::string::npos) << run.err;
  std::ofstream(folder_.path() / "short") << "abc\n";
  const CommandResult weak =
      RunCommand(folder_.path(), {"simulate", "--listen", "0.0.0.0:" + FirstPort(), "--token-file", "short"});
  EXPECT_EQ(weak.exit_code, 2);
  EXPECT_NE(weak.err.find("found a first line of 3 characters"), std::string::npos) << weak.err;
}

}  // namespace
}  // namespace osteon::app
