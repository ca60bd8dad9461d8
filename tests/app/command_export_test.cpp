#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/app/recorded_run.h"

// Tests `osteon export`: it writes tables, and rebuilds a complete recording from a torn one.

namespace osteon::app {
namespace {

// Header and rows of a CSV file, split at commas. Quoted fields are not supported.
struct Csv {
  explicit Csv(const std::filesystem::path& file) {
    std::istringstream text(io::test::ReadAll(file));
    std::string line;
    while (std::getline(text, line)) {
      std::vector<std::string> cells;
      std::istringstream parts(line);
      for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
      if (line.ends_with(',')) cells.emplace_back();
      if (columns.empty())
        columns = cells;
      else
        rows.push_back(cells);
    }
  }
  [[nodiscard]] double Number(std::size_t row, const std::string& column) const {
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i] == column) return std::strtod(rows.at(row).at(i).c_str(), nullptr);
    ADD_FAILURE() << "no column " << column;
    return 0.0;
  }
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

class ExportCommandTest : public RecordedRun {
 protected:
  /// Runs `osteon export`, which must succeed. @returns the JSON of --json; `out_` is the printed text.
  nlohmann::json Export(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "export");
    arguments.insert(arguments.end(), {"--json", "export.json"});
    const CommandResult run = RunCommand(folder_.path(), arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    out_ = run.out;
    return run.exit_code == 0 ? ReadJson(folder_.path() / "export.json") : nlohmann::json();
  }
  std::string out_;
};

TEST_F(ExportCommandTest, TablesHoldEveryValueBitForBit) {
  const nlohmann::json json = Export({Original().string(), "--csv", "--out", "tables"});
  const auto tables = folder_.path() / "tables";
  EXPECT_EQ(json.at("schema"), "osteon.export/1");
  EXPECT_EQ(json.at("ticks"), recording_->ticks.size());
  EXPECT_EQ(json.at("frames"), recording_->frames.size());
  EXPECT_EQ(json.at("recovered"), false);
  EXPECT_EQ(json.at("tables").size(), 3u);

  const Csv ticks(tables / "recording_ticks.csv");
  ASSERT_EQ(ticks.rows.size(), recording_->ticks.size());
  for (std::size_t row = 0; row < ticks.rows.size(); row += 37) {  // checks every 37th row
    const control::TickRecord& tick = recording_->ticks[row];
    ASSERT_EQ(ticks.rows[row].size(), ticks.columns.size());
    EXPECT_EQ(ticks.Number(row, "time_s"), 1e-9 * static_cast<double>(tick.stamp));
    EXPECT_EQ(ticks.Number(row, "stamp_ns"), static_cast<double>(tick.stamp));
    EXPECT_EQ(ticks.Number(row, "q_cmd_7_rad"), tick.q_cmd[6]);
    EXPECT_EQ(ticks.Number(row, "X_WT_cmd_z_m"), tick.X_WT_cmd.p.z);
    EXPECT_EQ(ticks.Number(row, "X_WT_meas_R32"), tick.X_WT_meas.R[7]);
    EXPECT_EQ(ticks.Number(row, "F_coupling_T_W_x_N"), tick.F_coupling_T_W.f.x);
    EXPECT_EQ(ticks.Number(row, "F_sensor_S_z_Nm"), tick.input.F_sensor_S.t.z);
    EXPECT_EQ(ticks.Number(row, "q_ipo_1_rad"), tick.input.q_ipo[0]);
    EXPECT_EQ(ticks.Number(row, "model_age_s"), tick.model_age_s);
  }

  const Csv frames(tables / "recording_frames.csv");
  ASSERT_EQ(frames.rows.size(), recording_->frames.size());
  bool touched = false;
  for (std::size_t row = 0; row < frames.rows.size(); ++row) {
    const simulation::ContactModel& model = recording_->frames[row].model;
    ASSERT_EQ(frames.rows[row].size(), frames.columns.size());
    EXPECT_EQ(frames.Number(row, "removed_volume_m3"), model.removed_volume_m3);
    if (model.contact_count == 0) {
      EXPECT_EQ(frames.rows[row].back(), "");
    } else {
      EXPECT_EQ(frames.Number(row, "contact_1_gap_m"), model.contacts[0].gap_m);
      touched = true;
    }
  }
  EXPECT_TRUE(touched);
}

// The copy keeps every message and adds the bone's states: first the whole bone, then only the bricks that
// changed.
TEST_F(ExportCommandTest, ACopyForFoxgloveShowsTheBoneBeingCarved) {
  const nlohmann::json json = Export({Original().string(), "--foxglove", "bone.mcap", "--every", "1"});
  EXPECT_TRUE(json.at("tables").empty()) << "nobody asked for tables";
  const auto copy = folder_.path() / "bone.mcap";
  const io::Recording same = ReadComplete(copy);
  ASSERT_EQ(same.ticks.size(), recording_->ticks.size());
  EXPECT_EQ(same.frames.size(), recording_->frames.size());
  EXPECT_EQ(same.events.size(), recording_->events.size());
  EXPECT_EQ(same.session.config_text, recording_->session.config_text);

  auto reader = io::McapReader::Open(copy);
  ASSERT_TRUE(reader) << reader.error();
  io::McapMessage message;
  std::vector<std::size_t> states;  // number of bytes of each bone state
  std::uint64_t others = 0, last_ns = 0;
  for (;;) {
    const auto more = reader->Next(message);
    ASSERT_TRUE(more) << more.error();
    if (!*more) break;
    if (message.channel->topic != "bone") {
      ++others;
      continue;
    }
    EXPECT_EQ(message.channel->schema_name, "foxglove.SceneUpdate");
    EXPECT_GE(message.log_time_ns, last_ns);
    last_ns = message.log_time_ns;
    states.push_back(message.bytes.size());
  }
  EXPECT_EQ(others, json.at("foxglove").at("messages"));
  EXPECT_EQ(states.size(), json.at("foxglove").at("bone_states"));
  ASSERT_GE(states.size(), 3u) << "four seconds of cutting";
  for (std::size_t i = 1; i < states.size(); ++i)
    EXPECT_LT(states[i], states[0] / 2) << "only the bricks that changed";

  // if the recording already contains bone states, the copy contains only new ones
  const nlohmann::json again = Export({"bone.mcap", "--foxglove", "again.mcap", "--every", "2"});
  EXPECT_EQ(again.at("foxglove").at("messages"), others);
  EXPECT_LT(again.at("foxglove").at("bone_states"), states.size());

  const auto refusal_of = [&](const std::vector<std::string>& words) {
    const CommandResult run = RunCommand(folder_.path(), words);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    return run.err;
  };
  EXPECT_NE(refusal_of({"export", "bone.mcap", "--foxglove", "bone.bag"})
                .find("accepted a name that ends with .mcap"),
            std::string::npos);
  EXPECT_NE(
      refusal_of({"export", "bone.mcap", "--mesh", "bone.mcap"}).find("neither --surface nor --foxglove"),
      std::string::npos);
}

// Each column's name ends with a unit or is listed in `bare`, the names without a unit. No name does both.
TEST_F(ExportCommandTest, ColumnsNameTheirUnits) {
  Export({Original().string(), "--out", "."});
  const std::vector<std::string> units{"_s",       "_ns",        "_m",       "_rad",      "_N",
                                       "_Nm",      "_kg",        "_J",       "_m2",       "_m3",
                                       "_m_per_s", "_rad_per_s", "_N_per_m", "_Ns_per_m", "_Nms_per_rad"};
  const std::vector<std::string> bare{"tick",
                                      "phase",
                                      "cell_state",
                                      "permits",
                                      "pause",
                                      "resume",
                                      "session_state",
                                      "faults",
                                      "wrench_scale",
                                      "arm_share",
                                      "vibration_index",
                                      "mass_factor",
                                      "damping_factor",
                                      "age_damping_factor",
                                      "age_wrench_share",
                                      "tank_share",
                                      "guidance_share",
                                      "guidance_present",
                                      "compliance_present",
                                      "guidance_stops_spindle",
                                      "guidance_gain_taken",
                                      "guidance_gain",
                                      "limits",
                                      "gains_taken",
                                      "coupling_damping_share",
                                      "model_frame",
                                      "arm_sequence",
                                      "arm_lost",
                                      "arm_duplicate",
                                      "arm_late",
                                      "arm_rejected",
                                      "arm_received",
                                      "arm_reordered",
                                      "arm_other_version",
                                      "arm_answers_lost",
                                      "arm_answers_foreign",
                                      "arm_activation",
                                      "arm_holding",
                                      "arm_operation_mode",
                                      "arm_control_mode",
                                      "arm_command_mode",
                                      "arm_drives_active",
                                      "activation_cmd",
                                      "arm_quality",
                                      "arm_safety_state",
                                      "has_ipo",
                                      "stop",
                                      "recover",
                                      "repeat_differed",
                                      "recorder_stalled",
                                      "tool_index",
                                      "sensor_trusted",
                                      "spindle_ready",
                                      "spindle_fault",
                                      "drive_faults",
                                      "drive_nmt_state",
                                      "drive_emergency_code",
                                      "drive_error_code",
                                      "permitted",
                                      "enabled",
                                      "spindle_permitted",
                                      "interlock_reason",
                                      "model_status",
                                      "frame",
                                      "status",
                                      "contact_fraction",
                                      "balls_not_split",
                                      "contact_count",
                                      "text"};
  for (const char* table : {"ticks", "frames", "events"}) {
    const Csv csv(folder_.path() / (std::string("recording_") + table + ".csv"));
    EXPECT_EQ(csv.columns.front(), "time_s");
    for (const std::string& column : csv.columns) {
      const auto ends = [&](const std::string& unit) { return column.ends_with(unit); };
      const bool has_unit = std::any_of(units.begin(), units.end(), ends);
      const bool is_bare = std::find(bare.begin(), bare.end(), column) != bare.end() ||
                           column.find("_R") != std::string::npos ||
                           column.find("n_W_") != std::string::npos || ends("_mu") || ends("_weight") ||
                           ends("_material");
      EXPECT_NE(has_unit, is_bare) << table << ": " << column;
    }
    EXPECT_EQ(std::set<std::string>(csv.columns.begin(), csv.columns.end()).size(), csv.columns.size());
  }
}

TEST_F(ExportCommandTest, EventTextsAreQuoted) {
  io::Recording changed = *recording_;
  changed.events = {{.stamp = 2'000'000'000, .text = "a \"fault\", with\na line"}};
  Export({Write(changed).string()});
  EXPECT_EQ(io::test::ReadAll(folder_.path() / "changed_events.csv"),
            "time_s,stamp_ns,text\n2,2000000000,\"a \"\"fault\"\", with\na line\"\n");
}

TEST_F(ExportCommandTest, RecoversATornRecording) {
  const std::string whole = io::test::ReadAll(Original());
  const auto torn = folder_.path() / "torn.mcap";
  io::test::WriteAll(torn, whole.substr(0, whole.size() * 2 / 3));
  nlohmann::json json = Export({torn.string(), "--recover"});
  EXPECT_EQ(json.at("recovered"), true);
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_TRUE(json.at("tables").empty());
  const io::Recording recovered = ReadComplete(json.at("recovered_file").get<std::string>());
  EXPECT_EQ(json.at("ticks"), recovered.ticks.size());
  EXPECT_GT(recovered.ticks.size(), recording_->ticks.size() / 2);
  EXPECT_NE(out_.find("of a message that was cut off"), std::string::npos) << out_;

  json = Export({torn.string()});  // the readable part of the torn recording itself
  EXPECT_EQ(json.at("ticks"), recovered.ticks.size());
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_NE(out_.find("ends early"), std::string::npos) << out_;

  json = Export({torn.string(), "--recover", "--csv", "--out", "both"});
  EXPECT_EQ(Csv(folder_.path() / "both/torn_ticks.csv").rows.size(), recovered.ticks.size());

  json = Export({Original().string(), "--recover", "--out", "whole"});
  EXPECT_EQ(json.at("recovered"), false);
  EXPECT_EQ(json.at("complete"), true);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "whole"));
}

TEST_F(ExportCommandTest, NamesTheDamagedByteAndSuggestsRecover) {
  std::string bytes = io::test::ReadAll(Original());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  const auto damaged = folder_.path() / "damaged.mcap";
  io::test::WriteAll(damaged, bytes);
  const CommandResult run = RunCommand(folder_.path(), {"export", damaged.string(), "--out", "tables"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find(damaged.string() + ": byte "), std::string::npos) << run.err;
  EXPECT_TRUE(run.err.find("chunk cannot be unpacked") != std::string::npos ||
              run.err.find("does not match its CRC") != std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("--recover"), std::string::npos) << run.err;

  const nlohmann::json json = Export({damaged.string(), "--recover"});
  ASSERT_EQ(json.at("recovery").at("damage").size(), 1u);
  EXPECT_GT(json.at("recovery").at("missing_ticks").get<int>(), 0);
  EXPECT_GT(json.at("ticks").get<std::size_t>() + json.at("recovery").at("missing_ticks").get<std::size_t>(),
            recording_->ticks.size() - 1);
}

TEST_F(ExportCommandTest, RefusesInvalidArguments) {
  io::test::WriteAll(folder_.path() / "file", "x");
  for (const auto& [arguments, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "recording is required"},
           {{"missing.mcap"}, "missing.mcap"},
           {{"file"}, "file: byte 0: not an MCAP file"},
           {{Original().string(), "--out", "file"}, "found a file, accepted a folder"},
           {{Original().string(), "--json", "no/where.json"}, "no folder no"},
           {{Original().string(), "--recovr"}, "did you mean --recover?"}}) {
    std::vector<std::string> all{"export"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult run = RunCommand(folder_.path(), all);
    EXPECT_EQ(run.exit_code, 2) << said;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("osteon export: "), std::string::npos) << run.err;
  }
  // the disk is full, so the JSON file cannot be written
  const CommandResult unwritable =
      RunCommand(folder_.path(), {"export", Original().string(), "--out", ".", "--json", "/dev/full"});
  EXPECT_EQ(unwritable.exit_code, 1) << unwritable.err;
  EXPECT_NE(unwritable.err.find("/dev/full: can't be written"), std::string::npos) << unwritable.err;
  EXPECT_NE(RunCommand(folder_.path(), {"export", "--help"}).out.find("Examples:"), std::string::npos);
}

}  // namespace
}  // namespace osteon::app
