#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/fnv1a.h"
#include "config/reading/scenario_config.h"
#include "control/tick_record.h"
#include "simulation/contact/contact_model.h"

namespace osteon::studies {

/// The parts of a tick, in the order in which each follows from those before: the first three are the loop's
/// inputs, the others its results. Every tick has a digest of each part, which shows the tick and the part in
/// which a difference began.
enum class TracePart : std::uint8_t {
  kArm,       ///< the arm's message, and whether the arm got earlier answers
  kDevices,   ///< readings of force sensor, drive and PLC; requests of the operator
  kBone,      ///< the contact model
  kHand,      ///< the loop's estimate of the hand's wrench, and the vibration in it
  kCoupling,  ///< the rendered wrench, and the limits that acted on it
  kState,     ///< state of the cell, faults, limits
  kCommand,   ///< the commands to arm and spindle
};
inline constexpr int kTraceParts = 7;
inline constexpr int kTraceInputs = 3;  ///< number of parts that are inputs; they come first
/// Names a part: "arm's message".
[[nodiscard]] const char* NameOf(TracePart part);

/// The digests of a tick: 12 bits for each part.
using TickDigest = std::array<std::uint16_t, kTraceParts>;

/// The tolerance that applies to a quantity.
enum class QuantityKind : std::uint8_t {
  kPosition,
  kAngle,
  kForce,
  kTorque,
  kSpeed,
  kVolume,
  kEnergy,
  kShare,
};

/// A sampled quantity. All values of a trace are in the unit of their quantity.
struct TraceQuantity {
  std::string name;    ///< name that ends in the unit, as in tables: tool_z_mm
  std::string family;  ///< name that is common to all axes or joints: tool
  QuantityKind kind{QuantityKind::kPosition};
};
/// Lists the quantities in the order of a sample's values.
[[nodiscard]] std::span<const TraceQuantity> TraceQuantities();
/// Returns "mm" or the like; empty for a pure number.
[[nodiscard]] const char* UnitOf(QuantityKind kind);
/// Number of decimals of the values in a golden file. The rounding is far smaller than the tolerances.
[[nodiscard]] int DecimalsOf(QuantityKind kind);
/// Returns the tolerance in the quantity's unit.
[[nodiscard]] double ToleranceOf(QuantityKind kind, const config::TraceTolerances& tolerances);

/// The values of all quantities in one tick.
struct TraceSample {
  std::uint64_t tick{0};
  std::vector<double> values;  ///< one for each of TraceQuantities
};

/// An event of a run, such as a change of state.
struct TraceEvent {
  std::uint64_t tick{0};
  std::string what;  ///< "state haptic", "fault sensor_silent", "scene pulp reached"
};

/// A scenario's run, reduced to the data that are compared.
struct ScenarioTrace {
  double period_s{0.0};     ///< period of a tick
  std::uint64_t ticks{0};   ///< number of ticks of the run
  std::uint64_t active{0};  ///< number of ticks that rendered
  /// Hash of every bit of every tick's record, of the contact models that the ticks used, and of the carved
  /// bone.
  std::uint64_t hash{0};
  std::string ended;  ///< how it ended: "completed", or what never came
  std::vector<TraceEvent> events;
  std::vector<TraceSample> samples;  ///< at multiples of the interval, from the arm's first motion on
  /// Smallest and largest value of each quantity, over all ticks from the arm's first motion on.
  std::vector<double> least, greatest;
  std::uint64_t first_tick{0};      ///< tick of the first digest
  std::vector<TickDigest> digests;  ///< digests of every tick from first_tick on

  /// Returns a tick's time; the first tick is at one period.
  [[nodiscard]] double TimeOf_s(std::uint64_t tick) const { return period_s * static_cast<double>(tick + 1); }
};

/// Calls deliver(golden sample, new sample) for each tick that both traces have sampled.
template <class Deliver>
void VisitCommonSamples(const ScenarioTrace& golden, const ScenarioTrace& now, Deliver&& deliver) {
  auto g = golden.samples.begin();
  for (const TraceSample& sample : now.samples) {
    while (g != golden.samples.end() && g->tick < sample.tick) ++g;
    if (g == golden.samples.end()) return;
    if (g->tick == sample.tick) deliver(*g, sample);
  }
}

/// Makes a trace from a run in virtual time.
class TraceRecorder {
 public:
  /// @param sample_s  sampling interval; rounded to a multiple of the period
  TraceRecorder(double period_s, double sample_s);

  /// Adds one tick and the contact model that it used.
  void Tick(const control::TickRecord& record, const simulation::ContactModel& model);
  /// Adds an event of the scene. @param stamp  its virtual time [ns]
  void SceneEvent(std::int64_t stamp, const std::string& name);
  /// Completes the trace. @param carved  hash of the carved bone
  [[nodiscard]] ScenarioTrace Finish(std::string ended, std::uint64_t active, std::uint64_t carved);

 private:
  /// Adds an event for each change of the session, the cell's state or a fault.
  void NoteState(const control::TickRecord& record);
  /// Updates the extremes of each quantity, and stores a sample if one is due.
  void Sample(const control::TickRecord& record, const simulation::ContactModel& model);

  ScenarioTrace trace_;
  std::uint64_t sample_ticks_;
  bool begun_{false};  ///< the arm has moved
  base::Fnv1a hash_;
  int cell_state_{-1};
  std::uint32_t faults_{0};
  bool active_{false};
  std::vector<double> values_;
};

}  // namespace osteon::studies
