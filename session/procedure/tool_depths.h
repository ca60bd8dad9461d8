#pragma once

#include <span>
#include <vector>

#include "kinematics/spatial.h"
#include "session/procedure/procedure_tools.h"
#include "simulation/bone/bone.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::session {

/// Computes the depth of the apex of each of a procedure's tools below the uncut floor of the cup.
class ToolDepths {
 public:
  /// @param bone  the uncut bone, with balls  @param tools  at least one  @param X_WG  the bone in the world
  ToolDepths(const simulation::Bone& bone, std::span<const ProcedureTool> tools, const Pose& X_WG);
  /// Returns the depth of a tool at its pose or its proxy's pose [m]; negative above the floor.
  /// @param tool  index in `tools`
  [[nodiscard]] double At(int tool, const Pose& X_WT) const;

 private:
  std::vector<simulation::ApexDepth> depths_;
  Pose X_GW_;
};

}  // namespace osteon::session
