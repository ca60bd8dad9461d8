#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/reading/strict/derived_file.h"

namespace osteon::app {

/// Writes a shipped cell with an FRI arm and wide limits of time, for tests in wall time whose subject is not
/// lateness. With the shipped limits, a machine that wakes a thread 25 ms late ends a run; with these, it may
/// be 250 ms late (the simulated PLC's limit for a heartbeat).
/// @param folder   where the file is written, as patient_SHIPPED.yaml
/// @param shipped  name of a cell under config/cells
/// @param more     further values that differ from the shipped cell
/// @returns the file's path
inline std::string PatientCell(const std::filesystem::path& folder, const std::string& shipped,
                               const std::vector<config::YamlEdit>& more = {}) {
  std::vector<config::YamlEdit> edits{{"watchdog.model_stop_ms", "1000"},
                                      {"watchdog.sensor_stop_ms", "1000"},
                                      {"watchdog.arm_miss_count", "100"},
                                      {"drive.lost_ms", "1000"},
                                      {"drive.heartbeat_ms", "100"},
                                      {"plc.max_age_ms", "1000"},
                                      {"link_quality.good_lost_count", "1000"},
                                      {"link_quality.end_lost_in_a_row_count", "1000"},
                                      {"link_quality.end_lost_count", "1000"}};
  edits.insert(edits.end(), more.begin(), more.end());
  const std::filesystem::path file = folder / ("patient_" + shipped + ".yaml");
  config::WriteDerived(OSTEON_SOURCE_DIR "/config/cells/" + shipped + ".yaml", edits, file);
  return file.string();
}

}  // namespace osteon::app
