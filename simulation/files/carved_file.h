#pragma once

#include <filesystem>
#include <string_view>

#include <tl/expected.hpp>

#include "base/file_error.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

// Files of carved states, for undo, save and resume.
//
//     byte   0   CarvedHeader   carved_file.cpp: magic, version, sizes, the bone's fingerprint, proxy,
//                               totals of the cut (volume, mass, work), CRCs
//     byte 392   balls          16 bytes each: x y z r [mm], float32
//                mass points    1 byte each: 1 if it is cleared; then zeros up to a multiple of 4
//                split balls    4 bytes each: index of the ball that is split
//                               4 bytes each: 0: it has children; 1 + n: it waits, with n capsules
//                               16 bytes per slot, as CarvedState says
//
// Little-endian. A file of another version is refused: states are short-lived, so there is no conversion.

namespace osteon::simulation {

/// The first bytes of a file with a carved state.
inline constexpr std::string_view kCarvedMagic{"OSTCARVE"};

/// Saves a state. The file appears complete or not at all. Its bytes depend on the arguments alone.
/// @param bone  the uncut bone of the state
/// @returns an error if the state belongs to another bone, or the system refuses to write.
[[nodiscard]] tl::expected<void, FileError> WriteCarvedState(const std::filesystem::path& path,
                                                             const CarvedState& state, const Bone& bone);

/// Reads a state and verifies sizes, checksums, the bone and every value. An engine with this bone and these
/// SplitParams can restore the result.
/// @returns an error naming the byte, what was found there and what is accepted.
[[nodiscard]] tl::expected<CarvedState, FileError> ReadCarvedState(const std::filesystem::path& path,
                                                                   const Bone& bone);

}  // namespace osteon::simulation
