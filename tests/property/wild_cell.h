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

/// The choice of a cell, each field out of a few; 0 is the simplest.
struct Choice {
  int law{0};        ///< 0, 1 admittance; 2 impedance by wrench, 3 by torques
  int start{0};      ///< of five postures
  int workspace{0};  ///< wide, or with the tool 1 or 4 mm from a bound; 4, 5: near the bound of `zone`
  int limits{0};     ///< of speed, force and elbow
  int devices{0};    ///< bit 0: a spindle with a drive, bit 1: a PLC
  int mode{0};       ///< 0 automatic at first, 1 T1
  ZoneChoice zone{};
};
void showValue(const Choice& choice, std::ostream& out);
[[nodiscard]] rc::Gen<Choice> AnyChoice();

class WildCell {
 public:
  /// Ranges of Op::what: from kPushes on the hand's pushes, below it errors; other values do nothing.
  static constexpr int kPushes = 44, kKinds = 48;

  WildCell(const Choice& choice, hil::ArmLevel level);

  /// Runs one tick with one operation on it. @returns the loop's violation; empty if there is none
  [[nodiscard]] std::string Tick(const Op& op);

  [[nodiscard]] const LoopOracle& oracle() const { return oracle_; }

 private:
  void Nominal();
  void Disturb(const Op& op);
  void DisturbArm(const Op& op);
  void DisturbModel(const Op& op);
  void DisturbDevices(const Op& op);
  void MoveArm();
  [[nodiscard]] std::string WhereTheArmIs() const;

  Allowed allowed_;
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
  Asked asked_;

  control::ArmCommand command_;
  // lasting conditions
  Wrench push_S_;
  Vector3 plane_W_m_, feed_W_;
  simulation::Contact contact_;
  rt::Nanoseconds clock_{rt::kSecond};  ///< the true time
  control::SessionState session_{control::SessionState::kCommandingActive};
  std::uint8_t operation_mode_{2};
  bool sensor_lives_{true}, simulation_lives_{true}, plc_permits_{true};
  /// About its position: only the arm's own checks then protect it (guarded_arm_test.cpp).
  bool arm_lied_{false};
  int ticks_{0};
};

}  // namespace osteon::property
