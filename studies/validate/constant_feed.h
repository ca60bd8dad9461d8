#pragma once

#include <filesystem>
#include <vector>

#include "simulation/bone/material.h"

namespace osteon::studies {

/// One stretch of a drill's way at one feed.
struct FeedStep {
  double feed_m_per_s{0.002};
  double depth_m{0.004};  ///< of the drill's tip below the surface at the stretch's end
};

/// A twist drill that a rigid machine feeds into a block of one material.
struct ConstantFeedParams {
  std::filesystem::path config_root;  ///< with tools/twist_drill.yaml and scenes/thin_plate.yaml
  simulation::Material material;
  double diameter_m{0.0032};  ///< one of the tool's sizes
  double spindle_rad_per_s{104.71975511965977};
  std::vector<FeedStep> steps{{}};  ///< depths rise
  bool edge_force{true};            ///< of the drill's lips, where the material has one
  bool bends{false};                ///< the drill, as its file's `bending` says
  double packing_scale{1.0};  ///< factor on the spacings of thin_plate.yaml's packing: above 1 is coarser
};

/// Means over the second half of the last stretch.
struct ConstantFeedResult {
  double thrust_N{0.0};
  double torque_Nm{0.0};        ///< on the spindle
  double energy_J_per_m3{0.0};  ///< work of spindle and feed over the volume removed
  double bend_m{0.0};           ///< how far the point is from where a rigid drill has it
  double removed_share{0.0};    ///< volume removed over the drill's cross-section times the way
};

/// The depth of the block.
inline constexpr double kFeedBlock_m = 0.008;

/// Steps the CPU engine once a millisecond. The machine is stiff (1 kN/mm) and bounds no force, so the drill
/// keeps its feed whatever the thrust. A drill that bends is a massless element between chuck and point, as
/// in a cell, with a time constant that is long enough for this machine.
/// @throws std::invalid_argument if the steps do not go deeper and deeper, or through the block, or a feed is
///   not positive; config::ConfigError and config::ToolSizeError as their files' readers do.
[[nodiscard]] ConstantFeedResult DrillAtConstantFeed(const ConstantFeedParams& params);

}  // namespace osteon::studies
