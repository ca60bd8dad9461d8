#pragma once

#include <cstdint>
#include <string>

#include "base/clock.h"
#include "io/can/can_pump.h"
#include "kinematics/spatial.h"

namespace osteon::io {

/// Flags of a reading, the same for all manufacturers.
enum SensorFlag : std::uint32_t {
  kSensorOverload = 1u << 0,  ///< an axis beyond its range: do not trust the value
  kSensorFault = 1u << 1,     ///< supply, temperature, memory, calibration: do not trust the value
  kSensorBusError = 1u << 2,  ///< the sensor saw errors on its bus: readings may be missing
  kSensorWarning = 1u << 3,   ///< another warning; the value is valid
};

/// One reading: force and torque on the sensor's tool side, at S's origin, in the maker's sensor frame S. The
/// tool's weight is included.
struct SensorReading {
  rt::Nanoseconds stamp{0};  ///< arrival of its first frame; 0: none yet
  PlainWrench F_S;
  std::uint32_t flags{0};   ///< SensorFlag
  std::uint16_t status{0};  ///< status word as sent; its bits depend on the manufacturer
};

enum class SensorPhase : std::uint8_t {
  kStarting,  ///< being set up: no reading yet
  kReady,     ///< readings come
  kFailed,    ///< refused; failure() gives the reason. Restart() tries again
};

struct SensorCounters {
  std::uint64_t readings{0};
  std::uint64_t halves{0};      ///< frames without their other half
  std::uint64_t malformed{0};   ///< of a wrong size
  std::uint64_t unexpected{0};  ///< answers to another command than the one sent, invalid values
};

/// A six-axis force sensor on a CAN bus. Accept and Next also set it up: call them (a CanPump does) until
/// phase() is no longer kStarting.
class WrenchSensor : public CanClient {
 public:
  /// The newest reading; the caller checks its age.
  [[nodiscard]] virtual const SensorReading& Latest() const OSTEON_RT = 0;
  [[nodiscard]] virtual SensorPhase phase() const OSTEON_RT = 0;
  [[nodiscard]] virtual SensorCounters counters() const OSTEON_RT = 0;

  /// Makes the present load the zero (true), or removes this bias (false). Takes effect within a few
  /// readings.
  virtual void RequestBias(bool on) OSTEON_RT = 0;

  /// Sets the sensor up again, e.g. after its supply was off.
  virtual void Restart() OSTEON_RT = 0;

  /// Whether the phase is kFailed because the sensor never answered: it may not be switched on yet.
  [[nodiscard]] virtual bool silent() const OSTEON_RT = 0;

  /// Why the sensor was refused: device, value found, what is accepted. Empty unless kFailed. Not for the
  /// tick.
  [[nodiscard]] virtual std::string failure() const = 0;
};

}  // namespace osteon::io
