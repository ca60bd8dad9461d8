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
  std::string client_address{
      "127.0.0.1"};                  ///< dotted IPv4; the loopback unless the client is on another machine
  std::uint16_t client_port{30200};  ///< where the client listens
  rt::RealtimeThreadParams thread{.priority = 80};
  InjectionParams injections{};              ///< only those of the arm's wire are used
  rt::SpscRing<CellState>* cycles{nullptr};  ///< each cycle is pushed there; null: nowhere
};

/// Statistics of the thread. Plain data.
struct CellThreadStatistics {
  CellState cell;
  std::uint64_t overruns{0};  ///< cycles in which this thread itself woke more than half a period late
  rt::Nanoseconds worst_wakeup_ns{0};
  std::uint64_t undelivered{0};  ///< messages that the system could not deliver, e.g. because nobody listens
                                 ///< yet
  rt::RealtimeGrant thread;      ///< what the system granted it
  CellWireCounters wires;        ///< injected faults
};

/// The simulated cell in wall time: its own thread, FRI or RSI over a UDP socket, an absolute
/// schedule of the arm's period.
///
/// The arm is the clock: it sends, sleeps until its next period and then reads the client's answers. Only the
/// client's address is heard (the socket is connected to it; the system drops the rest).
///
/// **Who was late.** A cycle counts against the client only if this thread woke on time and the client had a
/// whole period from the message on. If the message left late within its period, the thread waits that much
/// longer for a missing answer. If the thread wakes more than half a period late, it counts an overrun of its
/// own, excuses a missing answer, and restarts its schedule instead of sending the missed cycles in a burst.
///
/// **Injections** act on the datagrams as they leave and arrive here. The thread wakes when one is due, so
/// delays below a period are accurate. Their effects count against the client.
class SimulatedCellThread {
 public:
  /// Starts at once. @throws std::system_error if there is no socket, std::invalid_argument on the address,
  /// the port or an injection.
  SimulatedCellThread(const CellThreadParams& params, SimulatedCell cell);
  ~SimulatedCellThread();
  SimulatedCellThread(const SimulatedCellThread&) = delete;
  SimulatedCellThread& operator=(const SimulatedCellThread&) = delete;

  /// Ends the thread after its present period, or after the messages with which the arm ends its session
  /// (SessionEnd); the socket closes. Safe to call twice.
  void Stop();

  /// The newest load on the force sensor; one reader thread.
  [[nodiscard]] control::ForceReading Load() { return loads_.Load(); }

  /// COMMANDING_ACTIVE was reached. Any thread.
  [[nodiscard]] bool commanded() const { return commanded_.load(std::memory_order_relaxed); }

  /// See SimulatedCell. Any thread; takes effect with the next period.
  void SetPower(bool on) { power_.store(on, std::memory_order_relaxed); }

  /// The newest state; one reader thread (not necessarily the sensor's). Complete after Stop().
  [[nodiscard]] const CellThreadStatistics& statistics() { return published_.Load(); }

  /// The port that this side sends from.
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
