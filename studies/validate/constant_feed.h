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
  std::filesystem::path config_root;  ///< folder with tools/twist_drill.yaml and scenes/thin_plate.yaml
  simulation::Material material;
  double diameter_m{0.0032};  ///< one of the sizes in the tool's file
  double spindle_rad_per_s{104.71975511965977};
  std::vector<FeedStep> steps{{}};  ///< sections of the path; their depths must rise
  /// whether the drill's lips have the material's edge force, if the material has one
  bool edge_force{true};
  bool bends{false};          ///< whether the drill bends, as its file's `bending` says
  double packing_scale{1.0};  ///< factor on the spacings of thin_plate.yaml's packing: above 1 is coarser
};

/// Means over the second half of the last section.
struct ConstantFeedResult {
  double thrust_N{0.0};
  double torque_Nm{0.0};        ///< torque on the spindle
  double energy_J_per_m3{0.0};  ///< work of spindle and feed per removed volume
  double bend_m{0.0};           ///< distance of the drill's point from its place without bending
  double removed_share{0.0};    ///< removed volume over the drill's cross-section times the path's length
};

/// The depth of the block.
inline constexpr double kFeedBlock_m = 0.008;

/// Steps the CPU engine once a millisecond. The machine is stiff (1 kN/mm) and has no force limit, so the
/// drill keeps its feed at any thrust. A drill that bends is a massless element between chuck and point, as
/// in a cell, with a time constant that is long enough for this machine.
/// @throws std::invalid_argument if the steps' depths do not rise or exceed the block, or a feed is not
/// positive; config::ConfigError and config::ToolSizeError if a file or the drill's size is refused.
[[nodiscard]] ConstantFeedResult DrillAtConstantFeed(const ConstantFeedParams& params);

}  // namespace osteon::studies
