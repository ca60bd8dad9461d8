#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "kinematics/spatial.h"
#include "simulation/bone/material.h"

namespace osteon::simulation {

/// Largest number of planes that a frame reports.
inline constexpr int kMaxContacts = 8;

/// One plane of the bone's surface near the tool. The servo loop evaluates the tool against these planes
/// while the simulation computes its next frame.
struct Contact {
  PlainVector3 p_TP_m;            ///< the touching point on the tool, in T
  PlainVector3 p_W_m;             ///< a point on the plane, at the bone's surface, in W
  PlainVector3 n_W;               ///< unit normal, from bone to tool, in W
  double gap_m{0.0};              ///< n·(X_WT p_TP - p_W) at the frame's tool pose; negative inside
  double stiffness_N_per_m{0.0};  ///< stiffness of the coupling along n
  double mu{0.0};                 ///< friction coefficient of the contact's material
  double advance_m_per_s{0.0};    ///< speed at which the plane recedes along -n under the frame's force
  double weight{0.0};             ///< share of all contacts' squared overlaps with the enlarged tool, 0 … 1
  MaterialIndex material{0};
};

/// The status of a frame. A frame reports an error by its status and never throws.
enum class EngineStatus : std::uint8_t {
  kOk,
  kBadInput,    ///< pose or time not finite; the frame changed nothing
  kDeviceLost,  ///< the GPU is gone; every later frame returns this too
  kOverloaded,  ///< the tool's reach has more bone than the engine has memory for; the frame changed nothing
};

/// Result of a frame for the servo loop. It is plain data and is passed through rt::LatestValue.
struct ContactModel {
  PlainPose X_WP;                                ///< proxy: the tool's collision-free pose
  std::array<Contact, kMaxContacts> contacts{};  ///< the first contact_count entries are valid
  std::int32_t contact_count{0};
  EngineStatus status{EngineStatus::kOk};
  PlainVector3 n_W;               ///< direction of the cutting planes' resultant force; zero without contact
  double contact_fraction{1.0};   ///< fraction of the frame's path at first contact, 0 … 1
  PlainVector3 p_WS_m;            ///< T's origin after the slide, before the advance into bone
  PlainWrench F_T_W;              ///< coupling wrench at this frame's pose, on T, in W
  double advance_m_per_s{0.0};    ///< speed at which the bone gave way along -n_W in this frame
  double engaged_area_m2{0.0};    ///< area of the cutting surface in bone, projected along n_W
  double spindle_torque_Nm{0.0};  ///< axial torque of the cut on the tool's spindle, >= 0
  double removed_volume_m3{0.0};  ///< since the start; sum over cleared mass points
  double removed_mass_kg{0.0};    ///< since the start
  double cutting_work_J{0.0};     ///< since the start: sum of u_c V over cleared points, plus ploughing work
  /// Number of balls since the start that should have been split, but were not because the pool of blocks was
  /// exhausted; counted once per ball and frame. Such a ball shrinks as a whole, which removes more bone than
  /// was cut.
  std::uint64_t balls_not_split{0};
  rt::Nanoseconds pose_stamp{0};  ///< when the tool pose of this frame was commanded
  std::uint64_t frame{0};         ///< 0: no frame yet
};

}  // namespace osteon::simulation
