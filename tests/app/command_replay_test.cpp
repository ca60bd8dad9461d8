#include <bit>
#include <csignal>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/app/recorded_run.h"

// Tests `osteon replay`, which runs the controller again on the inputs of a recording.

namespace osteon::app {
namespace {

class ReplayCommandTest : public RecordedRun {
 protected:
  /// Replays a recording. @returns the JSON of --json. Sets `code_` to the exit code and `out_` to the
  /// printed text.
  nlohmann::json Replay(const std::filesystem::path& recording, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"replay", recording.string(), "--json", "replay.json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult run = RunCommand(folder_.path(), arguments);
    code_ = run.exit_code;
    out_ = run.out;
    EXPECT_LE(code_, 1) << run.err;
    return code_ <= 1 ? ReadJson(folder_.path() / "replay.json") : nlohmann::json();
  }
  // The size of a file in bytes, 0 if it does not exist.
  static std::uintmax_t SizeOf(const std::filesystem::path& path) {
    std::error_code none;
    const std::uintmax_t size = std::filesystem::file_size(path, none);
    return none ? 0 : size;
  }
  // A tick in the second half of the run whose coupling force exceeds 1 N, so that all parts of the loop are
  // active.
  static std::size_t BusyTick() {
    for (std::size_t i = recording_->ticks.size() / 2; i < recording_->ticks.size(); ++i)
      if (Vector3(recording_->ticks[i].F_coupling_T_W.f).norm() > 1.0) return i;
    ADD_FAILURE() << "the run touches no bone";
    return 0;
  }
  int code_{-1};
  std::string out_;
};

TEST_F(ReplayCommandTest, ReplayIsIdenticalBitForBit) {
  ASSERT_GT(BusyTick(), 0u);
  const nlohmann::json json = Replay(Original());
  EXPECT_EQ(code_, 0);
  EXPECT_EQ(json.at("schema"), "osteon.replay/1");
  EXPECT_EQ(json.at("ticks"), recording_->ticks.size());
  EXPECT_EQ(json.at("identical"), true);
  EXPECT_TRUE(json.at("first_difference").is_null());
  EXPECT_EQ(json.at("not_run_ticks"), 0);
  EXPECT_EQ(json.at("recorded_build"), json.at("replayed_build"));
  EXPECT_NE(json.at("recorded_build").get<std::string>().find("commit "), std::string::npos);
  EXPECT_NE(out_.find("identical, bit for bit"), std::string::npos) << out_;
}

// The tests below change copies of the recording. Therefore an unchanged copy must replay identically.
TEST_F(ReplayCommandTest, ARewrittenRecordingReplaysIdentically) {
  Replay(Write(*recording_));
  EXPECT_EQ(code_, 0) << "else the tests below would show nothing";
}

TEST_F(ReplayCommandTest, DetectsOneChangedBitOfOneReading) {
  io::Recording changed = *recording_;
  const std::size_t at = BusyTick();
  double& force_N = changed.ticks[at].input.F_sensor_S.f.x;
  force_N = std::bit_cast<double>(std::bit_cast<std::uint64_t>(force_N) ^ 1u);
  const nlohmann::json json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_EQ(json.at("identical"), false);
  EXPECT_EQ(json.at("ticks"), recording_->ticks.size());
  const nlohmann::json& difference = json.at("first_difference");
  EXPECT_EQ(difference.at("tick"), changed.ticks[at].tick);
  // the last bit of a force was changed, so the results of the same tick differ, but only by rounding
  const double recorded = difference.at("recorded"), replayed = difference.at("replayed");
  EXPECT_NE(recorded, replayed);
  EXPECT_NEAR(recorded, replayed, 1e-9);
  EXPECT_NE(out_.find(difference.at("field").get<std::string>()), std::string::npos) << out_;
}

// Shifts all contacts of one model by 1 um. The first tick that used this model must differ.
TEST_F(ReplayCommandTest, DetectsAShiftedContact) {
  io::Recording changed = *recording_;
  const control::TickRecord& seen = changed.ticks[BusyTick()];
  bool found = false;
  for (simulation::FrameRecord& frame : changed.frames)
    if (frame.model.frame == seen.model_frame) {
      for (simulation::Contact& contact : frame.model.contacts) contact.p_W_m.z += 1e-6;
      found = true;
    }
  ASSERT_TRUE(found);
  const nlohmann::json json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_LE(json.at("first_difference").at("tick").get<std::uint64_t>(), seen.tick);
  EXPECT_GE(json.at("first_difference").at("tick").get<std::uint64_t>() + 5, seen.tick);
}

TEST_F(ReplayCommandTest, DetectsARemovedStopRequest) {
  io::Recording changed = *recording_;
  std::uint64_t first_stop = 0;
  for (control::TickRecord& tick : changed.ticks) {
    if (tick.input.stop && first_stop == 0) first_stop = tick.tick;
    tick.input.stop = false;
  }
  ASSERT_GT(first_stop, 0u);
  const nlohmann::json json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_EQ(json.at("first_difference").at("tick"), first_stop);
  EXPECT_EQ(json.at("first_difference").at("field"), "phase");
}

TEST_F(ReplayCommandTest, DetectsAChangedGain) {
  io::Recording changed = *recording_;
  for (io::ConfigFile& file : changed.session.config.files) {
    const std::size_t at = file.content.find("\nadmittance:\n");
    if (at == std::string::npos) continue;
    const std::size_t value = file.content.find("mass_kg: [", at) + 10;
    file.content.insert(value, "1");  // 3 kg become 13 kg
  }
  const nlohmann::json json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_GT(json.at("different_ticks").get<std::uint64_t>(), 1000u);
}

// The recording is of the cell molar, so a replay with the demo cell must differ.
TEST_F(ReplayCommandTest, ReplaysWithAGivenCellInsteadOfTheRecordedOne) {
  Replay(Original(), {"--cell", OSTEON_SOURCE_DIR "/config/cells/molar.yaml"});
  EXPECT_EQ(code_, 0);
  Replay(Original(), {"--cell", "molar"});
  EXPECT_EQ(code_, 0) << "by its name";
  Replay(Original(), {"--cell", OSTEON_SOURCE_DIR "/config/cells/demo.yaml"});
  EXPECT_EQ(code_, 1);
}

TEST_F(ReplayCommandTest, SaysWhyTicksWereNotReplayed) {
  const std::size_t at = BusyTick();
  io::Recording changed = *recording_;
  changed.ticks.erase(changed.ticks.begin() + static_cast<std::ptrdiff_t>(at));
  nlohmann::json json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_EQ(json.at("identical"), false);
  EXPECT_EQ(json.at("ticks"), at);
  EXPECT_EQ(json.at("not_run_ticks"), changed.ticks.size() - at);
  EXPECT_NE(json.at("not_run_reason").get<std::string>().find("ticks are missing"), std::string::npos);

  changed = *recording_;
  const std::uint64_t frame = changed.ticks[at].model_frame;
  std::erase_if(changed.frames, [&](const auto& each) { return each.model.frame == frame; });
  json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_NE(json.at("not_run_reason").get<std::string>().find("saw frame " + std::to_string(frame)),
            std::string::npos);

  changed = *recording_;
  for (control::TickRecord& tick : changed.ticks) tick.input = {};
  json = Replay(Write(changed));
  EXPECT_EQ(code_, 1);
  EXPECT_EQ(json.at("ticks"), 0);
  EXPECT_NE(json.at("not_run_reason").get<std::string>().find("not recorded yet"), std::string::npos);
}

// The recording contains its configuration files, so it can be replayed after their folder was deleted.
TEST_F(ReplayCommandTest, NeedsNothingButTheRecording) {
  const auto root = folder_.path() / "config";
  std::filesystem::copy(OSTEON_SOURCE_DIR "/config", root, std::filesystem::copy_options::recursive);
  // the cell names its robot by an absolute path, its tool is a mesh, and its scene has a density image
  std::string cell = io::test::ReadAll(root / "cells/demo.yaml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(cell.find(from), std::string::npos) << from;
    cell.replace(cell.find(from), from.size(), to);
  };
  replace("robot: lbr_iiwa_14_r820", "robot: " + (root / "robots/lbr_iiwa_14_r820.yaml").string());
  replace("scene: acetabulum", "scene: acetabulum_density");
  io::test::WriteAll(root / "cells/mine.yaml", cell);
  for (const std::string tool : {"reamer:54", "broach"}) {
    const CommandResult run =
        RunCommand(folder_.path(), {"--config-root", root.string(), "demo", "--virtual-time", "--seconds",
                                    "0.3", "--cell", "mine", "--tool", tool, "--out", tool});
    ASSERT_LE(run.exit_code, 1) << run.err;
  }
  std::filesystem::remove_all(root);
  for (const std::string tool : {"reamer:54", "broach"}) {
    const auto path = folder_.path() / tool / "recording.mcap";
    const nlohmann::json json = Replay(path);
    EXPECT_EQ(json.at("identical"), true) << tool << ": " << out_;
    EXPECT_GT(json.at("ticks").get<std::uint64_t>(), 200u);
    for (const io::ConfigFile& file : ReadComplete(path).session.config.files)
      EXPECT_EQ(file.name.find(".."), std::string::npos) << file.name;
  }
}

TEST_F(ReplayCommandTest, RefusesInvalidRecordedConfigurations) {
  for (const std::string name :
       {"../outside.yaml", "/outside.yaml", "cells/../../outside.yaml", "", "cells/"}) {
    io::Recording changed = *recording_;
    changed.session.config.files[0].name = name;
    const CommandResult run = RunCommand(folder_.path(), {"replay", Write(changed).string()});
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_NE(run.err.find("accepted a name below its folder"), std::string::npos) << run.err;
  }
  io::Recording changed = *recording_;
  changed.session.config.files.clear();
  const CommandResult run = RunCommand(folder_.path(), {"replay", Write(changed).string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("found no configuration files"), std::string::npos) << run.err;

  changed = *recording_;
  for (io::ConfigFile& file : changed.session.config.files)
    if (file.name == changed.session.config.cell_file) file.content += "more: 1\n";
  const CommandResult unknown = RunCommand(folder_.path(), {"replay", Write(changed).string()});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("the recorded configuration: cells/molar.yaml:"), std::string::npos)
      << unknown.err;
}

// The run has threads and sockets, and Ctrl-C stops it. On a busy machine it may end earlier with a fault;
// the recording must replay in this case as well.
TEST_F(ReplayCommandTest, ARunInWallTimeReplaysIdentically) {
  Command demo(folder_.path(), {"demo", "--seconds", "60", "--port", "0", "--out", "wall"});
  const auto path = folder_.path() / "wall/recording.mcap";
  static_cast<void>(demo.WaitUntil([&] { return SizeOf(path) > 1'000'000; }));
  demo.Send(SIGINT);
  const int exit_code = demo.Wait().exit_code;
  EXPECT_TRUE(exit_code == 130 || exit_code == 1) << exit_code << ": " << demo.Err();
  const nlohmann::json json = Replay(path);
  EXPECT_EQ(json.at("identical"), true) << out_;
  EXPECT_EQ(json.at("not_run_ticks"), 0) << out_;
  EXPECT_GT(json.at("ticks").get<std::uint64_t>(), 100u);
}

// The recording of a killed run can be replayed, both as it was left and after its repair.
TEST_F(ReplayCommandTest, AKilledRunReplaysIdenticallyUpToItsEnd) {
  Command demo(folder_.path(), {"demo", "--virtual-time", "--seconds", "3600", "--out", "killed"});
  const auto path = folder_.path() / "killed/recording.mcap";
  ASSERT_TRUE(demo.WaitUntil([&] { return SizeOf(path) > 1'000'000; })) << demo.Err();
  demo.Send(SIGKILL);
  EXPECT_EQ(demo.Wait().exit_code, 128 + SIGKILL);
  nlohmann::json json = Replay(path);
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_EQ(json.at("identical"), true) << out_;
  EXPECT_GT(json.at("ticks").get<std::uint64_t>(), 500u);
  const CommandResult run =
      RunCommand(folder_.path(), {"export", path.string(), "--recover", "--json", "e.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(ReadJson(folder_.path() / "e.json").at("recovered"), true);
  json = Replay(folder_.path() / "killed/recording_recovered.mcap");
  EXPECT_EQ(json.at("complete"), true);
  EXPECT_EQ(json.at("identical"), true) << out_;
}

TEST_F(ReplayCommandTest, RefusesInvalidArguments) {
  io::test::WriteAll(folder_.path() / "file", "x");
  for (const auto& [arguments, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "recording is required"},
           {{"missing.mcap"}, "missing.mcap"},
           {{"file"}, "file: byte 0: not an MCAP file"},
           {{Original().string(), "--jsn", "x"}, "did you mean --json?"}}) {
    std::vector<std::string> all{"replay"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult run = RunCommand(folder_.path(), all);
    EXPECT_EQ(run.exit_code, 2) << said;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("osteon replay: "), std::string::npos) << run.err;
  }
  EXPECT_NE(RunCommand(folder_.path(), {"replay", "--help"}).out.find("Examples:"), std::string::npos);
}

}  // namespace
}  // namespace osteon::app
