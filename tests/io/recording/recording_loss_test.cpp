#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "io/recording/recording_reader.h"
#include "io/recording/recovery.h"
#include "tests/io/recording/recording_samples.h"
#include "tests/io/temporary_folder.h"

// Losses of a recording if its process is killed, if the disk is full, and if its file is removed.

namespace osteon::io {
namespace {

using test::SomeFrame;
using test::SomeSession;
using test::SomeTick;
using test::TemporaryFolder;

constexpr unsigned kSeed = 20261122;

// The child's progress, in memory that outlives it.
struct Shared {
  std::atomic<std::uint64_t> pushed{0};  // number of ticks
  std::atomic<rt::Nanoseconds> last_stamp{0};
};

// A child process that runs `work`; it is killed at the latest when the object ends.
class Child {
 public:
  Child(Shared& shared, const std::function<void(Shared&)>& work) : pid_(fork()) {
    if (pid_ != 0) return;
    work(shared);
    _exit(0);
  }
  ~Child() { Kill(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  void Kill() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, &status_, 0);
    pid_ = -1;
  }
  /// Waits, and returns its exit code.
  int Wait() {
    waitpid(pid_, &status_, 0);
    pid_ = -1;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
  }

 private:
  pid_t pid_;
  int status_{0};
};

class RecordingLoss : public testing::Test {
 protected:
  RecordingLoss() {
    void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no shared memory");
    shared_ = new (memory) Shared;
  }
  ~RecordingLoss() override { munmap(shared_, sizeof(Shared)); }

  TemporaryFolder folder_;
  std::filesystem::path path_{folder_.path() / "live.mcap"};
  Shared* shared_;
};

// Records ticks at 1 kHz and a frame beside every second one, until the process is ended.
void RecordForEver(const std::filesystem::path& path, Shared& shared) {
  auto recorder = Recorder::Open({.path = path}, SomeSession());
  if (!recorder) _exit(3);
  rt::Nanoseconds next = rt::MonotonicNow();
  for (std::uint64_t i = 0;; ++i) {
    rt::SleepUntil(next += rt::kMillisecond);
    control::TickRecord tick = SomeTick(i);
    tick.stamp = rt::MonotonicNow();
    if (!(*recorder)->Push(tick)) _exit(4);
    if (i % 2 == 0) {
      simulation::FrameRecord frame = SomeFrame(i);
      frame.stamp = tick.stamp;
      (*recorder)->PushFrame(frame);
    }
    shared.last_stamp.store(tick.stamp);
    shared.pushed.store(i + 1);
  }
}

TEST_F(RecordingLoss, AKilledProcessLosesAtMostOneSecond) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (int kill_at = 0; kill_at < 6; ++kill_at) {
    std::filesystem::remove(path_);
    new (shared_) Shared;
    const std::uint64_t ticks = 100 + random() % 1200;
    Child child(*shared_, [&](Shared& shared) { RecordForEver(path_, shared); });
    while (shared_->pushed.load() < ticks)
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 700));
    child.Kill();
    const std::uint64_t pushed = shared_->pushed.load();
    const rt::Nanoseconds last = shared_->last_stamp.load();

    const auto torn = ReadRecording(path_);
    ASSERT_TRUE(torn) << torn.error();
    EXPECT_FALSE(torn->complete);
    EXPECT_EQ(torn->session.tool, "reamer_50");
    const rt::Nanoseconds kept = torn->ticks.empty()
                                     ? last - static_cast<rt::Nanoseconds>(pushed) * rt::kMillisecond
                                     : torn->ticks.back().stamp;
    EXPECT_LE(rt::ToSeconds(last - kept), 1.0) << "killed after tick " << pushed;
    for (std::uint64_t i = 0; i < torn->ticks.size(); ++i) ASSERT_EQ(torn->ticks[i].tick, i);

    // recover it
    const auto whole_path = folder_.path() / "whole.mcap";
    const auto recovery = RecoverRecording(path_, whole_path);
    ASSERT_TRUE(recovery) << recovery.error();
    EXPECT_FALSE(recovery->was_whole);
    EXPECT_EQ(recovery->ticks, torn->ticks.size());
    EXPECT_EQ(recovery->missing_ticks, 0u);
    const auto whole = ReadRecording(whole_path);
    ASSERT_TRUE(whole) << whole.error();
    EXPECT_TRUE(whole->complete);
    EXPECT_EQ(whole->ticks.size(), torn->ticks.size());
    EXPECT_EQ(whole->frames.size(), torn->frames.size());
    RecordProperty("lost_ms_" + std::to_string(kill_at), static_cast<int>((last - kept) / rt::kMillisecond));
  }
}

