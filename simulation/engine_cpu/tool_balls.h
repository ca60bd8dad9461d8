#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/engine_cpu/aligned_array.h"
#include "simulation/engine_cpu/kernels.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation::cpu {

/// The tool's balls and T's origin at one pose, in G.
class ToolPlacement {
 public:
  ToolPlacement() = default;
  explicit ToolPlacement(std::size_t tool_balls);
  ToolPlacement(ToolPlacement&&) = default;
  ToolPlacement& operator=(ToolPlacement&&) = default;

  [[nodiscard]] const Places& places() const { return places_; }
  [[nodiscard]] Vector3 At(std::size_t t) const { return {places_.x[t], places_.y[t], places_.z[t]}; }
  [[nodiscard]] Vector3 Origin() const { return At(tool_balls_); }
  void CopyFrom(const ToolPlacement& other);

 private:
  std::size_t tool_balls_{0};
  std::array<AlignedArray<double>, 3> exact_;
  std::array<AlignedArray<float>, 3> rounded_;
  Places places_{};
};

/// At most 16 neighbouring tool balls of one kind. A search for pairs first finds the bone near each group.
struct ToolGroup {
  std::vector<std::uint16_t> members;  ///< indices of tool balls, ascending
  bool cutting{true};
};

/// The tool's balls in the layout that the kernels need.
class ToolBalls {
 public:
  explicit ToolBalls(const Tool& tool);

  [[nodiscard]] std::uint32_t count() const { return view_.count; }
  [[nodiscard]] const ToolView& view() const { return view_; }
  [[nodiscard]] const std::vector<ToolGroup>& groups() const { return groups_; }
  [[nodiscard]] double max_radius_mm() const { return max_radius_mm_; }
  [[nodiscard]] std::size_t cutting_count() const { return cutting_count_; }
  /// Range of ball indices, end excluded, that contains all balls of a kind (cutting or shaft). It may
  /// contain balls of the other kind as well.
  struct Range {
    std::uint32_t first{0}, end{0};
  };
  [[nodiscard]] const Range& cutting() const { return cutting_; }
  [[nodiscard]] const Range& shaft() const { return shaft_; }

  /// Computes view().rounding_mm: for each tool ball, the largest rounding error of a gap in floats, in a
  /// frame between two placements.
  /// @param reach_mm  largest gap that is compared
  /// @returns the largest of these errors [mm]
  float UpdateRounding(const ToolPlacement& start, const ToolPlacement& goal, float max_ball_radius_mm,
                       float reach_mm);

 private:
  void AddGroups(const Tool& tool, std::vector<std::uint16_t> members, bool cutting);

  ToolView view_{};
  std::array<AlignedArray<double>, 4> exact_;  // radius, x, y, z [m]
  AlignedArray<float> r_mm_, rounding_mm_;
  AlignedArray<std::uint8_t> cutting_flags_;
  std::vector<ToolGroup> groups_;
  double max_radius_mm_{0.0};
  std::size_t cutting_count_{0};
  Range cutting_, shaft_;
};

}  // namespace osteon::simulation::cpu
