#include <random>

#include <gtest/gtest.h>

#include "io/recording/recording_reader.h"
#include "io/recording/recovery.h"
#include "tests/io/recording/recording_samples.h"
#include "tests/io/temporary_folder.h"

// Fixed-seed damage to a recording. The reader may refuse the file, with an error that names byte and reason,
// or accept it as incomplete. It must not crash, and must not accept a damaged file as complete.

namespace osteon::io {
namespace {

constexpr unsigned kSeed = 20240608;

TEST(RecordingFuzz, DamageIsNeverTakenForACompleteRecording) {
  SCOPED_TRACE(kSeed);
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "fuzz.mcap";
  std::string whole;
  std::size_t summary = 0;  // offset of the summary section, which follows the data [byte]
  {
    auto recorder = Recorder::Open({.path = path, .writer_thread = false}, test::SomeSession());
    ASSERT_TRUE(recorder) << recorder.error();
    for (std::uint64_t i = 0; i < 5; ++i) {
      (*recorder)->Push(test::SomeTick(i));
      (*recorder)->PushFrame(test::SomeFrame(i));
    }
    ASSERT_TRUE((*recorder)->Close());
    whole = test::ReadAll(path);
    // read the offset from the first field of the footer, which is 8 + 20 bytes before the end of the file
    for (std::size_t i = 0; i < 8; ++i)
      summary |= std::size_t{static_cast<unsigned char>(whole[whole.size() - 28 + i])} << (8 * i);
    ASSERT_LT(summary, whole.size());
  }

  std::mt19937 random(kSeed);
  int refused = 0, torn = 0, recovered = 0;
  for (int i = 0; i < 500; ++i) {
    std::string bytes = whole;
    const std::size_t at = random() % summary;  // change only bytes before the summary
    switch (random() % 4) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 1:
        bytes.resize(at);
        break;
      case 2:
        bytes.erase(at, 1 + random() % 4);
        break;
      default:
        bytes.insert(at, 1 + random() % 4, static_cast<char>(random() % 256));
    }
    test::WriteAll(path, bytes);
    // if a session can still be read, recovery must succeed and give a complete recording
    const auto recovery = RecoverRecording(path, folder.path() / "recovered.mcap");
    if (!recovery) {
      EXPECT_TRUE(recovery.error().find(": byte ") != std::string::npos ||
                  recovery.error().find("no osteon.Session left") != std::string::npos)
          << recovery.error();
    } else if (!recovery->was_whole) {
      ++recovered;
      const auto again = ReadRecording(folder.path() / "recovered.mcap");
      ASSERT_TRUE(again) << "mutation " << i << " at byte " << at << ": " << again.error();
      ASSERT_TRUE(again->complete);
    } else {
      ADD_FAILURE() << "mutation " << i << " at byte " << at << " was taken for whole";
    }
    const auto recording = ReadRecording(path);
    if (!recording) {
      ++refused;
      EXPECT_NE(recording.error().find(": byte "), std::string::npos) << recording.error();
    } else {
      ++torn;
      // A CRC of 0 means "not available". So damage that turns a CRC to 0 is not detected; its probability is
      // 2^-30.
      ASSERT_FALSE(recording->complete) << "mutation " << i << " at byte " << at;
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(torn, 30);
  EXPECT_GT(recovered, 100);
}

}  // namespace
}  // namespace osteon::io
