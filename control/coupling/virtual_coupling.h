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
  double damping_Ns_per_m{100.0};      ///< along the resultant
  double damping_share{0.25};          ///< limit of the damping force over the spring's force, 0 … 0.25
  double fresh_s{0.020};               ///< up to this age a model counts in full, and its planes recede
  double gone_s{0.060};                ///< from this age on nothing is rendered
  double ramp_s{0.100};                ///< shortest time from nothing to full
  double return_s{0.008};  ///< time in which a new plane beyond the proxy is released; one period: at once
  double turn_m_per_s{0.025};  ///< least speed of a turn after a change of planes, as K times this; > 0
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const CouplingParams& params);

/// A plane of the newest frame, as received.
struct FramePlane {
  Vector3 p_T_m{Vector3::Zero()}, p_W_m{Vector3::Zero()}, n_W{Vector3::UnitZ()};
  double stiffness_N_per_m{0.0};  ///< as rendered in full
};

/// The coupling's state between ticks.
struct CouplingState {
  static constexpr int kHistory = 64;
  struct CutSample {
    rt::Nanoseconds stamp{-1};
    double cut_s{0.0};  ///< time spent cutting up to the stamp
  };

  rt::Nanoseconds last{-1};  ///< time of the last tick; -1: none
  double fade{0.0};          ///< share of the coupling that is rendered, 0 … 1
  std::uint64_t frame{0};    ///< of the planes below
  rt::Nanoseconds pose_stamp{-1};
  std::array<FramePlane, simulation::kMaxContacts> planes{};  ///< the first plane_count count
  int plane_count{0};
  std::array<double, simulation::kMaxContacts> recession_m{};  ///< of each plane since pose_stamp
  std::array<double, simulation::kMaxContacts> held_back_m{};  ///< of each plane, still held back
  double return_m_per_s{0.0};                                  ///< of the planes held back
  bool has_proxy{false};                                       ///< the last tick was evaluated
  Pose X_WP{Pose::Identity()};                                 ///< proxy of the last tick
  double violation_m{0.0};  ///< how far its planes are violated between walls that are too close
  std::array<bool, simulation::kMaxContacts> pressed{};  ///< in the last tick, with the spindle on
  double cut_s{0.0};                                     ///< time with any plane pressed, spindle on
  std::array<CutSample, kHistory> history{};             ///< the last ticks' cut_s, a ring
  int next{0};
  HandOver hand_over;  ///< from the previous frame's planes to these
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
  double stiffness_N_per_m{0.0};     ///< K_j, as rendered in full
  double force_N{0.0};               ///< of the faded spring along n, without damping; > 0
};

/// One tick's result.
struct CouplingOutput {
  static constexpr int kMaxActive = 4;

  Wrench F_T_W;             ///< on the tool, at To, in W; faded, not yet limited
  Wrench F_contact_T_W;     ///< part of it that the planes exert: without the spindle's torque
  Wrench F_hand_over_T_W;   ///< part of it that a hand-over adds to the planes' own
  double hand_over_s{0.0};  ///< time until the hand-over ends
  std::array<double, simulation::kMaxContacts> normal_force_N{};  ///< of each contact along its n, >= 0
  int active_count{0};                                            ///< contacts that press
  double age_s{0.0};                                              ///< of the model's pose
  double fade{0.0};                                               ///< share rendered, 0 … 1
  Vector3 displacement_W{Vector3::Zero()};                        ///< delta: from the tool to its proxy [m]
  ModelStatus status{ModelStatus::kNone};
  std::array<ActivePlane, kMaxActive> active{};  ///< the first active_planes count
  int active_planes{0};
  /// U = fade f_s·delta / 2: energy stored in the spring. With equal stiffnesses and planes at rest, its
  /// derivative along the tool's twist is minus the spring wrench, including levers and rotations.
  double potential_J{0.0};
  bool new_planes{false};  ///< another frame than in the tick before, or planes on their way back
};

/// Virtual coupling of the tool with the planes of the newest contact model, evaluated in every tick.
///
///     g_j   = n_j·(X_WT p_TP_j - p_W_j) + r_j + h_j            gap, r_j the plane's recession
///     delta = min |delta|, n_j·delta >= -g_j  =  sum l_j n_j   the constrained proxy is at p_WT + delta
///     f     = c sum K_j l_j n_j,   t = c sum (X_WT p_TP_j - p_WTo) × K_j l_j n_j
///     c     = fade (1 + clamp(b nu / |f_s|, -1, damping_share)),  nu = -(f_s·v + t_s·w) / |f_s|
///
/// Damping scales the whole spring wrench (f_s, t_s): it acts only along the resultant, takes power b nu^2
/// and never makes the surface pull (c >= 0). It adds at most a share of the spring's force, so a fresh
/// contact has no step (safety::WrenchRateTrip). Equal stiffnesses make f_s = K delta.
///
/// Recession. r_j grows by advance_j dt where the contact pressed in this tick with the spindle on and the
/// model is younger than fresh_s, by at most the remaining penetration. A new frame's planes are as old as
/// its pose; the time spent cutting since that pose (of any contact, because contacts of different frames are
/// not matched) gives them the recession they would have had, so that the hand-over has no step.
///
/// Return. A new frame may find bone where the last planes had none: a cut stalled that was predicted to go
/// on, or a ledge came into view. h_j holds such a plane back to where the last tick's proxy X_WP just
/// touches it,
///
///     h_j = max(0, -(n_j·(X_WP p_TP_j - p_W_j) + r_j)),
///
/// less the violation between walls that are too close for the tool (HalfSpaceProjection::violation), so that
/// no frame moves the proxy. h_j falls to 0 within return_s at constant speed: the force rises by K h_j, but
/// over several ticks. Bone that gives way is followed at once, because a falling force is no shock and adds
/// no energy. A frame that is wrong by more than 1.5 v_max return_s still trips safety::WrenchRateTrip.
///
/// Turn. A new frame's planes may also be fewer, or lie differently, so that the force would turn at once: on
/// a convex bone 15 to 19 N across 90 N, where a plane vanished or one became three. The turn takes return_s
/// as well (hand_over.h), and f_s and t_s above include it. Only a change of stiffness between frames is
/// rendered at once; the energy tank pays for it.
///
/// Age. fade is 1 up to fresh_s and falls linearly with the age to 0 at gone_s; it rises by at most 1/ramp_s.
///
/// Axial torque of the cut: a spindle that turns about +z of T feels -spindle_torque z, in proportion to this
/// tick's force over the frame's; zero with the spindle still or no contact.
///
/// Friction comes with the frames: with a still spindle their planes are tilted, within the cone of mu, by
/// what the proxy was held back (simulation/contact/contact_law.h), so that the force resists the slip. No
/// friction is added here: under a turning reamer friction acts along the spindle's speed and is the axial
/// torque, and a regularised friction in the tick has the gain mu F / v_0, more than a sampled loop can keep
/// passive at 200 N.
///
/// @param X_WT  tool pose; its rotation orthonormal  @param V_WT  velocity of T at To, in W
/// @param now   on the clock of model.pose_stamp; not decreasing
/// @returns finite values for every model, with any bit pattern. A model that is not credible renders
///   nothing.
[[nodiscard]] CouplingOutput EvaluateCoupling(const CouplingParams& params,
                                              const simulation::ContactModel& model, const Pose& X_WT,
                                              const Twist& V_WT, rt::Nanoseconds now, bool spindle_on,
                                              CouplingState& state) OSTEON_RT;

}  // namespace osteon::control
