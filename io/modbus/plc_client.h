#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "base/latest_value.h"
#include "io/modbus/plc_reading.h"

namespace osteon::io {

/// The role of a client, which determines the registers that it writes.
enum class PlcRole : std::uint8_t {
  kController,  ///< CONTROLLER_HEARTBEAT and MOTION_REQUEST
  kGuard,       ///< GUARD_HEARTBEAT and GUARD_PERMITS
};

struct PlcClientParams {
  std::string address{"127.0.0.1"};  ///< IPv4 address in dotted notation
  std::uint16_t port{kPlcDefaultPort};
  PlcRole role{PlcRole::kController};
  int read_every_ms{10};        ///< 1 … 100
  int heartbeat_every_ms{50};   ///< 1 … 100; the PLC requires a heartbeat at least every 100 ms
  int response_timeout_ms{20};  ///< 1 … 1000; longest time until an answer is complete
  int connect_timeout_ms{200};  ///< 1 … 5000
  int first_pause_ms{50};       ///< pause after a failure; it doubles with each further failure
  int longest_pause_ms{2000};   ///< largest pause; >= first_pause_ms
};

/// Connection to the cell's PLC by Modbus TCP, with libmodbus in a separate thread. The tick never waits: it
/// uses the newest reading and its age.
///
/// Each cycle reads the block of registers 970 … 983. If VERSION is correct and the heartbeat is due, the
/// cycle also writes the heartbeat. There are three kinds of failures:
///
/// - An exception (e.g. 6, the PLC is busy) is a complete answer: the connection stays open, and the next
/// cycle repeats the request.
/// - After a time-out or a closed connection, the connection is closed and opened again at once, because on
/// the old connection later answers would belong to earlier requests. In the meantime the last reading stays
/// valid and grows older; the cell's `max_age_ms` limits its age. If the new connection is refused or silent
/// too, the reading becomes "not connected", and further attempts follow after pauses.
/// - After an answer that violates the protocol or contains an invalid value, the connection is closed. The
/// reading is then "not connected" until a block has been read.
///
/// The heartbeat shows that the loop is alive, not this thread: it is written only if NotifyAlive() was
/// called since the last write. The PLC therefore notices if the loop hangs.
class PlcClient {
 public:
  /// Starts at once. @throws std::invalid_argument if a parameter is out of range, naming it.
  explicit PlcClient(const PlcClientParams& params);
  ~PlcClient();
  PlcClient(const PlcClient&) = delete;
  PlcClient& operator=(const PlcClient&) = delete;

  /// The newest reading. Call from one reader thread only.
  [[nodiscard]] const PlcReading& Latest() OSTEON_RT { return published_.Load(); }

  /// The loop calls this in each tick to show that it is alive. May be called by any thread.
  void NotifyAlive() OSTEON_RT { beats_.fetch_add(1, std::memory_order_relaxed); }

  /// Sets MOTION_REQUEST (for a guard: GUARD_PERMITS), which is written with the next heartbeat. May be
  /// called by any thread.
  void RequestMotion(bool wanted) OSTEON_RT { motion_.store(wanted, std::memory_order_relaxed); }

  /// Ends the thread. May be called twice.
  void Stop();

 private:
  struct Connection;  // libmodbus' context
  enum class Answer {
    kWhole,      ///< a complete answer
    kException,  ///< the PLC refused the request: the connection stays open
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
  /// Counts a failed request, given its errno, and returns the kind of failure.
  Answer CountFailure(int error);
  void PublishDisconnected();
  /// Sleeps until the time `until`, or until Stop().
  void Pause(rt::Nanoseconds until);
  void Publish() { published_.Store(reading_); }

  PlcClientParams params_;
  PlcReading reading_;              // used by the thread only
  std::uint16_t heartbeat_{0};      // last value written to the heartbeat's register
  std::uint32_t beats_written_{0};  // value of beats_ at the last write
  rt::LatestValue<PlcReading> published_;
  std::atomic<std::uint32_t> beats_{0};  // number of calls of NotifyAlive
  std::atomic<bool> motion_{false}, stop_{false};
  std::thread thread_;
};

/// Returns one line for screens, e.g. "PLC 127.0.0.1:1502: no connection: Connection refused (3 attempts in
/// vain, …)". Not for use in the tick.
[[nodiscard]] std::string Describe(const PlcClientParams& params, const PlcReading& reading);
/// Returns one line for a verdict, e.g. "RUN_PERMITTED (974) is 0: Stop 1".
[[nodiscard]] const char* Describe(PlcVerdict verdict);

}  // namespace osteon::io
