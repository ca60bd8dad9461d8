#include "hil/plc/modbus_server.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

// Tests the Modbus TCP codec of the simulated PLC, with right, wrong and damaged requests.

namespace osteon::hil {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The registers of a small PLC: 970 and 971 are read-only, 990 and 991 are writable.
struct Memory {
  std::map<std::uint16_t, std::uint16_t> cells{{970, 0x0102}, {971, 3}, {990, 0}, {991, 0}};
  int writes{0};

  ModbusRegisters registers() {
    return {.read = [this](std::uint16_t at) -> std::optional<std::uint16_t> {
              const auto found = cells.find(at);
              if (found == cells.end()) return {};
              return found->second;
            },
            .writable = [](std::uint16_t at) { return at == 990 || at == 991; },
            .write =
                [this](std::uint16_t at, std::uint16_t value) {
                  cells[at] = value;
                  ++writes;
                }};
  }
};

// Frames of the Modbus TCP specification, but with this project's registers: 970 = 03 ca, 990 = 03 de.
TEST(ModbusServer, AnswersTheSpecificationsFramesByteForByte) {
  Memory memory;
  const auto registers = memory.registers();
  EXPECT_EQ(AnswerModbus(Bytes{0xab, 0xcd, 0, 0, 0, 6, 0xff, 3, 0x03, 0xca, 0, 2}, registers),
            (Bytes{0xab, 0xcd, 0, 0, 0, 7, 0xff, 3, 4, 1, 2, 0, 3}));
  EXPECT_EQ(AnswerModbus(Bytes{0, 1, 0, 0, 0, 6, 1, 6, 0x03, 0xde, 0x12, 0x34}, registers),
            (Bytes{0, 1, 0, 0, 0, 6, 1, 6, 0x03, 0xde, 0x12, 0x34}));
  EXPECT_EQ(memory.cells[990], 0x1234);
  EXPECT_EQ(AnswerModbus(Bytes{0, 2, 0, 0, 0, 11, 1, 16, 0x03, 0xde, 0, 2, 4, 0, 9, 0, 1}, registers),
            (Bytes{0, 2, 0, 0, 0, 6, 1, 16, 0x03, 0xde, 0, 2}));
  EXPECT_EQ(memory.cells[990], 9);
  EXPECT_EQ(memory.cells[991], 1);
}

TEST(ModbusServer, AnswersBadRequestsWithAnExceptionAndWritesNothing) {
  struct Case {
    Bytes pdu;
    int exception;  // Modbus exception code: 1 for a wrong function, 2 for an address, 3 for a value
  };
  for (const Case& c : {
           Case{{4, 0x03, 0xca, 0, 1}, 1},            // function 4 (read input registers) is not supported
           Case{{0x83}, 1},                           // function code of an answer
           Case{{3, 0x03, 0xca, 0, 0}, 3},            // number of registers is 0
           Case{{3, 0x03, 0xca, 0, 126}, 3},          // more than 125 registers
           Case{{3, 0x03, 0xca, 0, 3}, 2},            // third register beyond the map
           Case{{3, 0xff, 0xff, 0, 2}, 2},            // beyond the address space
           Case{{3, 0x03, 0xca, 0}, 3},               // request is cut off
           Case{{3}, 3},                              // request is cut off
           Case{{6, 0x03, 0xca, 0, 1}, 2},            // write to a read-only register
           Case{{6, 0x03, 0xde, 0}, 3},               // request is cut off
           Case{{16, 0x03, 0xde, 0, 2, 4, 0, 1}, 3},  // fewer bytes than announced
           Case{{16, 0x03, 0xde, 0, 2, 2, 0, 1, 0, 2}, 3},  // byte count for one register, not two
           Case{{16, 0x03, 0xdf, 0, 2, 4, 0, 1, 0, 2}, 2},  // the second register does not exist
           Case{{16, 0xff, 0xff, 0, 2, 4, 0, 1, 0, 2}, 2},  // beyond the address space
           Case{{16, 0x03, 0xde, 0, 0, 0}, 3},              // number of registers is 0
       }) {
    Memory memory;
    Bytes request{0, 1, 0, 0, 0, static_cast<std::uint8_t>(c.pdu.size() + 1), 1};
    request.insert(request.end(), c.pdu.begin(), c.pdu.end());
    const Bytes answer = AnswerModbus(request, memory.registers());
    EXPECT_EQ(answer, (Bytes{0, 1, 0, 0, 0, 3, 1, static_cast<std::uint8_t>(c.pdu[0] | 0x80),
                             static_cast<std::uint8_t>(c.exception)}))
        << testing::PrintToString(c.pdu);
    EXPECT_EQ(memory.writes, 0) << "all or nothing";
  }
}

TEST(ModbusServer, FindsWholeIncompleteAndBrokenFramesInAStream) {
  const Bytes request{0, 1, 0, 0, 0, 6, 1, 3, 0x03, 0xca, 0, 1};
  for (std::size_t size = 0; size < request.size(); ++size)
    EXPECT_EQ(FrameOf(std::span(request).first(size)).state, MbapState::kIncomplete) << size;
  Bytes two = request;
  two.insert(two.end(), request.begin(), request.end());
  EXPECT_EQ(FrameOf(two).state, MbapState::kWhole);
  EXPECT_EQ(FrameOf(two).size, request.size());
  EXPECT_EQ(FrameOf(Bytes{0, 1, 0, 1}).state, MbapState::kBroken) << "protocol";
  EXPECT_EQ(FrameOf(Bytes{0, 1, 0, 0, 0, 1}).state, MbapState::kBroken) << "shorter than a function";
  EXPECT_EQ(FrameOf(Bytes{0, 1, 0, 0, 0, 255}).state, MbapState::kBroken) << "longer than an ADU";
  EXPECT_EQ(FrameOf(Bytes{0, 1, 0, 0, 0xff, 0xff}).state, MbapState::kBroken);
}

// A write request for two registers, in which one to three bytes are changed at random. Sometimes it is also
// cut off.
TEST(ModbusServer, DamagedRequestsWriteOnlyWritableRegisters) {
  constexpr unsigned kSeed = 20240932;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  int whole = 0, broken = 0;
  for (int i = 0; i < 200'000; ++i) {
    Bytes bytes{0, 1, 0, 0, 0, 11, 1, 16, 0x03, 0xde, 0, 2, 4, 0, 9, 0, 1};
    for (auto k = 1 + random() % 3; k > 0; --k)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random() % 256);
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    const MbapFrame frame = FrameOf(bytes);
    broken += frame.state == MbapState::kBroken;
    if (frame.state != MbapState::kWhole) continue;
    ++whole;
    ASSERT_LE(frame.size, bytes.size());
    Memory memory;
    const auto before = memory.cells.size();
    const Bytes answer = AnswerModbus(std::span(bytes).first(frame.size), memory.registers());
    ASSERT_GE(answer.size(), 9u);
    ASSERT_LE(answer.size(), kModbusMaxAdu);
    ASSERT_EQ(answer[4] * 256u + answer[5] + 6u, answer.size());
    ASSERT_EQ(memory.cells.size(), before);
    ASSERT_EQ(memory.cells[970], 0x0102);
  }
  EXPECT_GT(whole, 10'000);
  EXPECT_GT(broken, 10'000);
}

}  // namespace
}  // namespace osteon::hil
