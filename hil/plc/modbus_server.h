#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

// Modbus TCP, server side, bytes in and bytes out. Written independently of libmodbus, which the product
// uses.
//
//     transaction u16 | protocol u16 = 0 | length u16 | unit u8 | function u8 | data        big-endian
//
// Functions 3 (read holding registers), 6 and 16 (write one, several). Others get exception 1, unknown
// addresses 2, invalid counts 3. Source: MODBUS Application Protocol 1.1b3; Messaging on TCP/IP 1.0b.

namespace osteon::hil {

inline constexpr std::size_t kMbapHeader = 7;      ///< bytes before the function
inline constexpr std::size_t kModbusMaxAdu = 260;  ///< bytes of the largest request or answer

/// The registers behind the server.
struct ModbusRegisters {
  /// The register's value, or nothing if there is no such register to read.
  std::function<std::optional<std::uint16_t>(std::uint16_t address)> read;
  /// Whether there is such a register to write.
  std::function<bool(std::uint16_t address)> writable;
  std::function<void(std::uint16_t address, std::uint16_t value)> write;
};

enum class MbapState : std::uint8_t {
  kIncomplete,  ///< more bytes of the request must follow
  kWhole,       ///< the first size bytes are one request
  kBroken,      ///< not Modbus TCP: close the connection
};

struct MbapFrame {
  MbapState state{MbapState::kIncomplete};
  std::size_t size{0};
};

/// Finds the first request in the bytes of a stream, if there is a whole one.
[[nodiscard]] MbapFrame FrameOf(std::span<const std::uint8_t> stream);

/// Refuses one whole request with an exception code, e.g. kServerBusy.
[[nodiscard]] std::vector<std::uint8_t> RefuseModbus(std::span<const std::uint8_t> request,
                                                     std::uint8_t exception);
inline constexpr std::uint8_t kServerBusy = 6;  ///< exception code

/// Answers one whole request (FrameOf returned kWhole). A write takes effect as a whole or not at all. Never
/// empty.
[[nodiscard]] std::vector<std::uint8_t> AnswerModbus(std::span<const std::uint8_t> request,
                                                     const ModbusRegisters& registers);

}  // namespace osteon::hil
