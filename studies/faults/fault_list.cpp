// The faults of the matrix. The expected ticks from a fault to its detection follow from the watchdogs' ages
// (WatchdogParams).

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <vector>

#include "studies/faults/drive_faults.h"
#include "studies/faults/fault_case.h"

namespace osteon::studies {
namespace {

using control::ReceiveResult;
using control::SessionState;
using safety::Fault;
using safety::StopCategory;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHuge = 1e308;

// Ticks from a fault to its detection; a tick has 1 ms.
constexpr int kAtOnce = 1;
constexpr int kNextTick = 2;            // detected in the tick after that in which the fault occurs
constexpr int kSilentDevice = 102;      // 100 ms
constexpr int kSilentSimulation = 254;  // 250 ms after the newest pose that the simulation answered
constexpr int kPushed = 5;              // SensorForceParams::ticks: a force above the limit
constexpr int kMissed = 5;              // WatchdogParams::arm_misses: messages in a row
constexpr int kSpindleBeyond = 52;      // the rig's trip_s
// Until max_tracking_error is reached at the tool's speed along the plane.
constexpr int kDrifted = 450;
constexpr int kDriftedOnItsWay = 800;  // until max_tracking_error is reached at the start path's speed
constexpr int kLong = 500;             // ticks for which a slowly detected fault lasts
constexpr int kThrownAgain = 40;       // ticks from one jump to the next

// The set of these faults.
safety::FaultSet Of(std::initializer_list<Fault> faults) {
  safety::FaultSet set;
  for (const Fault fault : faults) set.Latch(fault);
  return set;
}

const Expected kGoesOn{};
const Expected kWaits{.reaction = Reaction::kWaits};
const Expected kBrakesOn{.reaction = Reaction::kBrakesOn};
const Expected kPauses{.reaction = Reaction::kPauses};
const Expected kAlignsOn{.reaction = Reaction::kAlignsOn};
const Expected kBacksOff{.reaction = Reaction::kBacksOff};
Expected Stops(safety::FaultSet faults, int ticks, StopCategory stop = StopCategory::kStop1) {
  return {.reaction = Reaction::kStops, .faults = faults, .ticks = ticks, .stop = stop};
}
Expected Faults(safety::FaultSet faults, int ticks = kAtOnce) {
  return {.reaction = Reaction::kFaults, .faults = faults, .ticks = ticks};
}

bool HasAny(safety::FaultSet faults, std::initializer_list<Fault> of) {
  return std::any_of(of.begin(), of.end(), [&](Fault fault) { return faults.Has(fault); });
}

// Expected reactions to a fault of a device that rendering needs. Nothing begins without the device, and
// rendering stops. A stop 2 becomes a stop 1 if the fault is detected before the arm is at rest. The force
// sensor is checked whenever the arm moves, the spindle also on the start path. A fault of any other device
// does not interrupt the start path.
FaultCase DeviceCase(const char* name, const char* injected, safety::FaultSet faults, int ticks,
                     RigInjection inject) {
  const bool sensor =
      HasAny(faults, {Fault::kSensorStale, Fault::kSensorFault, Fault::kSensorForce, Fault::kNotFinite});
  const bool spindle = HasAny(faults, {Fault::kSpindle, Fault::kSpindleLimit});
  return {.name = name,
          .injected = injected,
          .inject = std::move(inject),
          .lasts = kLong,
          .waiting = kWaits,
          .aligning = sensor || spindle ? Stops(faults, ticks) : kAlignsOn,
          .rendering = Stops(faults, ticks),
          .paused = kWaits,
          .stop1 = sensor && ticks <= kPushed ? Stops(faults, ticks) : kBrakesOn,
          .stop2 = ticks <= kPushed ? Stops(faults, ticks) : kBrakesOn};
}
// Expected reactions to a fault of an input that only rendering uses. During a stop 2 only the age of the
// input is checked.
FaultCase ModelCase(const char* name, const char* injected, safety::FaultSet faults, int ticks,
                    RigInjection inject) {
  FaultCase made = DeviceCase(name, injected, faults, ticks, std::move(inject));
  made.aligning = kAlignsOn;
  made.stop1 = kBrakesOn;
  if (!faults.Has(Fault::kModelStale) || ticks > kPushed) made.stop2 = kBrakesOn;
  return made;
}
// A fault that the cell must tolerate: it goes on, and a stop that has begun continues.
FaultCase Tolerated(const char* name, const char* injected, int lasts, RigInjection inject) {
  return {.name = name,
          .injected = injected,
          .inject = std::move(inject),
          .lasts = lasts,
          .waiting = kGoesOn,
          .aligning = kGoesOn,
          .rendering = kGoesOn,
          .paused = kGoesOn,
          .stop1 = kBrakesOn,
          .stop2 = kBrakesOn};
}
// The arm has left COMMANDING_ACTIVE: its messages report this session state, in which the arm follows no
// command.
FaultCase SessionCase(const char* name, SessionState session) {
  const Expected stops = Stops(Of({Fault::kSession}), kAtOnce, StopCategory::kStop0);
  Expected ends = stops;
  ends.faults = {};  // a requested end is not a fault
  return {.name = name,
          .injected = "the arm's messages say so, its joints stand",
          .inject =
              [session](RigInputs& in, int, FaultRig&) {
                in.arm.session = session;
                if (session == SessionState::kIdle) {
                  in.arm.q_meas = {};
                  in.arm.has_ipo = false;
                }
              },
          .waiting = kWaits,
          .aligning = kBacksOff,
          .rendering = stops,
          .paused = kWaits,
          .stop1 = ends,
          .stop2 = stops};
}
// A fault that is detected at once in every state, and stops every motion.
FaultCase NoticedAtOnce(const char* name, const char* injected, safety::FaultSet faults, RigInjection inject,
                        int ticks = kAtOnce) {
  return {.name = name,
          .injected = injected,
          .inject = std::move(inject),
          .waiting = Faults(faults, ticks),
          .aligning = Stops(faults, ticks),
          .rendering = Stops(faults, ticks),
          .paused = Faults(faults, ticks),
          .stop1 = Stops(faults, ticks),
          .stop2 = Stops(faults, ticks)};
}
// A message with values that are not finite.
FaultCase NotFiniteCase(const char* name, const char* injected, RigInjection inject) {
  return NoticedAtOnce(name, injected, Of({Fault::kNotFinite}), std::move(inject));
}
// The arm cannot be commanded: a moving arm needs a stop 0. @param waiting  the required reaction before
// motion
FaultCase LostArm(const char* name, const char* injected, safety::FaultSet faults, int ticks,
                  Expected waiting, RigInjection inject) {
  const Expected stops = Stops(faults, ticks, StopCategory::kStop0);
  return {.name = name,
          .injected = injected,
          .inject = std::move(inject),
          .waiting = waiting,
          .aligning = stops,
          .rendering = stops,
          .paused = Faults(faults, ticks),
          .stop1 = stops,
          .stop2 = stops};
}

void AddSensor(std::vector<FaultCase>& cases) {
  const auto stale = Of({Fault::kSensorStale});
  cases.push_back(DeviceCase("force sensor silent", "no reading any more", stale, kSilentDevice,
                             [held = control::ForceReading{}](RigInputs& in, int since, FaultRig&) mutable {
                               if (since == 0) held = in.readings.force;
                               in.readings.force = held;
                               if (since > 0 && held.stamp == 0) in.readings.force.stamp = 0;
                             }));
  cases.push_back(DeviceCase("force sensor gone", "no stamp", stale, kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.stamp = 0; }));
  cases.push_back(
      DeviceCase("force reading of the future", "its stamp is an hour ahead", stale, kAtOnce,
                 [](RigInputs& in, int, FaultRig&) { in.readings.force.stamp += 3600 * rt::kSecond; }));
  cases.push_back(DeviceCase("force reading of another clock", "its stamp is negative", stale, kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.stamp = -rt::kSecond; }));
  cases.push_back(DeviceCase("force NaN", "one component", Of({Fault::kNotFinite}), kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.F_S.f.x = kNaN; }));
  cases.push_back(DeviceCase("torque infinite", "one component", Of({Fault::kNotFinite}), kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.F_S.t.z = kInfinity; }));
  cases.push_back(DeviceCase("force 1e308 N", "one component", Of({Fault::kSensorForce, Fault::kNotFinite}),
                             kPushed,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.F_S.f.y = kHuge; }));
  cases.push_back(DeviceCase("force jumps", "by 400 N along the feed", Of({Fault::kSensorForce}), kPushed,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.F_S.f.z += 400.0; }));
  cases.push_back(DeviceCase("force sensor's own fault", "its status says so", Of({Fault::kSensorFault}),
                             kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.force.trusted = false; }));
  cases.push_back(Tolerated("force sensor stutters", "no reading for 60 ms, again and again", 240,
                            [held = control::ForceReading{}](RigInputs& in, int since, FaultRig&) mutable {
                              if (since % 60 == 0) held = in.readings.force;
                              in.readings.force = held;
                            }));
  cases.push_back(Tolerated("force bias", "20 N that nobody exerts", 200,
                            [](RigInputs& in, int, FaultRig&) { in.readings.force.F_S.f.z -= 20.0; }));
}

