#pragma once

#include <memory>

#include "hil/arm/simulated_arm.h"
#include "hil/arm_controller.h"
#include "kinematics/lbr_arm.h"

namespace osteon::hil {

/// An LBR with its controller, connected by FRI. It consists of the session (FriServer) and of the arm that
/// follows the session's commands (SimulatedArm). Its motion centre is T.
class FriArm final : public ArmController {
 public:
  /// Opens the session. @throws std::invalid_argument from FriServer or SimulatedArm, on a parameter out of
  /// range.
  FriArm(const FriServerParams& fri, const SimulatedArmParams& body, const Pose& X_FT);

  bool Receive(std::span<const std::uint8_t> datagram) override { return server_.Receive(datagram); }
  void Move(bool client_had_its_time, const Wrench& F_T_B) override;
  [[nodiscard]] std::span<const std::uint8_t> Message(const Wrench& F_T_T, rt::Nanoseconds now) override;
  void SetPower(bool on) override;
  [[nodiscard]] bool EndSession() override;
  [[nodiscard]] ArmMotion motion() const override;
  [[nodiscard]] ArmStatus status() const override;
  [[nodiscard]] double period_s() const override { return server_.period_s(); }

  /// The session's server, for actions of the robot's program and its operator.
  [[nodiscard]] FriServer& server() { return server_; }

 private:
  kinematics::LbrArm arm_;
  Pose X_FT_;
  FriServer server_;
  std::unique_ptr<SimulatedArm> body_;
  bool power_{true};
};

}  // namespace osteon::hil
