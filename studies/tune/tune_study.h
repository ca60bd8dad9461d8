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

// The computations of `osteon tune` about stability: their inputs (hands, contacts, delays) and their
// results.

namespace osteon::studies {

/// A hand whose own loop was measured while it held the handle. The response is -F / q_cmd (force over
/// commanded position), divided by the hand's impedance.
struct HeldLoop {
  hil::GridHand hand;
  std::shared_ptr<const MeasuredPlant> response;  ///< includes the sensor's delay
};

/// A cell's loop along one axis of its tool, and the conditions in which its gains must be stable.
struct TuneTask {
  hil::AdmittanceLoopParams loop;  ///< arm, delays, period and virtual tool of the cell; no hand, no wall
  /// the coupling's stiffness; each tick evaluates the coupling at the present pose
  double wall_N_per_m{20e3};
  /// Lateral stiffness that the planes cause by their own motion: the force limit over the radius of the
  /// tool's head. The planes follow from a pose that is as old as the contact model may be.
  double plane_N_per_m{8e3};
  double worst_age_s{0.002};
  double margin{1.1};  ///< gain margin: factor on hand and wall at which the loop must still be stable
  double command_loss{0.01};
  int command_jitter{1};  ///< largest additional delay of a command [ticks]
  /// with grips up to this stiffness the tool must stay light
  double human_grip_N_per_m{3e3};
  /// with grips up to this stiffness the tool must be stable
  double stiffest_grip_N_per_m{10e3};
  double max_mass_kg{5.0}, max_drag_Ns_per_m{30.0};  ///< a tool counts as light up to these limits
  /// the cell's vibration index; this study always switches it on
  control::VibrationParams vibration{};
  /// whether the index is also switched on in the cell itself
  bool index_acts{true};

