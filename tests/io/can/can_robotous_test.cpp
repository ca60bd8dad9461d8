#include "io/can/robotous_sensor.h"

#include <gtest/gtest.h>

#include "tests/io/can/can_frames.h"

// Tests the client of a Robotous force sensor, with frames from the manual and from the maker's sample
// program.

namespace osteon::io {
namespace {

using test::At;
using test::Frames;
using test::kFrameTime;
using test::kMs;
using test::Sent;

RobotousSensor Sensor(const RobotousParams& params = {}) { return test::Made<RobotousSensor>(params); }

// Delivers the two frames of an answer or of a reading. The second comes a frame's time after the first.
void Answer(RobotousSensor& sensor, rt::Nanoseconds now, const std::string& first,
            const std::string& second = "0000000000000000") {
  sensor.Accept(At(now, "001#" + first));
  sensor.Accept(At(now + kFrameTime, "002#" + second));
}

// Answers the requests of the set-up, then sends readings at 1 kHz until the client has confirmed the rate.
// @returns the time of the next reading
rt::Nanoseconds MakeReady(RobotousSensor& sensor) {
  rt::Nanoseconds now = 0;
  Sent(sensor, now);  // takes the stop command from the client
  Sent(sensor, now += 20 * kMs);
  Answer(sensor, now, "0801000000000000");
  Sent(sensor, now);
  Answer(sensor, now, "0900000000000000");
  Sent(sensor, now);
  Answer(sensor, now, "0F01000000000000");
  Sent(sensor, now);
  Answer(sensor, now, "1008000000000000");
  Sent(sensor, now);
  for (int i = 0; sensor.phase() == SensorPhase::kStarting && i < 1000; ++i, now += kMs) {
    Answer(sensor, now, "0B00000000000000");
    Sent(sensor, now);
  }
  EXPECT_EQ(sensor.phase(), SensorPhase::kReady) << sensor.failure();
  return now;
}

TEST(RobotousSensor, SetUpSendsTheManualsFrames) {
  auto sensor = Sensor({.filter_hz = 200});
  EXPECT_EQ(Sent(sensor, 0), Frames{"064#0C00000000000000"});
  EXPECT_EQ(Sent(sensor, 19 * kMs), Frames{}) << "what is still on its way passes first";
  EXPECT_EQ(Sent(sensor, 20 * kMs), Frames{"064#08010C0000000000"});
  Answer(sensor, 20 * kMs, "0801000000000000");
  EXPECT_EQ(Sent(sensor, 20 * kMs), Frames{"064#0900000000000000"});
  Answer(sensor, 20 * kMs, "09010C0000000000");
  EXPECT_EQ(Sent(sensor, 20 * kMs), Frames{"064#0F08000000000000"});
  Answer(sensor, 20 * kMs, "0F01000000000000");
  EXPECT_EQ(Sent(sensor, 20 * kMs), Frames{"064#1000000000000000"});
  Answer(sensor, 20 * kMs, "1008000000000000");
  EXPECT_EQ(Sent(sensor, 20 * kMs), Frames{"064#0B00000000000000"});
  EXPECT_EQ(sensor.phase(), SensorPhase::kStarting) << "not before its readings have been timed";
}

TEST(RobotousSensor, ReadsBigEndianForcesInNewtonAndTorquesInNewtonMetre) {
  auto sensor = Sensor();
  const rt::Nanoseconds now = MakeReady(sensor);
  // the values are 0x0064 = 100, 0xFF9C = -100, 0x7FFF, 0x8000, 0x07D0 = 2000 and 0xF830 = -2000
  Answer(sensor, now, "0B0064FF9C7FFF80", "0007D0F830000000");
  const SensorReading& reading = sensor.Latest();
  EXPECT_EQ(reading.stamp, now) << "its first half's";
  EXPECT_EQ(reading.F_S.f.x, 2.0);
  EXPECT_EQ(reading.F_S.f.y, -2.0);
  EXPECT_EQ(reading.F_S.f.z, 32767 / 50.0);
  EXPECT_EQ(reading.F_S.t.x, -16.384);
  EXPECT_EQ(reading.F_S.t.y, 1.0);
  EXPECT_EQ(reading.F_S.t.z, -1.0);
  EXPECT_EQ(reading.flags, 0u);
}

TEST(RobotousSensor, ReportsWhichAxesAreOverloaded) {
  auto sensor = Sensor();
  const rt::Nanoseconds now = MakeReady(sensor);
  Answer(sensor, now, "0B00000000000000", "0000000000240000");
  EXPECT_EQ(sensor.Latest().flags, kSensorOverload);
  EXPECT_EQ(sensor.Latest().status, 0x24);
  Answer(sensor, now + kMs, "0B00000000000000");
  EXPECT_EQ(sensor.Latest().flags, 0u) << "a reading's flag is its own";
}

TEST(RobotousSensor, SendsTheBiasCommandOnRequestOnceItRuns) {
  auto sensor = Sensor();
  sensor.RequestBias(true);
  EXPECT_EQ(Sent(sensor, 0), Frames{"064#0C00000000000000"});
  auto running = Sensor();
  const rt::Nanoseconds now = MakeReady(running);
  running.RequestBias(true);
  EXPECT_EQ(Sent(running, now), Frames{"064#1101000000000000"});
  EXPECT_EQ(Sent(running, now), Frames{}) << "once";
  running.RequestBias(false);
  EXPECT_EQ(Sent(running, now), Frames{"064#1100000000000000"});
}

TEST(RobotousSensor, HalvesOfDifferentReadingsAreNeverJoined) {
  auto sensor = Sensor();
  const rt::Nanoseconds t = MakeReady(sensor);
  const std::uint64_t before = sensor.counters().readings;
  const auto first = [&](rt::Nanoseconds at, bool gap = false) {
    sensor.Accept(At(at, "001#0B00320000000000", gap));
  };
  const auto second = [&](rt::Nanoseconds at, bool gap = false) {
    sensor.Accept(At(at, "002#0000000000000000", gap));
  };
  // the second half of a reading and the first half of the next are lost, so the halves are more than a
  // period apart
  first(t);
  second(t + kMs + kFrameTime);
  // a second half alone
  second(t + 2 * kMs);
  // two first halves: the newer one must be used
  first(t + 3 * kMs);
  first(t + 4 * kMs);
  EXPECT_EQ(sensor.counters().readings, before);
  second(t + 4 * kMs + kFrameTime);
  EXPECT_EQ(sensor.counters().readings, before + 1);
  EXPECT_EQ(sensor.Latest().stamp, t + 4 * kMs);
  // the second half once more
  second(t + 4 * kMs + 2 * kFrameTime);
  // the halves are close together, but the bus reports that frames between them were lost
  first(t + 5 * kMs);
  second(t + 5 * kMs + kFrameTime, true);
  EXPECT_EQ(sensor.counters().readings, before + 1);
  // the halves arrive in the wrong order
  second(t + 6 * kMs);
  first(t + 6 * kMs + kFrameTime);
  second(t + 7 * kMs);
  EXPECT_EQ(sensor.counters().readings, before + 1);
  EXPECT_EQ(sensor.counters().halves, 10u);  // all halves except the two that gave the reading
}

TEST(RobotousSensor, AFrameOfAnotherSizeIsRefused) {
  auto sensor = Sensor();
  const rt::Nanoseconds t = MakeReady(sensor);
  const std::uint64_t before = sensor.counters().readings;
  sensor.Accept(At(t, "001#0B003200000000"));
  sensor.Accept(At(t, "002#0000000000000000"));
  sensor.Accept(At(t + kMs, "001#0B00320000000000"));
  sensor.Accept(At(t + kMs, "002#"));
  EXPECT_EQ(sensor.counters().readings, before);
  EXPECT_EQ(sensor.counters().malformed, 2u);
}

TEST(RobotousSensor, AnEchoOfAnotherCommandIsNoReading) {
  auto sensor = Sensor();
  const rt::Nanoseconds t = MakeReady(sensor);
  const std::uint64_t before = sensor.counters().readings;
  Answer(sensor, t, "0A00320000000000");
  Answer(sensor, t + kMs, "1008000000000000");
  EXPECT_EQ(sensor.counters().readings, before);
  EXPECT_EQ(sensor.counters().unexpected, 2u);
}

TEST(RobotousSensor, OldReadingsDuringSetUpAnswerNoCommand) {
  auto sensor = Sensor();
  Answer(sensor, 0, "0B00000000000000");  // an answer before the client has requested anything
  Sent(sensor, 0);
  Answer(sensor, kMs, "0B00000000000000");
  Sent(sensor, 20 * kMs);
  Answer(sensor, 21 * kMs, "0B00000000000000");
  Answer(sensor, 22 * kMs, "1008000000000000");
  EXPECT_EQ(Sent(sensor, 23 * kMs), Frames{}) << "still waits for the filter's answer";
  EXPECT_EQ(sensor.counters().unexpected, 4u);
}

TEST(RobotousSensor, RepeatsACommandTwiceThenReportsASilentSensor) {
  auto sensor = Sensor();
  Sent(sensor, 0);
  EXPECT_EQ(Sent(sensor, 20 * kMs).size(), 1u);
  EXPECT_EQ(Sent(sensor, 119 * kMs).size(), 0u);
  EXPECT_EQ(Sent(sensor, 120 * kMs), Frames{"064#0800000000000000"});
  EXPECT_EQ(Sent(sensor, 220 * kMs).size(), 1u);
  EXPECT_EQ(sensor.phase(), SensorPhase::kStarting);
  EXPECT_EQ(Sent(sensor, 320 * kMs).size(), 0u);
  ASSERT_EQ(sensor.phase(), SensorPhase::kFailed);
  EXPECT_NE(sensor.failure().find("command id 0x064"), std::string::npos) << sensor.failure();
  EXPECT_NE(sensor.failure().find("no answer to command 0x08 in 3 attempts"), std::string::npos);
  sensor.Restart();
  EXPECT_EQ(Sent(sensor, 400 * kMs), Frames{"064#0C00000000000000"});
  EXPECT_TRUE(sensor.failure().empty());
}

// The client's failure after a set-up with these four answers: to the setting of the filter, to reading it
// back, to the setting of the rate, and to reading that back.
std::string FailureAfter(const std::string& filter, const std::string& filter_back, const std::string& rate,
                         const std::string& rate_back) {
  auto sensor = Sensor();
  Sent(sensor, 0);
  for (const std::string& answer : {filter, filter_back, rate, rate_back}) {
    Sent(sensor, 20 * kMs);
    Answer(sensor, 20 * kMs, answer);
  }
  EXPECT_EQ(sensor.phase(), SensorPhase::kFailed);
  EXPECT_EQ(Sent(sensor, 30 * kMs), Frames{}) << "a refused sensor is never started";
  return sensor.failure();
}

TEST(RobotousSensor, RefusesASensorWhoseRateIsNotConfirmed) {
  EXPECT_NE(FailureAfter("0801000000000000", "0900000000000000", "0F01000000000000", "1005000000000000")
                .find("rate reads back as code 5, accepted 8 (1000 Hz)"),
            std::string::npos);
  EXPECT_NE(FailureAfter("0801000000000000", "0900000000000000", "0F00020000000000", "1008000000000000")
                .find("refused command 0x0F with error 2 (value out of range)"),
            std::string::npos);
  EXPECT_NE(
      FailureAfter("0801000000000000", "0901030000000000", "", "").find("low-pass reads back as code 3"),
      std::string::npos);
}

TEST(RobotousSensor, RefusesASensorWhoseReadingsComeAtAnotherRate) {
  for (const rt::Nanoseconds period : {2 * kMs, 5 * kMs, kMs / 2}) {  // only 1 ms is accepted
    auto sensor = Sensor();
    rt::Nanoseconds now = 0;
    Sent(sensor, now);
    for (const char* answer :
         {"0801000000000000", "0900000000000000", "0F01000000000000", "1008000000000000"}) {
      Sent(sensor, now += 20 * kMs);
      Answer(sensor, now, answer);
    }
    Sent(sensor, now);
    for (int i = 0; i < 200; ++i, now += period) {
      Answer(sensor, now, "0B00000000000000");
      Sent(sensor, now);
    }
    EXPECT_EQ(sensor.phase(), SensorPhase::kFailed) << period;
    EXPECT_NE(sensor.failure().find("Hz, accepted 1000 Hz"), std::string::npos) << sensor.failure();
    EXPECT_EQ(sensor.counters().readings, 0u) << "not one reading reached the loop";
  }
}

TEST(RobotousSensor, ErrorsNameTheParameter) {
  const auto says = [](const RobotousParams& params, const std::string& text) {
    const auto sensor = RobotousSensor::Make(params);
    ASSERT_FALSE(sensor);
    EXPECT_NE(sensor.error().find(text), std::string::npos) << sensor.error();
  };
  says({.rate_hz = 400}, "rate_hz: found 400, accepted 10, 20, 50, 100, 200, 500, 1000");
  says({.filter_hz = 7}, "filter_hz: found 7");
  says({.command_id = 0x800}, "id: found 0x800");
  says({.first_id = 0x64}, "three different ones");
  says({.counts_per_N = 0.0}, "counts: found 0");
  says({.attempts = 0}, "attempts");
}

}  // namespace
}  // namespace osteon::io
