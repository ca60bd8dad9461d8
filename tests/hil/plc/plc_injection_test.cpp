#include "hil/plc/plc_injection.h"

#include <stdexcept>

#include "tests/hil/plc/modbus_context.h"

// Tests the faults that a scenario injects on the wire of the simulated PLC. The client is that of libmodbus.

namespace osteon::hil {
namespace {

// Whether the PLC answers when its version register is read (register 977, value 3).
bool Read(const Context& client) {
  std::uint16_t version = 0;
  return modbus_read_registers(client.get(), 977, 1, &version) == 1 && version == 3;
}

// Parameters with faults on the PLC's wire. from_s and to_s count from the start of the schedule.
InjectionParams PlcFaults(double from_s, double to_s, const WireFaults& faults) {
  return {.injections = {{.wire = Wire::kPlc, .from_s = from_s, .to_s = to_s, .faults = faults}}};
}

TEST(PlcInjection, ServerHangsDuringASilence) {
  PlcServer server({.port = 0});
  PlcInjection injection(server, PlcFaults(1.0, 2.0, {.silence = true}));
  const Context client = Connect(server, 5000);
  injection.Step(0);
  EXPECT_TRUE(Read(client)) << "not begun";
  injection.StartSchedule(0);
  injection.Step(rt::kSecond);
  EXPECT_EQ(injection.hangs(), 1u);
  modbus_set_response_timeout(client.get(), 0, 50'000);
  // the first request may still be answered, if it was in progress
  EXPECT_FALSE(Read(client) && Read(client) && Read(client));
  injection.Step(2 * rt::kSecond);
  const Context next = Connect(server, 5000);
  EXPECT_TRUE(Read(next));
  EXPECT_EQ(injection.hangs(), 1u);
}

// TCP hides lost packets. Therefore a loss in a scenario closes all connections once.
TEST(PlcInjection, ALossDropsConnectionsOnceWhenItBegins) {
  PlcServer server({.port = 0});
  PlcInjection injection(server, PlcFaults(0.0, 1.0, {.loss = 0.1}));
  const Context client = Connect(server, 5000), other = Connect(server, 5000);
  EXPECT_TRUE(Read(client) && Read(other));
  injection.StartSchedule(0);
  for (int i = 0; i < 10; ++i) injection.Step(i * 10 * rt::kMillisecond);
  EXPECT_EQ(injection.drops(), 1u);
  while (server.counters().dropped == 0) rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
  EXPECT_EQ(server.counters().dropped, 2u);
  EXPECT_FALSE(Read(client));
  const Context next = Connect(server, 5000);
  EXPECT_TRUE(Read(next)) << "and takes new ones";
}

TEST(PlcInjection, AnswersAreDelayedByTheGivenTime) {
  constexpr rt::Nanoseconds kDelay = 30 * rt::kMillisecond;  // not a multiple of the program's cycle time
  PlcServer server({.port = 0, .cycle_ms = 100});
  PlcInjection injection(server, PlcFaults(0.0, 1.0, {.delay = kDelay, .jitter = 5 * rt::kMillisecond}));
  const Context client = Connect(server, 5000);
  EXPECT_TRUE(Read(client));
  EXPECT_EQ(server.counters().delayed, 0u);
  injection.StartSchedule(0);
  for (int i = 0; i < 5; ++i) {
    injection.Step(i * rt::kMillisecond);
    const rt::Nanoseconds asked = rt::MonotonicNow();
    EXPECT_TRUE(Read(client));
    EXPECT_GE(rt::MonotonicNow() - asked, kDelay);
  }
  EXPECT_EQ(server.counters().delayed, 5u);
  injection.Step(rt::kSecond);
  EXPECT_TRUE(Read(client));
  EXPECT_EQ(server.counters().delayed, 5u) << "it is over";
}

TEST(PlcInjection, RefusesFaultsThatTcpCannotHave) {
  PlcServer server({.port = 0});
  for (const WireFaults& faults :
       {WireFaults{.duplicate = 0.1}, WireFaults{.reorder = 0.1}, WireFaults{.corrupt = 0.1}})
    EXPECT_THROW(PlcInjection(server, PlcFaults(0, 1, faults)), std::invalid_argument);
  EXPECT_NO_THROW(PlcInjection(server, {.injections = {{.faults = {.corrupt = 0.1}}}})) << "another wire's";
}

}  // namespace
}  // namespace osteon::hil
