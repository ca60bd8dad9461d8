#pragma once

#include <filesystem>
#include <vector>

#include "simulation/bone/material.h"

namespace osteon::studies {

/// One section of a drill's path at one feed.
struct FeedStep {
  double feed_m_per_s{0.002};
  double depth_m{0.004};  ///< depth of the drill's tip below the surface at the section's end
};

/// A twist drill that a rigid machine feeds into a block of one material.
struct ConstantFeedParams {
  std::filesystem::path config_root;  ///< with tools/twist_drill.yaml and scenes/thin_plate.yaml
  simulation::Material material;
  double diameter_m{0.0032};  ///< one of the tool's sizes
  double spindle_rad_per_s{104.71975511965977};
  std::vector<FeedStep> steps{{}};  ///< with rising depths
  bool edge_force{true};            ///< the drill's lips have the material's edge force, if it has one
  bool bends{false};                ///< the drill bends, as its file's `bending` says
  double packing_scale{1.0};  ///< factor on the spacings of thin_plate.yaml's packing: above 1 is coarser
};

/// Means over the second half of the last section.
struct ConstantFeedResult {
  double thrust_N{0.0};
  double torque_Nm{0.0};        ///< on the spindle
  double energy_J_per_m3{0.0};  ///< work of spindle and feed over the volume removed
  double bend_m{0.0};           ///< distance of the drill's point from its place on a rigid drill
  double removed_share{0.0};    ///< volume removed over the drill's cross-section times the path's length
};

/// The depth of the block.
inline constexpr double kFeedBlock_m = 0.008;

/// Steps the CPU engine once a millisecond. The machine is stiff (1 kN/mm) and bounds no force, so the drill
/// keeps its feed whatever the thrust. A drill that bends is a massless element between chuck and point, as
/// in a cell, with a time constant that is long enough for this machine.
/// @throws std::invalid_argument if the steps' depths do not rise or reach the block's end, or a feed is not
///   positive; config::ConfigError and config::ToolSizeError as their files' readers do.
[[nodiscard]] ConstantFeedResult DrillAtConstantFeed(const ConstantFeedParams& params);

}  // namespace osteon::studies
