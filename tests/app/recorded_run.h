#pragma once

#include <filesystem>

#include <gtest/gtest.h>

#include "io/recording/recorder.h"
#include "tests/app/command.h"

namespace osteon::app {

/// One run in virtual time that cuts bone for a while, made once per test suite, with helpers for its
/// recording.
class RecordedRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_of_run_ = new TemporaryFolder;
    const CommandResult run =
        RunCommand(folder_of_run_->path(), {"demo", "--virtual-time", "--seconds", "4", "--cell", "molar"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    recording_ = new io::Recording(ReadComplete(Original()));
  }
  static void TearDownTestSuite() {
    delete recording_;
    delete folder_of_run_;
  }
  static std::filesystem::path Original() { return folder_of_run_->path() / "demo_out/recording.mcap"; }

  /// Writes a changed recording into this test's folder.
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
  static inline TemporaryFolder* folder_of_run_{nullptr};
  static inline io::Recording* recording_{nullptr};
};

}  // namespace osteon::app
