#include "studies/regress/scenario_trace.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "control/ports.h"
#include "safety/cell_state.h"
#include "session/replay/tick_fields.h"
#include "session/summary/each_fault.h"

namespace osteon::studies {
namespace {

// Adds a value to the hash as one word; a floating-point number by its bits.
template <class T>
void Add(base::Fnv1a& hash, T value) {
  if constexpr (std::is_floating_point_v<T>)
    hash.AddWord(std::bit_cast<std::uint64_t>(value));
  else
    hash.AddWord(static_cast<std::uint64_t>(value));
}

// Mixes the bits so that each input bit affects each output bit (the last step of MurmurHash3).
std::uint64_t Mixed(std::uint64_t h) {
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
  return h ^ (h >> 33);
}

struct PartOfField {
  const char* begins;
  TracePart part;
};
// Assigns a field to a part by the beginning of the field's name; the first row that matches is used. A field
// without a match is a programming error.
constexpr PartOfField kOutputs[] = {
    {"tick", TracePart::kArm},
    {"stamp", TracePart::kArm},
    {"session_state", TracePart::kArm},
    {"q_meas", TracePart::kArm},
    {"X_WT_meas", TracePart::kArm},
    {"phase", TracePart::kState},
    {"cell_state", TracePart::kState},
    {"permits", TracePart::kState},
    {"faults", TracePart::kState},
    {"limits", TracePart::kState},
    {"tool_speed_meas", TracePart::kState},
    {"q_cmd", TracePart::kCommand},
    {"X_WT_cmd", TracePart::kCommand},
    {"v_WT_cmd", TracePart::kCommand},
    {"activation_cmd", TracePart::kCommand},
    {"F_cmd_T", TracePart::kCommand},
    {"tau_cmd", TracePart::kCommand},
    {"spindle", TracePart::kCommand},
    {"F_operator_T_W", TracePart::kHand},
    {"F_bias_S", TracePart::kHand},
    {"vibration", TracePart::kHand},
    {"mass_factor", TracePart::kHand},
    {"damping_factor", TracePart::kHand},
    {"sensor_age", TracePart::kHand},
    {"F_coupling_T_W", TracePart::kCoupling},
    {"wrench_step", TracePart::kCoupling},
    {"wrench_scale", TracePart::kCoupling},
    {"arm_share", TracePart::kCoupling},
    {"tool_in_bone", TracePart::kCoupling},
    {"age_", TracePart::kCoupling},
    {"passivity", TracePart::kCoupling},
    {"tank", TracePart::kCoupling},
    {"guidance", TracePart::kCoupling},
    {"compliance", TracePart::kCoupling},
    {"model_", TracePart::kCoupling},
};
constexpr PartOfField kInputs[] = {
    {"model_", TracePart::kBone},        {"sensor_", TracePart::kDevices},
    {"F_sensor_S", TracePart::kDevices}, {"spindle_", TracePart::kDevices},
    {"interlock_", TracePart::kDevices}, {"permitted", TracePart::kDevices},
    {"enabled", TracePart::kDevices},    {"", TracePart::kArm},
};

// The part of a field. @throws std::logic_error if the table has no row for its name
TracePart PartOf(const char* name, std::span<const PartOfField> table) {
  for (const PartOfField& row : table)
    if (std::strncmp(name, row.begins, std::strlen(row.begins)) == 0) return row.part;
  throw std::logic_error(std::string("a tick's field in no part of a trace: ") + name);
}

// Fields that only few cells use. They are hashed only if they are not zero, so that the golden traces of the
// other cells do not depend on them.
constexpr std::array kOptional{"guidance", "compliance", "tool_index"};

struct FieldPart {
  TracePart part;
  bool is_optional;
};

// The part of each field of a tick, in the order in which VisitOutputs and VisitInputs visit the fields.
const std::vector<FieldPart>& FieldParts() {
  static const std::vector<FieldPart> parts = [] {
    std::vector<FieldPart> all;
    const auto add = [&](const session::FieldName& field, std::span<const PartOfField> table) {
      const bool is_optional = std::ranges::any_of(kOptional, [&](const char* begins) {
        return std::strncmp(field.name, begins, std::strlen(begins)) == 0;
      });
      all.push_back({.part = PartOf(field.name, table), .is_optional = is_optional});
    };
    session::VisitOutputs(control::TickRecord{},
                          [&](const session::FieldName& field, auto) { add(field, kOutputs); });
    session::VisitInputs(control::TickRecord{},
                         [&](const session::FieldName& field, auto) { add(field, kInputs); });
    return all;
  }();
  return parts;
}

// Hash of a model and its contacts.
std::uint64_t DigestOf(const simulation::ContactModel& model) {
  base::Fnv1a hash;
  const auto add = [&](const session::FieldName&, auto value) { Add(hash, value); };
  session::VisitFrame(simulation::FrameRecord{.model = model}, add);
  for (int i = 0; i < std::clamp(model.contact_count, 0, simulation::kMaxContacts); ++i)
    session::VisitContact(model.contacts[static_cast<std::size_t>(i)], add);
  return hash.hash();
}

constexpr double kMillimetres = 1e3, kCubicMillimetres = 1e9;  // factors on m and m³

// Calls deliver(name, axis or joint, kind, value in the quantity's unit) for each quantity.
template <class Deliver>
void VisitQuantities(const control::TickRecord& r, const simulation::ContactModel& model, Deliver&& deliver) {
  using enum QuantityKind;
  const auto joints = [&](const char* name, const std::array<double, 7>& values, QuantityKind kind) {
    for (std::size_t i = 0; i < values.size(); ++i)
      deliver(name, session::fields::kJoint[i], kind, values[i]);
  };
  const auto vector = [&](const char* name, const PlainVector3& v, QuantityKind kind, double scale = 1.0) {
    deliver(name, "x", kind, scale * v.x);
    deliver(name, "y", kind, scale * v.y);
    deliver(name, "z", kind, scale * v.z);
  };
  joints("q_cmd", r.q_cmd, kAngle);
  vector("tool", r.X_WT_cmd.p, kPosition, kMillimetres);
  vector("tool_measured", r.X_WT_meas.p, kPosition, kMillimetres);
  const std::array<double, 9>& R = r.X_WT_meas.R;
  // the third column of R: the direction of the tool's z axis
  vector("tool_axis", PlainVector3(Vector3(R[2], R[5], R[8])), kShare);
  vector("hand", r.F_operator_T_W.f, kForce);
  vector("hand", r.F_operator_T_W.t, kTorque);
  vector("coupling", r.F_coupling_T_W.f, kForce);
  vector("coupling", r.F_coupling_T_W.t, kTorque);
  vector("overlay", r.F_cmd_T.f, kForce);
  vector("overlay", r.F_cmd_T.t, kTorque);
  joints("tau_cmd", r.tau_cmd, kTorque);
  deliver("tank", "", kEnergy, r.tank_J);
  deliver("wrench_scale", "", kShare, r.wrench_scale);
  deliver("spindle", "", kSpeed, r.input.spindle_meas_rad_per_s);
  deliver("spindle_load", "", kTorque, model.spindle_torque_Nm);
  deliver("removed", "", kVolume, kCubicMillimetres * model.removed_volume_m3);
  deliver("cutting_work", "", kEnergy, model.cutting_work_J);
}

}  // namespace

const char* NameOf(TracePart part) {
  static constexpr std::array<const char*, kTraceParts> kNames{
      "the arm's message", "the devices' readings", "the contact model", "the hand's wrench",
      "the coupling",      "the cell's state",      "the command"};
  return kNames.at(static_cast<std::size_t>(part));
}

const char* UnitOf(QuantityKind kind) {
  static constexpr std::array kUnits{"mm", "rad", "N", "Nm", "rad_per_s", "mm3", "J", ""};
  return kUnits.at(static_cast<std::size_t>(kind));
}

int DecimalsOf(QuantityKind kind) {
  static constexpr std::array kDecimals{5, 7, 4, 5, 4, 3, 6, 6};
  return kDecimals.at(static_cast<std::size_t>(kind));
}

double ToleranceOf(QuantityKind kind, const config::TraceTolerances& t) {
  const std::array values{
      kMillimetres * t.position_m,     t.angle_rad, t.force_N, t.torque_Nm, t.speed_rad_per_s,
      kCubicMillimetres * t.volume_m3, t.energy_J,  t.share};
  return values.at(static_cast<std::size_t>(kind));
}

std::span<const TraceQuantity> TraceQuantities() {
  static const std::vector<TraceQuantity> quantities = [] {
    std::vector<TraceQuantity> all;
    VisitQuantities({}, {}, [&](const char* name, const char* part, QuantityKind kind, double) {
      all.push_back(
          {.name = session::FieldName{name, part, UnitOf(kind)}.Text(), .family = name, .kind = kind});
    });
    return all;
  }();
  return quantities;
}

TraceRecorder::TraceRecorder(double period_s, double sample_s)
    : sample_ticks_(
          static_cast<std::uint64_t>(std::max<std::int64_t>(1, std::llround(sample_s / period_s)))) {
  trace_.period_s = period_s;
}

void TraceRecorder::NoteState(const control::TickRecord& record) {
  const auto note = [&](const std::string& what) {
    trace_.events.push_back({.tick = trace_.ticks, .what = what});
  };
  if (const bool active =
          record.session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
      active != active_) {
    note(active ? "arm handed over" : "arm taken back");
    active_ = active;
  }
  if (record.cell_state != cell_state_) {
    note(std::string("state ") + safety::Describe(static_cast<safety::CellState>(record.cell_state)).name);
    cell_state_ = record.cell_state;
  }
  session::ForEachFault([&](safety::Fault fault, const safety::FaultText& text) {
    const auto bit = static_cast<std::uint32_t>(fault);
    if ((record.faults & bit) != (faults_ & bit))
      note(std::string(record.faults & bit ? "fault " : "no fault any more: ") + text.name);
  });
  faults_ = record.faults;
}

void TraceRecorder::Sample(const control::TickRecord& record, const simulation::ContactModel& model) {
  values_.clear();
  VisitQuantities(record, model,
                  [&](const char*, const char*, QuantityKind, double value) { values_.push_back(value); });
  if (trace_.least.empty()) trace_.least = trace_.greatest = values_;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    trace_.least[i] = std::min(trace_.least[i], values_[i]);
    trace_.greatest[i] = std::max(trace_.greatest[i], values_[i]);
  }
  if (trace_.ticks % sample_ticks_ == 0) trace_.samples.push_back({.tick = trace_.ticks, .values = values_});
}