void AddArm(std::vector<FaultCase>& cases) {
  cases.push_back(Tolerated("arm's messages lost, 4 in a row", "again and again", 200,
                            [](RigInputs& in, int since, FaultRig&) {
                              if (since % 40 < kMissed - 1) in.received = ReceiveResult::kTimeout;
                            }));
  cases.push_back(LostArm("arm silent", "no message any more", Of({Fault::kArmStale}), kMissed, kWaits,
                          [](RigInputs& in, int, FaultRig&) { in.received = ReceiveResult::kTimeout; }));
  cases.push_back(LostArm("link closed", "the socket is", Of({Fault::kArmStale}), kAtOnce,
                          Faults(Of({Fault::kArmStale})),
                          [](RigInputs& in, int, FaultRig&) { in.received = ReceiveResult::kClosed; }));
  cases.push_back(SessionCase("arm in COMMANDING_WAIT", SessionState::kCommandingWait));
  cases.push_back(SessionCase("arm in MONITORING_READY", SessionState::kMonitoringReady));
  cases.push_back(SessionCase("arm in MONITORING_WAIT", SessionState::kMonitoringWait));
  cases.push_back(SessionCase("arm IDLE, its joints unknown", SessionState::kIdle));
  {
    FaultCase made = SessionCase("arm left and came back unseen", SessionState::kCommandingActive);
    made.injected = "handed over anew between two messages";
    made.inject = [](RigInputs& in, int since, FaultRig& rig) {
      // before motion there is no session to leave
      if (since != 0 || safety::Waits(rig.loop().state())) return;
      rig.HandOver();
      ++in.arm.activation;
      in.arm.session = SessionState::kCommandingActive;
      in.arm.q_ipo = in.arm.q_meas;
    };
    made.waiting = made.aligning = made.paused = kGoesOn;
    cases.push_back(std::move(made));
  }
  {
    const Expected stops = Stops(Of({Fault::kSession}), kAtOnce);
    cases.push_back({.name = "arm's safety stop",
                     .injected = "reported while it still takes commands",
                     .inject = [](RigInputs& in, int, FaultRig&) { in.arm.safety_state = 2; },
                     .waiting = kWaits,
                     .aligning = stops,
                     .rendering = stops,
                     .paused = kWaits,
                     .stop1 = kBrakesOn,
                     .stop2 = stops});
  }
  cases.push_back(NotFiniteCase("measured joint NaN", "one joint",
                                [](RigInputs& in, int, FaultRig&) { in.arm.q_meas[3] = kNaN; }));
  cases.push_back(NotFiniteCase("measured joint NaN for a tick", "one joint, once",
                                [](RigInputs& in, int since, FaultRig&) {
                                  if (since == 0) in.arm.q_meas[6] = kNaN;
                                }));
  cases.push_back(NotFiniteCase("arm's own command infinite", "one joint of q_ipo",
                                [](RigInputs& in, int, FaultRig&) { in.arm.q_ipo[0] = -kInfinity; }));
  {
    const Expected stops = Stops(Of({Fault::kTracking, Fault::kArmSpeed}), kAtOnce);
    cases.push_back({.name = "measured joints jump",
                     .injected = "A1 by 0.2 rad",
                     .inject = [](RigInputs& in, int, FaultRig&) { in.arm.q_meas[0] += 0.2; },
                     .waiting = kWaits,
                     .aligning = stops,
                     .rendering = stops,
                     .paused = Faults(Of({Fault::kTracking, Fault::kArmSpeed})),
                     .stop1 = Stops(Of({Fault::kArmSpeed}), kAtOnce),
                     .stop2 = stops});
  }
  {
    // An arm with RSI and HOLDON 0 behaves like this: its corrections drop to zero when an answer is lost.
    const Expected stops = Stops(Of({Fault::kArmSpeed}), kAtOnce);
    const Expected begins = Stops(Of({Fault::kArmSpeed}), kThrownAgain);
    cases.push_back({.name = "arm thrown back",
                     .injected = "A1 by 5 mrad for a message, again and again",
                     .inject =
                         [](RigInputs& in, int since, FaultRig&) {
                           if (since % kThrownAgain == 0) in.arm.q_meas[0] -= 5e-3;
                         },
                     .waiting = begins,
                     .aligning = stops,
                     .rendering = stops,
                     .paused = Faults(Of({Fault::kArmSpeed})),
                     .stop1 = stops,
                     .stop2 = stops});
  }
  {
    const RigInjection frozen = [held = control::JointArray{}](RigInputs& in, int since, FaultRig&) mutable {
      if (since == 0) held = in.arm.q_meas;
      in.arm.q_meas = held;
    };
    const Expected stops = Stops(Of({Fault::kTracking}), kDrifted);
    cases.push_back({.name = "arm does not follow",
                     .injected = "measured joints stand, whatever is commanded",
                     .inject = frozen,
                     .lasts = 900,
                     .waiting = stops,
                     .aligning = Stops(Of({Fault::kTracking}), kDriftedOnItsWay),
                     .rendering = stops,
                     .paused = stops,
                     .stop1 = kBrakesOn,
                     .stop2 = kBrakesOn});
  }
  cases.push_back(LostArm("arm's command mode changes", "to torque", Of({Fault::kCommandMode}), kAtOnce,
                          Faults(Of({Fault::kCommandMode})), [](RigInputs& in, int, FaultRig&) {
                            in.arm.command_mode = control::CommandMode::kTorque;
                          }));
  cases.push_back(LostArm("arm's period changes", "to 5 ms", Of({Fault::kPeriod}), kAtOnce,
                          Faults(Of({Fault::kPeriod})),
                          [](RigInputs& in, int, FaultRig&) { in.arm.period_s = 0.005; }));
  cases.push_back(LostArm("arm's period NaN", "its message says so", Of({Fault::kPeriod}), kAtOnce,
                          Faults(Of({Fault::kPeriod})),
                          [](RigInputs& in, int, FaultRig&) { in.arm.period_s = kNaN; }));
  cases.push_back(Tolerated("link's quality poor", "it ends the session itself where it gets worse", 200,
                            [](RigInputs& in, int, FaultRig&) { in.arm.quality = 0; }));
  {
    const Expected stops = Stops(Of({Fault::kJointLimit}), kAtOnce);
    cases.push_back({.name = "external torque beyond a joint's",
                     .injected = "60 N m on A6, which holds 40",
                     .inject = [](RigInputs& in, int, FaultRig&) { in.arm.tau_ext[5] = 60.0; },
                     .lasts = kLong,
                     .waiting = kWaits,
                     .aligning = stops,
                     .rendering = stops,
                     .paused = kWaits,
                     .stop1 = kBrakesOn,
                     .stop2 = stops});
  }
  cases.push_back(NotFiniteCase("external torques NaN", "all of them",
                                [](RigInputs& in, int, FaultRig&) { in.arm.tau_ext.fill(kNaN); }));
}

