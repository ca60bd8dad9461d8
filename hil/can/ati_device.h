#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/LU>

#include "hil/can/frame_queue.h"
#include "hil/can/sensor_model.h"
#include "io/can/can_pump.h"

namespace osteon::hil {

struct AtiDeviceParams {
  SensorModelParams model{.range_N = 660.0, .range_Nm = 60.0};  ///< gauges saturate 9 % beyond these ranges
  int base{0x20};
  std::uint32_t counts_per_N{1'000'000}, counts_per_Nm{1'000'000};
  int force_unit{2}, torque_unit{3};  ///< unit codes that the device reports; defaults: N and N·m. The counts
                                      ///< refer to N and N·m in any case
};

/// Simulates an ATI NETCANOEM force sensor: six strain gauges, mixed by a calibration matrix. Written
/// independently of io/can. The device reports the matrix; its gauge values are the matrix's inverse times
/// the load.
class AtiDevice final : public io::CanClient {
 public:
  /// @throws std::invalid_argument on a base identifier outside 0 … 0x7F, counts of 0, or a parameter that
  /// the sensor model does not accept.
  explicit AtiDevice(const AtiDeviceParams& params);

  /// Sets the load on the tool side at S, in S, from now on.
  void SetLoad(const Wrench& F_S) { load_ = F_S; }
  void SetSilent(bool silent);
  /// Sets the status bits, e.g. 0x4000: bus error (bit 15, "any error", is added, as on the real device).
  void SetStatus(int bits) { status_ = bits; }

  void Accept(const io::CanArrival& arrival) OSTEON_RT override;
  bool Next(rt::Nanoseconds now, io::CanFrame& frame) OSTEON_RT override;

  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  [[nodiscard]] const Matrix6& matrix() const { return matrix_; }

 private:
  // Queues the two frames of a reading of the present load.
  void QueueReading(rt::Nanoseconds now) noexcept;

  AtiDeviceParams params_;
  SensorModel model_;
  Matrix6 matrix_, inverse_;
  Wrench load_;
  int status_{0};
  bool silent_{false};
  FrameQueue queue_;
};

}  // namespace osteon::hil
