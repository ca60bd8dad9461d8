#pragma once

#include <array>
#include <cstdint>

#include "base/clock.h"
#include "base/marker.h"
#include "control/coupling/hand_over.h"
#include "kinematics/spatial.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Tuning of EvaluateCoupling. Every field has a usable default.
struct CouplingParams {
  double max_stiffness_N_per_m{20e3};  ///< limit of each contact's stiffness
  double damping_Ns_per_m{100.0};      ///< damping along the resultant force
  double damping_share{0.25};          ///< largest damping force / spring force, 0 … 0.25
  double fresh_s{0.020};  ///< up to this age of the model, the coupling is not faded and the planes recede
  double gone_s{0.060};   ///< from this age of the model on, nothing is rendered
  double ramp_s{0.100};   ///< shortest time in which the coupling fades in
  /// time in which a held-back plane is released; a value of one period releases it at once
  double return_s{0.008};
  double turn_m_per_s{0.025};  ///< smallest speed at which a hand-over turns the force [N/s] / K; > 0
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const CouplingParams& params);

/// A plane of the newest frame, as received.
struct FramePlane {
  Vector3 p_T_m{Vector3::Zero()}, p_W_m{Vector3::Zero()}, n_W{Vector3::UnitZ()};
  double stiffness_N_per_m{0.0};  ///< not faded by age
};

/// The coupling's state between ticks.
struct CouplingState {
  static constexpr int kHistory = 64;  ///< ticks in `history`
  struct CutSample {
    rt::Nanoseconds stamp{-1};
    double cut_s{0.0};  ///< time spent cutting up to the stamp
  };

  rt::Nanoseconds last{-1};  ///< time of the last tick; -1: none
  double fade{0.0};          ///< share of the coupling that is rendered, 0 … 1
  std::uint64_t frame{0};    ///< number of the frame to which the planes below belong
  rt::Nanoseconds pose_stamp{-1};
  std::array<FramePlane, simulation::kMaxContacts> planes{};  ///< the first plane_count count
  int plane_count{0};
  std::array<double, simulation::kMaxContacts> recession_m{};  ///< recession of each plane since pose_stamp
  /// Present distance by which each plane is held back [m]; it falls to 0 (EvaluateCoupling).
  std::array<double, simulation::kMaxContacts> held_back_m{};
  double return_m_per_s{0.0};   ///< speed at which held-back planes are released
  bool has_proxy{false};        ///< the last tick had a proxy
  Pose X_WP{Pose::Identity()};  ///< proxy of the last tick
  /// distance by which the proxy violates its planes, if walls are too close for the tool
  double violation_m{0.0};
  /// Contacts that pressed in the last tick, with the spindle on.
  std::array<bool, simulation::kMaxContacts> pressed{};
  double cut_s{0.0};                          ///< time with the spindle on in which any contact pressed
  std::array<CutSample, kHistory> history{};  ///< cut_s in the last ticks, as a ring buffer
  int next{0};                                ///< index in `history` of the next sample to write
  HandOver hand_over;                         ///< from the planes of the previous frame to the present ones
};

/// Inputs of the coupling in a tick.
struct CouplingInput {
  const simulation::ContactModel& model;  ///< newest contact model; must outlive the call
  /// Tool pose, commanded (admittance) or measured (impedance); its rotation orthonormal.
  Pose X_WT{Pose::Identity()};
  Twist V_WT{};            ///< velocity of T at To, in W
  rt::Nanoseconds now{0};  ///< time of the tick, on the clock of model.pose_stamp; not decreasing
  bool spindle_turns{false};
};

/// Defect of a model; a defective model renders nothing.
enum class ModelStatus : std::uint8_t {
  kOk,
  kNone,         ///< no frame yet
  kNotCredible,  ///< a value is not finite or implausible, or the engine reports that its input was
  kDeviceLost,
};

/// A plane that the proxy lies on: n_W·delta = -g.
struct ActivePlane {
  Vector3 n_W{Vector3::UnitZ()};     ///< unit, from bone to tool
  Vector3 lever_W{Vector3::Zero()};  ///< vector from To to the contact point [m]
  double stiffness_N_per_m{0.0};     ///< K_j, not faded by age
  double force_N{0.0};               ///< force of the faded spring along n, without damping; > 0
};

/// Result of a tick.
struct CouplingOutput {
  static constexpr int kMaxActive = 4;

