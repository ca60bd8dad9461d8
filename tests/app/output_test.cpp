#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/app/command.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// A command's outputs must not damage each other: standard output, standard error, its files, and files of
// earlier runs.

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

// A short demo with the scene of a plate, which is packed and drawn in half the time of the demo's bone.
const std::vector<std::string> kDemo{"demo",   "--virtual-time", "--seconds", "0.3",
                                     "--cell", "thin_plate",     "--json",    "j.json"};

// The arguments of the short demo, followed by these.
std::vector<std::string> Demo(const std::vector<std::string>& more) {
  std::vector<std::string> words = kDemo;
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

int OpenForWriting(const char* path) { return open(path, O_WRONLY | O_CLOEXEC); }

// A soft limit on the size of files that this process and its children may write. It has the effect of a full
// disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(Output, ClosedDescriptorsLetNoPrintedTextIntoTheRecording) {
  const TemporaryFolder folder;
  Command demo(folder.path(), kDemo, {}, {.out = CommandStreams::kClosed, .err = CommandStreams::kClosed});
  EXPECT_EQ(demo.Wait().exit_code, 0);
  EXPECT_EQ(ReadJson(folder.path() / "j.json").at("ended"), "completed");
  const fs::path recording = folder.path() / "demo_out/recording.mcap";
  EXPECT_TRUE(ReadComplete(recording).complete);
  EXPECT_EQ(io::test::ReadAll(recording).find("Osteon demo:"), std::string::npos);
}

TEST(Output, AFullStdoutIsReportedAndLosesNoFile) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "skipped, no /dev/full";
  const TemporaryFolder folder;
  const int full = OpenForWriting("/dev/full");
  Command demo(folder.path(), kDemo, {}, {.out = full});
  const CommandResult run = demo.Wait();
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("osteon: stdout: what was printed can't be written: No space left on device"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(ReadJson(folder.path() / "j.json").at("ended"), "completed");
  Command help(folder.path(), {"--help"}, {}, {.out = full});
  EXPECT_EQ(help.Wait().exit_code, 1);
  Command silent(folder.path(), {"states", "--json", "s.json"}, {}, {.err = full});
  EXPECT_EQ(silent.Wait().exit_code, 0) << "nothing was to be said";
  close(full);
}

