#include "session/summary/run_files.h"

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.h"

namespace osteon::session {
namespace {

using io::test::ReadAll, io::test::WriteAll, io::test::TemporaryFolder;
namespace fs = std::filesystem;

const auto kTime = std::chrono::system_clock::from_time_t(1795599000);  // 2026-11-25 09:30 UTC

TEST(RunFiles, ADatedNameHasDateAndTimeAndIsUnused) {
  const TemporaryFolder folder;
  const std::string stem = "run_" + DateAndTime(kTime);
  EXPECT_EQ(stem.size(), std::string("run_2026-11-26_09-30-00").size());
  EXPECT_TRUE(stem.starts_with("run_2026-11-2")) << stem;
  EXPECT_EQ(DatedRecording(folder.path(), kTime), folder.path() / (stem + ".mcap"));
  WriteAll(folder.path() / (stem + ".mcap"), "");
  EXPECT_EQ(DatedRecording(folder.path(), kTime), folder.path() / (stem + "_2.mcap"));
  WriteAll(folder.path() / (stem + "_2_stop_1.html"), "a page is evidence, too");
  EXPECT_EQ(DatedRecording(folder.path(), kTime), folder.path() / (stem + "_3.mcap"));
}

TEST(RunFiles, ANameWithFilesOfAnEarlierRunIsRefused) {
  const TemporaryFolder folder;
  const fs::path recording = folder.path() / "today.mcap";
  EXPECT_EQ(ValidateRecordingName(recording), "");
  WriteAll(folder.path() / "today_stop_2.html", "");
  EXPECT_EQ(ValidateRecordingName(recording), "") << "no run leaves a second page without a first";
  WriteAll(folder.path() / "today_stop_1_ticks.csv", "");
  EXPECT_EQ(FilesOfRun(recording).size(), 2u);
  EXPECT_EQ(ValidateRecordingName(recording),
            "--record " + recording.string() +
                ": found today_stop_1_ticks.csv, of an earlier run; accepted a name that "
                "is free, or --overwrite");
  WriteAll(recording, "");
  EXPECT_NE(ValidateRecordingName(recording).find("found a recording, of an earlier run"), std::string::npos);
  EXPECT_EQ(RemoveFiles(FilesOfRun(recording)), "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
  EXPECT_EQ(ValidateRecordingName("/dev/null"), "") << "a device keeps nothing";
}

TEST(RunFiles, AnEarlierDemosFilesAreMovedIntoADatedFolder) {
  const TemporaryFolder folder;
  const auto kept = KeepEarlierDemo(folder.path());
  ASSERT_TRUE(kept) << kept.error();
  EXPECT_TRUE(kept->empty());
  for (const char* name :
       {"recording.mcap", "recording_stop_1.html", "recording_ticks.csv", "summary.json", "report.html",
        "run_2_stop_1.html", "notes.txt", "records.csv", "run_x.html", "run_2026-11-26_report.html"})
    WriteAll(folder.path() / name, name);
  const auto earlier = KeepEarlierDemo(folder.path());
  ASSERT_TRUE(earlier) << earlier.error();
  EXPECT_EQ(earlier->filename().string().rfind("earlier_20", 0), 0u) << *earlier;
  for (const char* name : {"recording.mcap", "recording_stop_1.html", "recording_ticks.csv", "summary.json",
                           "report.html", "run_2_stop_1.html"}) {
    EXPECT_EQ(ReadAll(*earlier / name), name);
    EXPECT_FALSE(fs::exists(folder.path() / name));
  }
  EXPECT_TRUE(fs::exists(folder.path() / "notes.txt")) << "not a demo's";
  EXPECT_TRUE(fs::exists(folder.path() / "records.csv"));

  WriteAll(folder.path() / "recording.mcap", "the next, in the same second perhaps");
  const auto next = KeepEarlierDemo(folder.path());
  ASSERT_TRUE(next) << next.error();
  EXPECT_NE(*next, *earlier);
  EXPECT_EQ(ReadAll(*earlier / "recording.mcap"), "recording.mcap");
}

TEST(RunFiles, AFolderCanBeClaimedByOneRunAtATime) {
  const TemporaryFolder folder;
  FolderClaim nowhere;
  EXPECT_EQ(nowhere.Acquire(folder.path() / "not_there"), "");
  {
    FolderClaim first, second;
    EXPECT_EQ(first.Acquire(folder.path()), "");
    EXPECT_EQ(first.Acquire(folder.path()), "") << "it has it";
    EXPECT_NE(second.Acquire(folder.path()).find("another osteon writes into"), std::string::npos);
  }
  FolderClaim after;
  EXPECT_EQ(after.Acquire(folder.path()), "");
}

}  // namespace
}  // namespace osteon::session
