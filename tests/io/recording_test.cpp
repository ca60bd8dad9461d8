#include "io/recording/recording_reader.h"

#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "control/rt/no_alloc_scope.h"
#include "tests/io/recording_samples.h"
#include "tests/io/temporary_folder.h"

namespace osteon::io {
namespace {

using test::ReadAll;
using test::SomeFrame;
using test::SomeSession;
using test::SomeTick;
using test::TemporaryFolder;
using test::WriteAll;

// Compares every byte of a plain record, field by field through its own encoding: equal bytes, equal fields.
template <class Record>
std::string Encoded(const Record& record) {
  std::string bytes;
  Encode(record, bytes);
  return bytes;
}

// 400 ms in virtual time, drained every tick; long enough for several chunks.
constexpr std::uint64_t kTicks = 400;

std::string RecordVirtualTime(const std::filesystem::path& path) {
  auto recorder = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
  EXPECT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    if (i % 2 == 0) {
      EXPECT_TRUE((*recorder)->PushFrame(SomeFrame(i / 2)));
    }
    EXPECT_TRUE((*recorder)->Push(SomeTick(i)));
    if (i == 250) (*recorder)->PushEvent(SomeTick(i).stamp, "contact model stale");
    (*recorder)->Drain();
  }
  const auto counts = (*recorder)->Close();
  EXPECT_TRUE(counts) << counts.error();
  EXPECT_EQ(counts->ticks, kTicks);
  EXPECT_EQ(counts->frames, kTicks / 2);
  EXPECT_EQ(counts->events, 1u);
  EXPECT_EQ(counts->bytes, std::filesystem::file_size(path));
  return ReadAll(path);
}

TEST(Recording, ComesBackBitForBit) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "session.mcap";
  RecordVirtualTime(path);
  const auto recording = ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_TRUE(recording->complete);
  EXPECT_EQ(recording->read_bytes, std::filesystem::file_size(path));
  EXPECT_EQ(recording->session.stamp, 3);
  EXPECT_EQ(recording->session.version, "0.1.0");
  EXPECT_EQ(recording->session.engine, "vulkan");
  EXPECT_EQ(recording->session.device, "llvmpipe");
  EXPECT_EQ(recording->session.scene, "cup");
  EXPECT_EQ(recording->session.tool, "reamer_50");
  EXPECT_EQ(recording->session.force_limit_N, 200.0);
  EXPECT_EQ(recording->session.limits.size(), 2u);
  EXPECT_EQ(recording->session.limits.back(), "tool speed 250 mm/s (cell)");
  EXPECT_EQ(recording->session.config_text, "force_limit_N: 200\n");
  const ConfigSource &config = recording->session.config, sent = SomeSession().config;
  ASSERT_EQ(config.files.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(config.files[i].name, sent.files[i].name);
    EXPECT_EQ(config.files[i].content, sent.files[i].content);
  }
  EXPECT_EQ(config.cell_file, "cells/demo.yaml");
  EXPECT_EQ(config.tool_file, "tools/b.yaml");
  EXPECT_EQ(config.tool_diameter_m, 0.05);
  EXPECT_EQ(config.gains_file, "gains.yaml");
  EXPECT_EQ(config.folder, "/somewhere");
  EXPECT_EQ(recording->session.utc, 4);
  EXPECT_EQ(recording->session.build, "commit 123");
  EXPECT_EQ(recording->session.machine, "a processor");
  ASSERT_EQ(recording->ticks.size(), kTicks);
  ASSERT_EQ(recording->frames.size(), kTicks / 2);
  ASSERT_EQ(recording->events.size(), 1u);
  for (std::uint64_t i = 0; i < kTicks; ++i) EXPECT_EQ(Encoded(recording->ticks[i]), Encoded(SomeTick(i)));
  for (std::uint64_t i = 0; i < kTicks / 2; ++i)
    EXPECT_EQ(Encoded(recording->frames[i]), Encoded(SomeFrame(i)));
  EXPECT_EQ(recording->events[0].stamp, SomeTick(250).stamp);
  EXPECT_EQ(recording->events[0].text, "contact model stale");
}

