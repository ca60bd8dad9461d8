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

/// Counters of a connection to an engine.
struct EngineCounters {
  std::uint64_t frames{0};  ///< frames received
  std::uint64_t lost{0};    ///< frames that the engine made but the run never received
  /// Messages refused because they were damaged, invalid, or from an unknown sender.
  std::uint64_t rejected{0};
};

/// The run's side of the connection to an engine in a separate process. The servo thread calls Load and
/// Store; one other thread calls the other functions.
class EngineClient : public control::SimulationPort {
 public:
  /// Waits for the next frame (in their order), at most until `deadline`. Returns false if none arrived.
  [[nodiscard]] virtual bool AwaitFrame(EngineFrame& frame, rt::Nanoseconds deadline) = 0;
  /// Sends one command with its own dt_s, for lockstep operation. Must not be combined with Store.
  virtual void Send(const EngineCommand& command) = 0;
  /// Tells the engine to make no more frames, and fetches the carved state, in the format of
  /// WriteCarvedState. The error says why there is no carved state.
  [[nodiscard]] virtual tl::expected<std::vector<std::uint8_t>, std::string> FetchCarved(
      rt::Nanoseconds deadline) = 0;
  [[nodiscard]] virtual EngineCounters counters() const = 0;
  /// The engine's name and device, as reported by CuttingEngine.
  [[nodiscard]] virtual const std::string& engine() const = 0;
  [[nodiscard]] virtual const std::string& device() const = 0;
};

/// The event for which an engine's process has waited.
enum class EngineEvent : std::uint8_t {
  kNothing,  ///< no event occurred until the deadline
  kCommand,
  kEnd,   ///< the run has ended its commands and wants the carved state
  kGone,  ///< the run has ended or is gone
};

/// The engine's side of the connection to a run. One thread.
class EngineServer {
 public:
  virtual ~EngineServer() = default;
  /// Waits for the newest command or another event, at most until `deadline`.
  [[nodiscard]] virtual EngineEvent Await(EngineCommand& command, rt::Nanoseconds deadline) = 0;
  /// Sends a frame to the run.
  virtual void Publish(const EngineFrame& frame) = 0;
  /// Gives the carved state to the run.
  virtual void PutCarved(std::vector<std::uint8_t> bytes) = 0;
};

}  // namespace osteon::io
