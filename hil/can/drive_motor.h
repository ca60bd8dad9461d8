#pragma once

namespace osteon::hil {

/// Parameters of a velocity-controlled motor with a gear. Angles and torques are on the motor's side.
struct DriveMotorParams {
  double inertia_kg_m2{2e-4};      ///< inertia of motor, gear and tool, referred to the motor
  double rated_torque_Nm{0.5};     ///< rated torque of the motor
  double torque_limit_ratio{3.0};  ///< largest torque, as a multiple of the rated torque
  double gear_ratio{20.0};         ///< turns of the motor per turn of the tool
  double bandwidth_hz{20.0};       ///< bandwidth of the velocity loop
};

/// Model of the motor: `J w' = tau - load sign(w)`. A PI loop on the speed computes tau, which is limited.
/// The load only brakes: at rest it holds against any torque up to its own value.
class DriveMotor {
 public:
  /// @throws std::invalid_argument on a value that is not positive.
  explicit DriveMotor(const DriveMotorParams& params);

  /// @param load_Nm braking torque at the motor, >= 0.
  void Step(double dt_s, double target_rad_per_s, double load_Nm) noexcept;
  /// Advances by dt_s without motor torque: only the load brakes.
  void Coast(double dt_s, double load_Nm) noexcept;

  [[nodiscard]] double speed_rad_per_s() const { return speed_; }
  [[nodiscard]] double torque_Nm() const { return torque_; }
  /// Whether the torque was at its limit in the last step.
  [[nodiscard]] bool limited() const { return limited_; }
  [[nodiscard]] const DriveMotorParams& params() const { return params_; }

 private:
  void Accelerate(double dt_s, double load_Nm) noexcept;

  DriveMotorParams params_;
  double speed_{0.0}, torque_{0.0}, integral_{0.0};
  bool limited_{false};
};

}  // namespace osteon::hil
