#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"

namespace osteon::app {

struct CalibrateOptions {
  std::filesystem::path cell;
  std::filesystem::path
      payload{};  ///< recording: poses at rest with nobody at the handle; empty: not asked for
  std::filesystem::path pivot{};  ///< recording: poses at rest with the tool's tip on one point
  std::filesystem::path out{"calibration.yaml"};
  std::filesystem::path json{};
  std::string command_line{};
};

/// The arm at rest, within a recording.
struct Rest {
  double begin_s{0.0}, seconds{0.0};  ///< since the recording's first tick
  std::array<double, 7> q{};          ///< mean [rad]
  Wrench F_S;                         ///< mean reading of the force sensor
  double force_sd_N{0.0};             ///< of its force, the largest component
};

/// Where no joint moves by more than 0.5 mrad for half a second, the first 0.2 s left out; places nearer to
/// each other than 20 mrad in every joint count as one, the longer. Ticks without a fresh reading of the
/// sensor (20 ms) are no rest.
[[nodiscard]] std::vector<Rest> FindRests(const std::vector<control::TickRecord>& ticks);

/// `osteon calibrate CELL.yaml`: what hangs on the flange, from recorded poses. Prints a table and writes
/// `out`, which the cell's file names as its `calibration`.
/// @returns the process's exit code: 0; 1 where the poses do not say it; 2 bad input.
[[nodiscard]] int RunCalibrate(const CalibrateOptions& options);

}  // namespace osteon::app
