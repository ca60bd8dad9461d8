#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"

// The history of a cell's calibrations, in the order in which they were made, and the drift between them.

namespace osteon::studies {

/// The result of one calibration, with the standard deviations that the fits gave.
struct CalibrationEntry {
  std::string time;  ///< UTC, "2026-11-28T09:30:00Z"
  struct Payload {
    double mass_kg{0.0}, mass_sd_kg{0.0};
    Vector3 center_F_m{Vector3::Zero()};
    double center_sd_m{0.0};
    Vector3 bias_N{Vector3::Zero()};
    double residual_N{0.0};
  };
  std::optional<Payload> payload{};
  struct Apex {
    Vector3 p_FT_m{Vector3::Zero()};
    double sd_m{0.0}, residual_m{0.0};
  };
  std::optional<Apex> apex{};
};

/// The history's file beside an overlay: my_calibration.yaml has my_calibration.history.jsonl.
[[nodiscard]] std::filesystem::path HistoryFile(const std::filesystem::path& overlay);

/// Reads a history with one JSON object per line; empty if there is no file. The error names the file, the
/// line and what is accepted.
[[nodiscard]] tl::expected<std::vector<CalibrationEntry>, std::string> ReadHistory(
    const std::filesystem::path& file);

/// Appends an entry; the earlier lines stay as they are. The error names the file.
[[nodiscard]] tl::expected<void, std::string> AppendHistory(const std::filesystem::path& file,
                                                            const CalibrationEntry& entry);

/// Returns a sentence for each quantity that has drifted since its latest or since its first earlier
/// calibration. A quantity has drifted if it differs by more than three combined standard deviations of both
/// fits, and by more than 20 g of mass, 1 mm of the centre, 0.5 N of bias or 0.1 mm of the apex.
[[nodiscard]] std::vector<std::string> DriftSince(const std::vector<CalibrationEntry>& history,
                                                  const CalibrationEntry& now);

/// The present time, in the form of CalibrationEntry::time.
[[nodiscard]] std::string UtcNow();

}  // namespace osteon::studies
