#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/can/can_bus.h"
#include "io/can/pair_joiner.h"
#include "io/can/wrench_sensor.h"

namespace osteon::io {

struct RobotousParams {
  std::uint16_t command_id{0x64}, first_id{0x01},
      second_id{0x02};  ///< the manufacturer's default identifiers; each can be changed in the sensor
  int rate_hz{1000};    ///< accepted: 10, 20, 50, 100, 200, 500, 1000
  int filter_hz{0};  ///< cut-off frequency of the sensor's low-pass filter; 0: off; accepted: 1, 2, 3, 5, 10,
                     ///< 20, 30, 40, 50, 100 … 500
  double counts_per_N{50.0};                               ///< depends on the model; 50 for most models
  double counts_per_Nm{2000.0};                            ///< depends on the model; 2000 for most models
  rt::Nanoseconds settle{20 * rt::kMillisecond};           ///< after "stop", until readings in transit have
                                                           ///< arrived
  rt::Nanoseconds answer_timeout{100 * rt::kMillisecond};  ///< longest time to wait for an answer
  int attempts{3};                                         ///< largest number of times that a command is sent
  int rate_readings{100};  ///< number of readings that measure the true rate before the sensor is ready
};

/// Robotous RFT force sensor on CAN.
///
///     command   8 bytes to command_id: code, parameters, zeros
///     answer    16 bytes in two frames, first_id then second_id: byte 0 echoes the code
///     reading   byte 0 0x0B; 1 … 12 Fx Fy Fz Tx Ty Tz, int16 big-endian; 13 overloaded axes, one bit each
///
/// Set-up: stop (0x0C); set low-pass (0x08) and rate (0x0F) and read them back (0x09, 0x10); start (0x0B).
/// Then the rate of the readings is measured. A sensor is refused if its answer or its readings do not
/// confirm the rate. Otherwise the loop could use forces up to 5 ms old without noticing, at the default rate
/// of 200 Hz.
///
/// The bias is a function of the sensor (command 0x11 with 1 or 0). The sensor does not answer this command.
///
/// Source: RFT series manual 1.8 (communication), and the manufacturer's published sample code for the codes
/// of rates and cut-off frequencies. Sources differ on whether the "result" of a set command is 0 or 1 on
/// success, so this class uses the error code and the value read back instead.
class RobotousSensor final : public WrenchSensor {
 public:
  /// The error names the parameter, the value found and what is accepted.
  [[nodiscard]] static tl::expected<RobotousSensor, std::string> Make(const RobotousParams& params);

  void Accept(const CanArrival& arrival) OSTEON_RT override;
  bool Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT override;
  [[nodiscard]] const SensorReading& Latest() const OSTEON_RT override { return latest_; }
  [[nodiscard]] SensorPhase phase() const OSTEON_RT override { return phase_; }
  [[nodiscard]] SensorCounters counters() const OSTEON_RT override;
  void RequestBias(bool on) OSTEON_RT override { bias_ = on ? Bias::kSet : Bias::kClear; }
  void Restart() OSTEON_RT override;
  [[nodiscard]] bool silent() const OSTEON_RT override {
    return phase_ == SensorPhase::kFailed && wrong_ == Failure::kSilent;
  }
  [[nodiscard]] std::string failure() const override;

 private:
  explicit RobotousSensor(const RobotousParams& params);

  enum class Step : std::uint8_t {
    kStop,
    kSetFilter,
    kReadFilter,
    kSetRate,
    kReadRate,
    kStart,  // the answer is the first reading
    kMeasureRate,
    kRunning,
  };
  enum class Failure : std::uint8_t { kNothing, kSilent, kRefused, kFilter, kRateCode, kRateMeasured };
  enum class Bias : std::uint8_t { kNone, kSet, kClear };

  // @param found error code, rate [Hz] or number of attempts, for failure()
  void Fail(Failure wrong, double found) OSTEON_RT;
  // Checks an answer of the set-up; then continues with the next step, or fails.
  void HandleAnswer(const std::array<std::uint8_t, 16>& bytes) OSTEON_RT;
  void HandleReading(const std::array<std::uint8_t, 16>& bytes, rt::Nanoseconds stamp) OSTEON_RT;
  // Counts a reading. After rate_readings readings, checks their mean period.
  void MeasureRate(rt::Nanoseconds stamp) OSTEON_RT;
  // Continues with the next step.
  void Advance() OSTEON_RT;
  // Returns the command of a step.
  [[nodiscard]] CanFrame Command(Step step) const OSTEON_RT;

  RobotousParams params_;
  std::uint8_t rate_code_{0}, filter_code_{0};
  PairJoiner joiner_;
  SensorPhase phase_{SensorPhase::kStarting};
  Step step_{Step::kStop};
  int attempts_{0};         // number of times that this step's command was sent
  rt::Nanoseconds due_{0};  // time of the next attempt
  Failure wrong_{Failure::kNothing};
  Step wrong_step_{Step::kStop};
  double found_{0.0};
  Bias bias_{Bias::kNone};  // the bias command that is requested and not sent yet
  SensorReading latest_;
  std::uint64_t readings_{0}, unexpected_{0};
  // measurement of the rate: times of its first and last reading, and the periods between them
  rt::Nanoseconds rate_since_{0}, rate_last_{0};
  int rate_count_{0};
};

/// Identifiers that the bus must deliver for this sensor.
[[nodiscard]] std::vector<CanFilter> Filters(const RobotousParams& params);

}  // namespace osteon::io