void AddModel(std::vector<FaultCase>& cases) {
  const auto stale = Of({Fault::kModelStale}), not_credible = Of({Fault::kNotFinite});
  // no frames for this number of ticks, then frames for the same number of ticks
  const auto frames_pause = [](int pause) {
    return [pause, model = simulation::ContactModel{}](RigInputs& in, int since, FaultRig&) mutable {
      if (since % (2 * pause) == 0) model = in.model;
      if (since % (2 * pause) < pause) in.model = model;
    };
  };
  cases.push_back(ModelCase("simulation silent", "no frame any more", stale, kSilentSimulation,
                            frames_pause(std::numeric_limits<int>::max() / 2)));
  cases.push_back(Tolerated("simulation pauses 30 ms", "again and again", 240, frames_pause(30)));
  cases.push_back(Tolerated("simulation pauses 200 ms", "once", 240, frames_pause(200)));
  cases.push_back(ModelCase("simulation never began", "frame 0", stale, kAtOnce,
                            [](RigInputs& in, int, FaultRig&) { in.model = {}; }));
  cases.push_back(DeviceCase(
      "simulation's device lost", "its status says so", Of({Fault::kDevice}), kAtOnce,
      [](RigInputs& in, int, FaultRig&) { in.model.status = simulation::EngineStatus::kDeviceLost; }));
  cases.push_back(ModelCase(
      "simulation refuses its input", "its status says so", not_credible, kAtOnce,
      [](RigInputs& in, int, FaultRig&) { in.model.status = simulation::EngineStatus::kBadInput; }));
  const auto contact = [&](const char* name, const char* injected, auto spoil) {
    cases.push_back(ModelCase(name, injected, not_credible, kAtOnce, [spoil](RigInputs& in, int, FaultRig&) {
      if (in.model.frame == 0) in.model.frame = 1;
      in.model.contact_count = std::max(in.model.contact_count, 1);
      spoil(in.model, in.model.contacts[0]);
    }));
  };
  using simulation::Contact;
  using simulation::ContactModel;
  contact("plane's normal NaN", "one component", [](ContactModel&, Contact& c) { c.n_W.x = kNaN; });
  contact("plane's normal not of unit length", "1.01",
          [](ContactModel&, Contact& c) { c.n_W = 1.01 * Vector3::UnitZ(); });
  contact("plane's place infinite", "one component",
          [](ContactModel&, Contact& c) { c.p_W_m.y = kInfinity; });
  contact("stiffness 1e308", "of a plane", [](ContactModel&, Contact& c) { c.stiffness_N_per_m = kHuge; });
  contact("stiffness negative", "of a plane", [](ContactModel&, Contact& c) { c.stiffness_N_per_m = -1.0; });
  contact("advance NaN", "of a plane", [](ContactModel&, Contact& c) { c.advance_m_per_s = kNaN; });
  contact("spindle torque of the cut 1e308", "of a frame",
          [](ContactModel& m, Contact&) { m.spindle_torque_Nm = kHuge; });
  contact("more contacts than there is room for", "200",
          [](ContactModel& m, Contact&) { m.contact_count = 200; });
  cases.push_back(
      ModelCase("frame of the future", "its pose's stamp is an hour ahead", stale, kAtOnce,
                [](RigInputs& in, int, FaultRig&) { in.model.pose_stamp += 3600 * rt::kSecond; }));
  {
    FaultCase made{.name = "bone jumps into the tool",
                   .injected = "the plane, by 5 mm",
                   .inject =
                       [](RigInputs& in, int, FaultRig& rig) {
                         in.model.contacts[0].p_W_m =
                             Vector3(Vector3(in.model.contacts[0].p_W_m) - 5e-3 * rig.feed_W());
                       },
                   .lasts = 300,
                   .waiting = kGoesOn,
                   .aligning = kGoesOn,
                   .rendering = Stops(Of({Fault::kWrenchRate}), kAtOnce),
                   .paused = kGoesOn,
                   .stop1 = kBrakesOn,
                   .stop2 = kBrakesOn};
    cases.push_back(std::move(made));
  }
}

