#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "config/cell_config.h"
#include "hil/stability/admittance_run.h"
#include "hil/stability/grip_run.h"

// What `osteon tune` asks of the loop: which hands, which contacts, how late everything is; and the answers.

namespace osteon::app {

/// The loop of a cell along one axis of its tool, and what its gains have to stand.
struct TuneTask {
  hil::AdmittanceLoopParams
      loop;                   ///< arm, delays and period of the cell; its own virtual tool; no hand, no wall
  double wall_N_per_m{20e3};  ///< the coupling's stiffness: planes that are evaluated in the tick
  /// Stiffness by which the planes themselves move, across the contact: the force limit over the radius of
  /// the tool's head. It acts through poses as old as a contact model may be.
  double plane_N_per_m{8e3};
  double worst_age_s{0.002};
  double margin{1.1};  ///< gain margin: hand and wall may be so many times what they are
  double command_loss{0.01};
  int command_jitter{1};                               ///< [ticks]
  double human_grip_N_per_m{3e3};                      ///< for these the tool has to stay light ...
  double stiffest_grip_N_per_m{10e3};                  ///< ... and these have to be stable at all
  double most_mass_kg{5.0}, most_drag_Ns_per_m{30.0};  ///< what counts as light
  control::VibrationParams vibration{};                ///< the cell's, and acting
  bool index_acts{true};                               ///< in the cell, too
};

[[nodiscard]] TuneTask TuneTaskOf(const config::CellConfig& cell);

/// Every hand of the grid up to a stiffness, and one that is just so stiff, with a firm hand's damping and
/// mass.
[[nodiscard]] std::vector<hil::GridHand> HandsUpTo(double stiffness_N_per_m);

/// A virtual tool.
struct TuneGains {
  double mass_kg{0.0}, damping_Ns_per_m{0.0};
};

/// The worst of hands and contacts (free, wall in the tick, planes as old as they may be), every command as
/// late as the latest, at a gain: hand and wall times `gain`.
/// @returns whether all are stable.
[[nodiscard]] bool StandsAll(const TuneTask& task, const TuneGains& gains,
                             const std::vector<hil::GridHand>& hands, double gain);
/// The same at gain 1 and at the margin.
[[nodiscard]] bool StandsAll(const TuneTask& task, const TuneGains& gains,
                             const std::vector<hil::GridHand>& hands);

/// The greatest gain up to which they stand all; 0: not even as they are. At most `most`.
[[nodiscard]] double GainMargin(const TuneTask& task, const TuneGains& gains,
                                const std::vector<hil::GridHand>& hands, double most = 5.0);

/// The least drag with which a virtual mass stands all; infinity where up to 3000 N s/m will do.
[[nodiscard]] double LeastDragFor(const TuneTask& task, double mass_kg,
                                  const std::vector<hil::GridHand>& hands);

/// One damping of the map: how stiff a wall may be, nothing late but what the cell says.
struct TuneBoundary {
  double damping_Ns_per_m{0.0};
  double predicted_N_per_m{0.0};  ///< 0: unstable without a wall
  double simulated_N_per_m{0.0};  ///< of the hand that the prediction finds worst
  double degraded_N_per_m{0.0};   ///< the same, with commands lost and late
  std::size_t hand{0};            ///< the worst
};
/// Walls up to `most_N_per_m` are looked at: such a value means at least so much.
[[nodiscard]] TuneBoundary BoundaryAt(const TuneTask& task, const TuneGains& gains,
                                      const std::vector<hil::GridHand>& hands, double most_N_per_m);

/// How fast the slowest motion of the worst hand dies out at a wall [1/s]; negative: it grows.
[[nodiscard]] double DecayRate(const TuneTask& task, const TuneGains& gains,
                               const std::vector<hil::GridHand>& hands, double wall_N_per_m);

/// The shipped parts, run with commands lost and late, once for each hand and contact.
struct TuneCheck {
  std::size_t runs{0};
  std::vector<std::string> grew;  ///< hand and contact
};
[[nodiscard]] TuneCheck CheckInTime(const TuneTask& task, const TuneGains& gains,
                                    const std::vector<hil::GridHand>& hands);

/// One hand that the gains leave to the vibration index: the worst of the contacts.
struct TuneCarried {
  hil::GridHand hand;
  std::string contact;
  hil::GripRun run;
  double calm_N{0.5};  ///< of the force between 5 and 40 Hz, from 1 s on: less is calm
  [[nodiscard]] bool Calm() const { return run.valid && run.one_s_N < calm_N; }
};
/// The shipped parts with the cell's vibration index, for every hand of the grid beyond human_grip_N_per_m,
/// fixture and clamp included: the grip closes on a tool that moves with 40 mm/s, the sensor's noise is .1 N,
/// commands get lost and come late. 10 s each. What a hand may tremble with, the index lets a loop do as well
/// (VibrationReference), and a loop close to oscillating makes up to twice of it: calm is below 2.2 tremor_N,
/// .5 N at least.
[[nodiscard]] std::vector<TuneCarried> CarryStiffHands(const TuneTask& task, const TuneGains& gains);

/// The greatest index that any of these hands raises by itself (kick of .1 mm/s, the same noise): 0 where the
/// gains alone carry them.
[[nodiscard]] double IndexWith(const TuneTask& task, const TuneGains& gains,
                               const std::vector<hil::GridHand>& hands);

}  // namespace osteon::app
