#pragma once

#include <filesystem>

#include <limits>

#include "config/reader.h"
#include "control/admittance_law.h"
#include "control/gains.h"
#include "control/servo_params.h"
#include "control/virtual_coupling.h"

// The gains of the loop, as a cell's file has them, and as a file of their own that is laid over it.

namespace osteon::config {

/// Every key of the cell's section `admittance`.
void ReadAdmittance(Reader section, control::AdmittanceParams& admittance);
/// Every key of the cell's section `coupling`.
void ReadCoupling(Reader section, control::CouplingParams& coupling);

/// Lays a file over gains that were read: sections `admittance` and `coupling`, each with any of the cell's
/// own keys but those that are no gains (admittance: centre_m, locked; coupling: fresh_ms, gone_ms, ramp_ms),
/// in the same ranges. What it does not say stays.
/// @param law  of the cell: `admittance` is accepted where it has that law
/// @param most_stiffness_N_per_m  that the file may ask for
/// @throws ConfigError naming file, line, what was found and what is accepted.
void LayGainsOver(const std::filesystem::path& file, control::Law law, control::AdmittanceParams& admittance,
                  control::CouplingParams& coupling,
                  double most_stiffness_N_per_m = std::numeric_limits<double>::infinity());

/// The gains of a cell with a file laid over them, read anew: what the loop may change to while it runs.
/// @param own  of the cell's own file  @param most_stiffness_N_per_m  that the simulation was started with
/// @throws ConfigError naming file, line, what was found and what is accepted.
[[nodiscard]] control::Gains ReadGainsAgain(const std::filesystem::path& file, control::Law law,
                                            const control::Gains& own, double most_stiffness_N_per_m);

}  // namespace osteon::config
