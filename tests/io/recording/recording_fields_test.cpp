#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "io/recording/messages.h"
#include "tests/io/recording/recording_samples.h"

// Each field of a recorded tick, frame or event must be restored from its bytes.

namespace osteon::io {
namespace {

using test::Encoded;
using test::SomeFrame;
using test::SomeTick;

// The test compares each field separately: a comparison of encoded bytes would not show a field that the
// encoder forgets.
TEST(RecordingFields, CarriesEveryFieldOfATick) {
  const control::TickRecord sent = SomeTick(7);
  control::TickRecord r;
  ASSERT_EQ(Decode(Encoded(sent), r), "");
  EXPECT_EQ(r.tick, sent.tick);
  EXPECT_EQ(r.stamp, sent.stamp);
  EXPECT_EQ(r.phase, sent.phase);
  EXPECT_EQ(r.session_state, sent.session_state);
  EXPECT_EQ(r.faults, sent.faults);
  EXPECT_EQ(r.q_meas, sent.q_meas);
  EXPECT_EQ(r.q_cmd, sent.q_cmd);
  EXPECT_EQ(r.X_WT_cmd.R, sent.X_WT_cmd.R);
  EXPECT_EQ(Vector3(r.X_WT_cmd.p), Vector3(sent.X_WT_cmd.p));
  EXPECT_EQ(r.X_WT_meas.R, sent.X_WT_meas.R);
  EXPECT_EQ(Vector3(r.X_WT_meas.p), Vector3(sent.X_WT_meas.p));
  EXPECT_EQ(Vector3(r.v_WT_cmd_m_per_s), Vector3(sent.v_WT_cmd_m_per_s));
  EXPECT_EQ(Vector3(r.F_operator_T_W.f), Vector3(sent.F_operator_T_W.f));
  EXPECT_EQ(Vector3(r.F_operator_T_W.t), Vector3(sent.F_operator_T_W.t));
  EXPECT_EQ(Vector3(r.F_coupling_T_W.f), Vector3(sent.F_coupling_T_W.f));
  EXPECT_EQ(Vector3(r.F_coupling_T_W.t), Vector3(sent.F_coupling_T_W.t));
  EXPECT_EQ(r.wrench_scale, sent.wrench_scale);
  EXPECT_EQ(r.arm_share, sent.arm_share);
  EXPECT_EQ(r.tool_in_bone_m, sent.tool_in_bone_m);
  EXPECT_EQ(r.wrench_step_N, sent.wrench_step_N);
  EXPECT_EQ(r.wrench_step_limit_N, sent.wrench_step_limit_N);
  EXPECT_EQ(r.vibration_index, sent.vibration_index);
  EXPECT_EQ(r.vibration_reference_N, sent.vibration_reference_N);
  EXPECT_EQ(r.mass_factor, sent.mass_factor);
  EXPECT_EQ(r.damping_factor, sent.damping_factor);
  EXPECT_EQ(r.age_damping_factor, sent.age_damping_factor);
  EXPECT_EQ(r.age_wrench_share, sent.age_wrench_share);
  EXPECT_EQ(r.passivity_energy_J, sent.passivity_energy_J);
  EXPECT_EQ(r.passivity_damping_Ns_per_m, sent.passivity_damping_Ns_per_m);
  EXPECT_EQ(r.tank_J, sent.tank_J);
  EXPECT_EQ(r.tank_share, sent.tank_share);
  EXPECT_EQ(r.guidance.present, sent.guidance.present);
  EXPECT_EQ(Vector3(r.guidance.F_T_W.f), Vector3(sent.guidance.F_T_W.f));
  EXPECT_EQ(Vector3(r.guidance.F_T_W.t), Vector3(sent.guidance.F_T_W.t));
  EXPECT_EQ(r.guidance.share, sent.guidance.share);
  EXPECT_EQ(r.guidance.potential_J, sent.guidance.potential_J);
  EXPECT_EQ(r.guidance.energy_J, sent.guidance.energy_J);
  EXPECT_EQ(r.guidance.cone_rad, sent.guidance.cone_rad);
  EXPECT_EQ(r.guidance.lateral_m, sent.guidance.lateral_m);
  EXPECT_EQ(r.guidance.depth_m, sent.guidance.depth_m);
  EXPECT_EQ(r.guidance.stops_spindle, sent.guidance.stops_spindle);
  EXPECT_EQ(r.compliance.present, sent.compliance.present);
  EXPECT_EQ(Pose(r.compliance.X_ME).matrix(), Pose(sent.compliance.X_ME).matrix());
  EXPECT_EQ(Pose(r.compliance.X_WM).matrix(), Pose(sent.compliance.X_WM).matrix());
  EXPECT_EQ(Vector3(r.compliance.bend_m), Vector3(sent.compliance.bend_m));
  EXPECT_EQ(Vector3(r.compliance.bend_rad), Vector3(sent.compliance.bend_rad));
  EXPECT_EQ(Vector3(r.compliance.layer_m), Vector3(sent.compliance.layer_m));
  EXPECT_EQ(Vector3(r.compliance.mount_m), Vector3(sent.compliance.mount_m));
  EXPECT_EQ(Vector3(r.compliance.mount_rad), Vector3(sent.compliance.mount_rad));
  EXPECT_EQ(Vector3(r.compliance.mount_m_per_s), Vector3(sent.compliance.mount_m_per_s));
  EXPECT_EQ(Vector3(r.compliance.mount_rad_per_s), Vector3(sent.compliance.mount_rad_per_s));
  EXPECT_EQ(r.limits, sent.limits);
  EXPECT_EQ(r.cell_state, sent.cell_state);
  EXPECT_EQ(r.permits, sent.permits);
  EXPECT_EQ(Vector3(r.F_bias_S.f), Vector3(sent.F_bias_S.f));
  EXPECT_EQ(Vector3(r.F_bias_S.t), Vector3(sent.F_bias_S.t));
  EXPECT_EQ(r.model_age_s, sent.model_age_s);
  EXPECT_EQ(r.sensor_age_s, sent.sensor_age_s);
  EXPECT_EQ(r.model_frame, sent.model_frame);
  EXPECT_EQ(r.spindle_rad_per_s, sent.spindle_rad_per_s);
  EXPECT_EQ(r.tool_speed_meas_m_per_s, sent.tool_speed_meas_m_per_s);
  EXPECT_EQ(r.wakeup_ns, sent.wakeup_ns);
  EXPECT_EQ(r.compute_ns, sent.compute_ns);
  EXPECT_EQ(r.activation_cmd, sent.activation_cmd);
  EXPECT_EQ(Vector3(r.F_cmd_T.f), Vector3(sent.F_cmd_T.f));
  EXPECT_EQ(Vector3(r.F_cmd_T.t), Vector3(sent.F_cmd_T.t));
  EXPECT_EQ(r.tau_cmd, sent.tau_cmd);
}

TEST(RecordingFields, CarriesEveryInputOfATick) {
  for (const std::uint64_t i : {7u, 8u}) {  // odd and even: some fields depend on that
    const control::TickInput sent = SomeTick(i).input;
    control::TickRecord record;
    ASSERT_EQ(Decode(Encoded(SomeTick(i)), record), "");
    const control::TickInput& r = record.input;
    EXPECT_EQ(r.now, sent.now);
    EXPECT_EQ(r.arm_stamp, sent.arm_stamp);
    EXPECT_EQ(r.sequence, sent.sequence);
    EXPECT_EQ(r.lost, sent.lost);
    EXPECT_EQ(r.duplicate, sent.duplicate);
    EXPECT_EQ(r.late, sent.late);
    EXPECT_EQ(r.rejected, sent.rejected);
    EXPECT_EQ(r.received, sent.received);
    EXPECT_EQ(r.activation, sent.activation);
    EXPECT_EQ(r.reordered, sent.reordered);
    EXPECT_EQ(r.other_version, sent.other_version);
    EXPECT_EQ(r.answers_lost, sent.answers_lost);
    EXPECT_EQ(r.answers_foreign, sent.answers_foreign);
    EXPECT_EQ(r.operation_mode, sent.operation_mode);
    EXPECT_EQ(r.control_mode, sent.control_mode);
    EXPECT_EQ(r.command_mode, sent.command_mode);
    EXPECT_EQ(r.drives_active, sent.drives_active);
    EXPECT_EQ(r.holding, sent.holding);
    EXPECT_EQ(r.quality, sent.quality);
    EXPECT_EQ(r.safety_state, sent.safety_state);
    EXPECT_EQ(r.has_ipo, sent.has_ipo);
    EXPECT_EQ(r.stop, sent.stop);
    EXPECT_EQ(r.recover, sent.recover);
    EXPECT_EQ(r.pause, sent.pause);
    EXPECT_EQ(r.recorder_stalled, sent.recorder_stalled);
    EXPECT_EQ(r.tool_index, sent.tool_index);
    EXPECT_EQ(r.resume, sent.resume);
    EXPECT_EQ(r.model_status, sent.model_status);
    EXPECT_EQ(r.period_s, sent.period_s);
    EXPECT_EQ(r.q_ipo, sent.q_ipo);
    EXPECT_EQ(r.tau_ext, sent.tau_ext);
    EXPECT_EQ(r.sensor_stamp, sent.sensor_stamp);
    EXPECT_EQ(Vector3(r.F_sensor_S.f), Vector3(sent.F_sensor_S.f));
    EXPECT_EQ(Vector3(r.F_sensor_S.t), Vector3(sent.F_sensor_S.t));
    EXPECT_EQ(r.sensor_trusted, sent.sensor_trusted);
    EXPECT_EQ(r.spindle_stamp, sent.spindle_stamp);
    EXPECT_EQ(r.spindle_meas_rad_per_s, sent.spindle_meas_rad_per_s);
    EXPECT_EQ(r.spindle_torque_Nm, sent.spindle_torque_Nm);
    EXPECT_EQ(r.spindle_ready, sent.spindle_ready);
    EXPECT_EQ(r.spindle_fault, sent.spindle_fault);
    EXPECT_EQ(r.drive_faults, sent.drive_faults);
    EXPECT_EQ(r.drive_nmt_state, sent.drive_nmt_state);
    EXPECT_EQ(r.drive_emergency_code, sent.drive_emergency_code);
    EXPECT_EQ(r.drive_error_code, sent.drive_error_code);
    EXPECT_EQ(r.interlock_stamp, sent.interlock_stamp);
    EXPECT_EQ(r.permitted, sent.permitted);
    EXPECT_EQ(r.enabled, sent.enabled);
    EXPECT_EQ(r.spindle_permitted, sent.spindle_permitted);
    EXPECT_EQ(r.interlock_reason, sent.interlock_reason);
    EXPECT_EQ(r.has_guidance_gain, sent.has_guidance_gain);
    EXPECT_EQ(r.guidance_gain, sent.guidance_gain);
    EXPECT_EQ(r.has_gains, sent.has_gains);
    std::vector<double> gains;
    control::VisitGains(sent.gains, [&](auto, auto, auto, double value) { gains.push_back(value); });
    std::size_t gain = 0;
    control::VisitGains(r.gains, [&](const char* name, auto, auto, double value) {
      EXPECT_EQ(value, gains[gain++]) << name;
    });
    EXPECT_EQ(r.model_pose_stamp, sent.model_pose_stamp);
  }
}

TEST(RecordingFields, CarriesAContactCountOutOfRange) {
  for (const int count : {-1, 9}) {
    simulation::FrameRecord sent = SomeFrame(1), r;
    sent.model.contact_count = count;
    ASSERT_EQ(Decode(Encoded(sent), r), "");
    EXPECT_EQ(r.model.contact_count, count) << "the loop refused it, and must again";
  }
}

// The contact count (field 20) is appended to a frame of three contacts, with a different number. In
// protobuf, the last occurrence of a field is the valid one.
TEST(RecordingFields, RefusesAContactCountThatDiffersFromTheContacts) {
  for (const unsigned char count : {'\x02', '\x08', '\x14', '\x01'}) {  // sint32: 1, 4, 10, -1
    simulation::FrameRecord r;
    const std::string wrong = Decode(Encoded(SomeFrame(3)) + "\xa0\x01" + static_cast<char>(count), r);
    EXPECT_NE(wrong.find("beside 3 contacts"), std::string::npos) << wrong;
  }
}

TEST(RecordingFields, CarriesEveryFieldOfAFrame) {
  const simulation::FrameRecord sent = SomeFrame(8);
  simulation::FrameRecord r;
  ASSERT_EQ(Decode(Encoded(sent), r), "");
  const simulation::ContactModel &a = r.model, &b = sent.model;
  EXPECT_EQ(r.stamp, sent.stamp);
  EXPECT_EQ(r.duration_ns, sent.duration_ns);
  EXPECT_EQ(r.cup_depth_m, sent.cup_depth_m);
  EXPECT_EQ(a.X_WP.R, b.X_WP.R);
  EXPECT_EQ(Vector3(a.X_WP.p), Vector3(b.X_WP.p));
  ASSERT_EQ(a.contact_count, simulation::kMaxContacts);
  for (std::size_t k = 0; k < simulation::kMaxContacts; ++k) {
    const simulation::Contact &c = a.contacts[k], &d = b.contacts[k];
    EXPECT_EQ(Vector3(c.p_TP_m), Vector3(d.p_TP_m));
    EXPECT_EQ(Vector3(c.p_W_m), Vector3(d.p_W_m));
    EXPECT_EQ(Vector3(c.n_W), Vector3(d.n_W));
    EXPECT_EQ(c.gap_m, d.gap_m);
    EXPECT_EQ(c.stiffness_N_per_m, d.stiffness_N_per_m);
    EXPECT_EQ(c.mu, d.mu);
    EXPECT_EQ(c.advance_m_per_s, d.advance_m_per_s);
    EXPECT_EQ(c.weight, d.weight);
    EXPECT_EQ(c.material, d.material);
  }
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(Vector3(a.n_W), Vector3(b.n_W));
  EXPECT_EQ(a.contact_fraction, b.contact_fraction);
  EXPECT_EQ(Vector3(a.p_WS_m), Vector3(b.p_WS_m));
  EXPECT_EQ(Vector3(a.F_T_W.f), Vector3(b.F_T_W.f));
  EXPECT_EQ(Vector3(a.F_T_W.t), Vector3(b.F_T_W.t));
  EXPECT_EQ(a.advance_m_per_s, b.advance_m_per_s);
  EXPECT_EQ(a.engaged_area_m2, b.engaged_area_m2);
  EXPECT_EQ(a.spindle_torque_Nm, b.spindle_torque_Nm);
  EXPECT_EQ(a.removed_volume_m3, b.removed_volume_m3);
  EXPECT_EQ(a.removed_mass_kg, b.removed_mass_kg);
  EXPECT_EQ(a.cutting_work_J, b.cutting_work_J);
  EXPECT_EQ(a.balls_not_split, b.balls_not_split);
  EXPECT_EQ(a.pose_stamp, b.pose_stamp);
  EXPECT_EQ(a.frame, b.frame);
}

TEST(RecordingFields, CarriesEveryStatusOfAFrame) {
  for (const simulation::EngineStatus status :
       {simulation::EngineStatus::kOk, simulation::EngineStatus::kBadInput,
        simulation::EngineStatus::kDeviceLost, simulation::EngineStatus::kOverloaded}) {
    simulation::FrameRecord sent = SomeFrame(1), r;
    sent.model.status = status;
    EXPECT_EQ(Decode(Encoded(sent), r), "");
    EXPECT_EQ(r.model.status, status);
  }
}

TEST(RecordingFields, KeepsNegativeZeroAndNaN) {
  control::TickRecord sent = SomeTick(1), r;
  sent.wrench_scale = -0.0;
  sent.model_age_s = std::numeric_limits<double>::quiet_NaN();
  sent.q_cmd[3] = std::numeric_limits<double>::infinity();
  ASSERT_EQ(Decode(Encoded(sent), r), "");
  EXPECT_TRUE(std::signbit(r.wrench_scale));
  EXPECT_TRUE(std::isnan(r.model_age_s));
  EXPECT_EQ(r.q_cmd[3], sent.q_cmd[3]);
}

// Recordings of older versions lack later fields. Fields are written in order: 20, the arm's share (a tag of
// two bytes and a double), then 21, the inputs. So the test cuts the bytes off after field 20, and before
// field 20.
TEST(RecordingFields, ATickWithoutTheArmsShareOrTheInputsReadsAsDefaults) {
  const std::string now = Encoded(SomeTick(2));
  const std::size_t share = now.rfind("\xA1\x01");
  ASSERT_NE(share, std::string::npos);
  ASSERT_EQ(now.substr(share + 10, 2), "\xAA\x01");
  control::TickRecord r;
  ASSERT_EQ(Decode(now.substr(0, share + 10), r), "");
  EXPECT_EQ(r.arm_share, SomeTick(2).arm_share);
  EXPECT_EQ(r.input.now, 0) << "no inputs";
  ASSERT_EQ(Decode(now.substr(0, share), r), "");
  EXPECT_EQ(r.arm_share, 1.0);
  EXPECT_EQ(r.mass_factor, 1.0);
  EXPECT_EQ(r.damping_factor, 1.0);
  EXPECT_EQ(r.age_damping_factor, 1.0);
  EXPECT_EQ(r.age_wrench_share, 1.0);
  EXPECT_EQ(r.tank_share, 1.0);
  EXPECT_EQ(r.compute_ns, SomeTick(2).compute_ns);
}

// libprotobuf writes a string that is not UTF-8, but then fails to read the whole message. A comment in
// Latin-1 in a cell's file is enough. Found by the fuzz target recording_message.
TEST(RecordingFields, TextThatIsNotUtf8CanBeRead) {
  SessionInfo session = test::SomeSession();
  session.config_text = "# \xb5m, K\xf6nig\nradius_mm: 3\n";
  session.config.files = {{.name = "cells/K\xf6nig.yaml", .content = session.config_text}};
  session.config.cell_file = session.config.files[0].name;
  session.limits = {"\xff"};
  std::string bytes;
  Encode(session, bytes);
  SessionInfo read;
  ASSERT_EQ(Decode(bytes, read), "");
  EXPECT_EQ(read.config_text, "# \xef\xbf\xbdm, K\xef\xbf\xbdnig\nradius_mm: 3\n");
  ASSERT_EQ(read.config.files.size(), 1u);
  EXPECT_EQ(read.config.files[0].content, session.config_text) << "a file's content is kept byte by byte";
  EXPECT_EQ(read.config.files[0].name, read.config.cell_file);

  Encode(RecordedEvent{.stamp = 1, .text = "no such file: \xe4"}, bytes);
  RecordedEvent event;
  ASSERT_EQ(Decode(bytes, event), "");
  EXPECT_EQ(event.text, "no such file: \xef\xbf\xbd");
}

}  // namespace
}  // namespace osteon::io
