#include "simulation/engine_cpu/tool_balls.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "simulation/engine_cpu/rounding.h"

namespace osteon::simulation::cpu {
namespace {

constexpr std::size_t kMaxGroup = 16;  // largest number of balls in a group

// Number of tool balls plus one for T's origin, rounded up to whole vectors of eight.
std::size_t Padded(std::size_t tool_balls) { return (tool_balls + 1 + 7) / 8 * 8; }

}  // namespace

ToolPlacement::ToolPlacement(std::size_t tool_balls) : tool_balls_(tool_balls) {
  for (AlignedArray<double>& a : exact_) a = AlignedArray<double>(Padded(tool_balls));
  for (AlignedArray<float>& a : rounded_) a = AlignedArray<float>(Padded(tool_balls));
  places_ = {exact_[0].data(),   exact_[1].data(),   exact_[2].data(),
             rounded_[0].data(), rounded_[1].data(), rounded_[2].data()};
}

void ToolPlacement::CopyFrom(const ToolPlacement& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    std::memcpy(exact_[a].data(), other.exact_[a].data(), exact_[a].size() * sizeof(double));
    std::memcpy(rounded_[a].data(), other.rounded_[a].data(), rounded_[a].size() * sizeof(float));
  }
}

ToolBalls::ToolBalls(const Tool& tool) {
  const std::size_t count = tool.balls.size();
  for (AlignedArray<double>& a : exact_) a = AlignedArray<double>(Padded(count));
  r_mm_ = AlignedArray<float>(Padded(count));
  rounding_mm_ = AlignedArray<float>(Padded(count));
  cutting_flags_ = AlignedArray<std::uint8_t>(Padded(count));
  std::vector<std::uint16_t> cutting, shaft;
  for (std::size_t t = 0; t < count; ++t) {
    const ToolBall& ball = tool.balls[t];
    exact_[0][t] = ball.radius_m;
    for (std::size_t a = 0; a < 3; ++a)
      exact_[1 + a][t] = Vector3(ball.center_m)[static_cast<Eigen::Index>(a)];
    r_mm_[t] = static_cast<float>(1e3 * ball.radius_m);
    max_radius_mm_ = std::max(max_radius_mm_, 1e3 * ball.radius_m);
    cutting_flags_[t] = ball.cutting ? 1 : 0;
    (ball.cutting ? cutting : shaft).push_back(static_cast<std::uint16_t>(t));
  }
  view_ = {.count = static_cast<std::uint32_t>(count),
           .r = exact_[0].data(),
           .tx = exact_[1].data(),
           .ty = exact_[2].data(),
           .tz = exact_[3].data(),
           .r_mm = r_mm_.data(),
           .rounding_mm = rounding_mm_.data(),
           .cutting = cutting_flags_.data()};
  cutting_count_ = cutting.size();
  if (!cutting.empty()) cutting_ = {cutting.front(), cutting.back() + 1u};
  if (!shaft.empty()) shaft_ = {shaft.front(), shaft.back() + 1u};
  AddGroups(tool, std::move(cutting), true);
  AddGroups(tool, std::move(shaft), false);
}

// Halves the members along the longest side of their box, until each group has at most kMaxGroup balls and a
// box that is not larger than its largest ball.
void ToolBalls::AddGroups(const Tool& tool, std::vector<std::uint16_t> members, bool cutting) {
  if (members.empty()) return;
  Eigen::AlignedBox3d box;
  double max_radius_m = 0.0;
  for (const std::uint16_t t : members) {
    box.extend(Vector3(tool.balls[t].center_m));
    max_radius_m = std::max(max_radius_m, tool.balls[t].radius_m);
  }
  const bool is_compact = members.size() <= kMaxGroup && box.diagonal().norm() <= 2.0 * max_radius_m;
  if (members.size() == 1 || is_compact) {
    std::sort(members.begin(), members.end());
    groups_.push_back({.members = std::move(members), .cutting = cutting});
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto half = members.begin() + static_cast<std::ptrdiff_t>(members.size() / 2);
  std::nth_element(members.begin(), half, members.end(), [&](std::uint16_t a, std::uint16_t b) {
    return Vector3(tool.balls[a].center_m)[axis] < Vector3(tool.balls[b].center_m)[axis];
  });
  AddGroups(tool, {members.begin(), half}, cutting);
  AddGroups(tool, {half, members.end()}, cutting);
}

float ToolBalls::UpdateRounding(const ToolPlacement& start, const ToolPlacement& goal,
                                float max_ball_radius_mm, float reach_mm) {
  float largest = 0.0f;
  const auto extent = [](const Places& p, std::size_t t) {
    return std::max({std::abs(p.x_mm[t]), std::abs(p.y_mm[t]), std::abs(p.z_mm[t])});
  };
  for (std::size_t t = 0; t < count(); ++t) {
    const float extent_mm = std::max(extent(start.places(), t), extent(goal.places(), t));
    rounding_mm_[t] = RoundingOfGap(extent_mm, r_mm_[t], max_ball_radius_mm, reach_mm);
    largest = std::max(largest, rounding_mm_[t]);
  }
  return largest;
}

}  // namespace osteon::simulation::cpu
