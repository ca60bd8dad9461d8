#include <filesystem>

#include <gtest/gtest.h>

#include "tests/app/command.h"

// Runs `osteon transparency` as a user does, with few frequencies.

namespace osteon::app {
namespace {

TEST(Transparency, WritesTheDocumentedKeysAndFindsMoreMassThanTheLaws) {
  const TemporaryFolder folder;
  const CommandResult run = RunCommand(
      folder.path(), {"transparency", "demo", "--out", "felt", "--json", "copy.json", "--points", "6"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"transparency.svg", "transparency.png", "transparency.csv", "transparency.html"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder.path() / "felt" / name)) << name;
  const nlohmann::json json = ReadJson(folder.path() / "felt" / "transparency.json");
  EXPECT_EQ(json, ReadJson(folder.path() / "copy.json"));
  EXPECT_EQ(json.at("schema"), "osteon.transparency/1");
  EXPECT_FALSE(json.at("fault").get<bool>());
  EXPECT_EQ(json.at("points").size(), 7u * 6u) << "six directions in free motion, one in contact";
  // the demo's law has 1.7 kg and 30 N s/m. The arm lags by about 25 ms, so the drag of 30 N s/m adds 0.75 kg
  // to the felt mass
  EXPECT_GT(json.at("apparent_mass_kg").get<double>(), 2.1);
  EXPECT_LT(json.at("apparent_mass_kg").get<double>(), 2.7);
  EXPECT_NEAR(json.at("drag_Ns_per_m").get<double>(), 30.0, 3.0);
  EXPECT_NEAR(json.at("stiffness_N_per_m").get<double>(), json.at("asked_stiffness_N_per_m").get<double>(),
              0.01 * json.at("asked_stiffness_N_per_m").get<double>());
  EXPECT_GT(json.at("free_residual").get<double>(), 0.02);
  EXPECT_NE(run.out.find("Residual"), std::string::npos);
}

TEST(Transparency, RefusesUnsuitableCellsAndTooFewPoints) {
  const TemporaryFolder folder;
  EXPECT_EQ(RunCommand(folder.path(), {"transparency", "no_such_cell"}).exit_code, 2);
  EXPECT_EQ(RunCommand(folder.path(), {"transparency", "demo", "--points", "2"}).exit_code, 2);
  for (const auto& [cell, said] : {std::pair{"thin_plate_impedance", "found a cell with the impedance law"},
                                   std::pair{"kr_16_thin_plate", "accepted an LBR: "}}) {
    const CommandResult run = RunCommand(folder.path(), {"transparency", cell});
    EXPECT_EQ(run.exit_code, 2) << cell;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace osteon::app
