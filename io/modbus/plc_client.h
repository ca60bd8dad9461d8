#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "base/latest_value.h"
#include "io/modbus/plc_reading.h"

namespace osteon::io {

/// The registers that a client writes.
enum class PlcRole : std::uint8_t {
  kController,  ///< CONTROLLER_HEARTBEAT and MOTION_REQUEST
  kGuard,       ///< GUARD_HEARTBEAT and GUARD_PERMITS
};

struct PlcClientParams {
  std::string address{"127.0.0.1"};  ///< dotted IPv4
  std::uint16_t port{kPlcDefaultPort};
  PlcRole role{PlcRole::kController};
  int read_every_ms{10};        ///< 1 … 100
  int heartbeat_every_ms{50};   ///< 1 … 100, the PLC's limit
  int response_timeout_ms{20};  ///< 1 … 1000: for a whole answer
  int connect_timeout_ms{200};  ///< 1 … 5000
  int first_pause_ms{50};       ///< after a failure; doubles with each further failure
  int longest_pause_ms{2000};   ///< >= first_pause_ms
};

/// Modbus TCP to the cell's PLC, by libmodbus in a thread of its own. The tick never waits: it takes the
/// newest reading with its age.
///
/// Each cycle reads the block 970 … 983; if VERSION is right, the heartbeat follows when it is due. Failures
/// are distinguished:
///
/// - An exception (e.g. 6, the PLC is busy) is a complete answer: the connection stays, and the next cycle
///   asks again.
/// - A time-out or a closed connection ends the connection, since later answers would belong to earlier
///   requests. It is opened again at once. The reading stays meanwhile and grows older: the cell's
///   `max_age_ms` limits its age. If the new connection is refused or silent as well, the reading becomes
///   "not connected", and further attempts come after pauses.
/// - An answer that violates the protocol or a value that does not exist ends the connection, and the reading
///   is "not connected" from then until a block has been read.
///
/// The heartbeat is the loop's, not this thread's: it is written only if NotifyAlive() was called since the
/// last write. So the PLC notices a loop that hangs.
class PlcClient {
 public:
  /// Starts at once. @throws std::invalid_argument if a parameter is out of range, naming it.
  explicit PlcClient(const PlcClientParams& params);
  ~PlcClient();
  PlcClient(const PlcClient&) = delete;
  PlcClient& operator=(const PlcClient&) = delete;

  /// Call from one reader thread.
  [[nodiscard]] const PlcReading& Latest() OSTEON_RT { return published_.Load(); }

  /// Called by the loop each tick to show that it is alive. Any thread.
  void NotifyAlive() OSTEON_RT { beats_.fetch_add(1, std::memory_order_relaxed); }

  /// Sets MOTION_REQUEST (GUARD_PERMITS for a guard), written with the next heartbeat. Any thread.
  void RequestMotion(bool wanted) OSTEON_RT { motion_.store(wanted, std::memory_order_relaxed); }

  /// Ends the thread. Safe to call twice.
  void Stop();

 private:
  struct Connection;  // libmodbus' context
  enum class Answer {
    kWhole,      ///< a complete answer
    kException,  ///< refused: the connection stays
    kNone,       ///< no answer in time: the connection ends
    kNonsense,   ///< invalid: the connection ends, and the reading becomes "not connected"
  };

  void Run();
  bool Connect(Connection& connection);
  /// Reads blocks and writes heartbeats until the connection ends. @returns whether a block was read before
  /// the connection ended
  bool ServeConnection(Connection& connection);
  Answer ReadBlock(Connection& connection);
  Answer WriteHeartbeat(Connection& connection);
  /// Counts a failed request by its errno, and says what follows.
  Answer CountFailure(int error);
  void PublishDisconnected();
  /// Sleeps until the time, or until Stop().
  void Pause(rt::Nanoseconds until);
  void Publish() { published_.Store(reading_); }

  PlcClientParams params_;
  PlcReading reading_;              // the thread's
  std::uint16_t heartbeat_{0};      // the register's last value
  std::uint32_t beats_written_{0};  // beats_ at the last write
  rt::LatestValue<PlcReading> published_;
  std::atomic<std::uint32_t> beats_{0};  // calls of NotifyAlive
  std::atomic<bool> motion_{false}, stop_{false};
  std::thread thread_;
};

/// One line for screens, e.g. "PLC 127.0.0.1:1502: no connection: Connection refused (3 attempts in
/// vain, …)". Not for the tick.
[[nodiscard]] std::string Describe(const PlcClientParams& params, const PlcReading& reading);
/// One line for a verdict: "RUN_PERMITTED (974) is 0: Stop 1".
[[nodiscard]] const char* Describe(PlcVerdict verdict);

}  // namespace osteon::io
