#include "io/recording/recording_reader.h"
#include "io/recording/recovery.h"

#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/recording/recording_samples.h"
#include "tests/io/temporary_folder.h"

// Recorder and ReadRecording: what is recorded comes back, losses are counted, and incomplete files are read.

namespace osteon::io {
namespace {

using test::Encoded;
using test::ReadAll;
using test::SomeFrame;
using test::SomeSession;
using test::SomeTick;
using test::TemporaryFolder;
using test::WriteAll;
using test::WriteUncompressed;

constexpr std::uint64_t kTicks = 400;  // at 1 kHz: long enough for several chunks

// Records kTicks ticks in virtual time, a frame beside every second one, and one event. @returns the file's
// bytes
std::string RecordVirtualTime(const std::filesystem::path& path) {
  auto recorder = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
  EXPECT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    if (i % 2 == 0) {
      EXPECT_TRUE((*recorder)->PushFrame(SomeFrame(i / 2)));
    }
    EXPECT_TRUE((*recorder)->Push(SomeTick(i)));
    if (i == 250) (*recorder)->PushEvent(SomeTick(i).stamp, "contact model stale");
    (*recorder)->Drain();
  }
  const auto counts = (*recorder)->Close();
  EXPECT_TRUE(counts) << counts.error();
  EXPECT_EQ(counts->ticks, kTicks);
  EXPECT_EQ(counts->frames, kTicks / 2);
  EXPECT_EQ(counts->events, 1u);
  EXPECT_EQ(counts->bytes, std::filesystem::file_size(path));
  return ReadAll(path);
}

TEST(Recording, IsReadBackBitForBit) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "session.mcap";
  RecordVirtualTime(path);
  const auto recording = ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_TRUE(recording->complete);
  EXPECT_EQ(recording->read_bytes, std::filesystem::file_size(path));
  EXPECT_EQ(recording->session.stamp, 3);
  EXPECT_EQ(recording->session.version, "0.1.0");
  EXPECT_EQ(recording->session.engine, "vulkan");
  EXPECT_EQ(recording->session.device, "llvmpipe");
  EXPECT_EQ(recording->session.scene, "cup");
  EXPECT_EQ(recording->session.tool, "reamer_50");
  EXPECT_EQ(recording->session.force_limit_N, 200.0);
  EXPECT_EQ(recording->session.limits.size(), 2u);
  EXPECT_EQ(recording->session.limits.back(), "tool speed 250 mm/s (cell)");
  EXPECT_EQ(recording->session.config_text, "force_limit_N: 200\n");
  const ConfigSource &config = recording->session.config, sent = SomeSession().config;
  ASSERT_EQ(config.files.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(config.files[i].name, sent.files[i].name);
    EXPECT_EQ(config.files[i].content, sent.files[i].content);
  }
  EXPECT_EQ(config.cell_file, "cells/demo.yaml");
  EXPECT_EQ(config.tool_file, "tools/b.yaml");
  EXPECT_EQ(config.tool_diameter_m, 0.05);
  EXPECT_EQ(config.gains_file, "gains.yaml");
  EXPECT_EQ(config.identified_file, "identified.yaml");
  EXPECT_EQ(config.folder, "/somewhere");
  EXPECT_EQ(recording->session.utc, 4);
  EXPECT_EQ(recording->session.build, "commit 123");
  EXPECT_EQ(recording->session.machine, "a processor");
  ASSERT_EQ(recording->ticks.size(), kTicks);
  ASSERT_EQ(recording->frames.size(), kTicks / 2);
  ASSERT_EQ(recording->events.size(), 1u);
  for (std::uint64_t i = 0; i < kTicks; ++i) EXPECT_EQ(Encoded(recording->ticks[i]), Encoded(SomeTick(i)));
  for (std::uint64_t i = 0; i < kTicks / 2; ++i)
    EXPECT_EQ(Encoded(recording->frames[i]), Encoded(SomeFrame(i)));
  EXPECT_EQ(recording->events[0].stamp, SomeTick(250).stamp);
  EXPECT_EQ(recording->events[0].text, "contact model stale");
}

