#pragma once

#include <cstdint>
#include <optional>

#include "control/compliance/compliance.h"
#include "kinematics/spatial.h"
#include "plugin/include/osteon.h"
#include "plugin/src/bone_source.h"

namespace osteon::plugin {

/// Displacements after a tick of osteon_session_evaluate. Plain data.
struct Deflected {
  std::uint32_t begun{0};  ///< value of Session::beginnings_ (bone, tool and compliance in use) for which the
                           ///< displacements were computed
  bool noticed{false}, beyond_limit{false};
  control::ComplianceRecord record;  ///< displacements of the compliant parts
};

/// Figures of a session's coupling between tool and bone on which compliance depends.
struct CouplingFigures {
  double stiffness_N_per_m{0.0};
  double engaged_layer_m{0.0};  ///< from the engine's cutting parameters
};

/// Makes the compliance that a caller asked for, at rest; returns nothing if the caller asked for none.
/// @throws Failure naming the value, what was found and what is accepted, if the tool's file has no
/// `bending`, the bone has no soft tissue, or the figures would not be stable (docs/theory/compliance.md,
///   rules 1 and 3).
[[nodiscard]] std::optional<control::Compliance> MakeCompliance(const OsteonComplianceParams& params,
                                                                const BoneSource& bone,
                                                                const ToolSource& tool,
                                                                const CouplingFigures& coupling);

/// Pose of the bent head relative to the bone on its mount, for the pose X_GT of the rigid tool.
[[nodiscard]] Pose HeadInBone(const Deflected& deflected, const Pose& X_GT) noexcept;

[[nodiscard]] OsteonDeflection DeflectionOf(const Deflected& deflected) noexcept;

}  // namespace osteon::plugin
