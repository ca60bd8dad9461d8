#include "studies/failures/packet_bench.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "control/coupling/virtual_coupling.h"
#include "control/laws/admittance_law.h"
#include "hil/injection/impaired_wire.h"
#include "safety/watchdog.h"

namespace osteon::studies {
namespace {

using simulation::ContactModel;

constexpr double kDt_s = 1e-3, kTap_N = 2.0, kTap_s = 0.02;  // force and length of a tap
constexpr double kWindow_s = 0.5;                            // time over which a swing is measured
constexpr double kToolRadius_m = 0.025;

// Messages on the wires. A newer message has a later stamp.
struct PoseDatagram {
  rt::Nanoseconds stamp{-1};
  PlainVector3 p_W_m;
};
struct ForceDatagram {
  rt::Nanoseconds stamp{-1};       // time of creation
  rt::Nanoseconds pose_stamp{-1};  // stamp of the pose for which the force was computed
  PlainVector3 f_W{};
};

// Which of the received messages a client keeps: a client that uses the stamps keeps the newest one, a naive
// client keeps the one received last. ReceiveDue returns whether any message arrived.
enum class Keep { kNewest, kLast };
template <class T>
bool ReceiveDue(hil::ImpairedWire& wire, rt::Nanoseconds now, Keep keep, T& value) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 1500);
  bool came = false;
  while (wire.NextDue() <= now) {
    const auto bytes = wire.Next(now);
    T next;
    std::memcpy(static_cast<void*>(&next), bytes.data(), sizeof next);
    came = true;
    if (keep == Keep::kLast || next.stamp >= value.stamp) value = next;
  }
  return came;
}
// Sends a message as its bytes in memory.
template <class T>
void Send(hil::ImpairedWire& wire, rt::Nanoseconds now, const T& value) {
  wire.Push({reinterpret_cast<const std::uint8_t*>(&value), sizeof value}, now);
}

// A frame's contact model and its stamp.
struct ModelDatagram {
  rt::Nanoseconds stamp{-1};
  ContactModel model;
};

// Computes the contact of the tool's ball in the cup, a sphere about W's origin: one contact, whose normal
// points to the centre.
ModelDatagram Frame(const PacketTrialParams& params, const PoseDatagram& pose, rt::Nanoseconds now,
                    std::uint64_t frame) {
  const Vector3 p = pose.p_W_m;
  const double out_m = p.norm();
  const Vector3 n = out_m > 1e-9 ? Vector3(-p / out_m) : Vector3(Vector3::UnitZ());
  ModelDatagram datagram;
  datagram.stamp = now;
  ContactModel& model = datagram.model;
  model.contact_count = 1;
  simulation::Contact& contact = model.contacts[0];
  contact.p_TP_m = Vector3(-kToolRadius_m * n);
  contact.p_W_m = Vector3(-(params.clearance_m + kToolRadius_m) * n);
  contact.n_W = n;
  contact.gap_m = params.clearance_m - out_m;
  contact.stiffness_N_per_m = params.wall_N_per_m;
  model.pose_stamp = pose.stamp;
  model.frame = frame;
  return datagram;
}

// The force of a tap that begins at tap_s: down and sideways, constant for kTap_s.
Vector3 TapForce(double t_s, double tap_s) {
  const double u = (t_s - tap_s) / kTap_s;
  return u < 0.0 || u > 1.0 ? Vector3::Zero() : Vector3(kTap_N * Vector3(1.0, 0.0, -1.0).normalized());
}

// Diagonal of the bounding box of the positions in a time span.
double Swing(const std::vector<Vector3>& p_W_m, double from_s, double to_s) {
  Vector3 low = Vector3::Constant(1e9), high = -low;
  for (auto i = static_cast<std::size_t>(from_s / kDt_s); i < static_cast<std::size_t>(to_s / kDt_s); ++i) {
    low = low.cwiseMin(p_W_m[i]);
    high = high.cwiseMax(p_W_m[i]);
  }
  return (high - low).norm();
}

// The controller, with the newest messages about wall and hand, and the shipped law.
class Controller {
 public:
  explicit Controller(const PacketTrialParams& params) : params_(params) {
    law_.mass_kg.setConstant(params.mass_kg);
    law_.damping_Ns_per_m.setConstant(params.damping_Ns_per_m);
    coupling_.max_stiffness_N_per_m = params.wall_N_per_m;
    coupling_.damping_Ns_per_m = 0.0;  // only the drag dissipates energy, as with the other methods
    state_.X_WT.translation() = Vector3(0.0, 0.0, -params.clearance_m);
  }

  // Runs one tick with the messages received over the wires.
  void Tick(rt::Nanoseconds now, hil::ImpairedWire& wall, hil::ImpairedWire& hand, PacketTrial& trial) {
    const bool planes = params_.method == WallMethod::kPlanes;
    const Keep keep = planes ? Keep::kNewest : Keep::kLast;
    const bool hand_came = ReceiveDue(hand, now, keep, hand_);
    Vector3 f_hand = hand_.f_W;
    double fade = 1.0;
    Wrench F;
    if (planes) {
      ReceiveDue(wall, now, keep, model_);
      const control::CouplingOutput out = control::EvaluateCoupling(
          coupling_, {.model = model_.model, .X_WT = state_.X_WT, .V_WT = state_.V_WT, .now = now},
          coupling_state_);
      // As in ServoLoop: the age scales down the hand's force and the motion by the factor by which it fades
      // the coupling.
      fade = out.fade;
      const double hand_age_s = safety::AgeSeconds(now, hand_.stamp);
      f_hand *= fade * safety::AgeFade(hand_age_s, watchdog_.sensor_full_s, watchdog_.sensor_stop_s);
      F.f = out.F_T_W.f;
      RecordForce(now, model_.model.pose_stamp, F.f.norm(), trial);
    } else {
      const bool wall_came = ReceiveDue(wall, now, keep, wall_);
      const bool zeroed = params_.method == WallMethod::kZeroed;
      if (zeroed && !hand_came) f_hand.setZero();
      if (!zeroed || wall_came) F.f = wall_.f_W;
      RecordForce(now, wall_.pose_stamp, F.f.norm(), trial);
    }
    if (hand_.pose_stamp >= 0)
      trial.hand_age_s = std::max(trial.hand_age_s, rt::ToSeconds(now - hand_.pose_stamp));
    F.f += f_hand;
    if (!control::NextTwist(law_, {.X_WT = state_.X_WT, .V_WT = state_.V_WT, .F_T_W = F, .dt_s = kDt_s},
                            state_.V_WT))
      return;  // the tool stays in its place
    state_.X_WT =
        control::IntegratePose(state_.X_WT, {.v = fade * state_.V_WT.v, .w = Vector3::Zero()}, kDt_s);
  }