TEST(Recording, TwoEqualRunsGiveEqualBytes) {
  const TemporaryFolder folder;
  const std::string first = RecordVirtualTime(folder.path() / "first.mcap");
  const std::string second = RecordVirtualTime(folder.path() / "second.mcap");
  ASSERT_GT(first.size(), 10'000u);
  EXPECT_TRUE(first == second);
}

// A file with uncompressed chunks gives the same recording. Compression saves at least a fifth of the size,
// although nearly all values differ.
TEST(Recording, IsCompressedAndUncompressedFilesAreReadToo) {
  const TemporaryFolder folder;
  const auto plain = folder.path() / "plain.mcap";
  const std::string bytes = RecordVirtualTime(folder.path() / "session.mcap");
  WriteUncompressed(folder.path() / "session.mcap", plain);
  EXPECT_LT(bytes.size(), 4 * std::filesystem::file_size(plain) / 5);
  const auto recording = ReadRecording(plain);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_TRUE(recording->complete);
  ASSERT_EQ(recording->ticks.size(), kTicks);
  ASSERT_EQ(recording->frames.size(), kTicks / 2);
  for (std::uint64_t i = 0; i < kTicks; ++i) EXPECT_EQ(Encoded(recording->ticks[i]), Encoded(SomeTick(i)));
}

TEST(Recording, DrainSortsByStampAndPutsTicksFirst) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "merged.mcap";
  auto recorder = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  // Reads the times of messages in the file's order by McapReader, because ReadRecording returns ticks,
  // frames and events in separate lists.
  simulation::FrameRecord frame = SomeFrame(0);
  for (const rt::Nanoseconds stamp : {20, 40}) {
    frame.stamp = stamp;
    (*recorder)->PushFrame(frame);
  }
  (*recorder)->PushEvent(20, "e");
  control::TickRecord tick = SomeTick(0);
  for (const rt::Nanoseconds stamp : {10, 20, 30}) {
    tick.stamp = stamp;
    (*recorder)->Push(tick);
  }
  ASSERT_TRUE((*recorder)->Close());

  auto reader = McapReader::Open(path);
  ASSERT_TRUE(reader) << reader.error();
  std::vector<std::pair<int, std::uint64_t>> order;  // channel, log time
  for (McapMessage message; reader->Next(message).value();)
    order.emplace_back(message.channel->id, message.log_time_ns);
  const std::vector<std::pair<int, std::uint64_t>> expected{{0, 3},  {1, 10}, {1, 20}, {2, 20},
                                                            {3, 20}, {1, 30}, {2, 40}};
  EXPECT_EQ(order, expected);
}

TEST(Recording, WriterThreadLosesNothing) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "wall.mcap";
  auto recorder = Recorder::Open({.path = path}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  constexpr std::uint64_t kCount = 2000;
  std::thread servo([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) (*recorder)->Push(SomeTick(i));
  });
  std::thread simulation([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) (*recorder)->PushFrame(SomeFrame(i));
  });
  (*recorder)->PushEvent(1, "from the main thread");
  servo.join();
  simulation.join();
  const auto counts = (*recorder)->Close();
  ASSERT_TRUE(counts) << counts.error();
  EXPECT_EQ(counts->dropped_ticks + counts->dropped_frames, 0u);
  const auto recording = ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_TRUE(recording->complete);
  ASSERT_EQ(recording->ticks.size(), kCount);
  ASSERT_EQ(recording->frames.size(), kCount);
  for (std::uint64_t i = 0; i < kCount; ++i) ASSERT_EQ(recording->ticks[i].tick, i);
}