  // From the cell's measurements (studies/tune/tune_measured.h). Without measurements, all lags are assumed.
  std::optional<config::IdentifiedCell> identified{};
  bool arm_measured{false};  ///< false: no arm was measured, and its lag is assumed
  /// the loop must be stable with these hands, however stiff they are
  std::vector<hil::GridHand> measured_hands{};
  std::shared_ptr<const MeasuredPlant> response{};  ///< null: no response was measured
  /// the sensor's delay, if the response does not include it
  double response_delay_s{0.0};
  /// hands whose own loops were measured; each loop is judged by its own response
  std::vector<HeldLoop> held{};
  /// A structural resonance was found that the arm's model lacks, so gains are judged by the measured
  /// response alone.
  bool measured_only{false};
};

/// The task that the cell's file describes, without the cell's measurements.
[[nodiscard]] TuneTask TuneTaskOf(const config::CellConfig& cell);

/// Returns all hands of the grid that are at most as stiff as this, and one hand of exactly this stiffness
/// with the damping and mass of a firm hand.
[[nodiscard]] std::vector<hil::GridHand> HandsUpTo(double stiffness_N_per_m);
/// Returns these hands of the grid and the task's measured hands.
[[nodiscard]] std::vector<hil::GridHand> HandsUpTo(const TuneTask& task, double stiffness_N_per_m);

/// The contacts of a task: no contact, a wall that each tick evaluates at the present pose, and planes of the
/// largest age.
enum class TuneContact { kFree, kWall, kPlanes };
inline constexpr TuneContact kTuneContacts[]{TuneContact::kFree, TuneContact::kWall, TuneContact::kPlanes};
/// "free", "wall", "planes".
[[nodiscard]] const char* NameOf(TuneContact contact);
/// The wall of a contact; its stiffness is multiplied by `gain`.
[[nodiscard]] hil::LoopWall WallOf(const TuneTask& task, TuneContact contact, double gain);

/// The mass and drag of a virtual tool.
struct TuneGains {
  double mass_kg{0.0}, damping_Ns_per_m{0.0};
};

/// Checks all hands and contacts (free, a wall evaluated at the present pose, planes of the largest age).
/// Every command has its largest delay; hand and wall are multiplied by `gain`.
/// @returns whether all loops are stable.
[[nodiscard]] bool IsStable(const TuneTask& task, const TuneGains& gains,
                            const std::vector<hil::GridHand>& hands, double gain);
/// The same, at gain 1 and at the task's margin.
[[nodiscard]] bool IsStable(const TuneTask& task, const TuneGains& gains,
                            const std::vector<hil::GridHand>& hands);

/// The largest gain, up to `max_gain`, up to which all hands and contacts are stable; 0: unstable even at
/// gain 1.
[[nodiscard]] double GainMargin(const TuneTask& task, const TuneGains& gains,
                                const std::vector<hil::GridHand>& hands, double max_gain = 5.0);

/// The least drag with which a virtual mass is stable with all hands; infinity if 3000 N s/m are not enough.
[[nodiscard]] double MinDragFor(const TuneTask& task, double mass_kg,
                                const std::vector<hil::GridHand>& hands);

/// The stiffest stable wall for one damping of the map. Of the delays only the cell's own are included.
struct TuneBoundary {
  double damping_Ns_per_m{0.0};
  double predicted_N_per_m{0.0};  ///< by the linear analysis; 0: unstable without a wall
  double simulated_N_per_m{0.0};  ///< by simulation, with the hand that is the worst by the analysis
  double degraded_N_per_m{0.0};   ///< simulated like simulated_N_per_m, but with lost and late commands
  std::size_t hand{0};            ///< index of the worst hand by the analysis
};
/// Searches walls up to `max_N_per_m`. A result that equals max_N_per_m means "at least".
[[nodiscard]] TuneBoundary BoundaryAt(const TuneTask& task, const TuneGains& gains,
                                      const std::vector<hil::GridHand>& hands, double max_N_per_m);

/// Decay rate [1/s] of the slowest motion at a wall, with the worst hand; negative: the motion grows.
[[nodiscard]] double DecayRate(const TuneTask& task, const TuneGains& gains,
                               const std::vector<hil::GridHand>& hands, double wall_N_per_m);

/// Simulations of the shipped loop with lost and late commands, one for each hand and contact.
struct TuneCheck {
  std::size_t runs{0};
  std::vector<std::string> grew;  ///< hand and contact of each run in which the motion grew
};
/// Simulates every hand in every contact.
[[nodiscard]] TuneCheck CheckInTime(const TuneTask& task, const TuneGains& gains,
                                    const std::vector<hil::GridHand>& hands);

/// A hand stiffer than the human grip, and its simulated run with the vibration index in the worst contact.
struct StiffHandRun {
  hil::GridHand hand;
  std::string contact;
  GripRun run;
  double calm_N{0.5};  ///< bound of the force between 5 and 40 Hz after 1 s; the loop is calm below it
  [[nodiscard]] bool Calm() const { return run.valid && run.one_s_N < calm_N; }
};
/// Simulates the shipped loop with the cell's vibration index, for every hand of the grid that is stiffer
/// than human_grip_N_per_m, fixture and clamp included. Each run lasts 10 s. The grip closes on a tool that
/// moves at 40 mm/s, the sensor's noise is 0.1 N, and commands are lost and late. The index permits a loop as
/// much vibration as a hand's tremor (VibrationReference), and a loop close to oscillating reaches up to
/// twice that. Therefore a run counts as calm below 2.2 tremor_N, but at least 0.5 N.
[[nodiscard]] std::vector<StiffHandRun> RunStiffHands(const TuneTask& task, const TuneGains& gains);

/// The largest vibration index that any of these hands causes by itself, after a kick of 0.1 mm/s and with
/// the same noise. 0 if the gains alone stabilise all of them.
[[nodiscard]] double IndexWith(const TuneTask& task, const TuneGains& gains,
                               const std::vector<hil::GridHand>& hands);

}  // namespace osteon::studies
