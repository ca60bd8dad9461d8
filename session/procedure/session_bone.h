#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "session/procedure/session_file.h"
#include "session/setup/cell_setup.h"
#include "simulation/bone/bone.h"

// The uncut bone of a session, as it was packed: FOLDER/bone.packed. An assessment reads it instead of
// packing the bone again, which takes seconds. Without the file, or with a damaged one, it packs.

namespace osteon::session {

inline constexpr const char* kSessionBoneName = "bone.packed";

/// What packing makes; materials and site come from the scene.
struct PackedBone {
  std::vector<simulation::Ball> balls;
  std::vector<simulation::MassPoint> points;
};

/// Writes FOLDER/bone.packed with every bit of balls and mass points. It appears whole or not at all.
[[nodiscard]] tl::expected<void, std::string> WriteSessionBone(const std::filesystem::path& folder,
                                                               const simulation::Bone& bone);
/// Reads a saved state of a session. The error names the file: it cannot be read, or it is not the state that
/// session.json says (its hash).
/// @param name  of a pass's state
[[nodiscard]] tl::expected<simulation::CarvedState, std::string> ReadSessionState(
    const std::filesystem::path& folder, const SessionFile& session, const std::string& name,
    const simulation::Bone& bone);

/// Nothing where there is no such file, or it is not whole (sizes, checksum).
[[nodiscard]] std::optional<PackedBone> ReadSessionBone(const std::filesystem::path& folder);

/// The mesh that took the place of the cell's bone, with the plan's cup; nothing: none did. The error names
/// the file. @param recording  of the session, in its folder
[[nodiscard]] tl::expected<std::optional<MeshChoice>, std::string> MeshOfSession(
    const std::filesystem::path& recording);

/// The cell of a session's recording, with the bone that the session has kept; without one, the bone is
/// packed again, as the session did. The error names the file.
[[nodiscard]] tl::expected<CellSetup, std::string> SetUpSessionCell(const std::filesystem::path& recording);

}  // namespace osteon::session
