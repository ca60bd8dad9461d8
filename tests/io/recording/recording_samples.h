#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "io/recording/mcap_reader.h"
#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "io/recording/recorder.h"

// Records in which nearly all fields differ in value, so that a swapped or forgotten field shows.

namespace osteon::io::test {

/// Values in steps of 0.25 from `first`.
inline PlainVector3 Vector(double first) { return Vector3(first, first + 0.25, first + 0.5); }

/// Twelve different numbers from `first` on; no rotation.
inline PlainPose SomePose(double first) {
  PlainPose X;
  for (std::size_t i = 0; i < 9; ++i) X.R[i] = first + static_cast<double>(i) / 16;
  X.p = Vector(first + 2);
  return X;
}

inline PlainWrench SomeWrench(double first) { return Wrench{.f = Vector(first), .t = Vector(first + 1)}; }

/// The record of tick `i`, at i milliseconds; its values depend on i.
inline control::TickRecord SomeTick(std::uint64_t i) {
  control::TickRecord r;
  const auto base = static_cast<double>(i);
  r.tick = i;
  r.stamp = static_cast<rt::Nanoseconds>(i) * rt::kMillisecond;
  r.phase = static_cast<control::Phase>(i % 4);
  r.session_state = static_cast<std::uint8_t>(i % 5);
  r.faults = static_cast<std::uint32_t>(1u << (i % 13));
  for (std::size_t j = 0; j < 7; ++j) {
    r.q_meas[j] = base + 0.01 * static_cast<double>(j);
    r.q_cmd[j] = base - 0.01 * static_cast<double>(j);
  }
  r.X_WT_cmd = SomePose(base + 10);
  r.X_WT_meas = SomePose(base + 20);
  r.v_WT_cmd_m_per_s = Vector(base + 30);
  r.F_operator_T_W = SomeWrench(base + 40);
  r.F_coupling_T_W = SomeWrench(base + 50);
  r.wrench_scale = 0.1;
  r.arm_share = 0.8;
  r.tool_in_bone_m = 0.0042;
  r.wrench_step_N = 17.25;
  r.wrench_step_limit_N = 13.5;
  r.vibration_index = 0.3;
  r.vibration_reference_N = 0.45;
  r.mass_factor = 1.2;
  r.damping_factor = 30.0;
  r.age_damping_factor = 3.0;
  r.age_wrench_share = 0.7;
  r.passivity_energy_J = 0.125;
  r.passivity_damping_Ns_per_m = 250.0;
  r.tank_J = 0.875;
  r.tank_share = 0.625;
  if (i % 2 == 1)
    r.guidance = {.present = true,
                  .F_T_W = SomeWrench(base + 95),
                  .share = 0.55,
                  .potential_J = 0.01,
                  .energy_J = -0.02,
                  .cone_rad = -0.03,
                  .lateral_m = 0.004,
                  .depth_m = -0.005,
                  .stops_spindle = i % 4 == 1};
  if (i % 2 == 0)
    r.compliance = {.present = true,
                    .X_ME = SomePose(base + 101),
                    .X_WM = SomePose(base + 102),
                    .bend_m = Vector(base + 103),
                    .bend_rad = Vector(base + 104),
                    .layer_m = Vector(base + 105),
                    .mount_m = Vector(base + 106),
                    .mount_rad = Vector(base + 107),
                    .mount_m_per_s = Vector(base + 108),
                    .mount_rad_per_s = Vector(base + 109)};
  r.limits = 0x4201;
  r.cell_state = static_cast<std::uint8_t>(i % 12);
  r.permits = 0x155;
  r.F_bias_S = SomeWrench(base + 90);
  r.model_age_s = base + 60;
  r.sensor_age_s = base + 61;
  r.model_frame = i + 62;
  r.spindle_rad_per_s = base + 63;
  r.tool_speed_meas_m_per_s = base + 64;
  r.wakeup_ns = static_cast<rt::Nanoseconds>(i) + 64;
  r.compute_ns = static_cast<rt::Nanoseconds>(i) + 65;
  r.activation_cmd = static_cast<std::uint32_t>(i) + 82;
  r.F_cmd_T = SomeWrench(base + 97);
  r.tau_cmd.fill(base + 91);
  control::TickInput& in = r.input;
  const auto number = static_cast<std::uint32_t>(i);
  in.now = r.stamp + 66;
  in.arm_stamp = r.stamp + 67;
  in.sequence = number + 68;
  in.lost = number + 69;
  in.duplicate = number + 70;
  in.late = number + 71;
  in.rejected = number + 72;
  in.activation = number + 77;
  in.reordered = number + 78;
  in.other_version = number + 79;
  in.answers_lost = number + 80;
  in.answers_foreign = number + 81;
  in.operation_mode = static_cast<std::uint8_t>(i % 3);
  in.control_mode = static_cast<std::uint8_t>((i + 3) % 4);
  in.command_mode = static_cast<std::uint8_t>(i % 5);
  in.drives_active = i % 2 == 1;
  in.holding = i % 2 == 0;
  in.received = static_cast<std::uint8_t>(i % 3);
  in.quality = static_cast<std::uint8_t>(i % 4);
  in.safety_state = static_cast<std::uint8_t>((i + 1) % 4);
  in.has_ipo = i % 2 == 1;
  in.stop = i % 3 == 1;
  in.recover = i % 4 == 1;
  in.pause = i % 4 == 2;
  in.recorder_stalled = i % 4 == 3;
  in.tool_index = static_cast<std::uint8_t>(i % 5);
  in.resume = i % 4 == 3;
  in.model_status = static_cast<std::uint8_t>((i + 2) % 4);
  in.period_s = base + 73;
  for (std::size_t j = 0; j < 7; ++j) {
    if (in.has_ipo) in.q_ipo[j] = base + 0.02 * static_cast<double>(j);
    in.tau_ext[j] = base - 0.02 * static_cast<double>(j);
  }
  in.sensor_stamp = r.stamp + 74;
  in.F_sensor_S = SomeWrench(base + 75);
  in.sensor_trusted = i % 2 == 0;
  in.spindle_stamp = r.stamp + 82;
  in.spindle_meas_rad_per_s = base + 83;
  in.spindle_torque_Nm = base + 84;
  in.spindle_ready = i % 2 == 1;
  in.spindle_fault = i % 3 == 1;
  in.drive_faults = static_cast<std::uint8_t>(i + 1);
  in.drive_nmt_state = static_cast<std::uint8_t>(i + 2);
  in.drive_emergency_code = static_cast<std::uint16_t>(i + 0x4310);
  in.drive_error_code = static_cast<std::uint16_t>(i + 0x7121);
  in.interlock_stamp = r.stamp + 85;
  in.permitted = i % 2 == 0;
  in.enabled = i % 3 == 0;
  in.spindle_permitted = i % 3 == 2;
  in.interlock_reason = static_cast<std::uint8_t>(i % 7);
  in.model_pose_stamp = r.stamp + 76;
  in.has_guidance_gain = i % 3 == 1;
  if (in.has_guidance_gain) in.guidance_gain = 0.375;
  in.has_gains = i % 2 == 1;
  if (in.has_gains)
    in.gains = {.mass_kg = Vector(base + 1),
                .inertia_kg_m2 = Vector(base + 2),
                .damping_Ns_per_m = Vector(base + 3),
                .damping_Nms_per_rad = Vector(base + 4),
                .dead_zone_N = base + 5,
                .dead_zone_Nm = base + 6,
                .max_stiffness_N_per_m = base + 7,
                .coupling_damping_Ns_per_m = base + 8,
                .damping_share = 0.2};
  return r;
}

/// The record of simulation frame `i`, at 2 i milliseconds, with i modulo 9 contacts.
inline simulation::FrameRecord SomeFrame(std::uint64_t i) {
  simulation::FrameRecord r;
  const auto base = static_cast<double>(i);
  r.stamp = static_cast<rt::Nanoseconds>(i) * 2 * rt::kMillisecond + 1;
  r.duration_ns = 71;
  r.cup_depth_m = base + 72;
  simulation::ContactModel& m = r.model;
  m.X_WP = SomePose(base);
  m.contact_count = static_cast<std::int32_t>(i % (simulation::kMaxContacts + 1));
  for (int k = 0; k < m.contact_count; ++k) {
    simulation::Contact& c = m.contacts[static_cast<std::size_t>(k)];
    const double c_base = base + 100 * (k + 1);
    c.p_TP_m = Vector(c_base);
    c.p_W_m = Vector(c_base + 1);
    c.n_W = Vector(c_base + 2);
    c.gap_m = -c_base;
    c.stiffness_N_per_m = c_base + 3;
    c.mu = c_base + 4;
    c.advance_m_per_s = c_base + 5;
    c.weight = c_base + 6;
    c.material = static_cast<simulation::MaterialIndex>(k + 7);
  }
  m.status = static_cast<simulation::EngineStatus>(i % 4);
  m.n_W = Vector(base + 3);
  m.contact_fraction = base + 4;
  m.p_WS_m = Vector(base + 13);
  m.F_T_W = SomeWrench(base + 5);
  m.advance_m_per_s = base + 6;
  m.engaged_area_m2 = base + 7;
  m.spindle_torque_Nm = base + 8;
  m.removed_volume_m3 = base + 9;
  m.removed_mass_kg = base + 10;
  m.cutting_work_J = base + 11;
  m.balls_not_split = i + 14;
  m.pose_stamp = static_cast<rt::Nanoseconds>(i) + 12;
  m.frame = i;
  return r;
}

inline SessionInfo SomeSession() {
  return {.stamp = 3,
          .version = "0.1.0",
          .engine = "vulkan",
          .device = "llvmpipe",
          .scene = "cup",
          .tool = "reamer_50",
          .force_limit_N = 200.0,
          .limits = {"force 200 N (cell)", "tool speed 250 mm/s (cell)"},
          .config_text = "force_limit_N: 200\n",
          .config = {.files = {{.name = "cells/demo.yaml", .content = "tool: ../tools/a.yaml\n"},
                               {.name = "tools/a.png", .content = std::string("\x89PNG\0\xff", 6)}},
                     .cell_file = "cells/demo.yaml",
                     .tool_file = "tools/b.yaml",
                     .tool_diameter_m = 0.05,
                     .gains_file = "gains.yaml",
                     .identified_file = "identified.yaml",
                     .folder = "/somewhere"},
          .utc = 4,
          .build = "commit 123",
          .machine = "a processor"};
}

/// A record's bytes. Records with equal bytes have equal fields.
template <class Record>
std::string Encoded(const Record& record) {
  std::string bytes;
  Encode(record, bytes);
  return bytes;
}

/// Copies a complete recording into uncompressed chunks of 64 KiB, for tests that change a message's bytes in
/// the file.
inline void WriteUncompressed(const std::filesystem::path& from, const std::filesystem::path& to) {
  auto reader = McapReader::Open(from);
  auto writer =
      McapWriter::Create(to, reader.value().library(), {.chunk_bytes = 64u << 10, .compress = false});
  std::map<std::uint16_t, std::uint16_t> channels;
  McapMessage message;
  while (reader->Next(message).value()) {
    const McapChannel& channel = *message.channel;
    if (!channels.contains(channel.id))
      channels[channel.id] = writer.value().AddChannel(channel.topic, channel.schema_name, channel.schema);
    writer->Write(channels[channel.id], static_cast<std::int64_t>(message.log_time_ns),
                  {message.bytes.data(), message.bytes.size()});
    if (channel.topic == "session") writer->EndChunk();
  }
  if (!writer->Finish()) throw std::runtime_error("cannot write " + to.string());
}

}  // namespace osteon::io::test
