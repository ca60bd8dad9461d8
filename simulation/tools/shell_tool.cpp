#include "simulation/tools/shell_tool.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {

Tool MakeShellTool(const Tool& tool, std::size_t count, ShellPart part) {
  constexpr std::size_t kMax = 100'000;
  // largest radius of a ball over the balls' mean distance: r <= 3 d
  constexpr double kRadiusOverDistance = 3.0;
  if (count < 1 || count > kMax)
    throw std::invalid_argument(fmt::format("tool balls: found {}, accepted 1 … {}", count, kMax));
  const auto cutting =
      std::count_if(tool.balls.begin(), tool.balls.end(), [](const ToolBall& b) { return b.cutting; });
  if (cutting != 1)
    throw std::invalid_argument(
        fmt::format("tool {}: found {} cutting balls, accepted one, the head", tool.name, cutting));
  if (count == 1) return tool;

  const ToolBall head = *CuttingHead(tool);
  // height of the part, divided by the head's radius: 1 for the hemisphere, 2 for the sphere
  const double height_ratio = part == ShellPart::kHemisphere ? 1.0 : 2.0;
  const double distance_m =
      head.radius_m * std::sqrt(2.0 * std::numbers::pi * height_ratio / static_cast<double>(count));
  const double radius_m = std::min(0.5 * head.radius_m, kRadiusOverDistance * distance_m);
  const double golden_angle_rad =
      std::numbers::pi * (3.0 - std::sqrt(5.0));  // the golden angle, g of the header

  Tool shell = tool;
  shell.name = fmt::format("{}, {} balls", tool.name, count);
  shell.balls.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1.0 - height_ratio * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double across = std::sqrt(std::max(0.0, 1.0 - z * z)),
                 turn = golden_angle_rad * static_cast<double>(i);
    const Vector3 u(across * std::cos(turn), across * std::sin(turn), z);
    shell.balls.push_back({.center_m = Vector3(Vector3(head.center_m) + (head.radius_m - radius_m) * u),
                           .radius_m = radius_m,
                           .cutting = true});
  }
  for (const ToolBall& ball : tool.balls)
    if (!ball.cutting) shell.balls.push_back(ball);
  return shell;
}

}  // namespace osteon::simulation
