#pragma once

#include <cstddef>

#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// The part of a ball-shaped head that is made of balls.
enum class ShellPart : std::uint8_t {
  kHemisphere,  ///< the front half, u_z >= 0 in T, as of a reamer
  kSphere,      ///< the whole sphere, as of a round burr
};

/// Replaces the single analytic ball of a tool's head by many equal balls. Each touches the head's sphere of
/// radius R from inside, in the direction u_i of a Fibonacci lattice. The balls that do not cut stay.
///
///     u_i = (sqrt(1 - z^2) cos(i g), sqrt(1 - z^2) sin(i g), z),   g = pi (3 - sqrt 5)
///     z_i = 1 - (i + 1/2) / count  (kHemisphere),   1 - (2 i + 1) / count  (kSphere)
///     r = min(R / 2, 3 d),   d the mean distance of the balls' feet on the sphere
///
/// The deepest dent of their outer surface is about 0.11 d: 0.21 mm with 1000 balls at R = 25 mm, 0.08 mm
/// with 10 000. Source of the lattice: Swinbank, Purser, Q. J. R. Meteorol. Soc. 132, 2006.
/// @param count  number of balls that cut, 1 … 100 000; 1: the tool stays unchanged
/// @throws std::invalid_argument if the tool does not have exactly one cutting ball, or the count is out of
///   range.
[[nodiscard]] Tool MakeShellTool(const Tool& tool, std::size_t count, ShellPart part);

}  // namespace osteon::simulation
