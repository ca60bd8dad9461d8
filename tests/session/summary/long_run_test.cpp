#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tests/io/temporary_folder.h"
#include "tests/session/summary/long_recording.h"

namespace osteon::session {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // freed memory stays resident for a while
#else
constexpr bool kSanitized = false;
#endif

// Both runs are longer than the 131 s of frames that are kept point by point. If the end of a run kept all
// ticks and frames, the longer one would take 350 MB more.
TEST(LongRun, TwiceTheLengthTakesNoMoreMemoryAtItsEnd) {
  if (kSanitized) GTEST_SKIP() << "skipped, a sanitizer keeps memory that was freed";
  const io::test::TemporaryFolder folder;
  std::uint64_t peak[2]{};
  for (int i = 0; i < 2; ++i) {
    const auto recording = folder.path() / (i == 0 ? "short.mcap" : "long.mcap");
    const double seconds = i == 0 ? 140.0 : 280.0;
    WriteLongRecording(recording, seconds);
    peak[i] = PeakMemory([&] {
      const LongRunEnd end = EndLongRun(recording, folder.path());
      if (end.ticks != static_cast<std::uint64_t>(1000.0 * seconds) || end.frames != end.ticks ||
          end.stops != (i == 0 ? 1u : 2u) || end.path_tolerance_m <= 0.0)
        throw std::runtime_error("not what was recorded");
    });
    ASSERT_GT(peak[i], 0u);
    RecordProperty("peak_MiB_" + std::to_string(i), static_cast<int>(peak[i] >> 20));
  }
  EXPECT_LT(peak[1], peak[0] + (8u << 20)) << (peak[0] >> 20) << " MiB for the shorter";
}

}  // namespace
}  // namespace osteon::session
