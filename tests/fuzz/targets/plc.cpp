#include <array>
#include <string_view>

#include "io/modbus/plc_client.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Fuzz target: the PLC's registers 970 … 983, as a hostile server may send them. For each block, the input
// has the time since the previous block [ms], the registers (two bytes each, little-endian), and the time
// until the block is judged [ms]. The Modbus protocol itself is implemented by libmodbus;
// tests/io/modbus/modbus_client_test.cpp tests it with servers that misbehave.

namespace osteon::fuzz {
namespace {

constexpr rt::Nanoseconds kMaxAge = 100 * rt::kMillisecond;  // largest age of a block that permits motion

bool Same(const io::PlcInputs& a, const io::PlcInputs& b) {
  return a.mode == b.mode && a.version == b.version && a.emergency_stop == b.emergency_stop &&
         a.run_permitted == b.run_permitted && a.enabling == b.enabling && a.heartbeat == b.heartbeat &&
         a.foot_pedal == b.foot_pedal && a.spindle_permitted == b.spindle_permitted &&
         a.power_on == b.power_on;
}

// Reads one block from the input, and handles it like PlcClient::ReadBlock, but without a connection.
void HandleBlock(Input& in, rt::Nanoseconds now, io::PlcReading& reading) {
  std::array<std::uint16_t, io::kPlcReadCount> block{};
  for (std::uint16_t& value : block) value = in.Word();
  const auto at = [&](int address) { return block[static_cast<std::size_t>(address - io::kPlcFirstRead)]; };
  const io::PlcInputs before = reading.inputs;
  const auto bad = io::DecodePlc(block, reading.inputs);
  if (bad) {
    Claim(bad->address >= io::kPlcFirstRead && bad->address < io::kPlcFirstRead + io::kPlcReadCount,
          "a bad register is one of the block");
    Claim(bad->found == at(bad->address) && bad->found > bad->accepted_most, "and has that value");
    Claim(at(977) == io::kPlcVersion, "another version's registers may mean anything");
    Claim(Same(before, reading.inputs), "a bad block changes nothing");
    reading.bad = *bad;
    reading.link = io::PlcLink::kConnecting;
    return;
  }
  const io::PlcInputs& inputs = reading.inputs;
  Claim(inputs.version == at(977), "the version is the PLC's");
  Claim(inputs.mode <= io::PlcMode::kAutomatic && inputs.enabling <= io::PlcEnabling::kSqueezed,
        "mode and enabling switch exist");
  if (inputs.version != io::kPlcVersion)
    Claim(!inputs.run_permitted && inputs.emergency_stop && !inputs.spindle_permitted && !inputs.power_on,
          "a PLC of another version permits nothing");
  else
    Claim(inputs.run_permitted == (at(974) == 1) && inputs.emergency_stop == (at(978) == 1),
          "permission and emergency stop are the PLC's");
  if (inputs.heartbeat != before.heartbeat) reading.heartbeat_changed = now;
  reading.stamp = now;
  reading.link = inputs.version == io::kPlcVersion ? io::PlcLink::kConnected : io::PlcLink::kWrongVersion;
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  fuzz::Input in(data, size);
  io::PlcReading reading;
  rt::Nanoseconds now = rt::kSecond;
  while (!in.empty()) {
    now += in.Byte() * rt::kMillisecond;
    fuzz::HandleBlock(in, now, reading);
    const rt::Nanoseconds later = now + in.Byte() * rt::kMillisecond;
    const io::PlcVerdict verdict = io::Judge(reading, later, fuzz::kMaxAge);
    if (verdict == io::PlcVerdict::kRun)
      fuzz::Claim(reading.inputs.run_permitted && !reading.inputs.emergency_stop &&
                      later - reading.stamp <= fuzz::kMaxAge && reading.inputs.version == io::kPlcVersion,
                  "the arm moves by a fresh block of this version that permits it");
    fuzz::Claim(!std::string_view(io::Describe(verdict)).empty(), "a verdict has a text");
    fuzz::Claim(!io::Describe(io::PlcClientParams{}, reading).empty(), "a reading has a text");
  }
  return 0;
}
