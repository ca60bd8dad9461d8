#pragma once

#include <filesystem>

#include "config/reader.h"
#include "control/admittance_law.h"
#include "control/virtual_coupling.h"

// The gains of the loop, as a cell's file has them, and as a file of their own that is laid over it.

namespace osteon::config {

/// Every key of the cell's section `admittance`.
void ReadAdmittance(Reader section, control::AdmittanceParams& admittance);
/// Every key of the cell's section `coupling`.
void ReadCoupling(Reader section, control::CouplingParams& coupling);

/// Lays a file over gains that were read: sections `admittance` and `coupling`, each with any of the cell's
/// own keys but those of a model's age (coupling: fresh_ms, gone_ms, ramp_ms), in the same ranges. What it
/// does not say stays.
/// @throws ConfigError naming file, line, what was found and what is accepted.
void LayGainsOver(const std::filesystem::path& file, control::AdmittanceParams& admittance,
                  control::CouplingParams& coupling);

}  // namespace osteon::config
