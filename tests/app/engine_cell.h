#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/command.h"
#include "tests/config/cell_text.h"

namespace osteon::app {

/// Runs demos in virtual time of cells whose engine has its own process.
class EngineCellTest : public testing::Test {
 protected:
  /// @param process  place of the engine: "local", or HOST:PORT
  /// @returns the file of a shipped cell whose engine runs there
  std::string CellWith(const std::string& process, const std::string& shipped) {
    const std::filesystem::path file = folder_.path() / (shipped + ".yaml");
    std::ofstream(file) << config::CellText(shipped) << "simulation: {process: '" << process << "'}\n";
    return file.string();
  }
  /// Runs a demo of 1 s in a cell. @returns its summary.
  nlohmann::json Demo(const std::string& cell, const std::string& out) {
    const CommandResult run = RunCommand(folder_.path(), {"demo", "--virtual-time", "--seconds", "1",
                                                          "--engine", "cpu", "--cell", cell, "--out", out});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return ReadJson(folder_.path() / out / "summary.json");
  }
  const TemporaryFolder folder_;
};

}  // namespace osteon::app
