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
  double damping_share{0.25};          ///< limit of the damping force over the spring's force, 0 … 0.25
  double fresh_s{0.020};       ///< up to this age of the model the coupling is full, and its planes recede
  double gone_s{0.060};        ///< from this age of the model on, nothing is rendered
  double ramp_s{0.100};        ///< shortest time in which the coupling fades in
  double return_s{0.008};      ///< time in which a plane that was held back is released; one period: at once
  double turn_m_per_s{0.025};  ///< smallest speed at which a hand-over turns the force, over K; > 0
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const CouplingParams& params);

/// A plane of the newest frame, as received.
struct FramePlane {
  Vector3 p_T_m{Vector3::Zero()}, p_W_m{Vector3::Zero()}, n_W{Vector3::UnitZ()};
  double stiffness_N_per_m{0.0};  ///< without fade
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
  std::uint64_t frame{0};    ///< frame of the planes below
  rt::Nanoseconds pose_stamp{-1};
  std::array<FramePlane, simulation::kMaxContacts> planes{};  ///< the first plane_count count
  int plane_count{0};
  std::array<double, simulation::kMaxContacts> recession_m{};  ///< recession of each plane since pose_stamp
  /// Distance by which each plane is still held back.
  std::array<double, simulation::kMaxContacts> held_back_m{};
  double return_m_per_s{0.0};   ///< speed at which held-back planes are released
  bool has_proxy{false};        ///< the last tick had a proxy
  Pose X_WP{Pose::Identity()};  ///< proxy of the last tick
  double violation_m{0.0};      ///< how far the proxy violates its planes, between walls too close for it
  /// Contacts that pressed in the last tick, with the spindle on.
  std::array<bool, simulation::kMaxContacts> pressed{};
  double cut_s{0.0};                          ///< time with the spindle on in which any contact pressed
  std::array<CutSample, kHistory> history{};  ///< the last ticks' cut_s, a ring
  int next{0};                                ///< index in `history` of the next sample to write
  HandOver hand_over;                         ///< from the previous frame's planes to these
};

/// Inputs of the coupling in a tick.
struct CouplingInput {
  const simulation::ContactModel& model;  ///< newest contact model; must outlive the call
  /// Tool pose, commanded (admittance) or measured (impedance); its rotation orthonormal.
  Pose X_WT{Pose::Identity()};
  Twist V_WT{};            ///< velocity of T at To, in W
  rt::Nanoseconds now{0};  ///< on the clock of model.pose_stamp; not decreasing
  bool spindle_turns{false};
};

/// Defect of a model; a defective model renders nothing.
enum class ModelStatus : std::uint8_t {
  kOk,
  kNone,         ///< no frame yet
  kNotCredible,  ///< a value is not finite or implausible, or the engine reports such an input
  kDeviceLost,
};

/// A plane that the proxy lies on: n_W·delta = -g.
struct ActivePlane {
  Vector3 n_W{Vector3::UnitZ()};     ///< unit, from bone to tool
  Vector3 lever_W{Vector3::Zero()};  ///< from To to the contact point [m]
  double stiffness_N_per_m{0.0};     ///< K_j, without fade
  double force_N{0.0};               ///< force of the faded spring along n, without damping; > 0
};

/// Result of a tick.
struct CouplingOutput {
  static constexpr int kMaxActive = 4;

  Wrench F_T_W;             ///< on the tool, at To, in W; faded, not yet limited
  Wrench F_contact_T_W;     ///< part of F_T_W that the planes exert: without the spindle's torque
  Wrench F_hand_over_T_W;   ///< part of F_T_W that a hand-over adds to the planes' own
  double hand_over_s{0.0};  ///< time until the hand-over ends
  std::array<double, simulation::kMaxContacts> normal_force_N{};  ///< force of each contact along its n, >= 0
  int active_count{0};                                            ///< contacts that press
  double age_s{0.0};                        ///< age of the pose that the model was computed for
  double fade{0.0};                         ///< share rendered, 0 … 1
  Vector3 displacement_W{Vector3::Zero()};  ///< delta: from the tool to its proxy [m]
  ModelStatus status{ModelStatus::kNone};
  std::array<ActivePlane, kMaxActive> active{};  ///< the first active_planes count
  int active_planes{0};
  /// U = fade f_s·delta / 2: energy stored in the spring. With equal stiffnesses and planes at rest, its
  /// derivative along the tool's twist is minus the spring wrench, including levers and rotations.
  double potential_J{0.0};
  bool new_planes{false};  ///< a new frame in this tick, or planes being released
};

