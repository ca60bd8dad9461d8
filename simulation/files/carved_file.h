#pragma once

#include <filesystem>
#include <string_view>

#include <tl/expected.hpp>

#include "base/file_error.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"

// Carved states on disk: undo, save, resume.
//
//     byte   0   CarvedHeader   carved_file.cpp: magic, version, sizes, the bone's fingerprint, proxy,
//                               totals of the cut (volume, mass, work), CRCs
//     byte 392   balls          16 bytes each: x y z r [mm], float32
//                mass points    1 byte each: 1 where it is gone; then zeros up to a multiple of 4
//                split balls    4 bytes each: which ball
//                               4 bytes each: 0 children, 1 + n waits with n capsules
//                               16 bytes per slot, as CarvedState says
//
// Little-endian. Versions are not converted: a state is short-lived, a bone is not.

namespace osteon::simulation {

/// The first bytes of a file with a carved state.
inline constexpr std::string_view kCarvedMagic{"OSTCARVE"};

/// Saves a state. The file appears whole or not at all; its bytes depend on the arguments alone.
/// @param bone  the uncut bone of the state
/// @returns an error where the state belongs to another bone, or the system refuses to write.
[[nodiscard]] tl::expected<void, FileError> WriteCarvedState(const std::filesystem::path& path,
                                                             const CarvedState& state, const Bone& bone);

/// Reads a state and verifies everything: sizes, checksums, the bone, every value. An engine of this bone and
/// these SplitParams can restore the result.
/// @returns an error naming the byte, what was found there and what is accepted.
[[nodiscard]] tl::expected<CarvedState, FileError> ReadCarvedState(const std::filesystem::path& path,
                                                                   const Bone& bone);

}  // namespace osteon::simulation
