#include "safety/fault.h"

namespace osteon::safety {

FaultText Describe(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return {"none", "runs", "nothing to clear"};
    case Fault::kArmStale:
      return {"arm message stale", "holds the last command, then Stop 1",
              "check cable and controller, restart the session"};
    case Fault::kModelStale:
      return {"contact model stale", "holds the tool, then Stop 1",
              "check the simulation's load and device, restart the session"};
    case Fault::kSensorStale:
      return {"force sensor stale", "fades the operator's force, then Stop 1",
              "check the sensor's cable and supply, restart the session"};
    case Fault::kWrenchRate:
      return {"coupling wrench rate", "Stop 1",
              "retract by hand guiding, check stiffness against speed limit, restart the session"};
    case Fault::kSensorForce:
      return {"sensor force above limit", "Stop 1", "release the handle, restart the session"};
    case Fault::kToolSpeed:
      return {"tool speed above limit", "Stop 1", "check limits and inverse kinematics, restart the session"};
    case Fault::kWorkspace:
      return {"tool outside workspace", "Stop 1", "guide the tool back inside, restart the session"};
    case Fault::kJointLimit:
      return {"joint limit", "Stop 1 along the joints' last motion",
              "guide the joint away from its limit, restart the session"};
    case Fault::kInverseKinematics:
      return {"no joint solution", "Stop 1 along the joints' last motion",
              "guide the arm to a pose within reach, restart the session"};
    case Fault::kSession:
      return {"arm left COMMANDING_ACTIVE", "follows the arm's own position, commands nothing",
              "clear the arm's own stop, restart the session"};
    case Fault::kDevice:
      return {"simulation device lost", "Stop 1", "restart the simulation's device and the session"};
    case Fault::kNotFinite:
      return {"value not finite or not credible", "drops the value, Stop 1",
              "look at the recording's last ticks for its source, restart the session"};
    case Fault::kTracking:
      return {"arm far from its command", "Stop 1",
              "check for a collision or a payload error, restart the session"};
    case Fault::kPeriod:
      return {"arm's period is not the cell's", "holds, renders nothing",
              "set the cell's period_ms to the arm's send period, restart the session"};
    case Fault::kInterlock:
      return {"motion not permitted", "Stop 1; the PLC cuts the power after its delay",
              "see why the PLC does not permit it, clear that, reset, restart the session"};
    case Fault::kSpindle:
      return {"spindle drive fault", "stops the spindle, Stop 1",
              "read the drive's error, clear it, restart the session"};
    case Fault::kSensorFault:
      return {"force sensor overloaded or faulty", "drops the reading, Stop 1",
              "release the handle, check the sensor, restart the session"};
    case Fault::kCommandMode:
      return {"arm's command mode is not the law's", "holds, renders nothing",
              "start the robot's program for the cell's law, or change the law, and restart the session"};
  }
  return {"unknown fault", "Stop 1", "restart the session"};
}

}  // namespace osteon::safety
