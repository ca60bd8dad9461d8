#include "simulation/tools/tool.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace osteon::simulation {

Tool MakeReamer(double head_radius_m, double shaft_radius_m, double shaft_length_m, double mass_kg,
                const Vector3& center_of_mass_m) {
  if (!(head_radius_m > 0.0) || !(shaft_radius_m > 0.0) || !(shaft_length_m >= 0.0))
    throw std::invalid_argument("reamer: radii must be positive and the shaft's length not negative");
  if (shaft_radius_m >= head_radius_m)
    throw std::invalid_argument("reamer: the shaft is as wide as the head");
  if (!(mass_kg > 0.0) || !center_of_mass_m.allFinite())
    throw std::invalid_argument("reamer: the mass must be positive and the centre of mass finite");
  Tool tool;
  tool.name = "hemispherical reamer " + std::to_string(std::lround(head_radius_m * 2000.0)) + " mm";
  tool.balls.push_back(
      {.center_m = Vector3(0, 0, -head_radius_m), .radius_m = head_radius_m, .cutting = true});
  // Adjacent shaft balls are one radius apart, and the centre of the first one lies on the back of the head,
  // so that bone hardly fits between them.
  const int count = static_cast<int>(std::ceil(shaft_length_m / shaft_radius_m));
  for (int i = 1; i <= count; ++i)
    tool.balls.push_back({.center_m = Vector3(0, 0, -2.0 * head_radius_m - (i - 1) * shaft_radius_m),
                          .radius_m = shaft_radius_m,
                          .cutting = false});
  tool.mass_kg = mass_kg;
  tool.center_of_mass_m = center_of_mass_m;
  return tool;
}

const ToolBall* CuttingHead(const Tool& tool) {
  double largest_m = 0.0;
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting) largest_m = std::max(largest_m, ball.radius_m);
  const ToolBall* head = nullptr;
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting && ball.radius_m >= 0.999 * largest_m &&
        (head == nullptr || ball.center_m.z > head->center_m.z))
      head = &ball;
  return head;
}

int CuttingEdges(const Tool& tool) {
  int edges = 0;
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting) edges = std::max(edges, static_cast<int>(ball.edges));
  return edges;
}

double CuttingReach(const Tool& tool) {
  double reach_m = 0.0;
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting)
      reach_m = std::max(reach_m, std::hypot(ball.center_m.x, ball.center_m.y) + ball.radius_m);
  return reach_m;
}

}  // namespace osteon::simulation
