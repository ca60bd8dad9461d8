#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/cell_config.h"

namespace osteon::app {

/// Puts every wire of a cell on this machine, as a simulated cell has them: arm and PLC on the loopback, CAN
/// through tunnels.
/// @param first_port  instead of the file's ports, from here on: arm, PLC, two for each CAN bus, then
/// the guard's where the cell has one
/// @returns an empty string, or why not: there are not so many ports behind it; then nothing is changed
[[nodiscard]] std::string UseSimulatedWires(config::CellConfig& cell,
                                            std::optional<std::uint16_t> first_port);

/// UseSimulatedWires for a run that starts its cell itself. @param port  0: any free ones
/// @returns what to tell the cell's process: 0 where the file's ports stand.
[[nodiscard]] tl::expected<std::uint16_t, std::string> UseSimulated(config::CellConfig& cell,
                                                                    std::optional<std::uint16_t> port);

}  // namespace osteon::app
