#include "io/can/reamer_drive.h"

#include <array>
#include <bitset>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "io/can/drive_fault_text.h"
#include "io/can/id_claims.h"
#include "tests/io/can/can_frames.h"

// Tests the client of the reamer's drive, with frames and states from CiA 301 and CiA 402.

namespace osteon::io {
namespace {

using test::At;
using test::Frame;
using test::Frames;
using test::kMs;
using test::Sent;

// A row of the table of states in CiA 402; x stands for any bit.
struct StateRow {
  const char* bits;  // bits 15 … 0 of the statusword
  DriveState state;
};
constexpr std::array<StateRow, 8> kStates{{
    {"xxxxxxxxx0xx0000", DriveState::kNotReady},
    {"xxxxxxxxx1xx0000", DriveState::kDisabled},
    {"xxxxxxxxx01x0001", DriveState::kReady},
    {"xxxxxxxxx01x0011", DriveState::kSwitchedOn},
    {"xxxxxxxxx01x0111", DriveState::kEnabled},
    {"xxxxxxxxx00x0111", DriveState::kQuickStop},
    {"xxxxxxxxx0xx1111", DriveState::kFaultReaction},
    {"xxxxxxxxx0xx1000", DriveState::kFault},
}};

DriveState StateFromTable(unsigned word) {
  for (const StateRow& row : kStates) {
    bool fits = true;
    for (int i = 0; i < 16; ++i)
      fits = fits && (row.bits[i] == 'x' || (row.bits[i] == '1') == ((word >> (15 - i) & 1u) != 0));
    if (fits) return row.state;
  }
  return DriveState::kUnknown;
}

TEST(Cia402, EveryStatuswordGivesTheStateOfTheTable) {
  for (unsigned word = 0; word < 65536; ++word)
    ASSERT_EQ(StateOf(static_cast<std::uint16_t>(word)), StateFromTable(word)) << std::bitset<16>(word);
}

// For each statusword and each goal, the client must send the only controlword that is allowed.
TEST(Cia402, EveryStatuswordAndGoalGivesTheAllowedControlword) {
  for (unsigned word = 0; word < 65536; ++word) {
    const DriveState state = StateFromTable(word);
    const auto control = [&](DriveGoal goal) {
      return ControlToward(goal, StateOf(static_cast<std::uint16_t>(word)));
    };
    ASSERT_EQ(control(DriveGoal::kOff), 0x00) << word;
    const std::uint16_t enable = state == DriveState::kDisabled                                      ? 0x06
                                 : state == DriveState::kReady                                       ? 0x07
                                 : state == DriveState::kSwitchedOn || state == DriveState::kEnabled ? 0x0F
                                                                                                     : 0x00;
    ASSERT_EQ(control(DriveGoal::kEnabled), enable) << word;
    const bool turns = state == DriveState::kEnabled || state == DriveState::kQuickStop;
    ASSERT_EQ(control(DriveGoal::kQuickStop), turns ? 0x02 : 0x00) << word;
  }
}

TEST(CanOpen, EncodesTheFramesOfCia301) {
  using namespace canopen;
  EXPECT_EQ(ToText(Nmt(NmtCommand::kStart, 5)), "000#0105");
  EXPECT_EQ(ToText(Nmt(NmtCommand::kPreOperational, 5)), "000#8005");
  EXPECT_EQ(ToText(Nmt(NmtCommand::kReset, 0)), "000#8100");
  EXPECT_EQ(ToText(Sync()), "080#");
  EXPECT_EQ(ToText(Heartbeat(127, NmtState::kOperational)), "77F#05");
  EXPECT_EQ(ToText(SdoRead(16, {0x6041, 0, 2})), "610#4041600000000000");
  EXPECT_EQ(ToText(SdoWrite(16, {0x6060, 0, 1}, 3)), "610#2F60600003000000");
  EXPECT_EQ(ToText(SdoWrite(16, {0x1017, 0, 2}, 500)), "610#2B171000F4010000");
  EXPECT_EQ(ToText(SdoWrite(16, {0x1600, 3, 4}, 0x60FF0020)), "610#230016032000FF60");
  EXPECT_EQ(ToText(SdoWrite(16, {0x6060, 0, 1}, 0xABCDEF09)), "610#2F60600009000000")
      << "no more than its size";
  EXPECT_EQ(Mapped({0x6041, 0, 2}), 0x60410010u);
}

TEST(CanOpen, SdoAnswersAreReadByTheirSize) {
  using canopen::DecodeSdo;
  using Kind = canopen::SdoAnswer::Kind;
  const auto value = [](const char* text) { return DecodeSdo(Frame(text))->value; };
  EXPECT_EQ(value("590#4F616000FDFFFFFF"), 0xFDu) << "one byte, the rest is not its";
  EXPECT_EQ(value("590#4B41600037020000"), 0x237u);
  EXPECT_EQ(value("590#4F61600003000000"), 3u);
  EXPECT_EQ(value("590#43766000F4010000"), 500u);
  EXPECT_EQ(value("590#42766000F4010000"), 500u) << "size not said";
  EXPECT_EQ(DecodeSdo(Frame("590#6017100000000000"))->kind, Kind::kWritten);
  EXPECT_EQ(DecodeSdo(Frame("590#6017100000000000"))->index, 0x1017);
  const auto abort = DecodeSdo(Frame("590#8000140122000008"));
  EXPECT_EQ(abort->kind, Kind::kAbort);
  EXPECT_EQ(abort->sub, 1);
  EXPECT_EQ(abort->value, 0x08000022u);
  EXPECT_FALSE(DecodeSdo(Frame("590#41766000F4010000"))) << "a segmented transfer";
  EXPECT_FALSE(DecodeSdo(Frame("590#43766000F40100")));
}

ReamerDriveParams Params() {
  return {.node = 16, .gear_ratio = 20.0, .rated_torque_Nm = 0.5, .max_speed_rad_per_s = 40.0};
}

ReamerDrive Drive(const ReamerDriveParams& params = Params()) {
  auto drive = ReamerDrive::Make(params);
  EXPECT_TRUE(drive) << drive.error();
  return *drive;
}

// Answers every request of the set-up as a drive does that accepts it. @returns the requests
Frames AnswerSetUp(ReamerDrive& drive, rt::Nanoseconds& now) {
  Frames asked;
  for (int i = 0; i < 400 && drive.phase() == DrivePhase::kStarting; ++i, now += kMs) {
    for (CanFrame frame; drive.phase() == DrivePhase::kStarting && drive.Next(now, frame);) {
      const std::string text = ToText(frame);
      if (text != "77F#05") asked.push_back(text);
      if (frame.id == 0x610) {
        CanFrame answer = frame;
        answer.id = 0x590;
        const bool read = frame.data[0] == 0x40;
        answer.data[0] = read ? 0x43 : 0x60;
        if (!read) answer.data[4] = answer.data[5] = answer.data[6] = answer.data[7] = 0;
        if (read && frame.data[2] == 0x10)
          answer.data[4] = 0x92, answer.data[5] = 0x01, answer.data[6] = 0x02;
        if (read && frame.data[2] == 0x60) answer.data[4] = 0xF4, answer.data[5] = 0x01;
        drive.Accept({.frame = answer, .stamp = now});
      }
      if (text == "000#0110") drive.Accept(At(now, "710#05"));
    }
  }
  EXPECT_EQ(drive.phase(), DrivePhase::kReady) << drive.failure();
  return asked;
}

TEST(ReamerDrive, SetUpSendsExactlyTheseFrames) {
  auto drive = Drive();
  rt::Nanoseconds now = 0;
  const Frames golden{
      "000#8010",              // NMT: pre-operational
      "610#4000100000000000",  // 1000: device type
      "610#4076600000000000",  // 6076: rated torque
      "610#2B17100032000000",  // 1017: the drive sends a heartbeat each 50 ms
      "610#2316100196007F00",  // 1016: expects our heartbeat, node 127, in 150 ms
      "610#2B07600001000000",  // 6007: a lost connection is a fault of the drive
      "610#2B5E600002000000",  // 605E: after a fault, brake along the ramp
      "610#2B5A600006000000",  // 605A: quick stop: brake on the ramp, then stay
      "610#238360009B4A0000",  // 6083: acceleration 100 rad/s² · 20 · 60/2π = 19099 rpm/s
      "610#238460009B4A0000",
  };
  const Frames asked = AnswerSetUp(drive, now);
  ASSERT_EQ(asked.size(), 1u + 10u + 3 * 8u + 1u);
  for (std::size_t i = 0; i < golden.size(); ++i) EXPECT_EQ(asked[i], golden[i]);
  const Frames pdos{"610#238560006A2A0100",  // 6085: 76394 rpm/s
                    "610#2300140110020080", "610#2F00160000000000", "610#2300160110004060",  // 1400, 1600
                    "610#2300160208006060", "610#230016032000FF60", "610#2F00160003000000",  //
                    "610#2F00140201000000", "610#2300140110020000",                          //
                    "610#2300180190010080", "610#2F001A0000000000", "610#23001A0110004160",  // 1800, 1A00
                    "610#23001A0208006160", "610#23001A0320006C60", "610#2F001A0003000000",  //
                    "610#2F00180201000000", "610#2300180190010000",                          //
                    "610#2301180190020080", "610#2F011A0000000000", "610#23011A0110007760",  // 1801, 1A01
                    "610#23011A0210003F60", "610#23011A0310010132", "610#2F011A0003000000",  //
                    "610#2F01180201000000", "610#2301180190020000", "000#0110"};
  for (std::size_t i = 0; i < pdos.size(); ++i) EXPECT_EQ(asked[10 + i], pdos[i]) << i;
}

// The client of a drive that is already configured, and its clock. A test makes the drive's frames.
struct Running {
  explicit Running(const ReamerDriveParams& params = Params()) : drive(Drive(params)) {
    AnswerSetUp(drive, now);
  }

