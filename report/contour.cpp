#include "report/contour.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "simulation/tools/thin_path.h"

namespace osteon::report {
namespace {

// Distance of p from the segment between a and b.
double DistanceToChord(const Vector2& p, const Vector2& a, const Vector2& b) {
  const Vector2 m = b - a;
  const double length2 = m.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((p - a).dot(m) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * m).norm();
}

}  // namespace

PlanarGrid::PlanarGrid(const Vector2& min_corner, const Vector2& max_corner, double step_size, float fill)
    : min(min_corner), step(step_size) {
  const Vector2 extent = (max_corner - min_corner).cwiseMax(0.0);
  nx = static_cast<int>(std::ceil(extent.x() / step)) + 1;
  ny = static_cast<int>(std::ceil(extent.y() / step)) + 1;
  values.assign(static_cast<std::size_t>(nx) * ny, fill);
}

void PlanarGrid::CloseBorder(float value) {
  for (int i = 0; i < nx; ++i) At(i, 0) = At(i, ny - 1) = value;
  for (int j = 0; j < ny; ++j) At(0, j) = At(nx - 1, j) = value;
}

std::vector<Polyline> Contour(const PlanarGrid& grid) {
  // An edge of the grid is identified by its lower node and its direction. Segments are directed with the
  // inside on their left, so each crossed edge has at most one successor.
  using Edge = std::uint64_t;
  std::unordered_map<Edge, Edge> next;
  std::unordered_map<Edge, char> has_previous;
  const auto edge = [&grid](int i, int j, bool vertical) {
    return 2 * (static_cast<Edge>(j) * static_cast<Edge>(grid.nx) + static_cast<Edge>(i)) +
           (vertical ? 1u : 0u);
  };
  std::vector<Edge> order;  // edges in the order in which they were found, so that the result does not depend
                            // on the hash map
  const auto link = [&](Edge from, Edge to) {
    next[from] = to;
    has_previous[to] = 1;
    order.push_back(from);
  };
  for (int j = 0; j + 1 < grid.ny; ++j) {
    for (int i = 0; i + 1 < grid.nx; ++i) {
      const float a = grid.At(i, j), b = grid.At(i + 1, j), c = grid.At(i + 1, j + 1), d = grid.At(i, j + 1);
      // corners counter-clockwise from min; each negative corner sets its bit
      const int code = (a < 0 ? 1 : 0) | (b < 0 ? 2 : 0) | (c < 0 ? 4 : 0) | (d < 0 ? 8 : 0);
      if (code == 0 || code == 15) continue;
      const Edge bottom = edge(i, j, false), right = edge(i + 1, j, true), top = edge(i, j + 1, false),
                 left = edge(i, j, true);
      // only used if two opposite corners are negative: whether these two are connected through the cell's
      // middle
      const bool joined = a + b + c + d < 0;
      switch (code) {
        case 1:
          link(bottom, left);
          break;
        case 2:
          link(right, bottom);
          break;
        case 3:
          link(right, left);
          break;
        case 4:
          link(top, right);
          break;
        case 5:
          link(bottom, joined ? right : left);
          link(top, joined ? left : right);
          break;
        case 6:
          link(top, bottom);
          break;
        case 7:
          link(top, left);
          break;
        case 8:
          link(left, top);
          break;
        case 9:
          link(bottom, top);
          break;
        case 10:
          link(left, joined ? bottom : top);
          link(right, joined ? top : bottom);
          break;
        case 11:
          link(right, top);
          break;
        case 12:
          link(left, right);
          break;
        case 13:
          link(bottom, right);
          break;
        case 14:
          link(left, bottom);
          break;
        default:
          break;
      }
    }
  }
  // the point on an edge at which the field is zero, if it is linear between the nodes
  const auto crossing = [&grid](Edge e) {
    const bool vertical = (e & 1u) != 0;
    const auto node = static_cast<std::int64_t>(e >> 1u);
    const int i = static_cast<int>(node % grid.nx), j = static_cast<int>(node / grid.nx);
    const double a = grid.At(i, j), b = vertical ? grid.At(i, j + 1) : grid.At(i + 1, j);
    const double s = a / (a - b);
    return Vector2(grid.Node(i, j) + grid.step * s * (vertical ? Vector2::UnitY() : Vector2::UnitX()));
  };
  std::vector<Polyline> lines;
  // follows the links from an edge, and removes them
  const auto walk = [&](Edge start) {
    Polyline line;
    Edge current_edge = start;
    for (auto it = next.find(current_edge); it != next.end(); it = next.find(current_edge)) {
      line.points.push_back(crossing(current_edge));
      current_edge = it->second;
      next.erase(it);
    }
    line.closed = current_edge == start;
    if (!line.closed) line.points.push_back(crossing(current_edge));
    if (line.points.size() > 1) lines.push_back(std::move(line));
  };
  // first the open lines, each from its beginning; then the loops that remain
  for (const Edge e : order)
    if (!has_previous.contains(e) && next.contains(e)) walk(e);
  for (const Edge e : order)
    if (next.contains(e)) walk(e);
  return lines;
}

Polyline Simplify(const Polyline& line, double tolerance) {
  if (line.points.size() < 4) return line;
  return {.points = simulation::ThinPath(line.points, tolerance, DistanceToChord), .closed = line.closed};
}

}  // namespace osteon::report
