#include "io/can/drive_fault_text.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/can/canopen.h"
#include "io/can/reamer_drive.h"

namespace osteon::io {
namespace {

struct CodeText {
  std::uint16_t code;
  const char* text;
};

// Error codes of CiA 402 (IEC 61800-7-201) and of CiA 301 (communication) that can occur with a tool's servo
// drive.
constexpr std::array kCodes{
    CodeText{0x2130, "short circuit at the input"},
    CodeText{0x2220, "continuous over-current inside the drive"},
    CodeText{0x2250, "short circuit inside the drive"},
    CodeText{0x2310, "continuous over-current of the motor"},
    CodeText{0x2320, "short circuit or earth leakage of the motor"},
    CodeText{0x2340, "short circuit of the motor"},
    CodeText{0x2350, "load level of the motor (I2t)"},
    CodeText{0x3110, "mains over-voltage"},
    CodeText{0x3120, "mains under-voltage"},
    CodeText{0x3210, "over-voltage of the DC link"},
    CodeText{0x3220, "under-voltage of the DC link"},
    CodeText{0x4110, "excess ambient temperature"},
    CodeText{0x4210, "excess temperature of the device"},
    CodeText{0x4310, "excess temperature of the drive"},
    CodeText{0x5112, "supply of 24 V"},
    CodeText{0x5114, "supply of 5 V"},
    CodeText{0x5441, "contact 1: safe torque off or enable input"},
    CodeText{0x5530, "non-volatile memory"},
    CodeText{0x6010, "software reset by the watchdog"},
    CodeText{0x6320, "parameter error"},
    CodeText{0x7110, "brake chopper"},
    CodeText{0x7121, "motor blocked"},
    CodeText{0x7122, "motor error or commutation malfunction"},
    CodeText{0x7300, "sensor of the motor"},
    CodeText{0x7303, "resolver 1 fault"},
    CodeText{0x7305, "incremental encoder 1 fault"},
    CodeText{0x7310, "speed: over-speed or its sensor"},
    CodeText{0x7500, "communication"},
    CodeText{0x8110, "CAN overrun: objects lost"},
    CodeText{0x8120, "CAN in error-passive mode"},
    CodeText{0x8130, "life guard or heartbeat error: the drive does not hear the controller"},
    CodeText{0x8140, "recovered from bus-off"},
    CodeText{0x8150, "collision of CAN identifiers"},
    CodeText{0x8210, "PDO not processed: its length"},
    CodeText{0x8220, "PDO longer than its mapping"},
    CodeText{0x8240, "unexpected length of SYNC"},
    CodeText{0x8250, "RPDO timeout"},
    CodeText{0x8331, "torque fault"},
    CodeText{0x8400, "velocity controller"},
    CodeText{0x8500, "position controller"},
    CodeText{0x8611, "following error"},
};

// Classes of emergency error codes of CiA 301. A class is given by the code's high byte, or by the first
// hexadecimal digit of it.
constexpr std::array kClasses{
    CodeText{0x20, "current"},
    CodeText{0x21, "current at the device's input"},
    CodeText{0x22, "current inside the device"},
    CodeText{0x23, "current at the device's output"},
    CodeText{0x30, "voltage"},
    CodeText{0x31, "mains voltage"},
    CodeText{0x32, "voltage inside the device"},
    CodeText{0x33, "output voltage"},
    CodeText{0x40, "temperature"},
    CodeText{0x41, "ambient temperature"},
    CodeText{0x42, "temperature of the device"},
    CodeText{0x50, "hardware of the device"},
    CodeText{0x60, "software of the device"},
    CodeText{0x61, "internal software"},
    CodeText{0x62, "user software"},
    CodeText{0x63, "data set"},
    CodeText{0x70, "additional modules"},
    CodeText{0x80, "monitoring"},
    CodeText{0x81, "communication"},
    CodeText{0x82, "protocol error"},
    CodeText{0x90, "external error"},
    CodeText{0xF0, "additional functions"},
    CodeText{0xFF, "the maker's own"},
};

// The text of a code in a table; null if the table does not have the code.
template <std::size_t N>
const char* FindText(const std::array<CodeText, N>& table, unsigned code) {
  const auto found = std::ranges::find_if(table, [&](const CodeText& row) { return row.code == code; });
  return found == table.end() ? nullptr : found->text;
}

// Text of an NMT state, with its number.
std::string NmtText(std::uint8_t state) {
  switch (static_cast<canopen::NmtState>(state)) {
    case canopen::NmtState::kBootUp:
      return "boot-up (0x00)";
    case canopen::NmtState::kStopped:
      return "stopped (0x04)";
    case canopen::NmtState::kOperational:
      return "operational (0x05)";
    case canopen::NmtState::kPreOperational:
      return "pre-operational (0x7F)";
    case canopen::NmtState::kUnknown:
      break;
  }
  return fmt::format("unknown (0x{:02X})", state);
}

std::string CodeWithText(std::uint16_t code) {
  return fmt::format("0x{:04X} ({})", code, DescribeErrorCode(code));
}

}  // namespace

const char* DescribeErrorCode(std::uint16_t code) {
  if (code == 0) return "no error";
  if (const char* text = FindText(kCodes, code)) return text;
  if (const char* text = FindText(kClasses, code >> 8u)) return text;
  if (const char* text = FindText(kClasses, code >> 8u & 0xF0u)) return text;
  return code >> 12u == 1u ? "generic error" : "of no class of CiA 301";
}

std::string DescribeDriveFaults(const DriveFaultReport& report) {
  std::string text;
  // appends one phrase
  const auto append_phrase = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  // appends a fault's text if the fault's bit is set
  const auto append_if_latched = [&](DriveFault fault, int bit, const std::string& what) {
    if ((report.faults & fault) != 0) append_phrase(fmt::format("{} (bit {})", what, bit));
  };
  append_if_latched(kDriveHeartbeatLost, 0, "heartbeat lost: none came in time");
  append_if_latched(kDriveStatusLost, 1, "status lost: its PDOs do not come any more");
  append_if_latched(kDriveEmergency, 2, "EMCY " + CodeWithText(report.emergency_code));
  append_if_latched(kDriveInFault, 3, "in fault by its statusword");
  append_if_latched(kDriveRestarted, 4, "boot-up message (NMT state 0x00): its configuration is gone");
  append_if_latched(kDriveLeftEnabled, 5, "left operation enabled by itself");
  append_if_latched(kDriveLeftOperational, 6,
                    "left OPERATIONAL: its heartbeat says " + NmtText(report.nmt_state));
  if ((report.faults & kDriveEmergency) == 0 && report.emergency_code != 0)
    append_phrase("last EMCY " + CodeWithText(report.emergency_code));
  if (report.error_code != 0) append_phrase("603F " + CodeWithText(report.error_code));
  return text;
}

}  // namespace osteon::io
