#include "hil/plc/modbus_server.h"

#include <cstddef>

namespace osteon::hil {
namespace {

// Exception codes of Modbus.
constexpr std::uint8_t kIllegalFunction = 1, kIllegalAddress = 2, kIllegalValue = 3;

std::uint16_t ReadU16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

void PutU16(std::vector<std::uint8_t>& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

// Makes an answer: the request's header with the answer's length, then the function and its data.
std::vector<std::uint8_t> MakeAnswer(std::span<const std::uint8_t> request,
                                     std::span<const std::uint8_t> pdu) {
  std::vector<std::uint8_t> answer(request.begin(), request.begin() + 4);
  PutU16(answer, static_cast<unsigned>(pdu.size() + 1));
  answer.push_back(request[6]);
  answer.insert(answer.end(), pdu.begin(), pdu.end());
  return answer;
}

}  // namespace

MbapFrame FrameOf(std::span<const std::uint8_t> stream) {
  // check each field as soon as all its bytes have arrived
  if (stream.size() >= 4 && ReadU16(stream, 2) != 0) return {.state = MbapState::kBroken};
  if (stream.size() < 6) return {};
  const std::size_t length = ReadU16(stream, 4);
  if (length < 2 || length > kModbusMaxAdu - 6) return {.state = MbapState::kBroken};
  if (stream.size() < 6 + length) return {};
  return {.state = MbapState::kWhole, .size = 6 + length};
}

std::vector<std::uint8_t> RefuseModbus(std::span<const std::uint8_t> request, std::uint8_t exception) {
  const std::uint8_t answer[]{static_cast<std::uint8_t>(request[kMbapHeader] | 0x80), exception};
  return MakeAnswer(request, answer);
}

std::vector<std::uint8_t> AnswerModbus(std::span<const std::uint8_t> request,
                                       const ModbusRegisters& registers) {
  const std::span<const std::uint8_t> pdu = request.subspan(kMbapHeader);
  const std::uint8_t function = pdu[0];
  const auto refuse = [&](std::uint8_t exception) { return RefuseModbus(request, exception); };
  std::vector<std::uint8_t> answer{function};

  switch (function) {
    case 3: {  // read holding registers
      if (pdu.size() != 5) return refuse(kIllegalValue);
      const unsigned first = ReadU16(pdu, 1), count = ReadU16(pdu, 3);
      if (count < 1 || count > 125) return refuse(kIllegalValue);
      if (first + count > 65536u) return refuse(kIllegalAddress);
      answer.push_back(static_cast<std::uint8_t>(2 * count));
      for (unsigned i = 0; i < count; ++i) {
        const auto value = registers.read(static_cast<std::uint16_t>(first + i));
        if (!value) return refuse(kIllegalAddress);
        PutU16(answer, *value);
      }
      return MakeAnswer(request, answer);
    }
    case 6: {  // write one register
      if (pdu.size() != 5) return refuse(kIllegalValue);
      if (!registers.writable(ReadU16(pdu, 1))) return refuse(kIllegalAddress);
      registers.write(ReadU16(pdu, 1), ReadU16(pdu, 3));
      return MakeAnswer(request, pdu);
    }
    case 16: {  // write several registers
      if (pdu.size() < 6) return refuse(kIllegalValue);
      const unsigned first = ReadU16(pdu, 1), count = ReadU16(pdu, 3);
      if (count < 1 || count > 123 || pdu[5] != 2 * count || pdu.size() != 6 + 2 * std::size_t{count})
        return refuse(kIllegalValue);
      if (first + count > 65536u) return refuse(kIllegalAddress);
      for (unsigned i = 0; i < count; ++i)
        if (!registers.writable(static_cast<std::uint16_t>(first + i))) return refuse(kIllegalAddress);
      for (unsigned i = 0; i < count; ++i)
        registers.write(static_cast<std::uint16_t>(first + i), ReadU16(pdu, 6 + 2 * std::size_t{i}));
      PutU16(answer, first);
      PutU16(answer, count);
      return MakeAnswer(request, answer);
    }
    default:
      return refuse(kIllegalFunction);
  }
}

}  // namespace osteon::hil
