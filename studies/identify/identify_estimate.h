#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "studies/identify/identify_result.h"

namespace osteon::studies {

/// Fits one axis from samples: response by encoders, arm, and in free air tool and sensor; with a hand, the
/// hand. With an overlay the arm's own impedance; of a joint the response by its encoder alone.
/// @param tool_mass_kg  on the sensor's tool side, for a hand
/// @param overlaid  of an overlay: the arm that the force is laid over
/// @returns an error that says what is missing
[[nodiscard]] tl::expected<AxisResult, std::string> EstimateAxis(const ExcitedRun& run,
                                                                 const ExcitationRequest& request,
                                                                 double tool_mass_kg,
                                                                 const OverlaidArm* overlaid = nullptr);

/// Total lag from ticks that rendered, without excitation, by least squares of
///
///     (x_cmd - x_meas) = lag v_cmd + c F_hand
///
/// in the tool's three directions, where the tool moves. The interval follows from parts of 1 s.
/// @returns an error if there are fewer than 10 s of motion
[[nodiscard]] tl::expected<PassiveLag, std::string> EstimatePassiveLag(
    const std::vector<control::TickRecord>& ticks, double period_s);

/// Fits the hand of each held run again with what free runs say: whether the force sensor feels the tool's
/// inertia, and by how much the arm differs from a model without structure. By so much the handle may move
/// unlike the encoders.
void UseFreeRuns(IdentifyResult& result);

/// Computes for each held run the mass by which the hand's force moves the commanded arm, from the free run
/// of the same axis at the nearest speed, where a free run of the axis has a model that holds:
///
///     Y/U = P + C F/U,   C = 1 / (M (s^2 + 2 z w s + w^2)),   F the hand's force
///
/// by weighted least squares up to 30 Hz. Absent where the deflection does not stand out, as of a stiff arm.
void FillFeltMasses(IdentifyResult& result);

/// Hash of a file's bytes: FNV-1a, 16 hexadecimal digits.
[[nodiscard]] std::string HashOf(const std::filesystem::path& file);

/// Reads a recording and adds what it gives to the result, judged: an axis, a joint, noise, a tremor, or a
/// total lag. Bad data are findings in `result.refused`.
/// @returns an error if the file cannot be read
[[nodiscard]] tl::expected<void, std::string> AddRecording(const std::filesystem::path& file,
                                                           const config::CellConfig& cell,
                                                           IdentifyResult& result);

/// Adds all recordings of `fits`, then holds the fitted axes against those of `validations`, which have other
/// seeds. The next two files are read while one is estimated; the result is that of one after the other.
/// @returns an error if a file cannot be read, or a validation fits no axis of the result
[[nodiscard]] tl::expected<void, std::string> AddAll(std::span<const std::filesystem::path> fits,
                                                     std::span<const std::filesystem::path> validations,
                                                     const config::CellConfig& cell, IdentifyResult& result);

/// What a result says of its cell before anything is measured.
[[nodiscard]] IdentifyResult EmptyResult(const std::string& name, const config::CellConfig& cell);

}  // namespace osteon::studies
