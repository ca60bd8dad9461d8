#pragma once

#include <cstdint>
#include <string>

#include "control/rt/clock.h"
#include "io/can/can_pump.h"
#include "kinematics/spatial.h"

namespace osteon::io {

/// What a sensor says about a reading, whatever its make.
enum SensorFlag : std::uint32_t {
  kSensorOverload = 1u << 0,  ///< an axis beyond its range: the value is not to be trusted
  kSensorFault = 1u << 1,     ///< supply, temperature, memory, calibration: not to be trusted
  kSensorBusError = 1u << 2,  ///< the sensor saw errors on its bus: readings may be missing
  kSensorWarning = 1u << 3,   ///< something else; the value stands
};

/// One reading: force and torque on the sensor's tool side, at S's origin, in the sensor's frame S as its
/// maker drew it. The tool's weight is in it.
struct SensorReading {
  rt::Nanoseconds stamp{0};  ///< arrival of its first frame; 0: none yet
  PlainWrench F_S;
  std::uint32_t flags{0};   ///< SensorFlag
  std::uint16_t status{0};  ///< as the sensor sent it; the make's own bits
};

enum class SensorPhase : std::uint8_t {
  kStarting,  ///< being set up: no reading yet
  kReady,     ///< readings come
  kFailed,    ///< refused; failure() says why. Restart() tries again
};

struct SensorCounters {
  std::uint64_t readings{0};
  std::uint64_t halves{0};      ///< frames that never found their other half
  std::uint64_t malformed{0};   ///< of a wrong size
  std::uint64_t unexpected{0};  ///< answers to another command than the one given, values that are none
};

/// A six-axis force sensor on a CAN bus. It is set up by the same frames-in, frames-out calls that run it:
/// pump it until phase() is no longer kStarting.
class WrenchSensor : public CanClient {
 public:
  /// The newest reading; its age is the caller's to judge.
  [[nodiscard]] virtual const SensorReading& Latest() const OSTEON_RT = 0;
  [[nodiscard]] virtual SensorPhase phase() const OSTEON_RT = 0;
  [[nodiscard]] virtual SensorCounters counters() const OSTEON_RT = 0;

  /// Makes the present load the zero (true), or shows the load itself again (false). Takes effect within some
  /// readings.
  virtual void RequestBias(bool on) OSTEON_RT = 0;

  /// Sets the sensor up anew, e.g. after its supply was off.
  virtual void Restart() OSTEON_RT = 0;

  /// kFailed, as it never answered: it may be switched on yet.
  [[nodiscard]] virtual bool silent() const OSTEON_RT = 0;

  /// Why it was refused: device, value found, what is accepted. Empty unless kFailed. Not for the tick.
  [[nodiscard]] virtual std::string failure() const = 0;
};

}  // namespace osteon::io
