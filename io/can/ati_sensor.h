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

struct AtiParams {
  std::uint8_t base{0x20};  ///< 0 … 0x7F; the sensor's identifiers are base << 4 … base << 4 | 0xF
  /// Time between requests; the sensor answers each with one reading.
  rt::Nanoseconds period{rt::kMillisecond};
  /// Longest time to wait for an answer during set-up.
  rt::Nanoseconds answer_timeout{50 * rt::kMillisecond};
  int attempts{3};         ///< largest number of times that a set-up request is sent
  int bias_readings{100};  ///< number of readings averaged for a bias
};

/// ATI NETCANOEM force sensor: strain gauges with their calibration matrix, read by requests.
///
///     id = base << 4 | code
///     code 0  readings: answers 0 (status u16, gauges 0, 2, 4) and 1 (gauges 1, 3, 5), i16 big-endian
///     code 2  row of the matrix, 0 … 5 in one byte: answers 2, 3, 4, two float32 big-endian each
///     code 7  counts per force unit and per torque unit: two u32 big-endian
///     code 8  force unit and torque unit: one byte each
///
///     F_S = (matrix · gauges) / counts, in N and N·m for any units
///
/// The set-up reads matrix, counts and units. Then a request is sent in each period, and its answer is a
/// reading. A gauge at the end of its range is reported as an overload, because the matrix would spread the
/// gauge's error over all axes. The sensor has no bias function. On request, this class averages the next
/// readings and subtracts the mean.
///
/// Source: ATI manual 9610-05-1030 as quoted by public drivers.
class AtiSensor final : public WrenchSensor {
 public:
  /// The error names the parameter, the value found and what is accepted.
  [[nodiscard]] static tl::expected<AtiSensor, std::string> Make(const AtiParams& params);

  void Accept(const CanArrival& arrival) OSTEON_RT override;
  bool Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT override;
  [[nodiscard]] const SensorReading& Latest() const OSTEON_RT override { return latest_; }
  [[nodiscard]] SensorPhase phase() const OSTEON_RT override { return phase_; }
  [[nodiscard]] SensorCounters counters() const OSTEON_RT override;
  void RequestBias(bool on) OSTEON_RT override;
  void Restart() OSTEON_RT override;
  [[nodiscard]] bool silent() const OSTEON_RT override {
    return phase_ == SensorPhase::kFailed && wrong_ == Wrong::kSilent;
  }
  [[nodiscard]] std::string failure() const override;

  /// Calibration matrix, row-major, force rows first; valid once phase() is kReady.
  [[nodiscard]] const std::array<double, 36>& matrix() const { return matrix_; }

 private:
  // Cause of a failed set-up.
  enum class Wrong : std::uint8_t { kNothing, kSilent, kMatrix, kCounts, kUnits };
  using Values = std::array<double, 6>;

  explicit AtiSensor(const AtiParams& params);
  void HandleMatrix(const CanFrame& frame, std::size_t part) OSTEON_RT;
  void HandleCounts(const CanFrame& frame) OSTEON_RT;
  void HandleUnits(const CanFrame& frame) OSTEON_RT;
  void HandleReading() OSTEON_RT;
  // Continues with the next step of the set-up.
  void Advance() OSTEON_RT;
  // Ends the set-up in kFailed. @param found, other numbers for failure(); their meaning depends on the cause
  void Fail(Wrong wrong, double found, double other = 0.0) OSTEON_RT;

  AtiParams params_;
  PairJoiner joiner_;
  SensorPhase phase_{SensorPhase::kStarting};
  int step_{0};               // 0 … 5 rows of the matrix, 6 counts, 7 units, 8 running
  std::size_t next_part_{0};  // next part of the matrix's present row, 0 … 2
  int attempts_{0};           // number of requests sent in the present step
  rt::Nanoseconds due_{0};    // time of the next request
  Wrong wrong_{Wrong::kNothing};
  double found_{0.0}, found_other_{0.0};
  std::array<double, 36> matrix_{};
  double counts_per_force_{1.0}, counts_per_torque_{1.0}, force_unit_N_{1.0}, torque_unit_Nm_{1.0};
  Values bias_{}, bias_sum_{};
  int bias_left_{0};  // number of readings still to be averaged for a bias
  SensorReading latest_;
  std::uint64_t readings_{0}, unexpected_{0}, malformed_{0};
};

/// Identifiers that the bus must deliver for this sensor.
[[nodiscard]] std::vector<CanFilter> Filters(const AtiParams& params);

}  // namespace osteon::io
