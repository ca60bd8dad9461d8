#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/reading/cell_config.h"
#include "studies/stability/admittance_run.h"
#include "studies/stability/grip_run.h"
#include "studies/stability/measured_loop.h"

// The stability computations of `osteon tune`: hands, contacts and delays, and the results for them.

namespace osteon::studies {

/// A hand whose own loop was measured: -F / q_cmd while it held the handle, divided by the hand's impedance.
struct HeldLoop {
  hil::GridHand hand;
  std::shared_ptr<const MeasuredPlant> response;  ///< with the sensor's delay
};

/// A cell's loop along one axis of its tool, and the conditions in which its gains must be stable.
struct TuneTask {
  hil::AdmittanceLoopParams loop;  ///< arm, delays, period and virtual tool of the cell; no hand, no wall
  double wall_N_per_m{20e3};       ///< the coupling's stiffness: each tick evaluates it at the present pose
  /// Stiffness of the planes' own motion across the contact: the force limit over the radius of the tool's
  /// head. It acts through poses as old as a contact model may be.
  double plane_N_per_m{8e3};
  double worst_age_s{0.002};
  double margin{1.1};  ///< gain margin: factor on hand and wall at which the loop must still be stable
  double command_loss{0.01};
  int command_jitter{1};                             ///< [ticks]
  double human_grip_N_per_m{3e3};                    ///< up to this grip the tool has to stay light ...
  double stiffest_grip_N_per_m{10e3};                ///< ... and up to this grip it has to be stable
  double max_mass_kg{5.0}, max_drag_Ns_per_m{30.0};  ///< limits up to which a tool counts as light
  control::VibrationParams vibration{};              ///< the cell's index, made to act in this study
  bool index_acts{true};                             ///< whether the index also acts in the cell itself

  // From the cell's measurements (studies/tune/tune_measured.h); without them all lags are assumed.
  std::optional<config::IdentifiedCell> identified{};
  bool arm_measured{false};  ///< false: the measurements have no arm, and its lag is assumed
  std::vector<hil::GridHand> measured_hands{};      ///< the loop must be stable with them, however stiff
  std::shared_ptr<const MeasuredPlant> response{};  ///< null: no response was measured
  double response_delay_s{0.0};                     ///< delay of the force that the response does not include
  std::vector<HeldLoop> held{};                     ///< each is judged by its own measured response
  /// A structure was found that the model of the arm lacks: gains are judged by the response alone.
  bool measured_only{false};
};

/// The task that the cell's file gives, without its measurements.
[[nodiscard]] TuneTask TuneTaskOf(const config::CellConfig& cell);

/// Returns every hand of the grid up to a stiffness, and one of exactly that stiffness with a firm hand's
/// damping and mass.
[[nodiscard]] std::vector<hil::GridHand> HandsUpTo(double stiffness_N_per_m);
/// Returns the same hands and the task's measured hands.
[[nodiscard]] std::vector<hil::GridHand> HandsUpTo(const TuneTask& task, double stiffness_N_per_m);

/// The contacts of a task: free, a wall evaluated in the tick, planes at their greatest age.
enum class TuneContact { kFree, kWall, kPlanes };
inline constexpr TuneContact kTuneContacts[]{TuneContact::kFree, TuneContact::kWall, TuneContact::kPlanes};
/// "free", "wall", "planes".
[[nodiscard]] const char* NameOf(TuneContact contact);
/// The wall of a contact, multiplied by `gain`.
[[nodiscard]] hil::LoopWall WallOf(const TuneTask& task, TuneContact contact, double gain);

/// The mass and drag of a virtual tool.
struct TuneGains {
  double mass_kg{0.0}, damping_Ns_per_m{0.0};
};

/// Checks all hands and contacts (free, wall evaluated in the tick, planes at their greatest age) with the
/// greatest delay of every command; hand and wall are multiplied by `gain`.
/// @returns whether all are stable.
[[nodiscard]] bool StandsAll(const TuneTask& task, const TuneGains& gains,
                             const std::vector<hil::GridHand>& hands, double gain);
/// Checks at gain 1 and at the margin.
[[nodiscard]] bool StandsAll(const TuneTask& task, const TuneGains& gains,
                             const std::vector<hil::GridHand>& hands);

/// The greatest gain, up to `max_gain`, at which all hands and contacts are stable; 0: not even at gain 1.
[[nodiscard]] double GainMargin(const TuneTask& task, const TuneGains& gains,
                                const std::vector<hil::GridHand>& hands, double max_gain = 5.0);

/// The least drag with which a virtual mass is stable with all hands; infinity if 3000 N s/m are not enough.
[[nodiscard]] double MinDragFor(const TuneTask& task, double mass_kg,
                                const std::vector<hil::GridHand>& hands);

/// One damping of the map: the stiffest stable wall with the cell's own delays only.
struct TuneBoundary {
  double damping_Ns_per_m{0.0};
  double predicted_N_per_m{0.0};  ///< 0: unstable without a wall
  double simulated_N_per_m{0.0};  ///< with the hand that the prediction finds worst
  double degraded_N_per_m{0.0};   ///< the same, with commands lost and late
  std::size_t hand{0};            ///< index of the worst hand
};
/// Searches walls up to `max_N_per_m`; this value as a result means "at least".
[[nodiscard]] TuneBoundary BoundaryAt(const TuneTask& task, const TuneGains& gains,
                                      const std::vector<hil::GridHand>& hands, double max_N_per_m);

/// Decay rate of the slowest motion of the worst hand at a wall [1/s]; negative: it grows.
[[nodiscard]] double DecayRate(const TuneTask& task, const TuneGains& gains,
                               const std::vector<hil::GridHand>& hands, double wall_N_per_m);

/// Simulations of the shipped parts with lost and late commands, one for each hand and contact.
struct TuneCheck {
  std::size_t runs{0};
  std::vector<std::string> grew;  ///< hand and contact whose motion grew
};
/// Simulates every hand in every contact.
[[nodiscard]] TuneCheck CheckInTime(const TuneTask& task, const TuneGains& gains,
                                    const std::vector<hil::GridHand>& hands);

/// A hand that only the vibration index makes stable, in its worst contact.
struct TuneCarried {
  hil::GridHand hand;
  std::string contact;
  GripRun run;
  double calm_N{0.5};  ///< limit of the force between 5 and 40 Hz, from 1 s on: below it the loop is calm
  [[nodiscard]] bool Calm() const { return run.valid && run.one_s_N < calm_N; }
};
/// Simulates the shipped parts with the cell's vibration index for every hand of the grid beyond
/// human_grip_N_per_m, fixture and clamp included, 10 s each. The grip closes on a tool that moves at 40
/// mm/s, the sensor's noise is 0.1 N, commands are lost and late. The index permits a loop as much vibration
/// as a hand's tremor (VibrationReference), and a loop close to oscillating reaches up to twice that: calm is
/// below 2.2 tremor_N, at least 0.5 N.
[[nodiscard]] std::vector<TuneCarried> CarryStiffHands(const TuneTask& task, const TuneGains& gains);

/// The greatest index that any of these hands raises by itself (kick of 0.1 mm/s, the same noise): 0 if the
/// gains alone stabilise them.
[[nodiscard]] double IndexWith(const TuneTask& task, const TuneGains& gains,
                               const std::vector<hil::GridHand>& hands);

}  // namespace osteon::studies