void AddPlcAndSpindle(std::vector<FaultCase>& cases) {
  const auto plc = [&](const char* name, const char* injected, int ticks, RigInjection inject) {
    FaultCase made = DeviceCase(name, injected, Of({Fault::kInterlock}), ticks, std::move(inject));
    made.aligning = kPauses;
    made.aligning.ticks = ticks;
    cases.push_back(std::move(made));
  };
  plc("permission withdrawn", "by the PLC", kAtOnce, [](RigInputs& in, int, FaultRig&) {
    in.readings.interlock.permitted = in.readings.interlock.enabled = false;
  });
  plc("enabling switch let go", "the PLC permits on", kAtOnce,
      [](RigInputs& in, int, FaultRig&) { in.readings.interlock.enabled = false; });
  plc("PLC silent", "its last word was a permission", kSilentDevice,
      [held = control::InterlockReading{}](RigInputs& in, int since, FaultRig&) mutable {
        if (since == 0) held = in.readings.interlock;
        in.readings.interlock = held;
      });
  plc("PLC's word of the future", "its stamp is an hour ahead", kAtOnce,
      [](RigInputs& in, int, FaultRig&) { in.readings.interlock.stamp += 3600 * rt::kSecond; });

  const auto fault = Of({Fault::kSpindle}), beyond = Of({Fault::kSpindleLimit});
  cases.push_back(DeviceCase("drive's fault", "its status says so", fault, kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.spindle.fault = true; }));
  cases.push_back(DeviceCase("drive not ready", "its status says so", fault, kAtOnce,
                             [](RigInputs& in, int, FaultRig&) { in.readings.spindle.ready = false; }));
  cases.push_back(DeviceCase("drive silent", "no status any more", fault, kSilentDevice,
                             [held = control::SpindleReading{}](RigInputs& in, int since, FaultRig&) mutable {
                               if (since == 0) held = in.readings.spindle;
                               in.readings.spindle = held;
                             }));
  // Faults that are checked only while the cell moves: a waiting cell begins, and then stops.
  const auto trip = [&](const char* name, const char* injected, auto spoil) {
    FaultCase made = DeviceCase(name, injected, beyond, kSpindleBeyond,
                                [spoil](RigInputs& in, int, FaultRig&) { spoil(in.readings.spindle); });
    made.waiting = made.paused = Stops(beyond, kSpindleBeyond + 8);
    made.lasts = 300;
    cases.push_back(std::move(made));
  };
  using control::SpindleReading;
  trip("spindle's torque beyond its limit", "20 Nm", [](SpindleReading& s) { s.torque_Nm = 20.0; });
  trip("spindle's speed beyond its limit", "200 rad/s", [](SpindleReading& s) { s.speed_rad_per_s = 200.0; });
  trip("spindle's speed NaN", "the drive says so", [](SpindleReading& s) { s.speed_rad_per_s = kNaN; });
  cases.push_back(
      Tolerated("spindle stops turning", "the drive says so, without a fault", 300,
                [](RigInputs& in, int, FaultRig&) { in.readings.spindle.speed_rad_per_s = 0.0; }));
  cases.push_back(
      Tolerated("pedal released", "the PLC permits no spindle", 300,
                [](RigInputs& in, int, FaultRig&) { in.readings.interlock.spindle_permitted = false; }));
}

