#pragma once

#include <vector>

#include <Eigen/Core>

namespace osteon::report {

using Vector2 = Eigen::Vector2d;

/// Samples of a scalar field on a plane; node (i, j) lies at min + step (i, j).
struct PlanarGrid {
  Vector2 min{Vector2::Zero()};
  double step{1.0};
  int nx{0}, ny{0};
  std::vector<float> values;

  PlanarGrid(const Vector2& min_corner, const Vector2& max_corner, double step_size, float fill);
  [[nodiscard]] Vector2 Node(int i, int j) const { return min + step * Vector2(i, j); }
  [[nodiscard]] float& At(int i, int j) { return values[static_cast<std::size_t>(j) * nx + i]; }
  [[nodiscard]] float At(int i, int j) const { return values[static_cast<std::size_t>(j) * nx + i]; }
  /// Sets the nodes of the border to `value`. With a positive value every contour is closed.
  void CloseBorder(float value);
};

/// Points joined by straight lines. If `closed`, the last point is joined to the first.
struct Polyline {
  std::vector<Vector2> points{};
  bool closed{false};
};

/// Returns the lines on which the field is zero, linear between nodes (marching squares), with the negative
/// side on their left. Lines that leave the grid stay open. If the corners of a cell allow two ways of
/// joining, the mean of the corners decides.
[[nodiscard]] std::vector<Polyline> Contour(const PlanarGrid& grid);

/// Removes points of a line that lie within `tolerance` of the chord between the neighbouring points that are
/// kept.
[[nodiscard]] Polyline Simplify(const Polyline& line, double tolerance);

}  // namespace osteon::report
