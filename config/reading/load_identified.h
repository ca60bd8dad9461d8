#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "config/reading/cell_config.h"
#include "config/reading/identified_cell.h"

namespace osteon::config {

/// Loads what `osteon identify` wrote.
///
///     identified:
///       valid_for: {robot, tool, period_ms, start_deg: [7 numbers], [law: admittance | impedance,]
///                   recordings: [{file, hash}, …]}
///       arm: [{axis, speed_mm_per_s, bandwidth_hz, damping_ratio, dead_time_ms, gain_ratio, lag_ms,
///              [felt_mass_kg,] [impedance: {[translation_N_per_m,] [rotation_Nm_per_rad,] [joint_Nm_per_rad,]
///              [damping_ratio,] [on_mount]},] chi2_ratio,
///              interval: {bandwidth_hz, damping_ratio, dead_time_ms, lag_ms}}, …]
///       response: [{axis, speed_mm_per_s, by: encoders | force | hand, [hand,] [spring_N_per_m,]
///                   lines: [{hz, re_ratio, im_ratio, sd_ratio}]}]
///       [sensor: {[delay_ms,] noise_N, drift_N}]
///       [link: {jitter_mean_ms, jitter_p99_ms, loss_ratio}]
///       [structure: [{hz, damping_ratio}, …]]
///       [hands: [{name, stiffness_N_per_m, stiffness_interval_N_per_m, damping_Ns_per_m, mass_kg}, …]]
///       [vibration: {[tremor_N,] [notch_hz]}]
///       [dead_zone_N]
///
/// Every interval is [low, high] and must contain its value; lines rise in frequency.
/// @throws ConfigError naming file, line, key, what was found and what is accepted.
[[nodiscard]] IdentifiedCell ReadIdentified(const std::filesystem::path& file);

/// Reads the file for a cell: refuses a file of another robot, tool, period, posture or law.
/// @throws ConfigError at the line of the key that differs.
[[nodiscard]] IdentifiedCell ReadIdentifiedFor(const std::filesystem::path& file, const CellConfig& cell);

/// Returns the file's text, with 10 significant digits. If ReadIdentified reads this text, its values differ
/// from the original ones by less than 1e-9, and WriteIdentified makes the same text of them.
/// @param comment  lines for the file's head, without "# "
/// @param law  the cell's law; absent: the file names no law and is valid for any law
[[nodiscard]] std::string WriteIdentified(const IdentifiedCell& identified, const std::string& comment,
                                          std::optional<control::Law> law = {});

}  // namespace osteon::config
