// Virtual time with a real-time factor: a run that waits now and then has the same results.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"

namespace osteon::session {
namespace {

// Runs a cell for 0.2 s of rendering. @returns the recording's bytes, and how long the run took [s]
std::pair<std::string, double> RunPaced(double real_time_factor) {
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  auto engine = MakeEngine(*setup, {});
  EXPECT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  const CellRunParams params{.seconds = 0.2,
                             .virtual_time = true,
                             .real_time_factor = real_time_factor,
                             .recording = folder.path() / "r.mcap"};
  const auto began = std::chrono::steady_clock::now();
  const auto result = RunCell(*setup, **engine, params);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  EXPECT_TRUE(result) << result.error().what;
  std::ifstream file(params.recording, std::ios::binary);
  return {std::string(std::istreambuf_iterator<char>(file), {}), took.count()};
}

TEST(RealTimeFactor, DelaysARunAndChangesNoBitOfIt) {
  constexpr double kFactor = 2.0;
  const auto [free, free_s] = RunPaced(0.0);
  const auto [paced, paced_s] = RunPaced(kFactor);
  ASSERT_FALSE(free.empty());
  EXPECT_TRUE(free == paced) << "recordings of " << free.size() << " and " << paced.size() << " bytes";
  EXPECT_GE(paced_s, 0.2 / kFactor);  // rendering alone
}

}  // namespace
}  // namespace osteon::session
