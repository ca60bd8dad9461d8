#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/recording/recording_reader.h"
#include "tests/app/command.h"
#include "tests/app/first_port.h"
#include "tests/app/machine_lateness.h"
#include "tests/app/patient_cell.h"

// A terminal is closed, or the reader of an output ends, while the tool is in bone. The run must end in
// order, complete its recording and write its figures, and its exit code must show the cause. The same holds
// for the guard.
//
// To repeat each test twenty times:
//     osteon_test_app_wall --gtest_filter='*HangUp*' --gtest_repeat=20

namespace osteon::app {
namespace {

// A pipe whose reading end can be closed.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) std::abort();
  }
  ~Pipe() {
    CloseReader();
    CloseWriter();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int writer() const { return ends_[1]; }
  void CloseReader() { Close(ends_[0]); }
  void CloseWriter() { Close(ends_[1]); }

 private:
  static void Close(int& end) {
    if (end >= 0) close(end);
    end = -1;
  }
  std::array<int, 2> ends_{-1, -1};
};

// Whether the tool is in bone, according to the newest frame in the recording.
bool InContact(const std::filesystem::path& recording) {
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return false;
  bool contact = false;
  for (;;) {
    const auto topic = stream->Next();
    if (!topic || *topic == io::RecordedTopic::kOther) return contact;
    if (*topic == io::RecordedTopic::kFrame) contact = Vector3(stream->frame.model.F_T_W.f).norm() > 1.0;
  }
}

// The event that makes the observed process end.
enum class End { kHangUp, kTwoHangUps, kStdoutClosed, kStderrClosed };

// Streams of the process: the output that the event will close is the pipe, the other outputs are files.
CommandStreams StreamsOf(End end, const Pipe& pipe) {
  if (end == End::kStdoutClosed) return {.out = pipe.writer()};
  if (end == End::kStderrClosed) return {.err = pipe.writer()};
  return {};
}

// Sends one or two SIGHUP to the process, or closes the reader of its output.
void CauseEnd(End end, Command& process, Pipe& pipe) {
  if (end == End::kStdoutClosed || end == End::kStderrClosed) return pipe.CloseReader();
  process.Send(SIGHUP);
  if (end == End::kHangUp) return;
  usleep(600'000);
  process.Send(SIGHUP);
}

// Runs that are ended by an event while the tool is in bone.
class HangUp : public testing::Test {
 protected:
  // Causes the event while the tool is in bone. Checks the run's exit code, the name of the cause in the
  // summary, and the recording.
  static void RunEnds(Attempt& attempt, End end, int exit_code, const char* name) {
    const TemporaryFolder folder;
    Pipe pipe;
    const WakeupWatch watch;
    Command run(folder.path(),
                {"run", PatientCell(folder.path(), "thin_plate"), "--simulated", "--port", "0", "--record",
                 "r.mcap", "--json", "run.json"},
                {}, StreamsOf(end, pipe));
    const bool contact = run.WaitUntil([&] { return InContact(folder.path() / "r.mcap"); });
    if (contact) CauseEnd(end, run, pipe);
    const CommandResult result = run.Wait();
    if (result.exit_code == 1) return attempt.ExpectLate(result, ReadJson(folder.path() / "run.json"), watch);
    EXPECT_TRUE(contact) << result.err;
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    const nlohmann::json summary = ReadJson(folder.path() / "run.json");
    EXPECT_EQ(summary.value("ended", ""), "interrupted");
    EXPECT_EQ(summary.value("ended_by", ""), name);
    EXPECT_TRUE(summary.value("faults", nlohmann::json::array({"none written"})).empty()) << summary.dump(2);
    const CommandResult exported =
        RunCommand(folder.path(), {"export", "r.mcap", "--out", "tables", "--json", "export.json"});
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_TRUE(ReadJson(folder.path() / "export.json").value("complete", false));
    const io::Recording recording = ReadComplete(folder.path() / "r.mcap");
    EXPECT_EQ(recording.ticks.back().phase, control::Phase::kStopped);
  }

  void ExpectRunEnds(End end, int exit_code, const char* name) {
    RepeatWhileLate([&](Attempt& attempt) { RunEnds(attempt, end, exit_code, name); });
  }
};

// A signal's exit code is 128 plus the number of the signal.
TEST_F(HangUp, AClosedTerminalEndsARunInOrder) { ExpectRunEnds(End::kHangUp, 129, "SIGHUP"); }

// Shell, operating system and service manager may each send a SIGHUP.
TEST_F(HangUp, ASecondSighupDoesNotEndTheProcessBeforeTheArmRests) {
  ExpectRunEnds(End::kTwoHangUps, 129, "SIGHUP");
}

TEST_F(HangUp, AClosedReaderOfStdoutEndsARunInOrder) { ExpectRunEnds(End::kStdoutClosed, 141, "SIGPIPE"); }

TEST_F(HangUp, AClosedReaderOfStderrEndsARunInOrder) { ExpectRunEnds(End::kStderrClosed, 141, "SIGPIPE"); }

// The pipe is full and its reader stays open without reading, as after Ctrl-S on a terminal.
TEST_F(HangUp, AReaderThatDoesNotReadDoesNotDelayCtrlC) {
  Pipe pipe;
  fcntl(pipe.writer(), F_SETPIPE_SZ, 4096);
  const std::string full(1 << 20, '.');
  const int flags = fcntl(pipe.writer(), F_GETFL);
  fcntl(pipe.writer(), F_SETFL, flags | O_NONBLOCK);
  while (write(pipe.writer(), full.data(), 4096) > 0 || write(pipe.writer(), full.data(), 1) > 0) {
  }
  fcntl(pipe.writer(), F_SETFL, flags);
  const TemporaryFolder folder;
  Command run(folder.path(),
              {"run", PatientCell(folder.path(), "thin_plate"), "--simulated", "--port", "0", "--record",
               "r.mcap", "--json", "run.json"},
              {}, {.err = pipe.writer()});
  ASSERT_TRUE(run.WaitUntil([&] { return InContact(folder.path() / "r.mcap"); }));
  run.Send(SIGINT);
  EXPECT_TRUE(run.WaitUntil([&] { return std::filesystem::exists(folder.path() / "run.json"); }))
      << "the end waited for the reader";
  pipe.CloseReader();
  run.Wait();
  EXPECT_TRUE(ReadComplete(folder.path() / "r.mcap").complete);
}

// Runs `osteon cell`, `guard` and `run` as three processes. The events end the guard.
class GuardHangUp : public HangUp {
 protected:
  void SetUp() override {
    file_ = PatientCell(folder_.path(), "thin_plate",
                        {{"plc.guard", "true"}, {"guard", "{port: 30209, silence_ms: 500}"}});
  }

  // Causes the event at the guard while the tool is in bone. The PLC must withdraw its permission first, so
  // that the controller stops the arm while the guard still relays.
  void GuardEnds(Attempt& attempt, End end, int exit_code) {
    Pipe pipe;
    const TemporaryFolder cell_folder, guard_folder, run_folder;
    const WakeupWatch watch;
    const std::string port = FirstPort();
    Command cell(cell_folder.path(), {"cell", file_, "--port", port, "--json", "cell.json"});
    EXPECT_TRUE(cell.WaitUntil([&] { return cell.Out().find("Ctrl-C ends it") != std::string::npos; }))
        << cell.Err();
    Command guard(guard_folder.path(), {"guard", file_, "--port", port, "--json", "guard.json"}, {},
                  StreamsOf(end, pipe));
    Command run(run_folder.path(),
                {"run", file_, "--port", port, "--record", "r.mcap", "--json", "run.json"});
    const bool contact = run.WaitUntil([&] { return InContact(run_folder.path() / "r.mcap"); });
    if (contact) CauseEnd(end, guard, pipe);
    const CommandResult result = run.Wait();
    if (!contact) guard.Send(SIGTERM);
    const CommandResult guarded = guard.Wait();
    cell.Send(SIGTERM);
    EXPECT_EQ(cell.Wait().exit_code, 0);
    const nlohmann::json summary = ReadJson(run_folder.path() / "run.json");
    const nlohmann::json report = ReadJson(guard_folder.path() / "guard.json");
    const nlohmann::json faults = summary.value("faults", nlohmann::json::array());
    if (!contact || report.value("latched", true) || faults.empty() ||
        faults.front() != "motion not permitted") {
      return attempt.ExpectLate(
          result, summary, watch,
          fmt::format("{}\nthe guard ended with {}: {}", report.dump(2), guarded.exit_code, guarded.err));
    }
    EXPECT_EQ(guarded.exit_code, exit_code) << guarded.err;
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_EQ(ReadComplete(run_folder.path() / "r.mcap").ticks.back().phase, control::Phase::kStopped);
  }

  void ExpectGuardEnds(End end, int exit_code) {
    RepeatWhileLate([&](Attempt& attempt) { GuardEnds(attempt, end, exit_code); });
  }

  const TemporaryFolder folder_;
  std::string file_;
};

TEST_F(GuardHangUp, AClosedTerminalStopsTheArmBeforeTheGuardEnds) { ExpectGuardEnds(End::kHangUp, 129); }

TEST_F(GuardHangUp, AClosedReaderStopsTheArmBeforeTheGuardEnds) { ExpectGuardEnds(End::kStdoutClosed, 141); }

}  // namespace
}  // namespace osteon::app
