#pragma once

#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/bone.h"

namespace osteon::procedure {

/// Whether a mass point belongs to the tissue that a plan's opening leads to. Always false for a cup.
[[nodiscard]] inline bool IsTarget(const SurgicalPlan& plan, const simulation::Bone& bone,
                                   const simulation::MassPoint& point) {
  return !plan.target.empty() && point.material < bone.materials.size() &&
         bone.materials[point.material].name == plan.target;
}

}  // namespace osteon::procedure
