#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/clock.h"
#include "control/loop/simulation_port.h"
#include "io/engine/messages.h"

namespace osteon::io {

/// Counts of a connection to an engine.
struct EngineCounters {
  std::uint64_t frames{0};    ///< frames received
  std::uint64_t lost{0};      ///< frames that the engine made and that never came here
  std::uint64_t rejected{0};  ///< messages refused as damaged, hostile or from a stranger
};

/// A run's side of the connection to an engine in a process of its own. The servo thread calls Load and
/// Store; one other thread calls the other functions.
class EngineClient : public control::SimulationPort {
 public:
  /// Waits for the next frame, in order, at most until `deadline`. False if none came.
  [[nodiscard]] virtual bool AwaitFrame(EngineFrame& frame, rt::Nanoseconds deadline) = 0;
  /// Sends one command with its own dt_s, for lockstep. Not to be mixed with Store.
  virtual void Send(const EngineCommand& command) = 0;
  /// Tells the engine to make no more frames, and fetches the bytes of the carved state, as WriteCarvedState
  /// writes them. The error says why there are none.
  [[nodiscard]] virtual tl::expected<std::vector<std::uint8_t>, std::string> FetchCarved(
      rt::Nanoseconds deadline) = 0;
  [[nodiscard]] virtual EngineCounters counters() const = 0;
  /// The engine's name and device, as CuttingEngine has them.
  [[nodiscard]] virtual const std::string& engine() const = 0;
  [[nodiscard]] virtual const std::string& device() const = 0;
};

/// The event for which an engine's process has waited.
enum class EngineEvent : std::uint8_t {
  kNothing,  ///< no event until the deadline
  kCommand,
  kEnd,   ///< the carved state is wanted
  kGone,  ///< the run is over
};

/// The engine's side of the connection to a run. One thread.
class EngineServer {
 public:
  virtual ~EngineServer() = default;
  /// Waits for the newest command or another event, at most until `deadline`.
  [[nodiscard]] virtual EngineEvent Await(EngineCommand& command, rt::Nanoseconds deadline) = 0;
  /// Sends a frame to the run.
  virtual void Publish(const EngineFrame& frame) = 0;
  /// Hands the carved state over.
  virtual void PutCarved(std::vector<std::uint8_t> bytes) = 0;
};

}  // namespace osteon::io
