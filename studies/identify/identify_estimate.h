#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// Estimates one axis from samples: the response by the encoders and the arm; in free air also tool and
/// sensor; with a hand also the hand; with an overlay the arm's own impedance. For a joint, only the response
/// by its encoder.
/// @param tool_mass_kg  mass on the sensor's tool side, needed for a hand
/// @param overlaid  needed for an overlay: the arm that the force is laid over
/// @returns an error that says what is missing
[[nodiscard]] tl::expected<AxisResult, std::string> EstimateAxis(const ExcitedRun& run,
                                                                 const ExcitationRequest& request,
                                                                 double tool_mass_kg,
                                                                 const OverlaidArm* overlaid = nullptr);

/// Estimates the total lag from rendering ticks without excitation, by least squares of
///
///     (x_cmd - x_meas) = lag v_cmd + c F_hand
///
/// in the tool's three directions, where the tool moves. The interval follows from parts of 1 s.
/// @returns an error if there are fewer than 10 s of motion
[[nodiscard]] tl::expected<PassiveLag, std::string> EstimatePassiveLag(
    const std::vector<control::TickRecord>& ticks, double period_s);

/// Fits the hand of each held run again with two results of the free runs: whether the force sensor feels the
/// tool's inertia, and by how much the arm differs from a model without structure. The handle's motion may
/// differ from the encoders' by the same amount.
void UseFreeRuns(IdentifyResult& result);

/// Computes for each held run the mass by which the hand's force moves the commanded arm, from the free run
/// of the same axis at the nearest speed, where a free run of the axis has a model that holds:
///
///     Y/U = P + C F/U,   C = 1 / (M (s^2 + 2 z w s + w^2)),   F the hand's force
///
/// by weighted least squares up to 30 Hz. A run has no such mass if the deflection does not stand out of the
/// noise, as with a stiff arm.
void FillFeltMasses(IdentifyResult& result);

/// Hash of a file's bytes: FNV-1a, 16 hexadecimal digits.
[[nodiscard]] std::string HashOf(const std::filesystem::path& file);

/// Reads a recording, judges it, and adds what was estimated from it to the result: an axis, a joint, noise,
/// a tremor, or a total lag. Bad data become findings in `result.refused`.
/// @returns an error if the file cannot be read
[[nodiscard]] tl::expected<void, std::string> AddRecording(const std::filesystem::path& file,
                                                           const config::CellConfig& cell,
                                                           IdentifyResult& result);

/// Adds all recordings of `fits`, then compares the fitted axes with the recordings `validations`, which have
/// other seeds. The next two files are read while one is estimated; the result does not depend on this.
/// @returns an error if a file cannot be read, or a validation fits no axis of the result
[[nodiscard]] tl::expected<void, std::string> AddAll(std::span<const std::filesystem::path> fits,
                                                     std::span<const std::filesystem::path> validations,
                                                     const config::CellConfig& cell, IdentifyResult& result);

/// Returns a result that holds only the cell's own data: nothing is measured yet.
[[nodiscard]] IdentifyResult EmptyResult(const std::string& name, const config::CellConfig& cell);

}  // namespace osteon::studies
