#pragma once

#include "base/latest_value.h"
#include "base/marker.h"
#include "simulation/contact/contact_model.h"
#include "simulation/engine/cutting_engine.h"

namespace osteon::control {

/// The servo loop's interface to the cutting simulation, in this process or in another. Servo thread only.
class SimulationPort {
 public:
  virtual ~SimulationPort() = default;
  /// Returns the newest contact model, or a model with frame number 0 while there is none. The reference
  /// stays valid until the next call.
  [[nodiscard]] virtual const simulation::ContactModel& Load() OSTEON_RT = 0;
  /// Passes the newest command on. Never waits.
  virtual void Store(const simulation::ToolCommand& command) OSTEON_RT = 0;
};

/// A simulation in a thread of this process. Reads `models` and writes `commands`; both must outlive this
/// object.
class ThreadSimulation final : public SimulationPort {
 public:
  ThreadSimulation(rt::LatestValue<simulation::ContactModel>& models,
                   rt::LatestValue<simulation::ToolCommand>& commands)
      : models_(models), commands_(commands) {}

  [[nodiscard]] const simulation::ContactModel& Load() OSTEON_RT override { return models_.Load(); }
  void Store(const simulation::ToolCommand& command) OSTEON_RT override { commands_.Store(command); }

 private:
  rt::LatestValue<simulation::ContactModel>& models_;
  rt::LatestValue<simulation::ToolCommand>& commands_;
};

}  // namespace osteon::control
