#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// Triangles with shared vertices. Corners run counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Reason why a mesh was refused.
enum class MeshErrorKind : std::uint8_t {
  kMissing,      ///< no such file
  kFormat,       ///< not one of the formats that can be read
  kUnreadable,   ///< damaged: the message names the line or byte
  kEmpty,        ///< no triangles
  kNotFinite,    ///< a coordinate is NaN, infinite or absurdly large
  kOpen,         ///< an edge with one triangle
  kNonManifold,  ///< an edge with three or more triangles, or two sheets that meet in a vertex only
  kOrientation,  ///< neighbouring triangles have opposite winding
  kNoVolume,     ///< the mesh or a shell encloses no volume
  kTooLarge,     ///< farther than 10 m away or wider than 1 m: the file's unit is probably not the millimetre
  kContradictory,     ///< a solid within a solid, or a cavity outside any solid
  kSelfIntersecting,  ///< the surface passes through itself
  kCupOffMesh,        ///< at the given cup's place the bone has no cup
};

/// Refusal of a mesh.
struct MeshError {
  MeshErrorKind kind{};
  std::string message;  ///< names the file, the place, what was found and what is accepted
};

/// Role of a closed shell.
enum class ShellKind : std::uint8_t {
  kSolid,   ///< outer boundary of the solid
  kCavity,  ///< hole in the solid: wound inwards
  kRegion,  ///< boundary of another tissue within the solid: wound outwards, as is the shell around it
};

/// A closed shell of a file.
struct MeshShell {
  std::string name;  ///< name of the group, object or solid in the file
  std::size_t triangles{0};
  double volume_m3{0.0};              ///< enclosed volume, including the shells inside
  std::optional<std::size_t> parent;  ///< index of the shell around it
  ShellKind kind{ShellKind::kSolid};
};

/// Defects of a file that bounds no solid, and how RemakeMesh made a solid of it.
struct MeshRemake {
  std::size_t open_edges{0};      ///< edges with one triangle
  std::size_t crowded_edges{0};   ///< edges with three triangles or more
  std::size_t contrary_edges{0};  ///< edges between triangles of opposite winding
  std::size_t crossings{0};       ///< edges that pass through a triangle
  std::size_t shells{0};          ///< groups of triangles that are joined by edges with two triangles
  std::size_t turned_shells{0};   ///< shells that were inside out and were turned
  std::size_t dropped_shells{0};  ///< shells of the remade surface that were dropped: the smallest beyond 64
  double step_m{0.0};             ///< step of the grid on which the surface was remade
  double volume_m3{0.0};
};

/// Text that lists the defects: "found 3 open edges, …".
[[nodiscard]] std::string DescribeDefects(const MeshRemake& remake);
/// Text for a warning: the defects, and what was assumed to repair them.
[[nodiscard]] std::string DescribeRemake(const MeshRemake& remake);

/// Changes that loading made to the file's triangles.
struct MeshReport {
  std::size_t dropped_triangles{0};  ///< triangles with two corners in one place
  /// Copies of triangles that were dropped: same part, same three corners
  std::size_t duplicate_triangles{0};
  /// Vertices welded because they lay within the tolerance on the two sides of a slit
  std::size_t welded_vertices{0};
  bool flipped{false};               ///< the whole mesh was inside out, and was turned over
  std::vector<MeshShell> shells;     ///< in the order of their first triangles
  std::optional<MeshRemake> remake;  ///< if it has a value, the surface was remade from the file's
};

/// A closed shell inside the solid that separates tissues and bounds no solid.
struct MeshRegion {
  std::string name;
  TriangleMesh mesh;                  ///< the region's shell, and the cavities inside
  std::optional<std::size_t> parent;  ///< index of the region around this one; empty: the solid itself
};

/// Result of reading a mesh file.
struct LoadedMesh {
  TriangleMesh mesh;                ///< boundary of the solid: outer shells and cavities
  std::vector<MeshRegion> regions;  ///< a region comes before the regions inside it
  MeshReport report;
};

/// Parameters for reading a mesh file.
struct MeshParams {
  double scale{1.0};              ///< millimetres per unit of the file; 1e-6 … 1e6
  double weld_tolerance_m{1e-6};  ///< largest width of a slit that is closed by welding; 0 … 0.1 mm
  /// true: if the other steps refuse a mesh because it bounds no solid, make a solid of it (RemakeMesh)
  bool remake{false};
  double remake_grid_points{6e6};  ///< largest number of points of the remade surface's grid
};

/// Reads one or more closed shells from an STL, OBJ or PLY file, with the reader of its format (mesh_file.h)
/// and CheckMesh's conditions.
///
/// First, vertices of one group that lie at exactly the same place are welded, since STL has no shared
/// vertices. Touching shells with different names therefore stay separate. If the mesh is closed then,
/// nothing more is welded. Otherwise the ends of its open edges are welded with ends in other groups: first
/// those at exactly the same place and, if edges are still open, those within the tolerance. Triangles that
/// lose a corner and copies of triangles are dropped. The report counts all changes. T-junctions stay open.
///
/// A mesh that does not bound a solid after this is remade as a solid if MeshParams::remake is true,
/// otherwise refused.
///
/// A shell inside another one is a cavity if it is wound inwards. If it is wound outwards, it is a region: it
/// contains another tissue of the same solid. Regions may lie in regions.
/// @returns the mesh, or an error. The error names the line or byte of the file, or the place in mm and the
///   triangle, counted from 0 in the file's order without the dropped triangles.
/// @throws std::invalid_argument if a parameter is out of range.
[[nodiscard]] tl::expected<LoadedMesh, MeshError> LoadMesh(const std::filesystem::path& path,
                                                           const MeshParams& params = {});

/// Checks that the triangles bound a solid. Error messages call the file `name`.
///
/// Each edge joins exactly two triangles of the same winding. Vertices are finite, at most 10 m from the
/// origin, and in a box of at most 1 m. Seen from outside inwards, shells are in turn solids and cavities;
/// cavities are wound inwards. Regions are refused here; LoadMesh accepts them. No edge pierces another
/// triangle by more than 0.01 mm: rounding makes real meshes pierce themselves slightly, and a smaller
/// crossing is an error of the surface below 0.01 mm. If the whole mesh is inside out, its triangles are
/// flipped.
[[nodiscard]] tl::expected<MeshReport, MeshError> CheckMesh(TriangleMesh& mesh, const std::string& name);

/// Enclosed volume; negative if the mesh is inside out.
[[nodiscard]] double SignedVolume_m3(const TriangleMesh& mesh);

}  // namespace osteon::simulation
