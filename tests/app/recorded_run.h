#pragma once

#include <filesystem>
#include <system_error>

#include <gtest/gtest.h>

#include "io/recording/recorder.h"
#include "tests/app/command.h"

namespace osteon::app {

/// A run in virtual time that cuts bone, and helpers for its recording. Under ctest the test
/// app_recording.TheRun.IsMade makes the run once for all suites. A suite makes its own run if none exists or
/// if the build is newer.
class RecordedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    namespace fs = std::filesystem;
    original_ = new fs::path(fs::path(OSTEON_RECORDED_RUN) / "recording.mcap");
    std::error_code error;
    if (!fs::exists(*original_) ||
        fs::last_write_time(*original_, error) < fs::last_write_time(OSTEON_BINARY, error)) {
      own_folder_ = new TemporaryFolder;
      const CommandResult run =
          RunCommand(own_folder_->path(), {"demo", "--virtual-time", "--seconds", "4", "--cell", "molar"});
      ASSERT_EQ(run.exit_code, 0) << run.err;
      *original_ = own_folder_->path() / "demo_out/recording.mcap";
    }
    recording_ = new io::Recording(ReadComplete(*original_));
  }
  static void TearDownTestSuite() {
    delete recording_;
    delete original_;
    delete own_folder_;
  }
  static std::filesystem::path Original() { return *original_; }

  /// Writes a changed recording into this test's folder. @returns its path.
  std::filesystem::path Write(const io::Recording& changed) {
    const auto path = folder_.path() / "changed.mcap";
    auto recorder = io::Recorder::Open({.path = path, .writer_thread = false}, changed.session);
    EXPECT_TRUE(recorder) << recorder.error();
    const std::size_t frames_a_tick =
        1 + changed.frames.size() / std::max<std::size_t>(1, changed.ticks.size());
    std::size_t frame = 0;
    for (const control::TickRecord& tick : changed.ticks) {
      for (std::size_t i = 0; i < frames_a_tick && frame < changed.frames.size(); ++i)
        (*recorder)->PushFrame(changed.frames[frame++]);
      (*recorder)->Push(tick);
      (*recorder)->Drain();
    }
    for (const io::RecordedEvent& event : changed.events) (*recorder)->PushEvent(event.stamp, event.text);
    EXPECT_TRUE((*recorder)->Close());
    return path;
  }

  TemporaryFolder folder_;
  static inline TemporaryFolder* own_folder_{nullptr};
  static inline std::filesystem::path* original_{nullptr};
  static inline io::Recording* recording_{nullptr};
};

}  // namespace osteon::app
