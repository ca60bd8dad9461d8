#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/reading/cell_config.h"

// The demand of a capability study on the arm: the poses to which a cell's tool goes, and the forces that the
// arm must hold there.
//
//        ┆ tilt cone ┆     the tool's axis, within `tilt` of the site's
//         ╲    │    ╱
//       ┌──╲───│───╱──┐ top      where the script begins, above the site's centre
//       │   ╲  │  ╱   │
//       │    ╲ │ ╱    │          the centre of the tool's head: a cylinder about the site's axis
//       │      ●      │ 0
//       └─────────────┘ bottom   where the push ends
//        ◀─ radius ─▶

namespace osteon::studies {

/// The forces and the torque that the arm has to hold at the tool's apex, all at the same time.
struct CapabilityNeed {
  double axial_N{0.0};       ///< resisted along the tool
  double lateral_N{0.0};     ///< across the tool, in any direction
  double torque_Nm{0.0};     ///< about any axis
  std::string lateral_from;  ///< source of lateral_N
};

/// The working volume and the tilt cone, in the site's frame C. Poses whose apex lies outside the workspace
/// do not belong to it.
struct TaskVolume {
  Pose X_WC{Pose::Identity()};
  double radius_m{0.0};  ///< radius of the cylinder in which the head's centre moves
  double bottom_m{0.0}, top_m{0.0};
  double tilt_rad{0.0};
  double head_radius_m{0.0};  ///< distance of the apex ahead of the head's centre
  double tool_yaw_rad{0.0};   ///< turn of the tool about its own axis
  safety::WorkspaceParams workspace;
};

/// Derives the task from a cell's script.
/// @param radius_m  radius of the cylinder; none: the head's radius plus the script's swing, so that the site
/// may lie one head radius away from its planned place
[[nodiscard]] TaskVolume TaskOf(const config::CellConfig& cell, const std::optional<double>& radius_m = {});

/// Returns the need of a cell: its force limit along the tool, and the lateral force of its posture across
/// the tool.
[[nodiscard]] CapabilityNeed NeedOf(const config::CellConfig& cell);

/// Sampling of a task: heights, places around the rim at each height, and tilts at each place.
struct TaskFineness {
  int heights{3}, around{8}, azimuths{8};
};
inline constexpr TaskFineness kCoarseTask{.heights = 2, .around = 4, .azimuths = 4};

/// Returns X_WT with the head's centre at a place: the tool along the site's axis first, then tilted to the
/// cone's edge all round.
/// @param first_rad  azimuth of the first tilt about the site's axis, from its x. Pass the direction of the
///   base: then the arm's worst directions (toward the base, away from it, to the sides) are among the
///   samples
[[nodiscard]] std::vector<Pose> TiltCone(const TaskVolume& task, const Vector3& p_W_head, int azimuths,
                                         double first_rad);

/// Azimuth of a base about the site's axis, from the site's x.
[[nodiscard]] double DirectionOf(const TaskVolume& task, const Vector3& p_WB);

/// Samples X_WT over the volume: each height's centre and rim, each with its tilt cone. The forces are worst
/// at the volume's edges, where the levers are longest, so inside only the axis is sampled.
[[nodiscard]] std::vector<Pose> TaskPoses(const TaskVolume& task, const TaskFineness& fineness,
                                          double first_rad);

/// Number of poses in the sampling of TaskPoses, including those outside the workspace, which TaskPoses then
/// leaves out.
[[nodiscard]] int SampledPoses(const TaskVolume& task, const TaskFineness& fineness);

}  // namespace osteon::studies