  // Runs one cycle of 4 ms: first the client's command, which is returned, then the drive's status and
  // heartbeat.
  std::string Cycle(unsigned statusword, int rpm = 0, int permille = 0) {
    std::string command;
    now += 4 * kMs;
    for (CanFrame frame; drive.Next(now, frame);)
      if (frame.id == 0x210) command = ToText(frame);
    Status(statusword, rpm, permille);
    drive.Accept(At(now, "710#05"));
    return command;
  }
  // Delivers a status in the drive's two PDOs. The torque is in thousandths of the rated torque.
  void Status(unsigned statusword, int rpm, int permille) {
    CanFrame one{.id = 0x190, .size = 7}, two{.id = 0x290, .size = 6};
    const auto raw = static_cast<unsigned>(rpm), torque = static_cast<unsigned>(permille);
    one.data = {static_cast<std::uint8_t>(statusword),
                static_cast<std::uint8_t>(statusword >> 8),
                3,
                static_cast<std::uint8_t>(raw),
                static_cast<std::uint8_t>(raw >> 8),
                static_cast<std::uint8_t>(raw >> 16),
                static_cast<std::uint8_t>(raw >> 24)};
    two.data = {
        static_cast<std::uint8_t>(torque), static_cast<std::uint8_t>(torque >> 8), 0x34, 0x12, 0xFA, 0x00};
    drive.Accept({.frame = one, .stamp = now});
    drive.Accept({.frame = two, .stamp = now});
  }
  rt::Nanoseconds now{0};
  ReamerDrive drive;
};

TEST(ReamerDrive, StepsThroughTheStatesToEnabledAndTurnsAtTheToolsSpeed) {
  Running r;
  EXPECT_EQ(r.Cycle(0x250), "210#00000300000000") << "off by default";
  // 26.18 rad/s of the tool · gear ratio 20 · 60/2π = 5000 rpm of the motor = 0x1388
  r.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 5000 * 2 * std::numbers::pi / 60 / 20});
  EXPECT_EQ(r.Cycle(0x250), "210#06000300000000");
  EXPECT_EQ(r.Cycle(0x231), "210#06000300000000") << "until its status says more";
  EXPECT_EQ(r.Cycle(0x233), "210#07000300000000");
  EXPECT_EQ(r.Cycle(0x237), "210#0F000388130000");
  EXPECT_EQ(r.Cycle(0x237), "210#0F000388130000");
  r.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = -1e9});
  EXPECT_EQ(r.Cycle(0x237), "210#0F000329E2FFFF") << "clamped to -40 rad/s: -7639 rpm";
  r.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(r.Cycle(0x237), "210#0F000300000000");
  r.drive.Command({.goal = DriveGoal::kQuickStop, .speed_rad_per_s = 10});
  EXPECT_EQ(r.Cycle(0x217), "210#02000300000000");
  EXPECT_EQ(r.Cycle(0x217), "210#02000300000000") << "and stays";
  r.drive.Command({.goal = DriveGoal::kOff});
  EXPECT_EQ(r.Cycle(0x250), "210#00000300000000");
  EXPECT_EQ(r.drive.status().faults, 0u);
}

