#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/cell_config.h"

// Where the tool of a cell goes, and what it must be able to press: what a capability study asks the arm for.
//
//        ┆ tilt cone ┆     the tool's axis, within `tilt` of the site's
//         ╲    │    ╱
//       ┌──╲───│───╱──┐ top      where the script begins, above the site's centre
//       │   ╲  │  ╱   │
//       │    ╲ │ ╱    │          the centre of the tool's head: a cylinder about the site's axis
//       │      ●      │ 0
//       └─────────────┘ bottom   where the push ends
//        ◀─ radius ─▶

namespace osteon::app {

/// What the tool presses with. Forces at the apex.
struct CapabilityNeed {
  double axial_N{0.0};       ///< resisted along the tool
  double lateral_N{0.0};     ///< across it, in any direction, at the same time
  double torque_Nm{0.0};     ///< about any axis, at the same time
  std::string lateral_from;  ///< where that figure is from
};

/// The working volume and the tilt cone, in the site's frame C. Poses whose apex the cell's workspace does
/// not allow do not belong to it.
struct TaskVolume {
  Pose X_WC{Pose::Identity()};
  double radius_m{0.0};
  double bottom_m{0.0}, top_m{0.0};
  double tilt_rad{0.0};
  double head_radius_m{0.0};  ///< the apex is so far ahead of the head's centre
  double tool_yaw_rad{0.0};
  safety::WorkspaceParams workspace;
};

/// The task of a cell's script.
/// @param radius_m  of the cylinder; none: the head's radius and the script's swing, so that the site may lie
///   a head's radius beside where it was planned
[[nodiscard]] TaskVolume TaskOf(const config::CellConfig& cell, const std::optional<double>& radius_m = {});

/// What a cell asks for: its force limit along the tool, and across it the lateral force of its posture.
[[nodiscard]] CapabilityNeed NeedOf(const config::CellConfig& cell);

/// How finely a task is sampled.
struct TaskFineness {
  int heights{3}, around{8}, azimuths{8};
};
inline constexpr TaskFineness kCoarseTask{.heights = 2, .around = 4, .azimuths = 4};

/// X_WT with the head's centre at a place: the tool along the site's axis first, then tilted to the cone's
/// edge all round.
/// @param first_rad  direction of the first tilt, about the site's axis from its x: toward the base, so that
///   the arm's own worst ways, toward it, away and to the sides, are among them
[[nodiscard]] std::vector<Pose> TiltCone(const TaskVolume& task, const Vector3& p_W_head, int azimuths,
                                         double first_rad);

/// Where a base stands seen from the site: the angle about the site's axis from its x.
[[nodiscard]] double DirectionOf(const TaskVolume& task, const Vector3& p_WB);

/// X_WT over the volume: each height's centre and rim, each with its tilt cone. The forces are worst at its
/// edges, where the levers are longest, so the edges are sampled and of the inside the axis.
[[nodiscard]] std::vector<Pose> TaskPoses(const TaskVolume& task, const TaskFineness& fineness,
                                          double first_rad);

}  // namespace osteon::app
