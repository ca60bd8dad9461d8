#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"

namespace osteon::session {

/// Moves every connection of a cell to this machine, for a simulated cell: arm and PLC to the loopback
/// address, CAN buses to UDP tunnels.
/// @param first_port  replaces the file's ports by consecutive ones: arm, PLC, two for each CAN bus, then the
/// guard's if the cell has one
/// @returns an empty string, or the reason if too few ports follow first_port; then nothing is changed
[[nodiscard]] std::string UseSimulatedWires(config::CellConfig& cell,
                                            std::optional<std::uint16_t> first_port);

/// Calls UseSimulatedWires for a run that starts its cell itself. @param port  first port; 0: any free ports
/// @returns the first port to pass to the cell's process; 0 if the file's ports are kept.
[[nodiscard]] tl::expected<std::uint16_t, std::string> UseSimulated(config::CellConfig& cell,
                                                                    std::optional<std::uint16_t> port);

}  // namespace osteon::session