TEST(Recording, CountsRecordsDroppedByAFullRing) {
  const TemporaryFolder folder;
  auto recorder = Recorder::Open(
      {.path = folder.path() / "full.mcap", .tick_capacity = 4, .frame_capacity = 2, .writer_thread = false},
      SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ((*recorder)->Push(SomeTick(i)), i < 4);
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ((*recorder)->PushFrame(SomeFrame(i)), i < 2);
  const auto counts = (*recorder)->Close();
  ASSERT_TRUE(counts) << counts.error();
  EXPECT_EQ(counts->ticks, 4u);
  EXPECT_EQ(counts->frames, 2u);
  EXPECT_EQ(counts->dropped_ticks, 6u);
  EXPECT_EQ(counts->dropped_frames, 3u);
  EXPECT_EQ((*recorder)->Close()->dropped_ticks, 6u) << "closing again gives the same answer";
}

// Stalled() becomes true while the ring still has room for all ticks of a stop.
TEST(Recording, IsStalledWhileTooManyTicksWait) {
  const TemporaryFolder folder;
  const RecorderParams params{.path = folder.path() / "stalled.mcap", .writer_thread = false};
  auto recorder = Recorder::Open(params, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  std::uint64_t tick = 0;
  // often enough that the ring wraps around
  for (int round = 0; round < 6; ++round) {
    for (std::size_t i = 0; i < params.stalled_ticks; ++i) {
      ASSERT_FALSE((*recorder)->Stalled()) << i;
      ASSERT_TRUE((*recorder)->Push(SomeTick(++tick)));
    }
    EXPECT_TRUE((*recorder)->Stalled());
    (*recorder)->Drain();
    EXPECT_FALSE((*recorder)->Stalled());
  }
  EXPECT_GE(params.tick_capacity, 4 * params.stalled_ticks) << "6 s for the stop";
  EXPECT_EQ((*recorder)->Close()->dropped_ticks, 0u);
}

TEST(Recording, PushDoesNotAllocate) {
  const TemporaryFolder folder;
  auto recorder = Recorder::Open({.path = folder.path() / "rt.mcap", .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  const control::TickRecord tick = SomeTick(1);
  const simulation::FrameRecord frame = SomeFrame(1);
  rt::CheckedNoAllocScope no_alloc;
  const bool pushed = (*recorder)->Push(tick) && (*recorder)->PushFrame(frame);
  no_alloc.End();
  EXPECT_TRUE(pushed);
}

TEST(Recording, ErrorsNameAPathThatCannotBeWritten) {
  const auto nowhere = Recorder::Open({.path = "/nowhere/at/all.mcap"}, SomeSession());
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().find("/nowhere/at/all.mcap"), std::string::npos);
  const auto full = Recorder::Open({.path = "/dev/full"}, SomeSession());
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error(), "/dev/full: cannot write the recording: No space left on device");
}

TEST(Recording, ACutOffFileIsReadUpToItsCut) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "torn.mcap";
  const std::string whole = RecordVirtualTime(folder.path() / "whole.mcap");
  WriteAll(path, whole.substr(0, whole.size() / 2));
  const auto half = ReadRecording(path);
  ASSERT_TRUE(half) << half.error();
  EXPECT_FALSE(half->complete);
  EXPECT_GT(half->ticks.size(), 0u);
  EXPECT_LT(half->ticks.size(), kTicks);
  EXPECT_LE(half->read_bytes, whole.size() / 2);
  EXPECT_EQ(half->end_error,
            "it ends early, at byte " + std::to_string(half->read_bytes) + ": the process died");
  for (std::uint64_t i = 0; i < half->ticks.size(); ++i) EXPECT_EQ(half->ticks[i].tick, i);

  WriteAll(path, whole.substr(0, whole.size() - 3));  // cuts off a part of the closing magic bytes
  const auto nearly = ReadRecording(path);
  ASSERT_TRUE(nearly) << nearly.error();
  EXPECT_FALSE(nearly->complete);
  EXPECT_EQ(nearly->ticks.size(), kTicks);
}

// The test reads the file while it is being recorded. Another program would find the same content if the
// recording process were killed.
TEST(Recording, AKilledProcessLeavesTheDrainedTicksInTheFile) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "live.mcap";
  auto recorder = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  auto found = ReadRecording(path);
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->session.tool, "reamer_50") << "the session is on the disk at once";

  for (std::uint64_t i = 0; i < kTicks; ++i) (*recorder)->Push(SomeTick(i));
  (*recorder)->Drain();
  found = ReadRecording(path);
  ASSERT_TRUE(found) << found.error();
  EXPECT_FALSE(found->complete);
  EXPECT_LE(kTicks - found->ticks.size(), 251u) << "no more than one chunk: a quarter of a second at 1 kHz";

  (*recorder)->PushEvent(SomeTick(kTicks).stamp, "arm stopped");
  (*recorder)->Drain();
  found = ReadRecording(path);
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->ticks.size(), kTicks) << "an event brings everything before it to the disk";
  EXPECT_EQ(found->events.size(), 1u);
}

