#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "session/setup/cell_setup.h"
#include "simulation/surface/surface_export.h"

namespace osteon::session {

/// A carved bone that was written as a mesh.
struct WrittenSurface {
  std::filesystem::path file;
  surface::SurfaceFigures figures{};
  double voxel_mm{0.0};
  double time_s{0.0};  ///< time of the last carved frame, since the recording's start; 0: no frame was carved
  /// The surface is that of the bone's balls, since the solid from which they were packed is not known
  /// (.osp).
  bool from_balls{false};
};

/// Carves the bone's solid along the frames of a recording, and writes its surface. Frames give the proxy's
/// path, ticks the times in which the spindle turned. For a recording of a session, the solid is carved along
/// all passes of the session up to that time that were not undone.
/// @param setup  the cell of the recording: bone, solid, tool and X_WG
/// @param at_s   up to this time since the recording's start; none: to its end
/// @param drop_below_mm3  smaller loose pieces are left out; 0: none is left out
/// The error names the file and what is wrong.
[[nodiscard]] tl::expected<WrittenSurface, std::string> WriteRecordedSurface(
    const std::filesystem::path& recording, const CellSetup& setup, std::optional<double> at_s,
    const std::filesystem::path& file, double drop_below_mm3 = 0.0);

/// Makes the cell of a recording, with its bone, from the recording alone. A bone from a file is not in a
/// recording: `mesh` gives it.
/// The error says what the recording lacks.
[[nodiscard]] tl::expected<CellSetup, std::string> PrepareRecordedCell(const io::SessionInfo& session,
                                                                       const std::optional<MeshChoice>& mesh);

/// Checks a surface's file before anything runs. @returns what is wrong; empty: nothing
[[nodiscard]] std::string ValidateSurfaceFile(const std::filesystem::path& file);

/// Makes the JSON object {file, triangles, volume_mm3, watertight, voxel_mm, time_s, from_balls, pieces,
/// dropped_pieces, dropped_mm3}
[[nodiscard]] nlohmann::ordered_json SurfaceJson(const WrittenSurface& surface);
/// Makes a line of text: file, number of triangles, volume.
[[nodiscard]] std::string SurfaceText(const WrittenSurface& surface);

}  // namespace osteon::session