void AddLoop(std::vector<FaultCase>& cases) {
  // Jumps of the clock. All stamps jump by the same time, except that of the frame that is being computed.
  const auto jump = [&](const char* name, const char* injected, rt::Nanoseconds by) {
    FaultCase made = ModelCase(name, injected, Of({Fault::kModelStale}), kAtOnce,
                               [by](RigInputs& in, int since, FaultRig& rig) {
                                 if (since != 0) return;
                                 rig.clock_offset += by;
                                 in.now += by;
                                 in.arm.stamp += by;
                                 in.readings.force.stamp += by;
                                 in.readings.spindle.stamp += by;
                                 in.readings.interlock.stamp += by;
                               });
    made.aligning = made.paused = made.waiting = kGoesOn;  // the next frame has the new time
    cases.push_back(std::move(made));
  };
  jump("clock jumps forward", "10 s, for all but the frame under way", 10 * rt::kSecond);
  jump("clock jumps back", "0.5 s, for all but the frame under way", -rt::kSecond / 2);
  cases.push_back(NoticedAtOnce("a tick's second computation differs", "in the tick before",
                                Of({Fault::kRepeatDiffers}), [](RigInputs&, int since, FaultRig& rig) {
                                  if (since == 0) rig.loop().ReportDifference();
                                }));
  cases.push_back(
      Tolerated("a tick is late", "by 30 ms, every 100 ms", 300, [](RigInputs& in, int since, FaultRig& rig) {
        if (since % 100 != 0) return;
        rig.clock_offset += 30 * rt::kMillisecond;
        in.now += 30 * rt::kMillisecond;
      }));
  cases.push_back(Tolerated("gains asked for that are not accepted", "NaN, 1e308, negative", 100,
                            [](RigInputs&, int since, FaultRig& rig) {
                              control::Gains gains;
                              const double bad[] = {kNaN, kHuge, -1.0};
                              gains.mass_kg.x = bad[since % 3];
                              try {
                                rig.loop().RequestGains(gains);
                              } catch (const std::invalid_argument&) {
                                return;  // correct: the gains are refused before they reach the loop
                              }
                              throw std::logic_error("the loop took gains that are none");
                            }));
  FaultCase recorder = NoticedAtOnce(
      "recorder stands still", "2048 ticks wait for it", Of({Fault::kRecorder}),
      [](RigInputs&, int since, FaultRig& rig) { rig.recorder().stalled = since < 99; }, kNextTick);
  recorder.lasts = 100;
  cases.push_back(std::move(recorder));
}

std::vector<FaultCase> MakeCases() {
  std::vector<FaultCase> cases;
  AddSensor(cases);
  AddArm(cases);
  AddModel(cases);
  AddPlcAndSpindle(cases);
  for (FaultCase& fault : DriveFaultCases()) cases.push_back(std::move(fault));
  AddLoop(cases);
  return cases;
}

}  // namespace

std::span<const FaultCase> FaultCases() {
  static const std::vector<FaultCase> cases = MakeCases();
  return cases;
}

}  // namespace osteon::studies
