#pragma once

#include <span>
#include <vector>

#include "kinematics/spatial.h"
#include "session/procedure/procedure_tools.h"
#include "simulation/bone/bone.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::session {

/// Depth of the apex of each of a procedure's tools below the cup's first floor.
class ToolDepths {
 public:
  /// @param bone  uncut, with balls  @param tools  at least one  @param X_WG  the bone in the world
  ToolDepths(const simulation::Bone& bone, std::span<const ProcedureTool> tools, const Pose& X_WG);
  /// Depth of a tool, by its index in `tools`, at its pose X_WT or its proxy's [m]; negative above the floor.
  [[nodiscard]] double At(int tool, const Pose& X_WT) const;

 private:
  std::vector<simulation::ApexDepth> depths_;
  Pose X_GW_;
};

}  // namespace osteon::session
