#include "io/recording/message_parts.h"
#include "io/recording/messages.h"

namespace osteon::io {

using simulation::FrameRecord;

namespace {

// Returns a cleared message that reuses the memory of the one before, because a recording of hours has a
// hundred million messages.
Frame& ReusedFrame() {
  static thread_local Frame message;
  message.Clear();
  return message;
}

}  // namespace

void Encode(const FrameRecord& record, std::string& bytes) {
  const simulation::ContactModel& model = record.model;
  Frame& message = ReusedFrame();
  message.set_frame(model.frame);
  message.set_stamp_ns(record.stamp);
  message.set_duration_ns(record.duration_ns);
  message.set_cup_depth_m(record.cup_depth_m);
  message.set_pose_stamp_ns(model.pose_stamp);
  message.set_status(static_cast<Frame::Status>(model.status));
  FillMessage(model.X_WP, message.mutable_x_wp());
  for (int i = 0; i < std::clamp(model.contact_count, 0, simulation::kMaxContacts); ++i) {
    const simulation::Contact& contact = model.contacts[static_cast<std::size_t>(i)];
    ContactPlane* plane = message.add_contacts();
    FillMessage(contact.p_TP_m, plane->mutable_p_tp_m());
    FillMessage(contact.p_W_m, plane->mutable_p_w_m());
    FillMessage(contact.n_W, plane->mutable_n_w());
    plane->set_gap_m(contact.gap_m);
    plane->set_stiffness_n_per_m(contact.stiffness_N_per_m);
    plane->set_mu(contact.mu);
    plane->set_advance_m_per_s(contact.advance_m_per_s);
    plane->set_weight(contact.weight);
    plane->set_material(contact.material);
  }
  if (model.contact_count != message.contacts_size()) message.set_contact_count(model.contact_count);
  FillMessage(model.n_W, message.mutable_n_w());
  message.set_contact_fraction(model.contact_fraction);
  FillMessage(model.p_WS_m, message.mutable_p_ws());
  FillMessage(model.F_T_W, message.mutable_f_t_w());
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
  Frame& message = ReusedFrame();
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
  // Normally the number of contacts is the number of recorded planes. A separate contact_count is recorded
  // only if the model's number was invalid: negative, or above kMaxContacts. Any other contact_count is
  // refused.
  if (message.has_contact_count()) {
    const std::int32_t count = message.contact_count();
    const bool too_few = count < 0 && model.contact_count == 0;
    const bool too_many = count > simulation::kMaxContacts && model.contact_count == simulation::kMaxContacts;
    if (!too_few && !too_many)
      return "contact_count " + std::to_string(count) + " beside " + std::to_string(model.contact_count) +
             " contacts, accepted as many as there are, or one that no model may have";
    model.contact_count = count;
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

}  // namespace osteon::io
