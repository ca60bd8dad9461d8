// A session that is killed (SIGKILL) before any of its file operations leaves a folder that resumes at its
// last pass. A child process ends a pass, undoes it, saves the cup's pose and ends the session. The first
// child is killed before its first file operation, the next child before its second, and so on.

#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <new>
#include <optional>
#include <string>

#include "session/run/frame_runner.h"
#include "simulation/files/carved_file.h"
#include "tests/session/procedure/procedure_rig.h"

namespace osteon::session {
namespace {

namespace fs = std::filesystem;

constexpr rt::Nanoseconds kFrame = 2 * rt::kMillisecond;
constexpr double kSpindle_rad_per_s = 26.0;
constexpr double kClear_m = 0.010;  // height of the head's centre over the bone's origin, clear of bone

/// Runs the simulation's frames of a session without a servo loop: the tool moves along the bone's axis.
class FrameBench {
 public:
  explicit FrameBench(Rig& rig)
      : rig_(rig),
        depth_(rig.setup->bone, rig.tool_table[0].tool),
        watch_(rig.setup->solid.get(), rig.setup->bone, rig.tool_table[0].tool,
               rig.setup->config.scene.events),
        runner_(*rig.engine, depth_, watch_, rig.setup->X_WG) {
    runner_.SetObserver(rig.session.get());
  }

  /// Moves the head's centre to a height over the bone's origin, in so many frames.
  void MoveTo(double height_m, int frames) {
    const double from_m = height_m_;
    for (int i = 1; i <= frames; ++i) {
      height_m_ = from_m + (height_m - from_m) * i / frames;
      Frame(false);
    }
  }
  /// Runs one frame at the present height.
  void Frame(bool paused) {
    Pose X_GT = Pose::Identity();
    X_GT.linear() = Eigen::AngleAxisd(3.141592653589793, Vector3::UnitX()).toRotationMatrix();
    X_GT.translation() = Vector3(0.0, 0.0, height_m_ - 0.5 * rig_.tool_table[0].diameter_m);
    (void)runner_.Run({.X_WT = rig_.setup->X_WG * X_GT,
                       .spindle_rad_per_s = paused ? 0.0 : kSpindle_rad_per_s,
                       .stamp = stamp_ += kFrame,
                       .tool_index = 0,
                       .paused = paused});
  }
  /// Reams to a height and retracts. The pass stays open: its last frames, which would end it, are missing.
  void Ream(double height_m) {
    MoveTo(kClear_m, 20);
    MoveTo(height_m, 250);
    MoveTo(kClear_m, 50);
    MoveTo(kClear_m, 180);
  }

 private:
  Rig& rig_;
  simulation::ApexDepth depth_;
  simulation::SceneWatch watch_;
  FrameRunner runner_;
  double height_m_{0.030};
  rt::Nanoseconds stamp_{0};
};

/// The steps that the child's session has confirmed, in memory that outlives the child.
struct Progress {
  std::atomic<int> passes{0};
  std::atomic<bool> undone{false}, cup{false}, ended{false};
};

// The child's work: ends the open second pass, undoes it, saves the cup's pose and ends the session.
void EndSession(Rig& rig, FrameBench& bench, Progress& progress) {
  bench.MoveTo(kClear_m, 150);
  progress.passes.store(static_cast<int>(rig.session->File().passes.size()));
  const auto ask = [&](SessionRequest::Kind kind, std::atomic<bool>& done) {
    (void)rig.session->Post({.kind = kind},
                            [&done](const SessionAnswer& answer) { done.store(answer.done); });
    bench.Frame(true);
  };
  ask(SessionRequest::Kind::kUndo, progress.undone);
  ask(SessionRequest::Kind::kCup, progress.cup);
  progress.ended.store(rig.session->End(*rig.engine).empty());
}

// Whether a system call opens, writes, closes, renames, truncates or removes a file.
bool IsFileOperation(std::uint64_t number) {
  constexpr std::array kOperations{SYS_openat,   SYS_write,    SYS_fsync,    SYS_close, SYS_renameat2,
#ifdef SYS_rename
                                   SYS_rename,   SYS_unlink,   SYS_open,
#endif
                                   SYS_renameat, SYS_unlinkat, SYS_ftruncate};
  return std::ranges::find(kOperations, static_cast<long>(number)) != kOperations.end();
}

enum class ChildEnd { kKilled, kDone, kFailed };

// Runs `work` in a child process and kills the child before its file operation number `operation`, from 1.
// @returns kDone if the child ended before it came to that operation
template <class Work>
ChildEnd KilledBefore(int operation, const Work& work) {
  const pid_t child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(2);
    (void)raise(SIGSTOP);
    work();
    _exit(0);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return ChildEnd::kFailed;
  (void)ptrace(PTRACE_SETOPTIONS, child, nullptr,
               static_cast<long>(PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL));
  for (int seen = 0; ptrace(PTRACE_SYSCALL, child, nullptr, nullptr) == 0;) {
    if (waitpid(child, &status, 0) != child) return ChildEnd::kFailed;
    if (!WIFSTOPPED(status))
      return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? ChildEnd::kDone : ChildEnd::kFailed;
    __ptrace_syscall_info info{};
    if (ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info) <= 0) continue;
    if (info.op != PTRACE_SYSCALL_INFO_ENTRY || !IsFileOperation(info.entry.nr)) continue;
    if (++seen < operation) continue;
    (void)kill(child, SIGKILL);
    (void)waitpid(child, &status, 0);
    return ChildEnd::kKilled;
  }
  return ChildEnd::kFailed;
}

// Whether this machine permits a process to trace its child.
bool MayTrace() {
  return KilledBefore(1, [] {}) == ChildEnd::kDone;
}

class KilledSession : public testing::Test {
 protected:
  KilledSession()
      : rig_("killed_anywhere", {.scripted = false}),
        uncut_(rig_.engine->Snapshot()),
        spare_(std::move(*MakeEngine(*rig_.setup, {}))),
        progress_(new (mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
                            0)) Progress) {}
  ~KilledSession() override { (void)munmap(progress_, sizeof(Progress)); }