  [[nodiscard]] Vector3 p_W_m() const { return state_.X_WT.translation(); }

 private:
  // Updates the run's largest age of the wall's answer, and the largest force of the wall.
  static void RecordForce(rt::Nanoseconds now, rt::Nanoseconds pose_stamp, double force_N,
                          PacketTrial& trial) {
    if (pose_stamp >= 0) trial.wall_age_s = std::max(trial.wall_age_s, rt::ToSeconds(now - pose_stamp));
    trial.max_wall_N = std::max(trial.max_wall_N, force_N);
  }

  PacketTrialParams params_;
  control::AdmittanceParams law_;
  control::CouplingParams coupling_;
  control::CouplingState coupling_state_;
  control::AdmittanceState state_;
  safety::WatchdogParams watchdog_;
  ModelDatagram model_;
  ForceDatagram wall_, hand_;
};

}  // namespace

PacketTrial RunPacketTrial(const PacketTrialParams& params) {
  const auto faults = [&params](std::uint64_t seed) {
    return hil::InjectionParams{.injections = {{.to_s = params.step_s, .faults = params.before},
                                               {.from_s = params.step_s, .faults = params.after}},
                                .seed = seed};
  };
  const hil::InjectionParams of_simulation = faults(2 * params.seed), of_arm = faults(2 * params.seed + 1);
  hil::ImpairedWire pose(of_simulation, hil::Wire::kArm, hil::Direction::kFromController);
  hil::ImpairedWire wall(of_simulation, hil::Wire::kArm, hil::Direction::kToController);
  hil::ImpairedWire command(of_arm, hil::Wire::kArm, hil::Direction::kFromController);
  hil::ImpairedWire force(of_arm, hil::Wire::kArm, hil::Direction::kToController);
  for (hil::ImpairedWire* wire : {&pose, &wall, &command, &force}) wire->StartSchedule(0);

  PacketTrial trial;
  Controller controller(params);
  const Vector3 p_held = controller.p_W_m();  // rest position of the hand's spring
  PoseDatagram seen, commanded;
  std::uint64_t frame = 0;
  const auto ticks = std::llround(params.seconds / kDt_s);
  trial.p_W_m.reserve(static_cast<std::size_t>(ticks));
  for (std::int64_t i = 0; i < ticks; ++i) {
    const rt::Nanoseconds now = i * rt::kMillisecond;
    const double t_s = rt::ToSeconds(now);

    // The simulation answers each new pose.
    const rt::Nanoseconds before = seen.stamp;
    ReceiveDue(pose, now, Keep::kNewest, seen);
    if (seen.stamp > before) {
      const ModelDatagram answer = Frame(params, seen, now, ++frame);
      const simulation::Contact& contact = answer.model.contacts[0];
      const double push_N = params.wall_N_per_m * std::max(0.0, -contact.gap_m);
      if (params.method == WallMethod::kPlanes)
        Send(wall, now, answer);
      else
        Send(wall, now,
             ForceDatagram{
                 .stamp = now, .pose_stamp = seen.stamp, .f_W = Vector3(push_N * Vector3(contact.n_W))});
    }

    // The arm is at the newest command that it received; the sensor measures in every period.
    ReceiveDue(command, now, Keep::kNewest, commanded);
    if (commanded.stamp >= 0) {
      const Vector3 spring = params.hand_N_per_m * (p_held - Vector3(commanded.p_W_m));
      const Vector3 f = spring + Vector3(0.0, 0.0, -params.push_N) + TapForce(t_s, params.step_s - 1.0) +
                        TapForce(t_s, params.step_s);
      Send(force, now, ForceDatagram{.stamp = now, .pose_stamp = commanded.stamp, .f_W = f});
    }

    controller.Tick(now, wall, force, trial);
    const PoseDatagram next{.stamp = now, .p_W_m = controller.p_W_m()};
    Send(pose, now, next);
    Send(command, now, next);
    trial.p_W_m.push_back(controller.p_W_m());
  }
  trial.tap_m = Swing(trial.p_W_m, params.step_s - 1.0, params.step_s - 1.0 + kWindow_s);
  trial.end_m = Swing(trial.p_W_m, params.seconds - kWindow_s, params.seconds);
  return trial;
}

double AgeMargin(const PacketTrialParams& params, const PacketTrial& trial) {
  const double wall_N_per_m =
      params.method == WallMethod::kPlanes ? trial.max_wall_N / params.clearance_m : params.wall_N_per_m;
  return params.damping_Ns_per_m - trial.wall_age_s * wall_N_per_m - trial.hand_age_s * params.hand_N_per_m;
}

}  // namespace osteon::studies
