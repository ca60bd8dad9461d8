#pragma once

#include <array>
#include <cstdint>

#include "hil/can/frame_queue.h"
#include "hil/can/sensor_model.h"
#include "io/can/can_pump.h"

namespace osteon::hil {

struct RobotousDeviceParams {
  SensorModelParams model{.range_N = 500.0, .range_Nm = 15.0};
  int command_id{0x64}, first_id{0x01}, second_id{0x02};
  int counts_per_N{50}, counts_per_Nm{2000};
};

/// Faults of the device.
struct RobotousDeviceFaults {
  bool silent{false};          ///< no supply: the device loses its settings and sends nothing
  bool keeps_its_rate{false};  ///< the device confirms a new rate but keeps the old rate; a read of the rate
                               ///< returns the old one
  /// A read of the rate returns the requested rate, but readings are sent at 200 Hz.
  bool lies_about_rate{false};
  int refuse_code{0};  ///< the command that is answered with the error "not supported"
};

/// Simulates a Robotous RFT force sensor: the sensor's end of the protocol, written independently of io/can.
///
/// Behaviour by the manual: nothing is sent until "start"; while the sensor sends readings, it accepts only
/// the commands "stop" and "bias". The real sensor stores rate (default 200 Hz) and low-pass filter (default
/// off) without supply, but not the bias; in this model the fault `silent` clears all three. Commands of this
/// model: set and read filter, read once, start, stop, set and read rate, bias, overload count.
///
/// A CanPump exchanges the device's frames with a bus, as for any CanClient.
class RobotousDevice final : public io::CanClient {
 public:
  /// @throws std::invalid_argument from SensorModel.
  explicit RobotousDevice(const RobotousDeviceParams& params);

  /// Sets the load on the tool side at S, in S, from now on.
  void SetLoad(const Wrench& F_S) { load_ = F_S; }
  void SetFaults(const RobotousDeviceFaults& faults);

  void Accept(const io::CanArrival& arrival) OSTEON_RT override;
  bool Next(rt::Nanoseconds now, io::CanFrame& frame) OSTEON_RT override;

  [[nodiscard]] bool sending() const { return sending_; }
  [[nodiscard]] std::uint64_t readings() const { return readings_; }

 private:
  using Values = std::array<double, 6>;
  // Queues the two frames of a reading of the present load, as an answer to this command.
  void QueueReading(int echo, rt::Nanoseconds now) noexcept;
  void Reply(int echo, int a, int b = 0) noexcept;

  RobotousDeviceParams params_;
  RobotousDeviceFaults faults_;
  SensorModel model_;
  Wrench load_;
  FrameQueue queue_;
  int rate_code_{0}, filter_on_{0}, filter_code_{0};
  bool sending_{false}, take_bias_{false};
  Values zero_{};        // the bias
  Values low_passed_{};  // the last reading after the filter
  bool low_pass_fresh_{true};
  std::array<int, 6> overloads_{};
  rt::Nanoseconds due_{0};  // time of the next reading
  std::uint64_t readings_{0};
};

}  // namespace osteon::hil
