// Measures the memory that the end of a long run needs. One process makes up a recording of that length, and
// another process reads it as `osteon run` does at its end.
//
//     osteon_long_run_bench [HOURS] [FOLDER]
//
// Prints size, time and peak resident memory of both processes. The recording stays in the folder.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "tests/session/summary/long_recording.h"

using namespace osteon;

namespace {

double SecondsOf(const std::function<void()>& work) {
  const auto begun = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

}  // namespace

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 8.0;
  const std::filesystem::path folder = argc > 2 ? argv[2] : std::filesystem::temp_directory_path();
  if (!(hours >= 0.01 && hours <= 24.0)) {
    std::fprintf(stderr, "osteon_long_run_bench: HOURS: found %s, accepted 0.01 … 24\n", argv[1]);
    return 2;
  }
  const std::filesystem::path recording = folder / "long_run.mcap";
  std::uint64_t writing = 0, reading = 0;
  const double write_s = SecondsOf([&] {
    writing = session::PeakMemory([&] { session::WriteLongRecording(recording, 3600.0 * hours); });
  });
  if (writing == 0) return 1;
  std::printf("recorded: %.2f h, %.2f GB, %.0f s, at most %.0f MB resident\n", hours,
              1e-9 * static_cast<double>(std::filesystem::file_size(recording)), write_s,
              1e-6 * static_cast<double>(writing));
  std::fflush(stdout);
  const double read_s = SecondsOf([&] {
    reading = session::PeakMemory([&] {
      const session::LongRunEnd end = session::EndLongRun(recording, folder);
      std::printf("read: %llu ticks, %llu frames, %zu stops, path within %.3g um\n",
                  static_cast<unsigned long long>(end.ticks), static_cast<unsigned long long>(end.frames),
                  end.stops, 1e6 * end.path_tolerance_m);
      std::fflush(stdout);
    });
  });
  if (reading == 0) return 1;
  std::printf("the end of the run: %.0f s, at most %.0f MB resident\n", read_s,
              1e-6 * static_cast<double>(reading));
  return 0;
}