/// Evaluates the virtual coupling, a spring with damping, between the tool and its proxy. The proxy is the
/// nearest position to the tool that satisfies the planes of the newest contact model.
///
///     g_j   = n_j·(X_WT p_TP_j - p_W_j) + r_j + h_j            gap, r_j the plane's recession
///     delta = min |delta|, n_j·delta >= -g_j  =  sum l_j n_j   the constrained proxy is at p_WT + delta
///     f     = c sum K_j l_j n_j,   t = c sum (X_WT p_TP_j - p_WTo) × K_j l_j n_j
///     c     = fade (1 + clamp(b nu / |f_s|, -1, damping_share)),  nu = -(f_s·v + t_s·w) / |f_s|
///
/// Damping is a factor on the whole spring wrench (f_s, t_s). It therefore acts only along the resultant,
/// takes the power b nu^2, and never makes the surface pull (c >= 0). It adds at most a share of the spring's
/// force, so the force does not jump in a new contact (safety::WrenchRateTrip). With equal stiffnesses, f_s =
/// K delta.
///
/// Recession. A plane recedes while the tool cuts it: r_j grows by advance_j dt if the contact pressed in
/// this tick with the spindle on and the model is younger than fresh_s, by at most the remaining penetration.
/// A new frame's planes belong to an older pose. They get at once the recession of the time since then in
/// which the tool was cutting, so that they continue the old planes without a step. The time with any contact
/// pressed counts, because contacts of different frames are not matched.
///
/// Held-back planes. A new frame may find bone where the last planes had none, for example if a predicted cut
/// stalled or a ledge came within reach. h_j holds such a plane back to where the proxy X_WP of the last tick
/// just touches it,
///
///     h_j = max(0, -(n_j·(X_WP p_TP_j - p_W_j) + r_j)),
///
/// less the violation between walls that are too close for the tool (HalfSpaceProjection::violation), so a
/// new frame never moves the proxy. h_j then falls to 0 within return_s at constant speed, so the force rises
/// by K h_j over several ticks. Planes that recede are followed at once, because a falling force is no shock
/// and adds no energy. A frame that is wrong by more than 1.5 v_max return_s still trips
/// safety::WrenchRateTrip.
///
/// Turn. A new frame may have fewer planes, or other directions, so that the force would turn at once: on a
/// convex bone by 15 to 19 N across 90 N, when a plane vanishes or one becomes three. The turn is spread over
/// return_s as well (hand_over.h), and f_s and t_s above include it. Only a change of stiffness between
/// frames is rendered at once; the energy tank pays for it.
///
/// Age. fade is 1 up to fresh_s and falls linearly with the age to 0 at gone_s; it rises by at most 1/ramp_s.
///
/// Axial torque of the cut. A spindle that turns about +z of T feels -spindle_torque z, scaled by the ratio
/// of this tick's force to the frame's force. It is zero with a still spindle or without contact.
///
/// Friction comes with the frames: with a still spindle, the simulation tilts the planes within the friction
/// cone, so that the force resists slip (simulation/contact/contact_law.h). No friction is added here. Under
/// a turning reamer friction acts along the cutting speed, and is the axial torque. A regularised friction in
/// the tick would have the gain mu F / v_0, more than a sampled loop can keep passive at 200 N.
///
/// @returns finite values for every model, with any bit pattern. A model that is not credible renders
///   nothing.
[[nodiscard]] CouplingOutput EvaluateCoupling(const CouplingParams& params, const CouplingInput& input,
                                              CouplingState& state) OSTEON_RT;

}  // namespace osteon::control
