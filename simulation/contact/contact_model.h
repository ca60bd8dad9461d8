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
  PlainVector3 p_TP_m;            ///< the touching point, fixed to the tool, in T
  PlainVector3 p_W_m;             ///< a point of the plane on the bone, in W
  PlainVector3 n_W;               ///< unit normal, from bone to tool, in W
  double gap_m{0.0};              ///< n·(X_WT p_TP - p_W) at the frame's tool pose; negative inside
  double stiffness_N_per_m{0.0};  ///< stiffness of the coupling along n
  double mu{0.0};                 ///< friction coefficient of the material there
  double advance_m_per_s{0.0};    ///< speed at which the plane recedes along -n under the frame's force
  double weight{0.0};             ///< share of the contacts' squared overlap with the enlarged tool, 0 … 1
  MaterialIndex material{0};
};

/// A frame's error as data: a frame never throws.
enum class EngineStatus : std::uint8_t {
  kOk,
  kBadInput,    ///< pose or time not finite; the frame changed nothing
  kDeviceLost,  ///< the GPU is gone; every later frame returns this too
  kOverloaded,  ///< more bone within the tool's reach than the engine has room for; the frame changed nothing
};

/// Result of a frame for the servo loop. Plain data, handed over through rt::LatestValue.
struct ContactModel {
  PlainPose X_WP;                                ///< proxy: the tool's collision-free pose
  std::array<Contact, kMaxContacts> contacts{};  ///< the first contact_count are valid
  std::int32_t contact_count{0};
  EngineStatus status{EngineStatus::kOk};
  PlainVector3 n_W;               ///< direction of the resultant normal force; zero where free
  double contact_fraction{1.0};   ///< share of the frame's path up to first contact, 0 … 1
  PlainVector3 p_WS_m;            ///< T's origin after the slide, before the bone gave way
  PlainWrench F_T_W;              ///< coupling wrench of this frame's pose, on T, in W
  double advance_m_per_s{0.0};    ///< speed at which the bone gave way along -n_W in this frame
  double engaged_area_m2{0.0};    ///< cutting surface in bone, projected on the plane normal to n_W
  double spindle_torque_Nm{0.0};  ///< axial torque of the cut on the tool's spindle, >= 0
  double removed_volume_m3{0.0};  ///< since the start, from mass points
  double removed_mass_kg{0.0};    ///< since the start
  double cutting_work_J{0.0};     ///< since the start: the sum of u_c V over cleared points, and ploughing
  /// Since the start, counted once per ball and frame: balls that should have been split, but the pool was
  /// exhausted. They shrink whole, which removes more than was cut.
  std::uint64_t balls_not_split{0};
  rt::Nanoseconds pose_stamp{0};  ///< when the tool pose of this frame was commanded
  std::uint64_t frame{0};         ///< 0: no frame yet
};

}  // namespace osteon::simulation
