#pragma once

#include <gtest/gtest.h>

#include "hil/fri/fri_server.h"
#include "tests/hil/test_client.h"

// Shared by the tests of the simulated arm's FRI server: a server and a client that run cycle by cycle.

namespace osteon::hil {

/// The server of an arm whose joints are always exactly at the command, and a client that answers when a test
/// tells it to.
struct Session {
  explicit Session(const FriServerParams& params = {},
                   const kinematics::JointVector& q_start = kinematics::JointVector::Constant(0.5))
      : server(params, kinematics::Iiwa14().limits, q_start) {
    server.Open();
    Send();
  }

  /// Begins a cycle: the server sends its next message.
  void Send() {
    const auto bytes = server.BeginCycle({.q = server.q_commanded()}, ++cycles * rt::kMillisecond);
    message.assign(bytes.begin(), bytes.end());
  }
  /// Ends the cycle, with the client's answer or without an answer, and begins the next cycle.
  /// @param had_its_time  whether the client had the full time to answer
  void Cycle(bool answer = true, bool had_its_time = true) {
    if (answer) server.Receive(client.Answer(message));
    server.EndCycle(had_its_time);
    Send();
  }
  /// Ends the cycle with these bytes as the answer, and begins the next cycle.
  void Cycle(const Bytes& answer) {
    server.Receive(answer);
    server.EndCycle();
    Send();
  }
  /// Ends the cycle with this joint position as the answer, and begins the next cycle.
  void Command(std::vector<double> q) {
    Cycle(hil::Command(++client.sequence, static_cast<std::uint32_t>(UintAt(message, {1, 2})), q));
  }
  /// Runs cycles with answers until the session has this state, at most 2000. @returns whether the state was
  /// reached
  bool WalkTo(control::SessionState state) {
    for (int i = 0; i < 2000 && server.state() != state; ++i) Cycle();
    return server.state() == state;
  }

  FriServer server;
  TestClient client;
  Bytes message;
  rt::Nanoseconds cycles{0};
};

/// The arm's start position [rad], one value for each joint.
inline std::vector<double> Start() { return std::vector<double>(7, 0.5); }

}  // namespace osteon::hil
