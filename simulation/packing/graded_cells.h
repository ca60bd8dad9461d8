#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/scramble.h"
#include "simulation/solids/cut_zone.h"

namespace osteon::simulation {

/// Fineness of a division of space into cells, which depends on the depth below the cut zone.
struct GradeParams {
  double finest_m{0.001};  ///< side of the finest cells
  /// Element k - 1 is the smallest depth of the centre of a cell with side finest·2^k. The depths ascend.
  std::vector<double> coarser_from_m;
};

/// @throws std::invalid_argument unless min <= finest <= max and the depths ascend, at most four of them.
void CheckGrade(const std::string& name, const GradeParams& grade, double min_m, double max_m);

/// A cube of a graded division of space. Its corners lie at multiples of its own side, so that the cells of
/// all levels fit together. So do the cells of two divisions whose finest sides differ by a power of two.
struct Cell {
  std::array<std::int32_t, 3> index{};  ///< coordinates of the lowest corner, in units of the side
  int level{0};                         ///< the side is finest·2^level
  double side_m{0.0};
  double signed_distance_m{0.0};  ///< of the centre

  [[nodiscard]] Vector3 min_corner() const { return side_m * Vector3(index[0], index[1], index[2]); }
  [[nodiscard]] Vector3 center() const { return min_corner() + Vector3::Constant(0.5 * side_m); }
  /// Half the diagonal. If the centre is farther than this from the surface, the whole cell lies on one side
  /// of the surface.
  [[nodiscard]] double reach_m() const { return 0.8660254037844387 * side_m; }
};

enum class CellChoice {
  kSolid,    ///< all cells that may hold a point of the solid
  kSurface,  ///< all cells that the surface may pass through
};

/// Divides the solid into cubes that grow with depth below the cut zone: an octree, descended depth first.
/// The cells and their order do not depend on the number of threads (0: one per core).
/// @throws std::invalid_argument if there would be more than 100 million cells.
[[nodiscard]] std::vector<Cell> DivideGraded(const Solid& solid, const CutZone& zone,
                                             const GradeParams& params, CellChoice wanted, int threads = 0);

/// Cubes, larger than those of the coarsest level, that together contain the solid: the roots from which a
/// descent starts.
[[nodiscard]] std::vector<Cell> GradedRoots(const Solid& solid, const GradeParams& params);

/// Random numbers for a cell. They depend only on the cell's place and level and on a salt, so they are equal
/// on every machine.
class CellRandom {
 public:
  CellRandom(const Cell& cell, std::uint64_t salt);
  [[nodiscard]] std::uint64_t NextBits();
  /// Uniform in [0, 1).
  [[nodiscard]] double Next() { return Uniform(NextBits()); }
  [[nodiscard]] Vector3 NextInUnitCube();

 private:
  std::uint64_t state_;
};

}  // namespace osteon::simulation