// Only three ticks are pushed. The writer's thread must write them to the file without a further push.
TEST_F(RecordingLoss, TicksBeforeASilenceReachTheFile) {
  Child child(*shared_, [&](Shared& shared) {
    auto recorder = Recorder::Open({.path = path_}, SomeSession());
    for (std::uint64_t i = 1; i <= 3; ++i) (*recorder)->Push(SomeTick(i));
    shared.pushed.store(3);
    for (;;) pause();
  });
  std::size_t found = 0;
  // waits 30 s at most; the ticks usually appear within 0.25 s
  for (int look = 0; look < 3000 && found < 3; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (const auto recording = ReadRecording(path_)) found = recording->ticks.size();
  }
  EXPECT_EQ(found, 3u);
}

// A limit on the file's size takes the place of a full disk: the system refuses to write in the same way.
// Push() must still accept each tick.
TEST_F(RecordingLoss, AFullDiskIsReportedAndDoesNotDisturbTheTick) {
  constexpr std::uint64_t kTicks = 1000;
  Child child(*shared_, [&](Shared& shared) {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{.rlim_cur = 200'000, .rlim_max = 200'000};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(3);
    auto recorder =
        Recorder::Open({.path = path_, .tick_capacity = 64, .writer_thread = false}, SomeSession());
    if (!recorder) _exit(4);
    for (std::uint64_t i = 0; i < kTicks; ++i) {
      if (!(*recorder)->Push(SomeTick(i))) _exit(5);  // the full disk never blocks the ring
      (*recorder)->Drain();
      shared.pushed.store(i + 1);
    }
    if ((*recorder)->error().find("live.mcap: cannot write the recording: File too large") ==
        std::string::npos)
      _exit(6);
    const RecordingCounts counts = (*recorder)->counts();
    if (counts.ticks != kTicks || counts.dropped_ticks != 0 || counts.unwritten == 0) _exit(7);
    const auto closed = (*recorder)->Close();
    if (closed || closed.error().find(std::to_string((*recorder)->counts().unwritten) +
                                      " of 1001 messages are lost") == std::string::npos)
      _exit(8);
  });
  EXPECT_EQ(child.Wait(), 0);
  EXPECT_EQ(shared_->pushed.load(), kTicks);

  const auto recovery = RecoverRecording(path_, folder_.path() / "whole.mcap");
  ASSERT_TRUE(recovery) << recovery.error();
  EXPECT_GT(recovery->ticks, 50u);
  EXPECT_LT(recovery->ticks, kTicks);
  EXPECT_TRUE(ReadRecording(folder_.path() / "whole.mcap")->complete);
}

TEST_F(RecordingLoss, AFileThatWasRemovedIsReported) {
  for (const bool replaced : {false, true}) {
    auto recorder = Recorder::Open({.path = path_, .writer_thread = false}, SomeSession());
    ASSERT_TRUE(recorder) << recorder.error();
    (*recorder)->Push(SomeTick(1));
    std::filesystem::remove(path_);
    if (replaced) test::WriteAll(path_, "another");
    EXPECT_TRUE((*recorder)->Push(SomeTick(2)));
    const auto closed = (*recorder)->Close();
    ASSERT_FALSE(closed);
    EXPECT_EQ(closed.error(),
              path_.string() + ": the recording was removed or replaced while it was written");
  }
}

TEST_F(RecordingLoss, AFileThatWasRemovedIsReportedWhileItIsRecorded) {
  auto recorder = Recorder::Open({.path = path_}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  std::filesystem::remove(path_);
  std::string error;
  for (int look = 0; look < 3000 && error.empty(); ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    error = (*recorder)->error();
  }
  EXPECT_NE(error.find("removed or replaced"), std::string::npos) << error;
}

// A chunk spans at most a quarter of a second of log time, so with a tick every 100 ms the file lacks at most
// the last three ticks.
TEST_F(RecordingLoss, SlowMessagesReachTheFileWithoutAFullChunk) {
  auto recorder = Recorder::Open({.path = path_, .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 1; i <= 20; ++i) {
    (*recorder)->Push(SomeTick(100 * i));  // every 100 ms
    (*recorder)->Drain();
    const auto found = ReadRecording(path_);
    ASSERT_TRUE(found) << found.error();
    EXPECT_LE(i - found->ticks.size(), 3u) << "tick " << i;
  }
}

}  // namespace
}  // namespace osteon::io
