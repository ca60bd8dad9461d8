#include "io/recording/messages.h"

#include <google/protobuf/descriptor.pb.h>

#include <limits>

#include <recording.pb.h>

namespace osteon::io {
namespace {

using control::TickRecord;
using simulation::FrameRecord;

// out: plain data to protobuf

void Put(const PlainVector3& from, Vec3* to) {
  to->set_x(from.x);
  to->set_y(from.y);
  to->set_z(from.z);
}

void Put(const PlainPose& from, Transform* to) {
  to->mutable_rotation()->Assign(from.R.begin(), from.R.end());
  Put(from.p, to->mutable_position_m());
}

void Put(const PlainWrench& from, ForceTorque* to) {
  Put(from.f, to->mutable_force_n());
  Put(from.t, to->mutable_torque_nm());
}

// in: protobuf to plain data; false where an array has the wrong length

void Get(const Vec3& from, PlainVector3& to) {
  to.x = from.x();
  to.y = from.y();
  to.z = from.z();
}

template <std::size_t N>
[[nodiscard]] bool Get(const google::protobuf::RepeatedField<double>& from, std::array<double, N>& to) {
  if (from.size() != static_cast<int>(N)) return false;
  std::copy(from.begin(), from.end(), to.begin());
  return true;
}

[[nodiscard]] bool Get(const Transform& from, PlainPose& to) {
  Get(from.position_m(), to.p);
  return Get(from.rotation(), to.R);
}

void Get(const ForceTorque& from, PlainWrench& to) {
  Get(from.force_n(), to.f);
  Get(from.torque_nm(), to.t);
}

template <class Message>
[[nodiscard]] bool Parse(std::span<const char> bytes, Message& message) {
  return bytes.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()) &&
         message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace

std::string RecordingDescriptorSet() {
  google::protobuf::FileDescriptorSet set;
  Tick::descriptor()->file()->CopyTo(set.add_file());
  return set.SerializeAsString();
}

void Encode(const SessionInfo& session, std::string& bytes) {
  Session message;
  message.set_stamp_ns(session.stamp);
  message.set_version(session.version);
  message.set_engine(session.engine);
  message.set_device(session.device);
  message.set_scene(session.scene);
  message.set_tool(session.tool);
  message.set_force_limit_n(session.force_limit_N);
  message.set_config_text(session.config_text);
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, SessionInfo& session) {
  Session message;
  if (!Parse(bytes, message)) return "not an osteon.Session";
  session = {.stamp = message.stamp_ns(),
             .version = message.version(),
             .engine = message.engine(),
             .device = message.device(),
             .scene = message.scene(),
             .tool = message.tool(),
             .force_limit_N = message.force_limit_n(),
             .config_text = message.config_text()};
  return {};
}

void Encode(const TickRecord& record, std::string& bytes) {
  Tick message;
  message.set_tick(record.tick);
  message.set_stamp_ns(record.stamp);
  message.set_phase(static_cast<Tick::Phase>(record.phase));
  message.set_session_state(record.session_state);
  message.set_faults(record.faults);
  message.mutable_q_meas_rad()->Assign(record.q_meas.begin(), record.q_meas.end());
  message.mutable_q_cmd_rad()->Assign(record.q_cmd.begin(), record.q_cmd.end());
  Put(record.X_WT_cmd, message.mutable_x_wt_cmd());
  Put(record.X_WT_meas, message.mutable_x_wt_meas());
  Put(record.v_WT_cmd_m_per_s, message.mutable_v_wt_cmd_m_per_s());
  Put(record.F_operator_T_W, message.mutable_f_operator_t_w());
  Put(record.F_coupling_T_W, message.mutable_f_coupling_t_w());
  message.set_wrench_scale(record.wrench_scale);
  message.set_arm_share(record.arm_share);
  message.set_model_age_s(record.model_age_s);
  message.set_sensor_age_s(record.sensor_age_s);
  message.set_model_frame(record.model_frame);
  message.set_spindle_rad_per_s(record.spindle_rad_per_s);
  message.set_wakeup_ns(record.wakeup_ns);
  message.set_compute_ns(record.compute_ns);
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, TickRecord& record) {
  Tick message;
  if (!Parse(bytes, message)) return "not an osteon.Tick";
  if (!Tick::Phase_IsValid(message.phase()))
    return "phase " + std::to_string(message.phase()) + ", accepted 0 … 3";
  if (message.session_state() > 4)
    return "session_state " + std::to_string(message.session_state()) + ", accepted 0 … 4";
  TickRecord r;
  r.tick = message.tick();
  r.stamp = message.stamp_ns();
  r.phase = static_cast<control::Phase>(message.phase());
  r.session_state = static_cast<std::uint8_t>(message.session_state());
  r.faults = message.faults();
  if (!Get(message.q_meas_rad(), r.q_meas) || !Get(message.q_cmd_rad(), r.q_cmd)) return "not 7 joint values";
  if (!Get(message.x_wt_cmd(), r.X_WT_cmd) || !Get(message.x_wt_meas(), r.X_WT_meas))
    return "not 9 elements of a rotation";
  Get(message.v_wt_cmd_m_per_s(), r.v_WT_cmd_m_per_s);
  Get(message.f_operator_t_w(), r.F_operator_T_W);
  Get(message.f_coupling_t_w(), r.F_coupling_T_W);
  r.wrench_scale = message.wrench_scale();
  if (message.has_arm_share()) r.arm_share = message.arm_share();
  r.model_age_s = message.model_age_s();
  r.sensor_age_s = message.sensor_age_s();
  r.model_frame = message.model_frame();
  r.spindle_rad_per_s = message.spindle_rad_per_s();
  r.wakeup_ns = message.wakeup_ns();
  r.compute_ns = message.compute_ns();
  record = r;
  return {};
}

void Encode(const FrameRecord& record, std::string& bytes) {
  const simulation::ContactModel& model = record.model;
  Frame message;
  message.set_frame(model.frame);
  message.set_stamp_ns(record.stamp);
  message.set_duration_ns(record.duration_ns);
  message.set_cup_depth_m(record.cup_depth_m);
  message.set_pose_stamp_ns(model.pose_stamp);
  message.set_status(static_cast<Frame::Status>(model.status));
  Put(model.X_WP, message.mutable_x_wp());
  for (int i = 0; i < std::clamp(model.contact_count, 0, simulation::kMaxContacts); ++i) {
    const simulation::Contact& contact = model.contacts[static_cast<std::size_t>(i)];
    ContactPlane* plane = message.add_contacts();
    Put(contact.p_TP_m, plane->mutable_p_tp_m());
    Put(contact.p_W_m, plane->mutable_p_w_m());
    Put(contact.n_W, plane->mutable_n_w());
    plane->set_gap_m(contact.gap_m);
    plane->set_stiffness_n_per_m(contact.stiffness_N_per_m);
    plane->set_mu(contact.mu);
    plane->set_advance_m_per_s(contact.advance_m_per_s);
    plane->set_weight(contact.weight);
    plane->set_material(contact.material);
  }
  Put(model.n_W, message.mutable_n_w());
  message.set_contact_fraction(model.contact_fraction);
  Put(model.p_WS_m, message.mutable_p_ws());
  Put(model.F_T_W, message.mutable_f_t_w());
  message.set_advance_m_per_s(model.advance_m_per_s);
  message.set_engaged_area_m2(model.engaged_area_m2);
  message.set_spindle_torque_nm(model.spindle_torque_Nm);
  message.set_removed_volume_m3(model.removed_volume_m3);
  message.set_removed_mass_kg(model.removed_mass_kg);
  message.set_cutting_work_j(model.cutting_work_J);
  message.set_balls_not_split(model.balls_not_split);
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, FrameRecord& record) {
  Frame message;
  if (!Parse(bytes, message)) return "not an osteon.Frame";
  if (!Frame::Status_IsValid(message.status()))
    return "status " + std::to_string(message.status()) + ", accepted 0 … 3";
  if (message.contacts_size() > simulation::kMaxContacts)
    return std::to_string(message.contacts_size()) + " contacts, accepted 0 … 8";
  FrameRecord r;
  simulation::ContactModel& model = r.model;
  model.frame = message.frame();
  r.stamp = message.stamp_ns();
  r.duration_ns = message.duration_ns();
  r.cup_depth_m = message.cup_depth_m();
  model.pose_stamp = message.pose_stamp_ns();
  model.status = static_cast<simulation::EngineStatus>(message.status());
  if (!Get(message.x_wp(), model.X_WP)) return "not 9 elements of a rotation";
  for (const ContactPlane& plane : message.contacts()) {
    simulation::Contact& contact = model.contacts[static_cast<std::size_t>(model.contact_count++)];
    Get(plane.p_tp_m(), contact.p_TP_m);
    Get(plane.p_w_m(), contact.p_W_m);
    Get(plane.n_w(), contact.n_W);
    contact.gap_m = plane.gap_m();
    contact.stiffness_N_per_m = plane.stiffness_n_per_m();
    contact.mu = plane.mu();
    contact.advance_m_per_s = plane.advance_m_per_s();
    contact.weight = plane.weight();
    if (plane.material() > std::numeric_limits<simulation::MaterialIndex>::max())
      return "material " + std::to_string(plane.material()) + ", accepted 0 … 255";
    contact.material = static_cast<simulation::MaterialIndex>(plane.material());
  }
  Get(message.n_w(), model.n_W);
  model.contact_fraction = message.contact_fraction();
  Get(message.p_ws(), model.p_WS_m);
  Get(message.f_t_w(), model.F_T_W);
  model.advance_m_per_s = message.advance_m_per_s();
  model.engaged_area_m2 = message.engaged_area_m2();
  model.spindle_torque_Nm = message.spindle_torque_nm();
  model.removed_volume_m3 = message.removed_volume_m3();
  model.removed_mass_kg = message.removed_mass_kg();
  model.cutting_work_J = message.cutting_work_j();
  model.balls_not_split = message.balls_not_split();
  record = r;
  return {};
}

void Encode(const RecordedEvent& event, std::string& bytes) {
  Event message;
  message.set_stamp_ns(event.stamp);
  message.set_text(event.text);
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, RecordedEvent& event) {
  Event message;
  if (!Parse(bytes, message)) return "not an osteon.Event";
  event = {.stamp = message.stamp_ns(), .text = message.text()};
  return {};
}

}  // namespace osteon::io