TEST(ReamerDrive, ReadsSpeedAndTorqueAtTheTool) {
  Running r;
  r.Cycle(0x237, -3000, 250);
  const DriveStatus& status = r.drive.status();
  EXPECT_EQ(status.state, DriveState::kEnabled);
  EXPECT_NEAR(status.speed_rad_per_s, -3000.0 / 60 * 2 * std::numbers::pi / 20, 1e-12);
  EXPECT_NEAR(status.torque_Nm, 0.25 * 0.5 * 20, 1e-12);
  EXPECT_EQ(status.error_code, 0x1234);
  EXPECT_EQ(status.temperature, 250.0);
  EXPECT_EQ(status.stamp, r.now);
  r.Cycle(0x237, 100, -1);
  EXPECT_NEAR(r.drive.status().torque_Nm, -0.01, 1e-12);

  auto params = Params();
  params.direction = -1;
  Running turned(params);
  turned.Cycle(0x237, -3000, -250);
  EXPECT_GT(turned.drive.status().speed_rad_per_s, 0.0);
  EXPECT_GT(turned.drive.status().torque_Nm, 0.0) << "cutting torque and speed keep one sign";
}

TEST(ReamerDrive, EachCycleSendsACommandAndASync) {
  Running r;
  r.now += 4 * kMs;
  Frames frames = Sent(r.drive, r.now);
  std::erase(frames, "77F#05");
  EXPECT_EQ(frames, (Frames{"210#00000300000000", "080#"}));
  EXPECT_EQ(Sent(r.drive, r.now + 3 * kMs), Frames{});
  EXPECT_EQ(Sent(r.drive, r.now + 4 * kMs).size(), 2u);
}

