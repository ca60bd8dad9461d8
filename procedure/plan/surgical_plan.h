#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/units.h"
#include "kinematics/spatial.h"
#include "procedure/plan/cup_axis.h"
#include "procedure/plan/pelvic_frame.h"
#include "procedure/plan/planned_cavity.h"

// The plan of a procedure: the planned cavity, the tools, and the gains of the guidance that keeps the hand
// to the plan. Either a cup is reamed, or an opening is made down to a deeper tissue. Plain data in SI, in
// the packing's frame G.

namespace osteon::procedure {

/// The shape to be cut by a plan.
enum class PlanKind : std::uint8_t {
  kCup,     ///< the seat of an implant, with reamers
  kOpening  ///< an access down to a deeper tissue, with burrs that are moved around the axis
};

/// One tool of the sequence: a reamer or a burr. The planned centre of its head is `height_m` above the
/// plan's centre along the axis. A burr is moved around the axis, with its head's centre up to `around_m`
/// away from the axis.
struct PlannedTool {
  double diameter_m{0.0}, height_m{0.0}, around_m{0.0};
  /// Width of the opening that the tool leaves.
  [[nodiscard]] double width_m() const { return diameter_m + 2.0 * around_m; }
};

/// How one tool of the sequence is replaced by the next.
enum class ToolChange : std::uint8_t {
  kVirtual,  ///< the tool on the arm stays; only the simulated head changes
  kPhysical  ///< another tool is mounted on the arm
};

/// Gains of the guidance (docs/theory/guidance.md). Each part acts beyond `free` (for depth, below the height
/// `soft`); beyond `stop` it may stop the spindle. `ease` is the width over which the force rises softly,
/// `cap` the largest force or torque.
struct GuidanceGains {
  struct Cone {
    double free_rad{0.0}, stop_rad{0.0}, ease_rad{0.0}, stiffness_Nm_per_rad{0.0}, cap_Nm{0.0};
  };
  struct CupCone {
    double free_rad{0.0}, stop_rad{0.0};
  };
  struct Lateral {
    double free_m{0.0}, stop_m{0.0}, widening_rad{0.0}, ease_m{0.0}, stiffness_N_per_m{0.0}, cap_N{0.0};
  };
  struct Depth {
    double soft_m{0.0}, ease_m{0.0}, stiffness_N_per_m{0.0}, cap_N{0.0};
  };
  enum class OutsideSpindle : std::uint8_t { kStop, kFree };

  double gain{0.0};  ///< 0 … 1; 0: off
  Cone cone;         ///< tilt of the feed against the cup axis
  CupCone cup_cone;  ///< free and stop angles that replace those of `cone` while the cup is placed
  Lateral lateral;   ///< distance of the head's centre from the axis
  Depth depth;       ///< height of the head's centre over its planned centre
  /// The guidance's force and torque decrease with the tool's speed back toward the corridor, and are 0 from
  /// these speeds on.
  double return_m_per_s{0.05}, return_rad_per_s{1.0};
  OutsideSpindle spindle{OutsideSpindle::kStop};
};

/// The largest gains that a plan may ask for. With more stiffness or a higher cap, hands that are stable
/// without guidance could become unstable with it (docs/theory/guidance.md).
struct GuidanceCeilings {
  static constexpr double kConeStiffness_Nm_per_rad = 400.0, kConeCap_Nm = 8.0;
  static constexpr double kLateralStiffness_N_per_m = 5e3, kLateralCap_N = 60.0;
  static constexpr double kDepthStiffness_N_per_m = 20e3, kDepthCap_N = 150.0;
};

/// A whole plan, as read from its file.
struct SurgicalPlan {
  std::string name;  ///< the file's, without ".yaml"
  PlanKind kind{PlanKind::kCup};
  Side side{Side::kRight};
  std::optional<PelvicLandmarks> landmarks;  ///< absent: the plan's file gives the axes of `pelvis` instead
  double tilt_rad{0.0};  ///< backward tilt of the pelvis in the frame in which the angles are measured
  /// Frame in which the angles are measured, tilt included. For an opening, `superior` is the opening's axis,
  /// and the two others are perpendicular to it.
  PelvicFrame pelvis;
  Vector3 native_centre_m{Vector3::Zero()};  ///< centre of the hip before the operation
  /// Centre of the cup; for an opening, the centre of the last burr's head at the end of its path, on the
  /// axis.
  Vector3 centre_m{Vector3::Zero()};
  double cup_diameter_m{0.0};  ///< diameter of the implant, or width of the opening
  std::string target;          ///< for an opening, the name of the material that it leads to, e.g. "pulp"
  CupDefinition definition{CupDefinition::kRadiographic};
  CupAngles angles;                  ///< the planned angles, in `definition`
  Vector3 axis_G{Vector3::UnitZ()};  ///< unit, out of the cup or the opening
  std::vector<PlannedTool> tools;    ///< in the order of use, with rising diameters; at least one
  ToolChange tool_change{ToolChange::kVirtual};
  GuidanceGains guidance;

  /// Planned centre of a tool's head, in G.
  [[nodiscard]] Vector3 CentreOf(const PlannedTool& tool) const { return centre_m + tool.height_m * axis_G; }
  /// Planned position of a tool's apex, in G.
  [[nodiscard]] Vector3 ApexOf(const PlannedTool& tool) const {
    return CentreOf(tool) - 0.5 * tool.diameter_m * axis_G;
  }
  /// The space that a tool clears.
  [[nodiscard]] PlannedCavity CavityOf(const PlannedTool& tool) const {
    return {CentreOf(tool), axis_G, 0.5 * tool.diameter_m, tool.around_m};
  }
  /// The space that the last tool clears.
  [[nodiscard]] PlannedCavity cavity() const { return CavityOf(tools.back()); }
};

/// Largest angle between the planned axis and the axis of the scene's site. A larger angle means that the
/// plan is for the other side, or that the landmarks are in another frame.
inline constexpr double kMaxAxisFromSite_rad = 45.0 * kDegree;

/// @returns an error text if the plan does not fit the bone's site; empty: it fits.
[[nodiscard]] std::string SiteError(const SurgicalPlan& plan, const simulation::CutSite& site);

/// File name of the shipped rubric for a kind of plan, e.g. "rubric.yaml".
[[nodiscard]] const char* RubricOf(PlanKind kind);

/// Returns warnings that a person should read before the plan is used; mostly none.
[[nodiscard]] std::vector<std::string> WarningsOf(const SurgicalPlan& plan);

}  // namespace osteon::procedure
