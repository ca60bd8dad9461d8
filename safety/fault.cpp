#include "safety/fault.h"

namespace osteon::safety {

FaultText Describe(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return {"none", "nothing", "runs", "nothing to clear"};
    case Fault::kArmStale:
      return {"arm message stale", "no message of the arm within its deadline, several times in a row",
              "holds the last command; the arm is not under control (Stop 0)",
              "check cable and controller; then a recovery (`osteon recover`) or a new run"};
    case Fault::kModelStale:
      return {"contact model stale", "no frame of the simulation for longer than the watchdog allows",
              "holds the tool, then Stop 1", "check the simulation's load and device, begin a new run"};
    case Fault::kSensorStale:
      return {"force sensor stale", "no reading of the force sensor for longer than the watchdog allows",
              "fades the operator's force, then Stop 1",
              "check the sensor's cable and supply, begin a new run"};
    case Fault::kWrenchRate:
      return {"coupling wrench rate",
              "the coupling's force changed faster than a tool at its speed limit can press into bone: 1.5 K "
              "v_max",
              "Stop 1", "retract by hand guiding, check stiffness against speed limit, begin a new run"};
    case Fault::kSensorForce:
      return {"sensor force above limit",
              "the hand pushed beyond the force limit and its margin, several ticks in a row", "Stop 1",
              "release the handle, begin a new run"};
    case Fault::kToolSpeed:
      return {"tool speed above limit",
              "the commanded tool was faster than its limit although it had been scaled", "Stop 1",
              "begin a new run; if it comes again, keep the recording for those who maintain the software"};
    case Fault::kWorkspace:
      return {"tool outside workspace",
              "the tool's apex, the flange or the elbow was outside the workspace, one of its zones, or the "
              "depth limit",
              "Stop 1", "guide the tool back inside, begin a new run"};
    case Fault::kJointLimit:
      return {
          "joint limit",
          "a joint's position, speed or step would have been beyond its limit, or its torque a message later",
          "Stop 1 along the joints' last motion",
          "guide the joint away from its limit, take off what loads it, begin a new run"};
    case Fault::kInverseKinematics:
      return {"no joint solution", "no joints were found for the tool's way",
              "Stop 1 along the joints' last motion",
              "guide the arm to a pose within reach, begin a new run"};
    case Fault::kSession:
      return {"arm left COMMANDING_ACTIVE", "the arm left COMMANDING_ACTIVE, or reported a safety stop",
              "follows the arm's own position, commands nothing",
              "clear the arm's own stop; then a recovery (`osteon recover`) or a new run"};
    case Fault::kDevice:
      return {"simulation device lost", "the GPU was lost", "Stop 1",
              "see that the GPU works (`osteon doctor`), begin a new run"};
    case Fault::kNotFinite:
      return {"value not finite or not credible",
              "a NaN, an infinity or a value out of all proportion came from arm, sensor or simulation",
              "drops the value, Stop 1",
              "look at the recording's last ticks for its source, begin a new run"};
    case Fault::kTracking:
      return {"arm far from its command",
              "the measured tool was further from the commanded one than max_tracking_error", "Stop 1",
              "check for a collision or a payload error, begin a new run"};
    case Fault::kPeriod:
      return {"arm's period is not the cell's",
              "the arm sends at another period than the cell was set up for", "holds, renders nothing",
              "set the cell's period_ms to the arm's send period, begin a new run"};
    case Fault::kInterlock:
      return {
          "motion not permitted",
          "the PLC withdrew its permission or was silent, or the enabling switch was not held",
          "Stop 1; the PLC cuts the power after its delay",
          "see why the PLC does not permit it, or take the enabling switch again; reset, begin a new run"};
    case Fault::kSpindle:
      return {"spindle drive fault", "the drive reported a fault, was not ready, or was silent",
              "stops the spindle, Stop 1", "read the drive's error, clear it, begin a new run"};
    case Fault::kSensorFault:
      return {"force sensor overloaded or faulty", "the sensor reported an overload or a failure",
              "drops the reading, Stop 1", "release the handle, check the sensor, begin a new run"};
    case Fault::kCommandMode:
      return {"arm's command mode is not the law's",
              "the arm takes positions where the law gives wrenches, or the other way round",
              "holds, renders nothing",
              "start the robot's program for the cell's law, or change the law, and begin a new run"};
    case Fault::kSpindleLimit:
      return {"spindle beyond its limit",
              "its torque or its speed was beyond the cell's limit for longer than the trip's time",
              "stops the spindle, Stop 1", "free the tool, see why it jammed, begin a new run"};
    case Fault::kRepeatDiffers:
      return {"computation not repeatable",
              "a tick that was computed a second time, on the same inputs, did not come out the same",
              "Stop 1",
              "test the computer's memory and cooling, `osteon replay` the recording, begin a new run"};
    case Fault::kRecorder:
      return {"recorder stalled",
              "2048 ticks waited for the recorder (2 s at 1 kHz), or it had no room for one", "Stop 1",
              "check the disk's load and health, begin a new run"};
    case Fault::kToolInBone:
      return {"tool too deep in bone",
              "the commanded tool was further from the bone's proxy than max_tool_in_bone_mm allows",
              "Stop 1",
              "retract by hand guiding, check max_force_N against what the hand pushes, begin a new run"};
    case Fault::kArmSpeed:
      return {
          "measured arm speed above limit",
          "the measured tool went 1 mm further than 1.5 times its speed limit allows, whatever was commanded",
          "Stop 1", "look for what moved the arm (lost answers with HOLDON 0, a push), begin a new run"};
    case Fault::kForceLimit:
      return {"coupling at its force limit",
              "the hand pushed harder than the coupling may resist, for longer than 50 ms, and the cell says "
              "on_force_limit: stop",
              "Stop 1", "push less, or raise max_force_N within what the cell allows, and begin a new run"};
    case Fault::kDeflection:
      return {
          "deflection beyond its limit",
          "the tool was bent by more than a tenth of its free length or pressed with half of its buckling "
          "load, or the bone's mount moved by more than 10 mm or 0.1 rad",
          "Stop 1", "look for what bent or moved, push less or take a stiffer tool, and begin a new run"};
  }
  return {"unknown fault", "not known", "Stop 1", "begin a new run"};
}

}  // namespace osteon::safety