TEST(ReamerDrive, ALostHeartbeatStopsTheDriveUntilTheFaultIsReset) {
  Running r;
  r.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 10});
  for (int i = 0; i < 20; ++i) r.Cycle(0x237);
  ASSERT_EQ(r.drive.status().faults, 0u);
  const rt::Nanoseconds last = r.now;
  for (; r.now < last + 150 * kMs; r.now += kMs) {
    Sent(r.drive, r.now);
    r.Status(0x237, 0, 0);  // the status still arrives, but no heartbeat
  }
  EXPECT_EQ(r.drive.status().faults, 0u);
  r.now = last + 151 * kMs;
  Sent(r.drive, r.now);
  EXPECT_EQ(r.drive.status().faults, kDriveHeartbeatLost);
  EXPECT_EQ(r.Cycle(0x237), "210#02000300000000") << "quick stop, whatever is commanded";
  EXPECT_EQ(r.Cycle(0x237), "210#02000300000000") << "latched, although it is back";
  EXPECT_FALSE(r.drive.ResetFaults()) << "it would start by itself";
  r.drive.Command({.goal = DriveGoal::kOff});
  EXPECT_EQ(r.Cycle(0x217), "210#00000300000000");
  EXPECT_TRUE(r.drive.ResetFaults());
  EXPECT_EQ(r.drive.status().faults, 0u);
}

