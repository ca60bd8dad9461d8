#pragma once

#include <cstddef>

#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// The part of a ball-shaped head that is made of balls.
enum class ShellPart : std::uint8_t {
  kHemisphere,  ///< the half ahead, u_z >= 0 in T: a reamer's
  kSphere,      ///< the whole sphere: a round burr's
};

/// Replaces a tool's one analytic head by a packing: equal balls along a Fibonacci lattice whose outer hull
/// is the head's sphere, each touching it from inside. The balls that do not cut stay.
///
///     u_i = (sqrt(1 - z^2) cos(i g), sqrt(1 - z^2) sin(i g), z),   g = pi (3 - sqrt 5)
///     z_i = 1 - (i + 1/2) / count  (kHemisphere),   1 - (2 i + 1) / count  (kSphere)
///     r = min(R / 2, 3 d),   d the mean distance of the balls' feet on the sphere
///
/// The hull's deepest dent is about 0.11 d: 0.21 mm with 1000 balls at R = 25 mm, 0.08 mm with 10 000. Source
/// of the lattice: Swinbank, Purser, Q. J. R. Meteorol. Soc. 132, 2006.
/// @param count  of the balls that cut, 1 … 100 000; 1: the tool stays unchanged
/// @throws std::invalid_argument where the tool does not have exactly one cutting ball, or the count is out
///   of range.
[[nodiscard]] Tool MakeShellTool(const Tool& tool, std::size_t count, ShellPart part);

}  // namespace osteon::simulation
