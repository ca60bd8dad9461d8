#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// Estimates one axis from samples. For an axis of the tool: the frequency response by the encoders, and the
/// arm's model; in free air also the tool on the sensor, with a hand also the hand, with an overlay also the
/// arm's own impedance. For a joint: only the frequency response by its encoder.
/// @param tool_mass_kg  mass on the sensor's tool side, needed for a hand
/// @param overlaid      needed for an overlay: the arm on which the force acted
/// @returns an error that says what is missing
[[nodiscard]] tl::expected<AxisResult, std::string> EstimateAxis(const ExcitedRun& run,
                                                                 const ExcitationRequest& request,
                                                                 double tool_mass_kg,
                                                                 const OverlaidArm* overlaid = nullptr);

/// Estimates the total lag from rendering ticks without excitation, by least squares of
///
///     (x_cmd - x_meas) = lag v_cmd + c F_hand
///
/// in the tool's three directions, over the ticks in which the tool moves; v_cmd is the commanded velocity, c
/// the arm's compliance. The interval follows from the scatter over parts of 1 s.
/// @returns an error if there are fewer than 10 s of motion
[[nodiscard]] tl::expected<PassiveLag, std::string> EstimatePassiveLag(
    const std::vector<control::TickRecord>& ticks, double period_s);

/// Fits the hand again for each run with a hand (held run), with two results of the runs in free air (free
/// runs). The first is whether the force sensor measures the tool's inertia. The second is by how much the
/// arm's response differs from its model: the handle's motion may differ from the encoders' as much, which
/// limits the accuracy of the hand's fit.
void UseFreeRuns(IdentifyResult& result);

/// Computes for each held run the effective mass M of the commanded arm for the hand's force F. It uses the
/// free run of the same axis at the nearest speed, if that run's model holds:
///
///     Y/U = P + C F/U,   C = 1 / (M (s^2 + 2 z w s + w^2))
///
/// with the held run's response Y/U from command to position, the free run's response P, and the natural
/// frequency w and damping ratio z of the free run's model. The fit is by weighted least squares up to 30 Hz.
/// A held run gets no mass if the deflection due to the hand does not stand out of the noise, as with a stiff
/// arm.
void FillFeltMasses(IdentifyResult& result);

/// Hash of a file's bytes: FNV-1a, 16 hexadecimal digits.
[[nodiscard]] std::string HashOf(const std::filesystem::path& file);

/// Reads a recording, judges it, and adds the estimates from it to the result: an axis, a joint, noise, a
/// tremor, or a total lag. Bad data become findings in `result.refused`.
/// @returns an error if the file cannot be read
[[nodiscard]] tl::expected<void, std::string> AddRecording(const std::filesystem::path& file,
                                                           const config::CellConfig& cell,
                                                           IdentifyResult& result);

/// Adds all recordings of `fits`, then tests the fitted axes on the recordings `validations`, which have
/// other seeds. The next two files are read while one is estimated; the result does not depend on this.
/// @returns an error if a file cannot be read, or a validation recording belongs to no fitted axis
[[nodiscard]] tl::expected<void, std::string> AddAll(std::span<const std::filesystem::path> fits,
                                                     std::span<const std::filesystem::path> validations,
                                                     const config::CellConfig& cell, IdentifyResult& result);

/// Returns a result that holds only the cell's own data: nothing is measured yet.
[[nodiscard]] IdentifyResult EmptyResult(const std::string& name, const config::CellConfig& cell);

}  // namespace osteon::studies