// Encoded() of the test above cannot see a field that the encoder forgets, so each is read back by hand as
// well.
TEST(Recording, CarriesEveryFieldOfATick) {
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
  EXPECT_EQ(r.limits, sent.limits);
  EXPECT_EQ(r.cell_state, sent.cell_state);
  EXPECT_EQ(r.permits, sent.permits);
  EXPECT_EQ(Vector3(r.F_bias_S.f), Vector3(sent.F_bias_S.f));
  EXPECT_EQ(Vector3(r.F_bias_S.t), Vector3(sent.F_bias_S.t));
  EXPECT_EQ(r.model_age_s, sent.model_age_s);
  EXPECT_EQ(r.sensor_age_s, sent.sensor_age_s);
  EXPECT_EQ(r.model_frame, sent.model_frame);
  EXPECT_EQ(r.spindle_rad_per_s, sent.spindle_rad_per_s);
  EXPECT_EQ(r.wakeup_ns, sent.wakeup_ns);
  EXPECT_EQ(r.compute_ns, sent.compute_ns);
  EXPECT_EQ(r.activation_cmd, sent.activation_cmd);
  EXPECT_EQ(Vector3(r.F_cmd_T.f), Vector3(sent.F_cmd_T.f));
  EXPECT_EQ(Vector3(r.F_cmd_T.t), Vector3(sent.F_cmd_T.t));
  EXPECT_EQ(r.tau_cmd, sent.tau_cmd);
}

