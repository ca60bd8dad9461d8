#pragma once

#include <filesystem>

#include <limits>

#include "config/reading/strict/reader.h"
#include "control/coupling/virtual_coupling.h"
#include "control/laws/admittance_law.h"
#include "control/laws/gains.h"
#include "control/setup/servo_params.h"

// The loop's gains, in a cell's file or in a file of their own that overrides it.

namespace osteon::config {

/// Reads every key of the cell's section `admittance`.
void ReadAdmittance(Reader section, control::AdmittanceParams& admittance);
/// Reads every key of the cell's section `coupling`.
void ReadCoupling(Reader section, control::CouplingParams& coupling);

/// Overrides gains by those of a file. Its sections `admittance` and `coupling` may have any keys of the same
/// sections of a cell's file, in the same ranges, except keys that are no gains (admittance: centre_m,
/// locked; coupling: fresh_ms, gone_ms, ramp_ms). Gains whose keys are absent stay unchanged.
/// @param law  of the cell: `admittance` is accepted only with that law
/// @param max_stiffness_N_per_m  largest value in the file
/// @throws ConfigError naming file, line, what was found and what is accepted.
void ApplyGainsFile(const std::filesystem::path& file, control::Law law,
                    control::AdmittanceParams& admittance, control::CouplingParams& coupling,
                    double max_stiffness_N_per_m = std::numeric_limits<double>::infinity());

/// Reads the gains file again and applies it to the cell's own gains. Returns the gains that a running loop
/// may change to.
/// @param own  the gains of the cell's own file
/// @param max_stiffness_N_per_m  coupling stiffness with which the run was started; no later gains may exceed
///   it
/// @throws ConfigError naming file, line, what was found and what is accepted.
[[nodiscard]] control::Gains ReadGainsAgain(const std::filesystem::path& file, control::Law law,
                                            const control::Gains& own, double max_stiffness_N_per_m);

}  // namespace osteon::config
