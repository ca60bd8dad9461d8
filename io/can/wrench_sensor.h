#pragma once

#include <cstdint>
#include <string>

#include "base/clock.h"
#include "io/can/can_pump.h"
#include "kinematics/spatial.h"

namespace osteon::io {

/// Flags of a reading, the same for all manufacturers.
enum SensorFlag : std::uint32_t {
  kSensorOverload = 1u << 0,  ///< an axis is beyond its range: the values are not valid
  kSensorFault = 1u << 1,  ///< error of supply, temperature, memory or calibration: the values are not valid
  kSensorBusError = 1u << 2,  ///< the sensor has detected errors on its bus: readings may be missing
  kSensorWarning = 1u << 3,   ///< another warning; the values are valid
};

/// One reading: force and torque on the sensor's tool side, at S's origin, in the manufacturer's sensor frame
/// S. The tool's weight is included.
struct SensorReading {
  rt::Nanoseconds stamp{0};  ///< time of arrival of the reading's first frame; 0: no reading yet
  PlainWrench F_S;
  std::uint32_t flags{0};   ///< SensorFlag bits
  std::uint16_t status{0};  ///< status word as sent; its bits depend on the manufacturer
};

enum class SensorPhase : std::uint8_t {
  kStarting,  ///< the sensor is being set up: no reading yet
  kReady,     ///< readings arrive
  kFailed,    ///< the sensor was refused; failure() gives the reason, Restart() tries again
};

struct SensorCounters {
  std::uint64_t readings{0};
  std::uint64_t halves{0};      ///< frames without their other half
  std::uint64_t malformed{0};   ///< frames of a wrong size
  std::uint64_t unexpected{0};  ///< answers to a command that was not sent, or with invalid values
};

/// A six-axis force sensor on a CAN bus. Accept and Next also set it up: call them (a CanPump does) until
/// phase() is no longer kStarting.
class WrenchSensor : public CanClient {
 public:
  /// Returns the newest reading. The caller must check its age.
  [[nodiscard]] virtual const SensorReading& Latest() const OSTEON_RT = 0;
  [[nodiscard]] virtual SensorPhase phase() const OSTEON_RT = 0;
  [[nodiscard]] virtual SensorCounters counters() const OSTEON_RT = 0;

  /// True: makes the present load the sensor's zero (sets the bias). False: removes the bias. Takes effect
  /// within a few readings.
  virtual void RequestBias(bool on) OSTEON_RT = 0;

  /// Sets the sensor up again, e.g. after its supply was off.
  virtual void Restart() OSTEON_RT = 0;

  /// Whether the phase is kFailed because the sensor never answered. Possibly the sensor is not switched on
  /// yet.
  [[nodiscard]] virtual bool silent() const OSTEON_RT = 0;

  /// Returns why the sensor was refused: device, value found, value accepted. Empty unless the phase is
  /// kFailed. Not for use in the tick.
  [[nodiscard]] virtual std::string failure() const = 0;
};

}  // namespace osteon::io