TEST(Recording, CarriesEveryInputOfATick) {
  for (const std::uint64_t i : {7u, 8u}) {
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
    EXPECT_EQ(r.interlock_stamp, sent.interlock_stamp);
    EXPECT_EQ(r.permitted, sent.permitted);
    EXPECT_EQ(r.enabled, sent.enabled);
    EXPECT_EQ(r.spindle_permitted, sent.spindle_permitted);
    EXPECT_EQ(r.interlock_reason, sent.interlock_reason);
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

TEST(Recording, CarriesAContactCountThatIsNoCount) {
  for (const int count : {-1, 9}) {
    simulation::FrameRecord sent = SomeFrame(1), r;
    sent.model.contact_count = count;
    ASSERT_EQ(Decode(Encoded(sent), r), "");
    EXPECT_EQ(r.model.contact_count, count) << "the loop refused it, and must again";
  }
}

TEST(Recording, CarriesEveryFieldOfAFrame) {
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

TEST(Recording, CarriesEveryStatusOfAFrame) {
  for (const simulation::EngineStatus status :
       {simulation::EngineStatus::kOk, simulation::EngineStatus::kBadInput,
        simulation::EngineStatus::kDeviceLost, simulation::EngineStatus::kOverloaded}) {
    simulation::FrameRecord sent = SomeFrame(1), r;
    sent.model.status = status;
    EXPECT_EQ(Decode(Encoded(sent), r), "");
    EXPECT_EQ(r.model.status, status);
  }
}

TEST(Recording, KeepsNegativeZeroAndNaN) {
  control::TickRecord sent = SomeTick(1), r;
  sent.wrench_scale = -0.0;
  sent.model_age_s = std::numeric_limits<double>::quiet_NaN();
  sent.q_cmd[3] = std::numeric_limits<double>::infinity();
  ASSERT_EQ(Decode(Encoded(sent), r), "");
  EXPECT_TRUE(std::signbit(r.wrench_scale));
  EXPECT_TRUE(std::isnan(r.model_age_s));
  EXPECT_EQ(r.q_cmd[3], sent.q_cmd[3]);
}

// Fields are written in their order: 20, its tag in two bytes and the double, before 21, the inputs.
TEST(Recording, ATickFromBeforeTheArmsShareAndTheInputsWereRecordedReadsAsNone) {
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

TEST(Recording, TwoEqualRunsGiveEqualBytes) {
  const TemporaryFolder folder;
  const std::string first = RecordVirtualTime(folder.path() / "first.mcap");
  const std::string second = RecordVirtualTime(folder.path() / "second.mcap");
  ASSERT_GT(first.size(), 10'000u);
  EXPECT_TRUE(first == second);
}

TEST(Recording, DrainMergesByStampAndTicksGoFirst) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "merged.mcap";
  auto recorder = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  // Message times in the file's order: read from the raw records, as the reader keeps the lists apart.
  simulation::FrameRecord frame = SomeFrame(0);
  for (const rt::Nanoseconds stamp : {20, 40}) {
    frame.stamp = stamp;
    (*recorder)->PushFrame(frame);
  }
  (*recorder)->PushEvent(20, "e");
  control::TickRecord tick = SomeTick(0);
  for (const rt::Nanoseconds stamp : {10, 20, 30}) {
    tick.stamp = stamp;
    (*recorder)->Push(tick);
  }
  ASSERT_TRUE((*recorder)->Close());

  const std::string bytes = ReadAll(path);
  std::vector<std::pair<int, std::uint64_t>> order;  // channel, log time
  for (std::size_t at = 8; at + 9 <= bytes.size();) {
    std::uint64_t length = 0, time = 0;
    std::memcpy(&length, bytes.data() + at + 1, 8);
    if (bytes[at] == 6) {  // into the chunk: its times, size, CRC, empty compression, length
      at += 9 + 8 + 8 + 8 + 4 + 4 + 8;
      continue;
    }
    if (bytes[at] == 5) {
      std::memcpy(&time, bytes.data() + at + 9 + 6, 8);
      order.emplace_back(bytes[at + 9], time);
    }
    at += 9 + length;
  }
  const std::vector<std::pair<int, std::uint64_t>> expected{{0, 3},  {1, 10}, {1, 20}, {2, 20},
                                                            {3, 20}, {1, 30}, {2, 40}};
  EXPECT_EQ(order, expected);
}

TEST(Recording, WriterThreadLosesNothing) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "wall.mcap";
  auto recorder = Recorder::Open({.path = path}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  constexpr std::uint64_t kCount = 2000;
  std::thread servo([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) (*recorder)->Push(SomeTick(i));
  });
  std::thread simulation([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) (*recorder)->PushFrame(SomeFrame(i));
  });
  (*recorder)->PushEvent(1, "from the main thread");
  servo.join();
  simulation.join();
  const auto counts = (*recorder)->Close();
  ASSERT_TRUE(counts) << counts.error();
  EXPECT_EQ(counts->dropped_ticks + counts->dropped_frames, 0u);
  const auto recording = ReadRecording(path);
  ASSERT_TRUE(recording) << recording.error();
  EXPECT_TRUE(recording->complete);
  ASSERT_EQ(recording->ticks.size(), kCount);
  ASSERT_EQ(recording->frames.size(), kCount);
  for (std::uint64_t i = 0; i < kCount; ++i) ASSERT_EQ(recording->ticks[i].tick, i);
}

TEST(Recording, CountsWhatTheDiskWasTooSlowFor) {
  const TemporaryFolder folder;
  auto recorder = Recorder::Open(
      {.path = folder.path() / "full.mcap", .tick_capacity = 4, .frame_capacity = 2, .writer_thread = false},
      SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ((*recorder)->Push(SomeTick(i)), i < 4);
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ((*recorder)->PushFrame(SomeFrame(i)), i < 2);
  const auto counts = (*recorder)->Close();
  ASSERT_TRUE(counts) << counts.error();
  EXPECT_EQ(counts->ticks, 4u);
  EXPECT_EQ(counts->frames, 2u);
  EXPECT_EQ(counts->dropped_ticks, 6u);
  EXPECT_EQ(counts->dropped_frames, 3u);
  EXPECT_EQ((*recorder)->Close()->dropped_ticks, 6u) << "closing again gives the same answer";
}

// The loop hears of a writer that stands still while there is room for a stop that is recorded to its end.
TEST(Recording, IsStalledWhileTooManyTicksWaitForItsWriter) {
  const TemporaryFolder folder;
  const RecorderParams params{.path = folder.path() / "stalled.mcap", .writer_thread = false};
  auto recorder = Recorder::Open(params, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  std::uint64_t tick = 0;
  // so often that the ring has gone round
  for (int time = 0; time < 6; ++time) {
    for (std::size_t i = 0; i < params.stalled_ticks; ++i) {
      ASSERT_FALSE((*recorder)->Stalled()) << i;
      ASSERT_TRUE((*recorder)->Push(SomeTick(++tick)));
    }
    EXPECT_TRUE((*recorder)->Stalled());
    (*recorder)->Drain();
    EXPECT_FALSE((*recorder)->Stalled());
  }
  EXPECT_GE(params.tick_capacity, 4 * params.stalled_ticks) << "6 s for the stop";
  EXPECT_EQ((*recorder)->Close()->dropped_ticks, 0u);
}

TEST(Recording, PushDoesNotAllocate) {
  const TemporaryFolder folder;
  auto recorder = Recorder::Open({.path = folder.path() / "rt.mcap", .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  const control::TickRecord tick = SomeTick(1);
  const simulation::FrameRecord frame = SomeFrame(1);
  rt::NoAllocScope scope;
  const bool pushed = (*recorder)->Push(tick) && (*recorder)->PushFrame(frame);
  EXPECT_EQ(scope.heap_calls(), 0);
  EXPECT_EQ(scope.locks(), 0);
  EXPECT_TRUE(pushed);
}

TEST(Recording, AnUnwritablePathIsNamed) {
  const auto nowhere = Recorder::Open({.path = "/nowhere/at/all.mcap"}, SomeSession());
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().find("/nowhere/at/all.mcap"), std::string::npos);
  const auto full = Recorder::Open({.path = "/dev/full"}, SomeSession());
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error(), "/dev/full: cannot write the recording: No space left on device");
}

TEST(Recording, ATornFileGivesWhatCameBefore) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "torn.mcap";
  const std::string whole = RecordVirtualTime(folder.path() / "whole.mcap");
  WriteAll(path, whole.substr(0, whole.size() / 2));
  const auto half = ReadRecording(path);
  ASSERT_TRUE(half) << half.error();
  EXPECT_FALSE(half->complete);
  EXPECT_GT(half->ticks.size(), 0u);
  EXPECT_LT(half->ticks.size(), kTicks);
  EXPECT_LE(half->read_bytes, whole.size() / 2);
  for (std::uint64_t i = 0; i < half->ticks.size(); ++i) EXPECT_EQ(half->ticks[i].tick, i);

  WriteAll(path, whole.substr(0, whole.size() - 3));  // all the data, a part of the closing magic
  const auto nearly = ReadRecording(path);
  ASSERT_TRUE(nearly) << nearly.error();
  EXPECT_FALSE(nearly->complete);
  EXPECT_EQ(nearly->ticks.size(), kTicks);
}

// As another program would find the file now, were this one killed.
TEST(Recording, AProcessThatDiedLeavesWhatWasDrained) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "live.mcap";
  auto recorder = Recorder::Open({.path = path, .writer_thread = false}, SomeSession());
  ASSERT_TRUE(recorder) << recorder.error();
  auto found = ReadRecording(path);
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->session.tool, "reamer_50") << "the session is on the disk at once";

  for (std::uint64_t i = 0; i < kTicks; ++i) (*recorder)->Push(SomeTick(i));
  (*recorder)->Drain();
  found = ReadRecording(path);
  ASSERT_TRUE(found) << found.error();
  EXPECT_FALSE(found->complete);
  const std::size_t lost = kTicks - found->ticks.size();
  EXPECT_LE(lost * Encoded(SomeTick(1)).size(), McapWriter::kChunkBytes) << "no more than one chunk";

  (*recorder)->PushEvent(SomeTick(kTicks).stamp, "arm stopped");
  (*recorder)->Drain();
  found = ReadRecording(path);
  ASSERT_TRUE(found) << found.error();
  EXPECT_EQ(found->ticks.size(), kTicks) << "an event brings everything before it to the disk";
  EXPECT_EQ(found->events.size(), 1u);
}

TEST(Recording, ErrorsNameByteAndReason) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "bad.mcap";
  const std::string whole = RecordVirtualTime(folder.path() / "whole.mcap");
  const auto error_of = [&](const std::string& bytes) {
    WriteAll(path, bytes);
    const auto recording = ReadRecording(path);
    return recording ? std::string("accepted") : recording.error().substr(path.string().size());
  };
  EXPECT_EQ(error_of("PNG"), ": byte 0: not an MCAP file (its first 8 bytes are not the magic)");
  EXPECT_EQ(error_of(whole.substr(0, 8)),
            ": byte 8: no osteon.Session in it: not a recording of this program");

  std::string bad = whole;
  bad[8] = 5;  // the header's opcode
  EXPECT_EQ(error_of(bad), ": byte 8: the first record is not a header");
  bad = whole;
  bad[8 + 1 + 7] = '\x7f';  // top byte of the header's length
  EXPECT_EQ(error_of(bad).find(": byte 8: record of 9151314442816847"), 0u) << error_of(bad);

  bad = whole;  // one bit of one double: still a message, no longer what was recorded
  std::string double_bytes(sizeof(double), '\0');
  const double value = SomeTick(200).X_WT_cmd.p.x;
  std::memcpy(double_bytes.data(), &value, sizeof value);
  const std::size_t at = bad.find(double_bytes);
  ASSERT_NE(at, std::string::npos);
  bad[at] = static_cast<char>(bad[at] ^ 1);
  EXPECT_NE(error_of(bad).find("the chunk does not match its CRC"), std::string::npos) << error_of(bad);

  EXPECT_NE(ReadRecording(folder.path() / "missing.mcap").error().find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace osteon::io
