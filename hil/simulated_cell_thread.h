#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <thread>

#include "base/latest_value.h"
#include "base/realtime_thread.h"
#include "base/spsc_ring.h"
#include "hil/cell_wires.h"
#include "hil/simulated_cell.h"
#include "hil/udp_client.h"

namespace osteon::hil {

struct CellThreadParams {
  /// Client's IPv4 address in dotted notation.
  std::string client_address{"127.0.0.1"};
  std::uint16_t client_port{30200};  ///< port on which the client listens
  rt::RealtimeThreadParams thread{.priority = 80};
  InjectionParams injections{};              ///< only those of the arm's wire are used
  rt::SpscRing<CellState>* cycles{nullptr};  ///< ring to which the state of each cycle is pushed; null: none
};

/// Statistics of the thread. Plain data.
struct CellThreadStatistics {
  CellState cell;
  std::uint64_t overruns{0};  ///< cycles in which this thread woke more than half a period late
  rt::Nanoseconds worst_wakeup_ns{0};
  /// Messages that the system could not deliver, e.g. because the client does not listen yet.
  std::uint64_t undelivered{0};
  rt::RealtimeGrant thread;  ///< real-time properties that the system granted to the thread
  CellWireCounters wires;    ///< injected faults
};

/// The simulated cell in wall time. It has its own thread, communicates by FRI or RSI over a UDP socket, and
/// runs on an absolute schedule with the arm's period.
///
/// The arm determines the timing: it sends, sleeps until its next period and then reads the client's answers.
/// The socket is connected to the client's address, so the system drops datagrams of other senders.
///
/// **Late answers.** A missing answer counts as the client's loss only if this thread woke on time and the
/// client had a whole period after the message. If the message left late within its period, the thread waits
/// that much longer for a missing answer. If the thread wakes more than half a period late, it counts an
/// overrun of its own, excuses a missing answer, and restarts its schedule instead of sending the missed
/// cycles in a burst.
///
/// **Injections** act on the datagrams that this thread sends and receives. The thread wakes when a datagram
/// is due, so delays below a period are accurate. Losses that the injections cause count as the client's.
class SimulatedCellThread {
 public:
  /// Starts at once. @throws std::system_error if there is no socket, std::invalid_argument on the address,
  /// the port or an injection.
  SimulatedCellThread(const CellThreadParams& params, SimulatedCell cell);
  ~SimulatedCellThread();
  SimulatedCellThread(const SimulatedCellThread&) = delete;
  SimulatedCellThread& operator=(const SimulatedCellThread&) = delete;

  /// Ends the thread after its present period, or after the messages with which the arm ends its session
  /// (SessionEnd). Closes the socket. May be called twice.
  void Stop();

  /// Returns the newest load on the force sensor. Call from one reader thread only.
  [[nodiscard]] control::ForceReading Load() { return loads_.Load(); }

  /// Whether COMMANDING_ACTIVE was reached. May be called by any thread.
  [[nodiscard]] bool commanded() const { return commanded_.load(std::memory_order_relaxed); }

  /// See SimulatedCell. May be called by any thread; takes effect in the next period.
  void SetPower(bool on) { power_.store(on, std::memory_order_relaxed); }

  /// Returns the newest statistics. Call from one reader thread only (not necessarily that of Load()). Final
  /// after Stop().
  [[nodiscard]] const CellThreadStatistics& statistics() { return published_.Load(); }

  /// Local port from which the thread sends.
  [[nodiscard]] std::uint16_t port() const { return client_.port(); }

 private:
  void Run();  // the arm's thread
  void WaitUntil(rt::Nanoseconds target, CellThreadStatistics& statistics);
  bool ReceiveAll(CellThreadStatistics& statistics);
  void MoveDue(rt::Nanoseconds now, CellThreadStatistics& statistics);

  CellThreadParams params_;
  SimulatedCell cell_;
  CellWires wires_;
  bool answered_{false};  // whether the client has answered the message last sent
  UdpClient client_;
  rt::LatestValue<control::ForceReading> loads_;
  std::atomic<bool> power_{true}, commanded_{false};
  rt::LatestValue<CellThreadStatistics> published_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::hil
