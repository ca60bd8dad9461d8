#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cell_text.h"

// Tests a cell's section simulation, with which the engine can run in a process of its own.

namespace osteon::config {
namespace {

using testing::HasSubstr;

// Text of the thin plate's cell, with a section simulation that consists of these lines.
std::string WithSimulation(const std::string& keys) {
  return CellText("thin_plate") + "\nsimulation:\n" + keys;
}

TEST(SimulationKeys, TheEngineIsAThreadByDefault) {
  EXPECT_FALSE(LoadText(CellText("thin_plate")).engine_process);
  EXPECT_FALSE(LoadText(WithSimulation("  process: inside\n")).engine_process);
}

TEST(SimulationKeys, ProcessIsLocalOrAnAddress) {
  const CellConfig local = LoadText(WithSimulation("  process: local\n"));
  ASSERT_TRUE(local.engine_process);
  EXPECT_EQ(local.engine_process->host, "");
  const CellConfig loopback = LoadText(WithSimulation("  process: 127.0.0.1:30300\n"));
  ASSERT_TRUE(loopback.engine_process);
  EXPECT_EQ(loopback.engine_process->host, "127.0.0.1");
  EXPECT_EQ(loopback.engine_process->port, 30300);
  const CellConfig far = LoadText(WithSimulation("  process: 192.168.1.7:30300\n  token_file: token.txt\n"));
  ASSERT_TRUE(far.engine_process);
  EXPECT_EQ(far.engine_process->token_file, "token.txt");
}

TEST(SimulationKeys, RefusalNamesTheValueAndWhatIsAccepted) {
  EXPECT_THAT(Refusal(WithSimulation("  process: 192.168.1.7:30300\n")),
              HasSubstr("found 192.168.1.7:30300 without token_file"));
  for (const char* wrong :
       {"there", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:70000", "localhost:30300", "127.0.0.1:30300x"})
    EXPECT_THAT(Refusal(WithSimulation(std::string("  process: ") + wrong + "\n")),
                HasSubstr(std::string("process: found ") + wrong + ", accepted inside, local"));
  EXPECT_THAT(Refusal(WithSimulation("  process: local\n  token_file: t\n")),
              HasSubstr("token_file: found with process: local"));
  EXPECT_THAT(Refusal(WithSimulation("  token_file: t\n")), HasSubstr("process"));
}

}  // namespace
}  // namespace osteon::config
