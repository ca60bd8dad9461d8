#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

// Server side of Modbus TCP: converts the bytes of requests to the bytes of answers. Written independently of
// libmodbus, which the controller uses.
//
//     transaction u16 | protocol u16 = 0 | length u16 | unit u8 | function u8 | data        big-endian
//
// Functions 3 (read holding registers), 6 and 16 (write one, several). Other functions are answered with
// exception 1, unknown addresses with exception 2, invalid counts with exception 3. Source: MODBUS
// Application Protocol 1.1b3; Messaging on TCP/IP 1.0b.

namespace osteon::hil {

inline constexpr std::size_t kMbapHeader = 7;      ///< number of bytes before the function
inline constexpr std::size_t kModbusMaxAdu = 260;  ///< bytes of the largest request or answer

/// Access to the registers that the server serves.
struct ModbusRegisters {
  /// Returns the register's value, or nothing if there is no readable register with this address.
  std::function<std::optional<std::uint16_t>(std::uint16_t address)> read;
  /// Whether there is a writable register with this address.
  std::function<bool(std::uint16_t address)> writable;
  std::function<void(std::uint16_t address, std::uint16_t value)> write;
};

enum class MbapState : std::uint8_t {
  kIncomplete,  ///< the request is not complete: wait for more bytes
  kWhole,       ///< the first size bytes are one request
  kBroken,      ///< not Modbus TCP: close the connection
};

struct MbapFrame {
  MbapState state{MbapState::kIncomplete};
  std::size_t size{0};
};

/// Finds the first complete request in the bytes of a stream.
[[nodiscard]] MbapFrame FrameOf(std::span<const std::uint8_t> stream);

/// Makes the answer that refuses one complete request with an exception code, e.g. kServerBusy.
[[nodiscard]] std::vector<std::uint8_t> RefuseModbus(std::span<const std::uint8_t> request,
                                                     std::uint8_t exception);
inline constexpr std::uint8_t kServerBusy = 6;  ///< exception code

/// Executes one complete request (FrameOf returned kWhole) and returns the answer, which is never empty. A
/// write sets all of its registers or none.
[[nodiscard]] std::vector<std::uint8_t> AnswerModbus(std::span<const std::uint8_t> request,
                                                     const ModbusRegisters& registers);

}  // namespace osteon::hil
