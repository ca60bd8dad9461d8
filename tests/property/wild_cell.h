#pragma once

#include <memory>
#include <ostream>

#include "hil/arm/simulated_arm.h"
#include "tests/property/loop_oracle.h"
#include "tests/property/wild_values.h"
#include "tests/property/wild_zone.h"

// A servo loop whose inputs all come from a generator: arm, sensor, simulation, spindle, PLC, clock, operator
// and changes of gains.

namespace osteon::property {

/// The numbers from which a case's cell is built; 0 is the simplest value of each.
struct Choice {
  int law{0};    ///< 0, 1 admittance (1 with the arm's masses); 2 impedance by wrench, 3 by torques
  int start{0};  ///< index into five start postures
  /// 0: wide; 1, 2, 3: with the tool or the flange 1 mm from a bound; 4, 5: near the bound of `zone`.
  int workspace{0};
  int limits{0};   ///< index into four sets of limits for speed, force, torque and elbow
  int devices{0};  ///< bit 0: a spindle with a drive, bit 1: a PLC
  int mode{0};     ///< 0 automatic at first, 1 T1
  ZoneChoice zone{};
};
void showValue(const Choice& choice, std::ostream& out);
[[nodiscard]] rc::Gen<Choice> AnyChoice();

/// Runs a servo loop and a simulated arm on generated inputs, and checks each tick with a LoopOracle.
class WildCell {
 public:
  /// Op::what from kPushes up to kKinds is a push of the hand, 6 … kPushes - 1 an error or a request; lower
  /// values do nothing.
  static constexpr int kPushes = 44, kKinds = 48;

  WildCell(const Choice& choice, hil::ArmLevel level);

  /// Runs one tick with one operation on it. @returns the loop's violation; empty if there is none
  [[nodiscard]] std::string Tick(const Op& op);

  [[nodiscard]] const LoopOracle& oracle() const { return oracle_; }

 private:
  void SetNormalInputs();
  void Disturb(const Op& op);  ///< applies the operation to this tick's inputs
  void DisturbArm(const Op& op);
  void DisturbModel(const Op& op);
  void DisturbDevices(const Op& op);
  void MoveArm();
  [[nodiscard]] std::string CheckArmPlace() const;

  CaseLimits allowed_;
  control::ServoLoop loop_;
  LoopOracle oracle_;
  std::unique_ptr<hil::SimulatedArm> arm_;
  hil::ArmDrive drive_;

  // the loop's inputs in this tick
  control::ArmState state_;
  control::ReceiveResult received_{control::ReceiveResult::kOk};
  control::CellReadings readings_;
  simulation::ContactModel model_;
  rt::Nanoseconds now_{rt::kSecond};
  PersonsRequests asked_;

  control::ArmCommand command_;
  // lasting conditions, which stay until an operation changes them
  Wrench push_S_;               ///< wrench of the hand on the force sensor
  Vector3 plane_W_m_, feed_W_;  ///< a point of the bone's surface; the direction from the tool into it
  simulation::Contact contact_;
  rt::Nanoseconds clock_{rt::kSecond};  ///< the true time
  control::SessionState session_{control::SessionState::kCommandingActive};
  std::uint8_t operation_mode_{2};
  bool sensor_lives_{true}, simulation_lives_{true}, plc_permits_{true};
  /// The arm has sent a false position: then only the arm's own checks protect it (guarded_arm_test.cpp).
  bool arm_lied_{false};
  int ticks_{0};
};

}  // namespace osteon::property
