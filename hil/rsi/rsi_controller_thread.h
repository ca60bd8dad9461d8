#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

#include "control/rt/latest_value.h"
#include "control/rt/realtime_thread.h"
#include "hil/rsi/rsi_controller.h"
#include "hil/udp_client.h"

namespace osteon::hil {

struct RsiThreadParams {
  std::string server_address{"127.0.0.1"};  ///< dotted IPv4 of the PC; the loopback unless it is elsewhere
  std::uint16_t server_port{49152};         ///< where the PC listens
  rt::RealtimeThreadParams thread{.priority = 80};
};

/// What the thread did. Plain data.
struct RsiThreadStatistics {
  RsiControllerState controller;
  std::uint64_t overruns{0};     ///< cycles in which this thread itself woke more than half a cycle late
  std::uint64_t undelivered{0};  ///< messages that the system could not hand on, e.g. as nobody listens yet
  rt::RealtimeGrant thread;      ///< what the system granted it
};

/// The simulated KR in wall time: its own thread, RSI over a UDP socket, an absolute schedule of 4 or 12 ms.
/// Only the server's address is listened to. Where this thread itself woke late, its schedule begins anew;
/// the PC has had more than its cycle then.
class RsiControllerThread {
 public:
  /// Starts at once. @throws std::system_error where there is no socket, std::invalid_argument on address or
  /// port.
  RsiControllerThread(const RsiThreadParams& params, RsiController controller);
  ~RsiControllerThread();
  RsiControllerThread(const RsiControllerThread&) = delete;
  RsiControllerThread& operator=(const RsiControllerThread&) = delete;

  /// Ends the thread after its present cycle; the socket closes. Safe to call twice.
  void Stop();

  /// The newest state; one reader thread. Complete after Stop().
  [[nodiscard]] const RsiThreadStatistics& statistics() { return published_.Load(); }

 private:
  void Run();
  void ReceiveAll(RsiThreadStatistics& statistics);

  RsiThreadParams params_;
  RsiController controller_;
  UdpClient client_;
  rt::LatestValue<RsiThreadStatistics> published_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::hil
