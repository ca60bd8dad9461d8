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

/// Why a mesh was refused.
enum class MeshErrorKind : std::uint8_t {
  kMissing,           ///< no such file
  kFormat,            ///< not one of the formats read
  kUnreadable,        ///< damaged: the message names the line or byte
  kEmpty,             ///< no triangles
  kNotFinite,         ///< a coordinate is NaN, infinite or absurdly large
  kOpen,              ///< an edge with one triangle
  kNonManifold,       ///< an edge with three or more triangles, or two sheets that meet in a vertex only
  kOrientation,       ///< neighbouring triangles that face opposite ways
  kNoVolume,          ///< encloses nothing
  kTooLarge,          ///< further than 10 m away, or wider than 1 m: hardly in millimetres
  kContradictory,     ///< shells that are solid twice over, or hollow in the void
  kSelfIntersecting,  ///< the surface passes through itself
  kCupOffMesh,        ///< the cup named is not where the bone has one
};

struct MeshError {
  MeshErrorKind kind{};
  std::string message;  ///< file, where, what was found, what is accepted
};

/// What a closed shell does.
enum class ShellKind : std::uint8_t {
  kSolid,   ///< bounds solid from outside
  kCavity,  ///< a hole in it: wound inwards
  kRegion,  ///< another tissue within the solid: wound outwards, like what is around it
};

struct MeshShell {
  std::string name;  ///< of the group, object or solid in the file
  std::size_t triangles{0};
  double volume_m3{0.0};              ///< enclosed, without what lies in it taken away
  std::optional<std::size_t> parent;  ///< place of the shell around it
  ShellKind kind{ShellKind::kSolid};
};

/// What loading did to the file's triangles.
struct MeshReport {
  std::size_t dropped_triangles{0};    ///< with two corners in one place
  std::size_t duplicate_triangles{0};  ///< a second time the same three corners, dropped
  std::size_t welded_vertices{0};      ///< on the two sides of a slit, within the tolerance
  bool flipped{false};                 ///< the whole mesh was inside out
  std::vector<MeshShell> shells;       ///< in the order of their first triangles
};

/// A closed shell inside the solid that tells one tissue from another and bounds nothing.
struct MeshRegion {
  std::string name;
  TriangleMesh mesh;                  ///< its shell, and the cavities within it
  std::optional<std::size_t> parent;  ///< the region it lies in; none: the solid itself
};

struct LoadedMesh {
  TriangleMesh mesh;                ///< what bounds the solid: outer shells and cavities
  std::vector<MeshRegion> regions;  ///< outer ones before those inside them
  MeshReport report;
};

/// How a mesh file is read.
struct MeshParams {
  double scale{1.0};              ///< millimetres to a unit of the file; 1e-6 … 1e6
  double weld_tolerance_m{1e-6};  ///< 0 … 0.1 mm: how far apart the two sides of a slit may lie
};

/// Reads one or more closed shells from an STL, OBJ or PLY file, by the one reader of its format
/// (mesh_file.h), with CheckMesh's conditions.
///
/// Vertices at exactly the same place are welded (STL has no others) within each group of the file, so that
/// shells that touch stay apart where they have names of their own. What is closed then is left as it is.
/// Where edges are open, their ends are welded with those of other groups at exactly the same place, and, if
/// that is not enough, with those within the tolerance. Triangles that lose a corner by this, and copies of
/// triangles, are dropped. All of it is counted in the report. T-junctions stay open.
///
/// A shell inside another is a cavity where it is wound inwards. Wound outwards it is a region: it bounds
/// nothing, but what is in it is another tissue. Regions may lie in regions.
/// @returns or the refusal, with the line or byte of the file, or the place in mm and the triangle (counted
///   from 0 in the file's order, without those dropped).
/// @throws std::invalid_argument where the parameters are out of range.
[[nodiscard]] tl::expected<LoadedMesh, MeshError> LoadMesh(const std::filesystem::path& path,
                                                           const MeshParams& params = {});

/// Whether the triangles bound a solid without contradiction; `name` stands for the file in messages.
///
/// Each edge joins exactly two triangles, wound alike; vertices are finite, within 10 m, and within 1 m of
/// each other; shells nest solid, cavity, solid (cavities are wound inwards; regions are for LoadMesh); no
/// edge pierces another triangle by more than 0.01 mm (real meshes touch themselves by rounding: less is let
/// pass, and shifts the surface by less than that). A mesh that is inside out as a whole has its triangles
/// flipped, since only one reading makes sense.
[[nodiscard]] tl::expected<MeshReport, MeshError> CheckMesh(TriangleMesh& mesh, const std::string& name);

/// Enclosed volume; negative where the mesh is inside out.
[[nodiscard]] double SignedVolume_m3(const TriangleMesh& mesh);

}  // namespace osteon::simulation
