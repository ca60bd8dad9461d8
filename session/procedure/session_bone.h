#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "session/procedure/session_file.h"
#include "session/setup/cell_setup.h"
#include "simulation/bone/bone.h"

// The uncut bone of a session, as it was packed: FOLDER/bone.packed. An assessment reads this file instead of
// packing the bone again, which takes seconds. If the file is missing or damaged, the bone is packed again.

namespace osteon::session {

inline constexpr const char* kSessionBoneName = "bone.packed";

/// The result of packing a bone. The bone's materials and site are not included: they come from the scene.
struct PackedBone {
  std::vector<simulation::Ball> balls;
  std::vector<simulation::MassPoint> points;
};

/// Writes FOLDER/bone.packed with every bit of balls and mass points. The file appears complete or not at
/// all.
[[nodiscard]] tl::expected<void, std::string> WriteSessionBone(const std::filesystem::path& folder,
                                                               const simulation::Bone& bone);
/// Reads a saved state of a session. The error names the file, if it cannot be read or does not have the hash
/// that session.json states.
/// @param name  the state's file (SessionPass::state)
[[nodiscard]] tl::expected<simulation::CarvedState, std::string> ReadSessionState(
    const std::filesystem::path& folder, const SessionFile& session, const std::string& name,
    const simulation::Bone& bone);

/// Reads FOLDER/bone.packed. Nothing if there is no such file, or its sizes or checksum are wrong.
[[nodiscard]] std::optional<PackedBone> ReadSessionBone(const std::filesystem::path& folder);

/// Finds the mesh that replaced the cell's bone in a session, with the plan's cup; nothing: the bone was the
/// cell's. The error names the file. @param recording a recording in the session's folder
[[nodiscard]] tl::expected<std::optional<MeshChoice>, std::string> MeshOfSession(
    const std::filesystem::path& recording);

/// Makes the cell of a session's recording, with the bone from the session's bone.packed. If that file is
/// missing, the bone is packed again as the session packed it. The error names the file.
[[nodiscard]] tl::expected<CellSetup, std::string> SetUpSessionCell(const std::filesystem::path& recording);

}  // namespace osteon::session