void TraceRecorder::Tick(const control::TickRecord& record, const simulation::ContactModel& model) {
  // Hash every bit of each part.
  std::array<base::Fnv1a, kTraceParts> parts{};
  const std::vector<FieldPart>& of_field = FieldParts();
  std::size_t at = 0;
  const auto add = [&](const session::FieldName&, auto value) {
    const FieldPart& field = of_field[at++];
    if (!field.is_optional || value != 0) Add(parts[static_cast<std::size_t>(field.part)], value);
  };
  session::VisitOutputs(record, add);
  session::VisitInputs(record, add);
  Add(parts[static_cast<std::size_t>(TracePart::kBone)], DigestOf(model));
  for (const base::Fnv1a& part : parts) Add(hash_, part.hash());

  NoteState(record);
  if (!begun_ && record.phase != control::Phase::kWaiting) {
    begun_ = true;
    trace_.first_tick = trace_.ticks;
  }
  if (begun_) {
    TickDigest digest{};
    for (std::size_t i = 0; i < parts.size(); ++i)
      digest[i] = static_cast<std::uint16_t>(Mixed(parts[i].hash()) & 0xfff);
    trace_.digests.push_back(digest);
    Sample(record, model);
  }
  ++trace_.ticks;
}

void TraceRecorder::SceneEvent(std::int64_t stamp, const std::string& name) {
  // The first tick ends at one period.
  const std::int64_t tick = std::llround(static_cast<double>(stamp) * 1e-9 / trace_.period_s) - 1;
  trace_.events.push_back(
      {.tick = static_cast<std::uint64_t>(std::max<std::int64_t>(0, tick)), .what = "scene " + name});
}

ScenarioTrace TraceRecorder::Finish(std::string ended, std::uint64_t active, std::uint64_t carved) {
  Add(hash_, carved);
  trace_.hash = Mixed(hash_.hash());
  trace_.ended = std::move(ended);
  trace_.active = active;
  std::ranges::stable_sort(trace_.events, {}, &TraceEvent::tick);
  return std::move(trace_);
}

}  // namespace osteon::studies