TEST(ReamerDrive, MissingStatusIsAFault) {
  Running r;
  for (int i = 0; i < 3; ++i) r.Cycle(0x250);
  const rt::Nanoseconds last = r.now;
  r.now = last + 40 * kMs;
  r.drive.Accept(At(r.now, "710#05"));
  Sent(r.drive, r.now);
  EXPECT_EQ(r.drive.status().faults, 0u);
  Sent(r.drive, r.now + kMs);
  EXPECT_EQ(r.drive.status().faults, kDriveStatusLost);
}

TEST(ReamerDrive, FaultsOfTheDriveAreLatchedAndResetByARisingEdge) {
  Running r;
  r.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 10});
  r.Cycle(0x237);
  r.drive.Accept(At(r.now, "090#1043010000000000"));
  EXPECT_EQ(r.drive.status().faults, kDriveEmergency);
  EXPECT_EQ(r.drive.status().emergency_code, 0x4310);
  r.Cycle(0x21F);
  r.drive.Command({.goal = DriveGoal::kOff});
  EXPECT_FALSE(r.drive.ResetFaults()) << "not while it brakes";
  r.Cycle(0x218);
  EXPECT_EQ(r.drive.status().faults, kDriveEmergency | kDriveInFault);
  EXPECT_TRUE(r.drive.ResetFaults());
  EXPECT_EQ(r.Cycle(0x218), "210#00000300000000") << "low first";
  EXPECT_EQ(r.Cycle(0x218), "210#80000300000000");
  EXPECT_EQ(r.Cycle(0x250), "210#80000300000000");
  EXPECT_EQ(r.Cycle(0x250), "210#00000300000000");
  EXPECT_EQ(r.drive.status().faults, 0u);
}

TEST(ReamerDrive, AFaultThatStaysIsLatchedAgain) {
  Running r;
  r.Cycle(0x218);
  ASSERT_TRUE(r.drive.ResetFaults());
  for (int i = 0; i < 20; ++i) r.Cycle(0x218);
  EXPECT_EQ(r.drive.status().faults, kDriveInFault);
  EXPECT_EQ(r.Cycle(0x218), "210#00000300000000");
}

TEST(ReamerDrive, DetectsARestartAndLeavingEnabled) {
  Running restarted;
  restarted.Cycle(0x250);
  restarted.drive.Accept(At(restarted.now, "710#00"));
  EXPECT_EQ(restarted.drive.status().faults, kDriveRestarted);
  Running left;
  left.drive.Command({.goal = DriveGoal::kEnabled});
  left.Cycle(0x237);
  left.Cycle(0x250);
  EXPECT_EQ(left.drive.status().faults, kDriveLeftEnabled);
  Running told;
  told.drive.Command({.goal = DriveGoal::kEnabled});
  told.Cycle(0x237);
  told.drive.Command({.goal = DriveGoal::kOff});
  told.Cycle(0x250);
  EXPECT_EQ(told.drive.status().faults, 0u);
}

// The loop commands a quick stop, and enables the drive again before a status arrives. The drive then reports
// the quick stop, which must not count as a fault.
TEST(ReamerDrive, ACommandedStopIsNotAFault) {
  Running told;
  told.drive.Command({.goal = DriveGoal::kEnabled});
  told.Cycle(0x237);
  told.drive.Command({.goal = DriveGoal::kQuickStop});
  told.drive.Command({.goal = DriveGoal::kEnabled});
  told.Cycle(0x217);  // quick stop active: the drive has received the first command
  EXPECT_EQ(told.drive.status().faults, 0u);
  told.Cycle(0x237);
  told.Cycle(0x217);
  EXPECT_EQ(told.drive.status().faults, kDriveLeftEnabled) << "this time nobody told it";
}

