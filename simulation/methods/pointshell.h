#pragma once

#include <vector>

#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// A tool's surface as points with inward normals, in T. The points are sorted along a Morton curve and
/// divided into runs of at most kRun. Each run has a bounding ball, so that a run in the air costs only one
/// query.
struct Pointshell {
  struct Point {
    Vector3 p_m, n;  ///< n: unit, into the tool
    bool cutting;
  };
  struct Run {
    std::size_t begin, end;
    Vector3 center_m;
    double radius_m;
  };
  static constexpr std::size_t kRun = 64;

  std::vector<Point> points;
  std::vector<Run> runs;
};

/// Makes points on the outer surface of the union of the tool's balls, one per area of `spacing_m` squared
/// (Fibonacci spirals).
/// @throws std::invalid_argument if the spacing is not 0.01 … 5 mm, or there would be more than 10 million
///   points.
[[nodiscard]] Pointshell MakePointshell(const Tool& tool, double spacing_m);

}  // namespace osteon::simulation