  Wrench F_T_W;             ///< rendered wrench on the tool, at To, in W: faded, but not limited yet
  Wrench F_contact_T_W;     ///< part of F_T_W that the planes exert; the rest is the spindle's torque
  Wrench F_hand_over_T_W;   ///< part of F_T_W that a hand-over adds to the wrench of the present planes
  double hand_over_s{0.0};  ///< time until the hand-over ends
  std::array<double, simulation::kMaxContacts> normal_force_N{};  ///< force of each contact along its n, >= 0
  int active_count{0};                                            ///< number of contacts that press
  double age_s{0.0};                        ///< age of the pose that the model was computed for
  double fade{0.0};                         ///< share of the coupling that is rendered, 0 … 1
  Vector3 displacement_W{Vector3::Zero()};  ///< delta: vector from the tool to its proxy [m]
  ModelStatus status{ModelStatus::kNone};
  std::array<ActivePlane, kMaxActive> active{};  ///< the first active_planes count
  int active_planes{0};
  /// U = fade f_s·delta / 2: energy stored in the spring. With equal stiffnesses and resting planes, its
  /// derivative with respect to the tool's motion is minus the spring wrench, including levers and rotations.
  double potential_J{0.0};
  bool new_planes{false};  ///< this tick has a new frame, or held-back planes are being released
};

/// Evaluates the virtual coupling, a spring with damping, between the tool and its proxy. The proxy is the
/// nearest position to the tool that satisfies the planes of the newest contact model.
///
///     g_j   = n_j·(X_WT p_TP_j - p_W_j) + r_j + h_j            gap; r_j: recession, h_j: held back
///     delta = min |delta|, n_j·delta >= -g_j  =  sum l_j n_j   the constrained proxy is at p_WT + delta
///     f     = c sum K_j l_j n_j,   t = c sum (X_WT p_TP_j - p_WTo) × K_j l_j n_j
///     c     = fade (1 + clamp(b nu / |f_s|, -1, damping_share)),  nu = -(f_s·v + t_s·w) / |f_s|
///
/// Here n_j is the plane's normal, p_W_j a point of the plane, p_TP_j the tool's touching point in T, K_j the
/// stiffness, b the damping and (v, w) the tool's twist. (f_s, t_s) is the spring wrench: the sums above
/// without c. With equal stiffnesses, f_s = K delta.
///
/// Damping is the factor c on the whole spring wrench. It therefore acts only along the resultant, takes the
/// power b nu^2, and never makes the surface pull (c >= 0). It adds at most damping_share of the spring's
/// force, so the force does not jump at a new contact (safety::WrenchRateTrip).
///
/// Recession. A plane recedes while the tool cuts it. r_j grows by advance_j dt, but by at most the remaining
/// penetration, if the contact pressed in the previous tick, the spindle turns, and the model is younger than
/// fresh_s. A new frame's planes belong to an older pose of the tool. They get at once the recession for the
/// time spent cutting since that pose, so that they continue the old planes without a step. This is the time
/// in which any contact pressed, because contacts of different frames are not matched.
///
/// Held-back planes. A new frame may find bone where the last planes had none, for example because a
/// predicted cut stalled, or because a ledge came within reach. The distance h_j holds such a plane back so
/// that the proxy X_WP of the last tick just touches it,
///
///     h_j = max(0, -(n_j·(X_WP p_TP_j - p_W_j) + r_j)),
///
/// less the violation between walls that are too close for the tool (HalfSpaceProjection::violation), so a
/// new frame never moves the proxy. h_j then falls to 0 within return_s at constant speed, so the force rises
/// by K h_j over several ticks. If a new frame's plane lies deeper than the old one, it is used at once,
/// because a falling force is no shock and adds no energy. If h_j exceeds 1.5 v_max return_s, with the tool's
/// speed limit v_max, safety::WrenchRateTrip still trips.
///
/// Turn. A new frame may have fewer planes, or other normals, so that the force would turn at once. Example:
/// on a convex bone, when a plane vanishes or one plane becomes three, a force of 90 N gets a lateral step of
/// 15 to 19 N. The turn is also distributed over return_s (hand_over.h), and f_s and t_s above include this.
/// Only a change of stiffness between frames is rendered at once; the energy tank pays for it.
///
/// Age. The fade is 1 up to the age fresh_s of the model, and falls linearly with the age to 0 at gone_s. It
/// rises at a speed of at most 1/ramp_s.
///
/// Axial torque of the cut. On a spindle that turns about +z of T, the bone exerts the torque -spindle_torque
/// z. It is scaled by the ratio of this tick's force to the frame's force, and is zero with a still spindle
/// or without contact.
///
/// Friction. No friction is added here: it is part of the frames. With a still spindle, the simulation tilts
/// the planes within the friction cone, so that the force resists slip (simulation/contact/contact_law.h).
/// Under a turning reamer, friction acts along the cutting speed and is included in the axial torque. A
/// regularised friction in the tick would have the gain mu F / v_0 (coefficient mu, force F, transition speed
/// v_0). At 200 N a sampled loop with this gain would not be passive.
///
/// @returns finite values for every model, with any bit pattern. A model that is not credible renders
///   nothing.
[[nodiscard]] CouplingOutput EvaluateCoupling(const CouplingParams& params, const CouplingInput& input,
                                              CouplingState& state) OSTEON_RT;

}  // namespace osteon::control
