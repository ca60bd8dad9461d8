#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/reading/load.h"
#include "tests/config/cell_text.h"

// Tests the keys in a cell's section fri. They configure both the controller's link and the simulated arm.

namespace osteon::config {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FriKeys : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy(fs::path(OSTEON_SOURCE_DIR) / "config", folder_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(folder_); }
  // Loads the thin plate's cell, without its own key `version` and with these lines in section fri.
  CellConfig LoadWith(const std::string& keys) const {
    const fs::path cell = folder_ / "cells/thin_plate.yaml";
    std::string edited = CellText("thin_plate");
    // the removed line has the library's default value
    const std::size_t version = edited.find("  version:");
    edited.erase(version, edited.find('\n', version) + 1 - version);
    const std::string before = "  period_ms: 1\n";
    const std::size_t at = edited.find(before);
    if (at == std::string::npos) throw std::logic_error("the cell has changed");
    edited.insert(at, keys);
    std::ofstream(cell) << edited;
    return LoadCell(cell);
  }
  // The error of LoadWith for these lines; empty if the cell is accepted.
  std::string Refusal(const std::string& keys) const {
    try {
      (void)LoadWith(keys);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  const fs::path folder_ =
      fs::temp_directory_path() / ("osteon_fri_keys_" + std::to_string(::getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(FriKeys, HaveTheLibrarysDefaultsWhereTheCellOmitsThem) {
  const CellConfig cell = LoadWith("");
  EXPECT_EQ(cell.link.fri()->version, io::FriVersion::k1_15);
  EXPECT_EQ(cell.simulated.fri.version, io::FriVersion::k1_15);
  EXPECT_EQ(cell.link.fri()->torque_order, io::FriTorqueOrder::kZyx);
  EXPECT_TRUE(cell.simulated.fri.torques_zyx);
  EXPECT_EQ(cell.simulated.fri.receive_multiplier, 1);
}

TEST_F(FriKeys, ReachLinkAndSimulatedArm) {
  const CellConfig cell = LoadWith("  version: 2.7\n  wrench_torques: xyz\n  receive_multiplier_count: 2\n");
  EXPECT_EQ(cell.link.fri()->version, io::FriVersion::k2_7);
  EXPECT_EQ(cell.simulated.fri.version, io::FriVersion::k2_7);
  EXPECT_EQ(cell.link.fri()->torque_order, io::FriTorqueOrder::kXyz);
  EXPECT_FALSE(cell.simulated.fri.torques_zyx);
  EXPECT_EQ(cell.simulated.fri.receive_multiplier, 2);
}

TEST_F(FriKeys, SessionEndIsSilenceByDefaultAndCanBeChosen) {
  const std::string text = CellText("thin_plate"), key = "  good_timeout_s: 10";
  EXPECT_EQ(LoadText(text).simulated.fri.session_end, hil::SessionEnd::kSilence);
  const auto with_session_end = [&](const std::string& value) {
    return With(text, key, "  session_end: " + value + "\n" + key);
  };
  EXPECT_EQ(LoadText(with_session_end("silence")).simulated.fri.session_end, hil::SessionEnd::kSilence);
  EXPECT_EQ(LoadText(with_session_end("idle_messages")).simulated.fri.session_end,
            hil::SessionEnd::kIdleMessages);
  EXPECT_THROW(LoadText(with_session_end("wave")), ConfigError);
}

TEST_F(FriKeys, AcceptEveryVersionByItsName) {
  const fs::path cell = folder_ / "cells/thin_plate.yaml";
  const fs::path original = folder_ / "kept.yaml";
  fs::copy_file(cell, original);
  for (const io::FriVersion version : io::kFriVersions) {
    fs::copy_file(original, cell, fs::copy_options::overwrite_existing);
    EXPECT_EQ(LoadWith(std::string("  version: ") + Name(version) + "\n").link.fri()->version, version);
  }
}

TEST_F(FriKeys, RefuseAnUnsupportedVersion) {
  const std::string text = Refusal("  version: 2.6\n");
  EXPECT_THAT(text, HasSubstr("thin_plate.yaml:"));
  EXPECT_THAT(text, HasSubstr("version: found 2.6, accepted 1.11"));
  EXPECT_THAT(text, HasSubstr("2.7"));
}

}  // namespace
}  // namespace osteon::config
