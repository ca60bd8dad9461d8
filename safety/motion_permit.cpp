#include "safety/motion_permit.h"

namespace osteon::safety {

const char* DescribeMissing(MotionPermit permit) {
  switch (permit) {
    case MotionPermit::kArmFresh:
      return "a message of the arm";
    case MotionPermit::kHandedOver:
      return "the arm in COMMANDING_ACTIVE without a safety stop";
    case MotionPermit::kRunPermitted:
      return "the PLC's RUN_PERMITTED, with the enabling switch held";
    case MotionPermit::kSensorFresh:
      return "a fresh reading of the force sensor";
    case MotionPermit::kModelFresh:
      return "a fresh contact model of the simulation";
    case MotionPermit::kPosePlausible:
      return "the arm measured where it is commanded";
    case MotionPermit::kNoResidualWrench:
      return "a tool that does not stand deeper in bone than the force limit";
    case MotionPermit::kSpindleReady:
      return "the spindle's drive, ready and without a fault";
    case MotionPermit::kPathChecked:
      return "a checked path to the start; the check is under way";
    case MotionPermit::kHandOff:
      return "a hand off the handle before the first motion: the force sensor reads a steady push at rest "
             "(let go, or calibrate its zero: `osteon calibrate`)";
  }
  return "an unknown condition";
}

}  // namespace osteon::safety
