#include "io/recording/recovery.h"

#include <cstring>

#include <gtest/gtest.h>

#include "io/recording/recording_reader.h"
#include "tests/io/recording/recording_samples.h"
#include "tests/io/temporary_folder.h"

// RecoverRecording with recordings that are cut off or damaged: what it keeps and what it reports.

namespace osteon::io {
namespace {

using test::ReadAll;
using test::SomeFrame;
using test::SomeTick;
using test::WriteAll;

constexpr std::uint64_t kTicks = 400;  // length of the recording below, at 1 kHz

// Reads the little-endian 64-bit number at an offset.
std::uint64_t IntAt(const std::string& bytes, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Offset and size of each chunk's record (opcode 6).
std::vector<std::pair<std::size_t, std::size_t>> Chunks(const std::string& bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> chunks;
  for (std::size_t at = 8; at + 9 <= bytes.size();) {
    const std::size_t size = 9 + IntAt(bytes, at + 1);
    if (bytes[at] == 6) chunks.emplace_back(at, size);
    at += size;
  }
  return chunks;
}

// Each test starts from a complete recording of kTicks ticks, half as many frames, and one event.
class RecoverRecordingTest : public testing::Test {
 protected:
  RecoverRecordingTest() {
    auto recorder = Recorder::Open({.path = torn_, .writer_thread = false}, test::SomeSession());
    EXPECT_TRUE(recorder) << recorder.error();
    for (std::uint64_t i = 0; i < kTicks; ++i) {
      (*recorder)->Push(SomeTick(i));
      if (i % 2 == 0) (*recorder)->PushFrame(SomeFrame(i / 2));
      if (i == 250) (*recorder)->PushEvent(SomeTick(i).stamp, "an event");
      (*recorder)->Drain();
    }
    EXPECT_TRUE((*recorder)->Close());
    compressed_ = ReadAll(torn_);
    test::WriteUncompressed(torn_, out_);
    whole_ = ReadAll(out_);
    std::filesystem::remove(out_);
  }

  /// Recovers these bytes; expects a complete file with the reported content, which is read into kept_.
  Recovery Recover(const std::string& bytes) {
    WriteAll(torn_, bytes);
    std::filesystem::remove(out_);
    const auto recovery = RecoverRecording(torn_, out_);
    if (!recovery) {
      ADD_FAILURE() << recovery.error();
      return {};
    }
    EXPECT_FALSE(std::filesystem::exists(out_.string() + ".part"));
    if (recovery->was_whole) return *recovery;
    auto read = ReadRecording(out_);
    if (!read) {
      ADD_FAILURE() << read.error();
      return *recovery;
    }
    EXPECT_TRUE(read->complete);
    EXPECT_EQ(read->ticks.size(), recovery->ticks);
    EXPECT_EQ(read->frames.size(), recovery->frames);
    EXPECT_EQ(read->events.size(), recovery->events);
    EXPECT_EQ(recovery->messages, 1 + recovery->ticks + recovery->frames + recovery->events);
    EXPECT_EQ(recovery->bytes, std::filesystem::file_size(out_));
    kept_ = std::move(*read);
    return *recovery;
  }

  /// The last tick kept.
  [[nodiscard]] std::uint64_t LastTick() const { return kept_.ticks.empty() ? 0 : kept_.ticks.back().tick; }

  test::TemporaryFolder folder_;
  std::filesystem::path torn_{folder_.path() / "torn.mcap"}, out_{folder_.path() / "whole.mcap"};
  std::string whole_;       // uncompressed, in many chunks: a message's bytes can be found in it
  std::string compressed_;  // compressed, as the recorder writes it
  Recording kept_;
};

TEST_F(RecoverRecordingTest, AWholeRecordingIsNotWrittenAgain) {
  const Recovery recovery = Recover(whole_);
  EXPECT_TRUE(recovery.was_whole);
  EXPECT_EQ(recovery.ticks, kTicks);
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(RecoverRecordingTest, ARecordingWithoutItsSummaryLosesNothing) {
  const auto chunks = Chunks(whole_);
  // all chunks and their indexes, cut at the end of the data
  std::size_t end = chunks.back().first + chunks.back().second;
  while (whole_[end] == 7) end += 9 + IntAt(whole_, end + 1);
  const Recovery recovery = Recover(whole_.substr(0, end));
  EXPECT_EQ(recovery.ticks, kTicks);
  EXPECT_EQ(recovery.tail_bytes, 0u);
  EXPECT_EQ(recovery.unchecked, 0u);
  EXPECT_EQ(kept_.events.size(), 1u);
  EXPECT_DOUBLE_EQ(recovery.last_s, 0.399);
  EXPECT_EQ(McapReader::Open(out_)->library(), "osteon 0.1.0") << "what recorded it";
}

// Wherever the file is cut off, all messages before the cut are kept, including the complete ones of the last
// chunk.
TEST_F(RecoverRecordingTest, KeepsEveryCompleteMessage) {
  const auto chunks = Chunks(whole_);
  ASSERT_GT(chunks.size(), 4u);
  const auto [start, size] = chunks[chunks.size() - 2];
  std::size_t before = 0;
  for (std::size_t cut = start; cut <= start + size; cut += 691) {
    const Recovery recovery = Recover(whole_.substr(0, cut));
    EXPECT_GE(recovery.messages, before) << cut;
    EXPECT_LT(recovery.tail_bytes, 2000u) << "at most the one that is cut off";
    EXPECT_EQ(recovery.missing_ticks, 0u);
    before = recovery.messages;
    for (std::uint64_t i = 0; i < kept_.ticks.size(); ++i) {
      std::string kept, sent;
      Encode(kept_.ticks[i], kept);
      Encode(SomeTick(i), sent);
      ASSERT_EQ(kept, sent);
    }
    const auto read = ReadRecording(torn_);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->ticks.size(), recovery.ticks) << "a reader sees as much as is recovered";
  }
  // a chunk of many messages is cut in the middle: nearly half of its messages remain
  const Recovery recovery = Recover(whole_.substr(0, start + size / 2));
  EXPECT_GT(recovery.unchecked, 10u);
}

// In a compressed chunk that is cut off, all complete blocks (128 KiB of records each) are kept.
TEST_F(RecoverRecordingTest, KeepsTheCompleteBlocksOfACutOffCompressedChunk) {
  const auto chunks = Chunks(compressed_);
  ASSERT_GE(chunks.size(), 3u);  // session; until the event at tick 250; rest
  const auto [start, size] = chunks[1];
  std::size_t before = 0, most_unchecked = 0;
  for (std::size_t cut = start; cut < start + size; cut += 2311) {
    const Recovery recovery = Recover(compressed_.substr(0, cut));
    EXPECT_GE(recovery.messages, before) << cut;
    EXPECT_EQ(recovery.tail_bytes, cut - start) << "of the chunk that is cut off";
    EXPECT_EQ(recovery.missing_ticks, 0u);
    EXPECT_EQ(recovery.unchecked + 1, recovery.messages) << "all but the session";
    before = recovery.messages;
    most_unchecked = std::max<std::size_t>(most_unchecked, recovery.unchecked);
    for (std::uint64_t i = 0; i < kept_.ticks.size(); ++i) {
      std::string kept, sent;
      Encode(kept_.ticks[i], kept);
      Encode(SomeTick(i), sent);
      ASSERT_EQ(kept, sent);
    }
    const auto read = ReadRecording(torn_);
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->ticks.size(), recovery.ticks) << "a reader sees as much as is recovered";
  }
  EXPECT_GT(most_unchecked, 80u) << "128 KiB of schemas and records";
  const Recovery recovery = Recover(compressed_.substr(0, chunks[2].first));
  EXPECT_EQ(recovery.unchecked, 0u) << "a whole chunk is checked";
  EXPECT_GT(recovery.ticks, most_unchecked / 2);
}

TEST_F(RecoverRecordingTest, SkipsADamagedCompressedChunk) {
  const auto chunks = Chunks(compressed_);
  const auto [start, size] = chunks[1];
  std::string bytes = compressed_;
  bytes[start + size / 2] = static_cast<char>(bytes[start + size / 2] ^ 1);
  const Recovery recovery = Recover(bytes);
  ASSERT_EQ(recovery.damage.size(), 1u);
  EXPECT_EQ(recovery.damage[0].offset, start);
  EXPECT_EQ(recovery.ticks + recovery.missing_ticks + kept_.ticks.front().tick, kTicks);
  EXPECT_EQ(LastTick(), kTicks - 1) << "what comes after it is kept";
}

TEST_F(RecoverRecordingTest, SkipsADamagedChunkAndReportsItsPosition) {
  const auto chunks = Chunks(whole_);
  const auto [start, size] = chunks[2];
  std::string bytes = whole_;
  bytes[start + size / 2] = static_cast<char>(bytes[start + size / 2] ^ 1);
  const auto refused = [&] {
    WriteAll(torn_, bytes);
    return ReadRecording(torn_).error();
  }();
  EXPECT_EQ(refused, torn_.string() + ": byte " + std::to_string(start) +
                         ": the chunk does not match its CRC: the file was changed");
  const Recovery recovery = Recover(bytes);
  ASSERT_EQ(recovery.damage.size(), 1u);
  EXPECT_EQ(recovery.damage[0].offset, start);
  EXPECT_GE(recovery.damage[0].bytes, size);
  EXPECT_EQ(recovery.damage[0].reason, "the chunk does not match its CRC: the file was changed");
  EXPECT_GT(recovery.missing_ticks, 10u);
  EXPECT_EQ(recovery.ticks + recovery.missing_ticks, kTicks);
  EXPECT_EQ(LastTick(), kTicks - 1) << "what comes after it is kept";
}

TEST_F(RecoverRecordingTest, FindsTheNextChunkAfterADamagedLength) {
  const auto chunks = Chunks(whole_);
  for (const unsigned byte :
       {1u, 4u, 8u}) {  // damaged byte of the length: slightly wrong, beyond the file, absurd
    std::string bytes = whole_;
    bytes[chunks[2].first + byte] = static_cast<char>(bytes[chunks[2].first + byte] ^ 0x41);
    const Recovery recovery = Recover(bytes);
    ASSERT_EQ(recovery.damage.size(), 1u) << byte;
    EXPECT_EQ(recovery.damage[0].offset, chunks[2].first);
    EXPECT_EQ(recovery.damage[0].offset + recovery.damage[0].bytes, chunks[3].first);
    EXPECT_EQ(LastTick(), kTicks - 1);
  }
}

// The damaged chunk is the first one of ticks and contains their schema. A complete file repeats the schema
// at its end.
TEST_F(RecoverRecordingTest, LosesOnlyTheDamagedChunkThatContainedTheSchema) {
  const auto chunks = Chunks(whole_);
  std::string bytes = whole_;
  bytes[chunks[1].first + 500] = static_cast<char>(bytes[chunks[1].first + 500] ^ 1);
  const Recovery recovery = Recover(bytes);
  EXPECT_GT(recovery.ticks, kTicks / 2);
  EXPECT_EQ(LastTick(), kTicks - 1);
}

// The first channel gets a wrong number, so the reader finds messages without a channel. Recovery also uses
// the channels that the summary repeats, and must not report the file as whole. Found by libFuzzer
// (tests/fuzz/targets/recording.cpp).
TEST_F(RecoverRecordingTest, AnUnreadableFileIsNotReportedAsWhole) {
  std::string bytes = whole_;
  const std::size_t chunk = Chunks(bytes).front().first;
  bytes.replace(chunk + 9 + 24, 4, 4, '\0');  // checksum 0: not given
  for (std::size_t at = 8; at + 9 <= bytes.size(); at += 9 + IntAt(bytes, at + 1))
    if (bytes[at] == 0x0f) bytes.replace(at + 9, 4, 4, '\0');
  bool changed = false;
  for (std::size_t at = chunk + 9 + 40; !changed; at += 9 + IntAt(bytes, at + 1))
    if (bytes[at] == 4) {  // the first channel gets another number, and its messages have no channel
      bytes[at + 9] = 77;
      changed = true;
    }
  const Recovery recovery = Recover(bytes);
  EXPECT_FALSE(recovery.was_whole);
  ASSERT_EQ(recovery.damage.size(), 1u);
  EXPECT_NE(recovery.damage.front().reason.find("which is not in the file"), std::string::npos)
      << recovery.damage.front().reason;
  EXPECT_EQ(recovery.ticks, kTicks);
}

// Damage gives the ticks' channel the number 0, which is already the session channel's number. Found by
// libFuzzer.
TEST_F(RecoverRecordingTest, AChannelMayTakeTheNumberOfAnEarlierChannel) {
  std::string bytes = whole_;
  const auto chunks = Chunks(bytes);
  int ticks = 0;
  for (const auto& [chunk, size] : chunks) {
    bytes.replace(chunk + 9 + 24, 4, 4, '\0');  // checksum 0: not given
    for (std::size_t at = chunk + 9 + 40; at < chunk + size; at += 9 + IntAt(bytes, at + 1))
      if ((bytes[at] == 4 || bytes[at] == 5) && bytes[at + 9] == 1) {  // a channel, or a message, of ticks
        bytes[at + 9] = 0;                                             // which was the session's
        ticks += bytes[at] == 5;
      }
  }
  ASSERT_EQ(ticks, static_cast<int>(kTicks));
  const Recovery recovery = Recover(bytes.substr(0, chunks.back().first + chunks.back().second));
  EXPECT_EQ(recovery.ticks, kTicks);
  EXPECT_TRUE(recovery.damage.empty());
  EXPECT_EQ(LastTick(), kTicks - 1);
}

// After a power cut, a file may end with space that was never written, which reads as zeros.
TEST_F(RecoverRecordingTest, ZerosAtTheEndCountAsACutOffTail) {
  const auto chunks = Chunks(whole_);
  const std::string bytes = whole_.substr(0, chunks[3].first) + std::string(5000, '\0');
  const Recovery recovery = Recover(bytes);
  EXPECT_EQ(recovery.tail_bytes, 5000u);
  EXPECT_TRUE(recovery.damage.empty());
  const auto read = ReadRecording(torn_);
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->ticks.size(), recovery.ticks);
}

TEST_F(RecoverRecordingTest, RefusesFilesThatAreNoRecordingAndLeavesNoOutput) {
  const auto error_of = [&](const std::string& bytes) {
    WriteAll(torn_, bytes);
    const auto recovery = RecoverRecording(torn_, out_);
    EXPECT_FALSE(std::filesystem::exists(out_));
    EXPECT_FALSE(std::filesystem::exists(out_.string() + ".part"));
    return recovery ? "accepted" : recovery.error();
  };
  EXPECT_EQ(error_of("PNG"),
            torn_.string() + ": byte 0: not an MCAP file (its first 8 bytes are not the magic)");
  EXPECT_EQ(error_of(whole_.substr(0, 60)),
            torn_.string() + ": no osteon.Session left in it: nothing to recover");
  WriteAll(torn_, whole_.substr(0, whole_.size() / 2));
  const auto itself = RecoverRecording(torn_, torn_);
  ASSERT_FALSE(itself);
  EXPECT_NE(itself.error().find("found the torn recording itself"), std::string::npos);
  EXPECT_EQ(ReadAll(torn_).size(), whole_.size() / 2) << "and it is untouched";
  EXPECT_NE(RecoverRecording(torn_, "/nowhere/at/all.mcap").error().find("/nowhere/at/all.mcap"),
            std::string::npos);
}

}  // namespace
}  // namespace osteon::io
