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

/// Triangles over shared vertices; counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Reason why a mesh was refused.
enum class MeshErrorKind : std::uint8_t {
  kMissing,           ///< no such file
  kFormat,            ///< not one of the formats read
  kUnreadable,        ///< damaged: the message names the line or byte
  kEmpty,             ///< no triangles
  kNotFinite,         ///< a coordinate is NaN, infinite or absurdly large
  kOpen,              ///< an edge with one triangle
  kNonManifold,       ///< an edge with three or more triangles, or two sheets that meet in a vertex only
  kOrientation,       ///< neighbouring triangles wound in contrary senses
  kNoVolume,          ///< encloses nothing
  kTooLarge,          ///< further than 10 m away, or wider than 1 m: hardly in millimetres
  kContradictory,     ///< a solid within a solid, or a cavity outside any solid
  kSelfIntersecting,  ///< the surface passes through itself
  kCupOffMesh,        ///< the given cup is not at a cup of the bone
};

/// Refusal of a mesh.
struct MeshError {
  MeshErrorKind kind{};
  std::string message;  ///< file, where, what was found, what is accepted
};

/// Meaning of a closed shell.
enum class ShellKind : std::uint8_t {
  kSolid,   ///< outer boundary of the solid
  kCavity,  ///< hole in the solid: wound inwards
  kRegion,  ///< another tissue within the solid: wound outwards, like the shell around it
};

/// A closed shell of a file.
struct MeshShell {
  std::string name;  ///< of the group, object or solid in the file
  std::size_t triangles{0};
  double volume_m3{0.0};              ///< enclosed, including shells inside it
  std::optional<std::size_t> parent;  ///< index of the shell around it
  ShellKind kind{ShellKind::kSolid};
};

/// Defects of a file that bounds no solid, and how RemakeMesh made a solid of it.
struct MeshRemake {
  std::size_t open_edges{0};      ///< with one triangle
  std::size_t crowded_edges{0};   ///< with three triangles or more
  std::size_t contrary_edges{0};  ///< between triangles wound in contrary senses
  std::size_t crossings{0};       ///< edges that pass through a triangle
  std::size_t shells{0};          ///< groups of triangles joined by edges of two
  std::size_t turned_shells{0};   ///< that were inside out
  std::size_t dropped_shells{0};  ///< of the remade surface, too small beside the others
  double step_m{0.0};             ///< of the grid on which the surface was remade
  double volume_m3{0.0};
};

/// "found 3 open edges, …".
[[nodiscard]] std::string DescribeDefects(const MeshRemake& remake);
/// The defects and what was assumed, for a warning.
[[nodiscard]] std::string DescribeRemake(const MeshRemake& remake);

/// Changes that loading made to the file's triangles.
struct MeshReport {
  std::size_t dropped_triangles{0};    ///< triangles with two corners in one place
  std::size_t duplicate_triangles{0};  ///< further triangles of the same three corners, dropped
  std::size_t welded_vertices{0};      ///< on the two sides of a slit, within the tolerance
  bool flipped{false};                 ///< the whole mesh was inside out, and was turned over
  std::vector<MeshShell> shells;       ///< in the order of their first triangles
  std::optional<MeshRemake> remake;    ///< the surface is not the file's, but remade
};

/// A closed shell inside the solid that separates tissues and bounds no solid.
struct MeshRegion {
  std::string name;
  TriangleMesh mesh;                  ///< its shell, and the cavities within it
  std::optional<std::size_t> parent;  ///< region around it; none: the solid itself
};

/// Result of reading a mesh file.
struct LoadedMesh {
  TriangleMesh mesh;                ///< boundary of the solid: outer shells and cavities
  std::vector<MeshRegion> regions;  ///< outer regions before those inside them
  MeshReport report;
};

/// Parameters for reading a mesh file.
struct MeshParams {
  double scale{1.0};              ///< millimetres to a unit of the file; 1e-6 … 1e6
  double weld_tolerance_m{1e-6};  ///< largest distance of a slit's two sides; 0 … 0.1 mm
  /// Makes a solid of a mesh that bounds none (RemakeMesh), where the other steps refuse it.
  bool remake{false};
  double remake_grid_points{6e6};  ///< largest number of points of the remade surface's grid
};

/// Reads one or more closed shells from an STL, OBJ or PLY file, with the reader of its format (mesh_file.h)
/// and CheckMesh's conditions.
///
/// Vertices at exactly the same place are welded within each group of the file, since STL has no shared
/// vertices. Touching shells with different names therefore stay apart. Where this closes the mesh, nothing
/// more is welded. Where edges are open, their ends are welded with those of other groups at exactly the same
/// place and, if that is not enough, with those within the tolerance. Triangles that lose a corner, and
/// copies of triangles, are dropped. The report counts all changes. T-junctions stay open.
///
/// A mesh that is still no solid is refused, or remade as one where the parameters ask for that.
///
/// A shell inside another is a cavity where it is wound inwards. Wound outwards it is a region: it bounds no
/// solid, but contains another tissue. Regions may lie in regions.
/// @returns the mesh, or the refusal with the line or byte of the file, or the place in mm and the triangle
///   (counted from 0 in the file's order, without those dropped).
/// @throws std::invalid_argument where the parameters are out of range.
[[nodiscard]] tl::expected<LoadedMesh, MeshError> LoadMesh(const std::filesystem::path& path,
                                                           const MeshParams& params = {});

/// Checks that the triangles bound a solid without contradiction; messages call the file `name`.
///
/// Each edge joins exactly two triangles of the same winding. Vertices are finite, within 10 m, and within 1
/// m of each other. Shells nest solid, cavity, solid; cavities are wound inwards (regions are for LoadMesh).
/// No edge pierces another triangle by more than 0.01 mm: real meshes touch themselves by rounding, and less
/// than this shifts the surface by less. A mesh that is inside out as a whole has its triangles flipped,
/// since only one reading makes sense.
[[nodiscard]] tl::expected<MeshReport, MeshError> CheckMesh(TriangleMesh& mesh, const std::string& name);

/// Enclosed volume; negative where the mesh is inside out.
[[nodiscard]] double SignedVolume_m3(const TriangleMesh& mesh);

}  // namespace osteon::simulation