// The limit is below the size of the recording and above the size of the small files.
TEST(Output, ARecordingThatDoesNotFitLosesNeitherSummaryNorJson) {
  const TemporaryFolder folder;
  CommandResult run;
  {
    const FileSizeLimit limit(150'000);
    Command demo(folder.path(), kDemo);
    run = demo.Wait();
  }
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_NE(run.err.find("recording.mcap: cannot write the recording"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("not whole"), std::string::npos) << run.out;
  for (const char* name : {"j.json", "demo_out/summary.json"}) {
    const nlohmann::json summary = ReadJson(folder.path() / name);
    EXPECT_EQ(summary.at("ended"), "completed");
    EXPECT_GT(summary.at("peak_force_N").get<double>() + summary.at("peak_sensor_force_N").get<double>(),
              0.0);
    EXPECT_NE(summary.at("recording_error").get<std::string>().find("messages are lost"), std::string::npos);
  }
}

TEST(Output, AnEarlierDemoIsKeptBesideTheNextOne) {
  const TemporaryFolder folder;
  for (int run = 0; run < 2; ++run) ASSERT_EQ(RunCommand(folder.path(), kDemo).exit_code, 0);
  std::vector<fs::path> earlier;
  for (const auto& entry : fs::directory_iterator(folder.path() / "demo_out"))
    if (entry.is_directory()) earlier.push_back(entry.path());
  ASSERT_EQ(earlier.size(), 1u);
  for (const fs::path& place : {earlier[0], folder.path() / "demo_out"}) {
    EXPECT_TRUE(ReadComplete(place / "recording.mcap").complete);
    EXPECT_TRUE(fs::exists(place / "summary.json"));
    EXPECT_TRUE(fs::exists(place / "report.html"));
  }
  ASSERT_EQ(RunCommand(folder.path(), Demo({"--overwrite"})).exit_code, 0);
  EXPECT_TRUE(fs::exists(earlier[0] / "recording.mcap"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "demo_out"), {}),
            std::distance(fs::directory_iterator(earlier[0]), {}) + 1)
      << "no further folder";
}

TEST(Output, TwoDemosDoNotWriteIntoOneFolder) {
  const TemporaryFolder folder, second;
  Command first(folder.path(), {"demo", "--virtual-time", "--seconds", "600", "--cell", "thin_plate"});
  const fs::path recording = folder.path() / "demo_out/recording.mcap";
  std::error_code ignored;
  ASSERT_TRUE(first.WaitUntil([&] {
    return fs::exists(recording) && fs::file_size(recording, ignored) > 100'000;
  })) << first.Err();
  const CommandResult refused =
      RunCommand(second.path(), Demo({"--out", (folder.path() / "demo_out").string(), "--overwrite"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("found a folder that another osteon writes into"), std::string::npos)
      << refused.err;
  first.Send(SIGINT);
  EXPECT_EQ(first.Wait().exit_code, 130);
  EXPECT_TRUE(ReadComplete(recording).complete);
}

// A file name may contain any bytes, but osteon's output files are UTF-8. U+FFFD must replace the byte FC.
TEST(Output, ALatin1FileNameIsWrittenAsValidUtf8) {
  const TemporaryFolder folder;
  const std::string name =
      "h\xfc"
      "fte.obj";
  io::test::WriteAll(folder.path() / name, simulation::ObjText(simulation::MakeBox(
                                               Vector3::Constant(-0.004), Vector3::Constant(0.004))));
  const CommandResult demo = RunCommand(folder.path(), Demo({"--mesh", name, "--cup", "0,0,4,0,0,1,1.6"}));
  EXPECT_EQ(demo.exit_code, 0) << demo.err;
  EXPECT_EQ(ReadJson(folder.path() / "j.json").at("scene"),
            "h\xef\xbf\xbd"
            "fte");
  EXPECT_TRUE(ReadComplete(folder.path() / "demo_out/recording.mcap").complete);
  const CommandResult pack =
      RunCommand(folder.path(), {"pack", name, "-o", "p.osp", "--count", "500", "--point-spacing-mm", "2",
                                 "--report", "report", "--json", "p.json"});
  EXPECT_EQ(pack.exit_code, 0) << pack.err;
  EXPECT_TRUE(ReadJson(folder.path() / "p.json").is_object());
}

TEST(Output, InvalidOutputsAndPortsAreRefusedAtOnce) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](const std::vector<std::string>& words, const std::string& text,
                                  const std::vector<std::string>& environment = {}) {
    const CommandResult run = RunCommand(folder.path(), words, environment);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "");
  };
  expect_refused({"demo", "--json", "-"}, "osteon demo: --json: found -, accepted a file's name");
  expect_refused({"bench", "kinematics", "--json", "-"}, "osteon bench kinematics: --json: found -");
  for (const char* command : {"demo", "run", "cell"}) {
    std::vector<std::string> words{command};
    if (words[0] != "demo") words.emplace_back("demo");
    words.insert(words.end(), {"--port", "65534"});
    if (words[0] == "run") words.emplace_back("--simulated");
    expect_refused(words, "--port: found 65534, accepted 0 … 655");
  }
  expect_refused({"demo", "--virtual-time"}, "TMPDIR: found /nowhere, which is no folder",
                 {"TMPDIR=/nowhere"});
  EXPECT_EQ(RunCommand(folder.path(), {"--help"}, {"TMPDIR=/nowhere"}).exit_code, 0);

  io::test::WriteAll(folder.path() / "today.mcap", "evidence");
  expect_refused(
      {"run", "thin_plate", "--simulated", "--record", "today.mcap"},
      "--record today.mcap: found a recording, of an earlier run; accepted a name that is free, or "
      "--overwrite");
  EXPECT_EQ(io::test::ReadAll(folder.path() / "today.mcap"), "evidence");
  const std::string mcap = "\x89MCAP0\r\n and more", session = R"({"schema": "osteon.session/1"})";
  for (const auto& [name, content] :
       {std::pair("a.mcap", mcap), std::pair("a.stl", mcap),
        std::pair("kept", std::string("OSTCARVE and more")), std::pair("s", session),
        std::pair("p.yaml", std::string("scene: x")), std::pair("part", session)})
    io::test::WriteAll(folder.path() / name, content);
  std::filesystem::create_symlink("a.mcap", folder.path() / "link");
  expect_refused({"replay", "a.mcap", "--json", "a.mcap"},
                 "--json: found a.mcap, which recording names as well");
  expect_refused({"replay", "a.mcap", "--json", "./link"},
                 "--json: found ./link, which recording names as well");
  expect_refused({"export", "a.stl", "--surface", "a.stl"},
                 "--surface: found a.stl, which recording names as well");
  expect_refused({"export", "a.mcap", "--surface", "a.stl"}, "--surface: found a.stl, which is a recording");
  expect_refused({"doctor", "--json", "link"},
                 "--json: found link, which is a recording, accepted another file");
  expect_refused({"doctor", "--json", "kept"}, "--json: found kept, which is a carved state");
  expect_refused({"doctor", "--json", "s"}, "--json: found s, which is a session");
  expect_refused({"surgical-plan", "./p.yaml", "--json", "p.yaml"},
                 "--json: found p.yaml, which plan names as well");
  expect_refused({"demo", "--json", "new.mcap"},
                 "--json: found new.mcap, accepted a name that does not end with .mcap");
  expect_refused({"demo", "--json", ""}, "--json: found no name, accepted a file");
  expect_refused({"demo", "--out", ""}, "--out: found no name, accepted a folder");
  EXPECT_EQ(io::test::ReadAll(folder.path() / "a.mcap"), mcap);
  EXPECT_EQ(io::test::ReadAll(folder.path() / "p.yaml"), "scene: x");
  expect_refused({"run", "thin_plate", "--simulated", "--json", "nowhere/run.json"},
                 "--json nowhere/run.json: no folder");
}

}  // namespace
}  // namespace osteon::app
