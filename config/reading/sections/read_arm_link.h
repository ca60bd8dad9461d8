#pragma once

#include <array>
#include <optional>
#include <string>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Sections and values of the file that CheckArmLink needs.
struct ArmLinkSections {
  Reader link;                      ///< `fri` or `rsi`
  std::optional<Reader> quality{};  ///< `link_quality`, beside fri
  bool jump_accepted{false};        ///< value of accept_jump_after_lost_answers in `rsi`
};

/// Reads either section `fri` together with `link_quality`, or section `rsi`. The values are for both ends of
/// the connection to the arm.
///
///     fri: {host, port, period_ms, [arm_host], [version], [wrench_torques], [receive_multiplier_count]}
///     rsi: {host, port, [arm_host], layout, correction, absolute, hold_on, cycle_ms, ipoc_step_count,
///           timeout_count,
///           range_deg: [A1 … A6], or of cartesian corrections range_mm: [X, Y, Z] and range_deg: [A, B, C],
///           [entry_step_deg], [settle_count], [late_at_start_count], [decimal_count],
///           [accept_jump_after_lost_answers]}
///
/// Absolute corrections without hold_on are refused unless accept_jump_after_lost_answers is true, because
/// the arm would jump after a lost answer. An address other than the loopback's is refused without arm_host.
/// Absent keys keep the libraries' defaults.
///
/// Sets in `cell`: link, servo.period_s, and for the simulated arm simulated.fri or simulated.kr.
[[nodiscard]] ArmLinkSections ReadArmLink(Reader& cell_section, CellConfig& cell);

/// Checks the link's values against each other. Call after Finish(), with the simulated arm read.
void CheckArmLink(const ArmLinkSections& sections, const CellConfig& cell);

/// Call after the robot is read. Refuses an LBR without `fri`, and an arm of six axes without `rsi`. Gives
/// both ends of RSI the arm's geometry.
void CompleteArmLink(const Reader& cell_section, CellConfig& cell);

/// Reads the bounds of corrections: key NAME_deg with six numbers, or for Cartesian corrections NAME_mm and
/// NAME_deg with three numbers each. Each bound holds in both directions. @returns the bounds in RSI's units,
/// mm and deg
[[nodiscard]] std::array<double, 6> ReadCorrectionRange(Reader& section, const std::string& name,
                                                        io::RsiCorrection kind);

}  // namespace osteon::config