TEST(ReamerDrive, LeavingOperationalRequiresANewSetUp) {
  Running r;
  r.Cycle(0x250);
  r.drive.Accept(At(r.now, "710#7F"));
  EXPECT_EQ(r.drive.status().faults, kDriveLeftOperational);
  EXPECT_EQ(r.drive.status().nmt_state, 0x7F);
  ASSERT_TRUE(r.drive.ResetFaults());
  EXPECT_EQ(r.drive.phase(), DrivePhase::kStarting) << "it has to be configured anew";
  EXPECT_EQ(r.drive.status().faults, 0u);
}

// During the set-up, an emergency that the drive resets must be forgotten. In a running drive the same
// emergency must be latched.
TEST(ReamerDrive, AnEmergencyResetDuringSetUpIsForgotten) {
  Running r;
  r.drive.Accept(At(r.now, "090#2032040000000000"));
  r.drive.Accept(At(r.now, "090#0000000000000000"));
  EXPECT_EQ(r.drive.status().emergency_code, 0x3220) << "latched, it stays";
  auto booting = Drive();
  booting.Accept(At(0, "090#2032040000000000"));
  EXPECT_EQ(booting.status().emergency_code, 0x3220);
  booting.Accept(At(0, "090#0000000000000000"));
  EXPECT_EQ(booting.status().emergency_code, 0);
}

TEST(DriveFaultText, NamesCodesByCia402AndByTheirClass) {
  EXPECT_STREQ(DescribeErrorCode(0x4310), "excess temperature of the drive");
  EXPECT_STREQ(DescribeErrorCode(0x8130),
               "life guard or heartbeat error: the drive does not hear the controller");
  EXPECT_STREQ(DescribeErrorCode(0x2399), "current at the device's output");
  EXPECT_STREQ(DescribeErrorCode(0x3499), "voltage");
  EXPECT_STREQ(DescribeErrorCode(0x1000), "generic error");
  EXPECT_STREQ(DescribeErrorCode(0xFF07), "the maker's own");
  EXPECT_STREQ(DescribeErrorCode(0xA000), "of no class of CiA 301");
  EXPECT_STREQ(DescribeErrorCode(0), "no error");
}

TEST(DriveFaultText, EachLatchedFaultHasANameAndItsBit) {
  EXPECT_EQ(DescribeDriveFaults({}), "");
  std::set<std::string> texts;
  for (unsigned bit = 0; bit <= 6; ++bit) {
    const std::string text = DescribeDriveFaults({.faults = 1u << bit, .nmt_state = 4, .emergency_code = 0});
    EXPECT_TRUE(text.ends_with("(bit " + std::to_string(bit) + ")")) << text;
    texts.insert(text);
  }
  EXPECT_EQ(texts.size(), 7u);
  EXPECT_EQ(DescribeDriveFaults({.faults = kDriveLeftOperational, .nmt_state = 4}),
            "left OPERATIONAL: its heartbeat says stopped (0x04) (bit 6)");
  EXPECT_EQ(
      DescribeDriveFaults({.faults = kDriveInFault, .emergency_code = 0x3220, .error_code = 0x3220}),
      "in fault by its statusword (bit 3); last EMCY 0x3220 (under-voltage of the DC link); 603F 0x3220 "
      "(under-voltage of the DC link)");
}

TEST(ReamerDrive, FramesOfAWrongSizeChangeNothing) {
  Running r;
  r.Cycle(0x237, 1000, 100);
  const DriveStatus before = r.drive.status();
  for (const char* frame :
       {"190#2702", "290#01", "290#00010203040506", "190#", "710#", "710#0505", "090#1043"})
    r.drive.Accept(At(r.now + 1, frame));
  EXPECT_EQ(r.drive.rejected(), 7u);
  EXPECT_EQ(r.drive.status().stamp, before.stamp);
  EXPECT_EQ(r.drive.status().faults, 0u);
}