TEST(Recording, AFileWithBytesBehindItsEndIsNotComplete) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "behind.mcap", recovered = folder.path() / "recovered.mcap";
  const std::string whole = RecordVirtualTime(folder.path() / "whole.mcap");
  WriteAll(path, whole + "Osteon run: acetabulum\n");
  const auto recording = ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_FALSE(recording->complete);
  EXPECT_EQ(recording->read_bytes, whole.size());
  EXPECT_EQ(recording->end_error,
            "it ends at byte " + std::to_string(whole.size()) +
                ", and 23 bytes follow, which are not read: another file was appended, or a longer one was "
                "here");
  const auto recovery = RecoverRecording(path, recovered);
  ASSERT_TRUE(recovery) << recovery.error();
  EXPECT_FALSE(recovery->was_whole);
  EXPECT_TRUE(recovery->closed);
  EXPECT_EQ(recovery->tail_bytes, 23u);
  const auto again = ReadRecording(recovered);
  ASSERT_TRUE(again) << again.error();
  EXPECT_TRUE(again->complete);
  EXPECT_EQ(again->ticks.size(), recording->ticks.size());
}

TEST(Recording, AFileInUseIsRefusedToASecondRecorder) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "one.mcap";
  {
    auto first = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
    ASSERT_TRUE(first) << first.error();
    const auto second = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error(), path.string() + ": another process records into it, accepted another name");
    (*first)->Push(SomeTick(1));
    ASSERT_TRUE((*first)->Close());
  }
  const auto recording = ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_TRUE(recording->complete) << "the second has left it as it was";
  EXPECT_EQ(recording->ticks.size(), 1u);
  EXPECT_TRUE(Recorder::Open({.path = path, .writer_thread = false}, SomeSession()))
      << "nobody has it any more";
}

TEST(Recording, ErrorsNameByteAndReason) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "bad.mcap";
  const std::string whole = RecordVirtualTime(folder.path() / "whole.mcap");
  const auto error_of = [&](const std::string& bytes) {
    WriteAll(path, bytes);
    const auto recording = ReadRecording(path);
    return recording ? std::string("accepted") : recording.error().substr(path.string().size());
  };
  EXPECT_EQ(error_of("PNG"), ": byte 0: not an MCAP file (its first 8 bytes are not the magic)");
  EXPECT_EQ(error_of(whole.substr(0, 8)),
            ": byte 8: no osteon.Session in it: not a recording of this program");

  std::string bad = whole;
  bad[8] = 5;  // the header's opcode
  EXPECT_EQ(error_of(bad), ": byte 8: the first record is not a header");
  bad = whole;
  bad[8 + 1 + 7] = '\x7f';  // top byte of the header's length
  EXPECT_EQ(error_of(bad).find(": byte 8: record of 9151314442816847"), 0u) << error_of(bad);

  // one bit of one double: still a valid message, but not the recorded one
  WriteUncompressed(folder.path() / "whole.mcap", path);
  bad = ReadAll(path);
  std::string double_bytes(sizeof(double), '\0');
  const double value = SomeTick(200).X_WT_cmd.p.x;
  std::memcpy(double_bytes.data(), &value, sizeof value);
  const std::size_t at = bad.find(double_bytes);
  ASSERT_NE(at, std::string::npos);
  bad[at] = static_cast<char>(bad[at] ^ 1);
  EXPECT_NE(error_of(bad).find("the chunk does not match its CRC"), std::string::npos) << error_of(bad);

  EXPECT_NE(ReadRecording(folder.path() / "missing.mcap").error().find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace osteon::io
