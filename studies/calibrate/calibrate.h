#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"

namespace osteon::studies {

/// Options of `osteon calibrate`.
struct CalibrateOptions {
  std::filesystem::path cell;
  /// Recording: poses at rest with nobody at the handle; empty: no payload calibration.
  std::filesystem::path payload{};
  /// Recording: poses at rest with the tool's tip on one point; empty: no calibration of the tip.
  std::filesystem::path pivot{};
  std::filesystem::path out{"calibration.yaml"};
  std::filesystem::path json{};
  std::string command_line{};
};

/// A period of a recording in which the arm rests in one posture.
struct RestingPose {
  double begin_s{0.0}, seconds{0.0};  ///< since the recording's first tick
  std::array<double, 7> q{};          ///< mean [rad]
  Wrench F_S;                         ///< mean reading of the force sensor
  int visits{1};                      ///< number of rests in this posture
  double repeat_N{0.0};               ///< largest difference of the mean force between two of these rests
};

/// Finds the periods of at least half a second in which no joint moves by more than 0.5 mrad; leaves out the
/// first 0.2 s of each. A tick whose sensor reading is older than 20 ms ends a rest. Rests whose postures
/// differ by less than 20 mrad in every joint are merged into one, which keeps the values of the longest.
[[nodiscard]] std::vector<RestingPose> FindRestingPoses(const std::vector<control::TickRecord>& ticks);

/// Runs `osteon calibrate CELL.yaml`: identifies the load on the flange from recorded poses. Prints a table
/// and writes `out`, which the cell's file names as its `calibration`. States the residual of each posture
/// and the repeatability of postures that were visited again, appends the result to the history beside `out`
/// (calibration_history.h), and warns of drift.
/// @returns the process's exit code: 0; 1 if the poses do not determine the result; 2 bad input.
[[nodiscard]] int RunCalibrate(const CalibrateOptions& options);

}  // namespace osteon::studies