// The client's failure if each read request of the set-up gets this answer; an empty text stands for no
// answer.
std::string FailureWith(const std::string& answer) {
  auto drive = Drive();
  rt::Nanoseconds now = 0;
  for (int i = 0; i < 100 && drive.phase() == DrivePhase::kStarting; ++i, now += 10 * kMs)
    for (const std::string& frame : Sent(drive, now))
      if (frame.starts_with("610#40") && !answer.empty()) drive.Accept(At(now, answer));
  EXPECT_EQ(drive.phase(), DrivePhase::kFailed);
  EXPECT_EQ(Sent(drive, now + rt::kSecond), Frames{}) << "a refused drive is not talked to";
  return drive.failure();
}

TEST(ReamerDrive, RefusalsNameObjectValueAndAcceptedValue) {
  EXPECT_NE(FailureWith("590#4300100091010200")
                .find("device type (object 1000:00) is 0x00020191, accepted: profile 402"),
            std::string::npos);
  EXPECT_NE(FailureWith("590#8000100000000206")
                .find("object 1000:00 cannot be read: aborted with 0x06020000 (no such object)"),
            std::string::npos);
  EXPECT_NE(FailureWith("").find("Reamer drive (node 16): no answer about object 1000:00 in 3 attempts"),
            std::string::npos);
}

TEST(ReamerDrive, ErrorsNameTheParameter) {
  const auto says = [](auto&& change, const std::string& text) {
    auto params = Params();
    change(params);
    const auto drive = ReamerDrive::Make(params);
    ASSERT_FALSE(drive) << text;
    EXPECT_NE(drive.error().find(text), std::string::npos) << drive.error();
  };
  says([](auto& p) { p.node = 0; }, "node: found 0, accepted 1 … 127");
  says([](auto& p) { p.master_node = 16; }, "master_node: found 16");
  says([](auto& p) { p.mode = 1; }, "mode: found 1, accepted 3");
  says([](auto& p) { p.gear_ratio = -1; }, "gear_ratio: found -1");
  says([](auto& p) { p.rated_torque_Nm = 0; }, "rated_torque_Nm: found 0");
  says([](auto& p) { p.direction = 0; }, "direction: found 0");
  says([](auto& p) { p.max_speed_rad_per_s = 1e9; }, "max_speed_rad_per_s: found 1000000000");
  says([](auto& p) { p.quick_stop_rad_per_s2 = std::numeric_limits<double>::infinity(); }, "ramp: found inf");
  says([](auto& p) { p.cycle = 1000; }, "cycle: found 1000 ns");
  says([](auto& p) { p.heartbeat = 1'500'000; }, "heartbeat: found 1500000 ns");
  says([](auto& p) { p.temperature.size = 4; }, "temperature: found an object of 4 bytes");
}

std::vector<IdClaim> ClaimsOfBoth(const auto& a, const auto& b) {
  auto claims = Claims(a);
  const auto more = Claims(b);
  claims.insert(claims.end(), more.begin(), more.end());
  return claims;
}

TEST(CanIds, DevicesWithoutCommonIdsAreAccepted) {
  EXPECT_FALSE(FindOverlap(ClaimsOfBoth(RobotousParams{}, Params())));
  EXPECT_FALSE(FindOverlap(Claims(Params()))) << "a device does not meet itself";
}

TEST(CanIds, AnOverlapNamesBothDevicesAndTheRemedy) {
  const auto text = FindOverlap(ClaimsOfBoth(RobotousParams{.command_id = 0x210}, Params()));
  ASSERT_TRUE(text);
  EXPECT_EQ(
      *text,
      "CAN ids overlap: 0x210 of the Robotous force sensor (command id 0x210) (commands) and 0x210 of the "
      "reamer drive (node 16) (RPDO1); give the sensor other ids, give the drive another node (16 or more "
      "beside an ATI sensor), or use a bus for each");
  EXPECT_TRUE(FindOverlap(ClaimsOfBoth(RobotousParams{.first_id = 0x000}, Params()))) << "NMT";
}

}  // namespace
}  // namespace osteon::io
