#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "app/fnv1a.h"
#include "config/scenario_config.h"
#include "control/tick_record.h"
#include "simulation/contact_model.h"

namespace osteon::app {

/// What a tick is made of, in the order in which one follows from the other: the first three are what the
/// loop was given, the others what it made of that. A digest of each in every tick tells where a difference
/// began.
enum class TracePart : std::uint8_t {
  kArm,       ///< its message, what became of earlier ones
  kDevices,   ///< force sensor, drive, PLC; what was asked for
  kBone,      ///< the contact model
  kHand,      ///< what the loop takes the hand to exert, and the vibration in it
  kCoupling,  ///< what is rendered, and what limited it
  kState,     ///< of the cell; faults, limits
  kCommand,   ///< what arm and spindle are told
};
inline constexpr int kTraceParts = 7;
inline constexpr int kTraceInputs = 3;  ///< the first of them
/// "arm's message"
[[nodiscard]] const char* NameOf(TracePart part);

/// 12 bits of each part.
using TickDigest = std::array<std::uint16_t, kTraceParts>;

/// Which of the tolerances is a quantity's.
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

/// What is sampled. Values of it are in its unit, everywhere in a trace.
struct TraceQuantity {
  std::string name;    ///< with the unit at its end, as in tables: tool_z_mm
  std::string family;  ///< what its axes or joints have in common: tool
  QuantityKind kind{QuantityKind::kPosition};
};
/// In the order of a sample's values.
[[nodiscard]] std::span<const TraceQuantity> TraceQuantities();
/// "mm"; empty of a pure number.
[[nodiscard]] const char* UnitOf(QuantityKind kind);
/// Of the values that a file holds: well below the tolerances.
[[nodiscard]] int DecimalsOf(QuantityKind kind);
/// In the quantity's unit.
[[nodiscard]] double ToleranceOf(QuantityKind kind, const config::TraceTolerances& tolerances);

struct TraceSample {
  std::uint64_t tick{0};
  std::vector<double> values;  ///< one for each of TraceQuantities
};

/// Something that is there or is not.
struct TraceEvent {
  std::uint64_t tick{0};
  std::string what;  ///< "state haptic", "fault sensor_silent", "scene pulp reached"
};

/// A run of a scenario, as far as it is compared.
struct ScenarioTrace {
  double period_s{0.0};     ///< of a tick
  std::uint64_t ticks{0};   ///< of the run
  std::uint64_t active{0};  ///< of them, rendering
  std::uint64_t hash{
      0};  ///< over every bit of every tick's record, of the models that ticks saw and of the carved bone
  std::string ended;  ///< how: "completed", or what never came
  std::vector<TraceEvent> events;
  std::vector<TraceSample> samples;     ///< at multiples of the interval, from when the arm began to move
  std::vector<double> least, greatest;  ///< of each quantity, over all ticks from then on
  std::uint64_t first_tick{0};          ///< of the digests
  std::vector<TickDigest> digests;      ///< of every tick from then on

  /// When a tick was: the first one is at one period.
  [[nodiscard]] double TimeOf_s(std::uint64_t tick) const { return period_s * static_cast<double>(tick + 1); }
};

/// take(golden's, now's) of each tick that both have sampled.
template <class Take>
void VisitCommonSamples(const ScenarioTrace& golden, const ScenarioTrace& now, Take&& take) {
  auto g = golden.samples.begin();
  for (const TraceSample& sample : now.samples) {
    while (g != golden.samples.end() && g->tick < sample.tick) ++g;
    if (g == golden.samples.end()) return;
    if (g->tick == sample.tick) take(*g, sample);
  }
}

/// Makes a trace of what a run in virtual time does.
class TraceRecorder {
 public:
  /// @param sample_s  from one sample to the next; a multiple of the period is made of it
  TraceRecorder(double period_s, double sample_s);

  /// One tick and the contact model that it saw.
  void Tick(const control::TickRecord& record, const simulation::ContactModel& model);
  /// @param stamp  the virtual time [ns] of what has happened in the scene
  void SceneEvent(std::int64_t stamp, const std::string& name);
  /// @param carved  hash of the carved bone
  [[nodiscard]] ScenarioTrace Finish(std::string ended, std::uint64_t active, std::uint64_t carved);

 private:
  void NoteState(const control::TickRecord& record);
  void Sample(const control::TickRecord& record, const simulation::ContactModel& model);

  ScenarioTrace trace_;
  std::uint64_t sample_ticks_;
  bool begun_{false};
  Fnv1a hash_;
  int cell_state_{-1};
  std::uint32_t faults_{0};
  bool active_{false};
  std::vector<double> values_;
};

}  // namespace osteon::app