  // Expects that the killed session's folder has all steps that were confirmed, and resumes at its last pass.
  void ExpectResumes() {
    const auto killed = ReadSession(rig_.folder);
    ASSERT_TRUE(killed) << killed.error();
    ASSERT_GE(static_cast<int>(killed->passes.size()), std::max(1, progress_->passes.load()));
    if (progress_->undone) {
      EXPECT_TRUE(killed->passes.back().undone);
    }
    if (progress_->cup) {
      EXPECT_TRUE(killed->cup_X_GT.has_value());
    }
    if (progress_->ended) {
      EXPECT_TRUE(killed->ended);
    }
    for (const SessionPass& pass : killed->passes) {
      const auto state = simulation::ReadCarvedState(rig_.folder / pass.state, rig_.setup->bone);
      ASSERT_TRUE(state) << state.error().Text();
      EXPECT_EQ(HashText(*state), pass.state_hash) << pass.state;
    }
    spare_->Restore(uncut_);
    rig_.recording = "run_2.mcap";
    const auto again = rig_.MakeSession(*killed);
    const auto begun = again->Begin(*spare_);
    ASSERT_TRUE(begun) << begun.error();
    const auto last = std::ranges::find(killed->passes, killed->LastState(), &SessionPass::state);
    ASSERT_NE(last, killed->passes.end());
    EXPECT_EQ(HashText(spare_->Snapshot()), last->state_hash);
  }

  Rig rig_;
  simulation::CarvedState uncut_;
  std::unique_ptr<simulation::CuttingEngine> spare_;
  Progress* progress_;
};

TEST_F(KilledSession, ResumesAtItsLastPassAfterAKillBeforeAnyFileOperation) {
  if (!MayTrace()) GTEST_SKIP() << "this machine does not let a process trace its child";
  const auto begun = rig_.session->Begin(*rig_.engine);
  ASSERT_TRUE(begun) << begun.error();
  FrameBench bench(rig_);
  bench.Ream(-0.002);
  bench.MoveTo(kClear_m, 100);
  ASSERT_EQ(rig_.session->File().passes.size(), 1u);
  bench.Ream(-0.004);
  ASSERT_EQ(rig_.session->File().passes.size(), 1u) << "the second pass ends in the child";
  const fs::path folder = rig_.folder, kept = TemporaryPath("killed_anywhere_before");
  fs::copy(folder, kept, fs::copy_options::recursive);

  int operation = 1;
  for (ChildEnd end = ChildEnd::kKilled; end == ChildEnd::kKilled; ++operation) {
    SCOPED_TRACE("killed before file operation " + std::to_string(operation));
    fs::remove_all(folder);
    fs::copy(kept, folder, fs::copy_options::recursive);
    progress_ = new (progress_) Progress;
    end = KilledBefore(operation, [&] { EndSession(rig_, bench, *progress_); });
    ASSERT_NE(end, ChildEnd::kFailed);
    ASSERT_NO_FATAL_FAILURE(ExpectResumes());
    if (end == ChildEnd::kDone) {
      EXPECT_TRUE(progress_->ended && progress_->undone && progress_->cup);
      EXPECT_EQ(progress_->passes, 2);
    }
  }
  EXPECT_GT(operation, 20) << "a state and four times session.json: create, write, flush, close, rename";
}

}  // namespace
}  // namespace osteon::session
