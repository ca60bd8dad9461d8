#pragma once

#include <gtest/gtest.h>

#include "hil/fri/fri_server.h"
#include "tests/hil/test_client.h"

// Shared by the tests of the simulated arm's FRI server: a server and a client, cycle by cycle.

namespace osteon::hil {

/// The server of an arm that is always exactly at its command, and a client that answers when told to.
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
  /// Ends the cycle with or without the client's answer, and begins the next.
  /// @param had_its_time  whether the client had its full time to answer
  void Cycle(bool answer = true, bool had_its_time = true) {
    if (answer) server.Receive(client.Answer(message));
    server.EndCycle(had_its_time);
    Send();
  }
  /// Ends the cycle with these bytes as the answer, and begins the next.
  void Cycle(const Bytes& answer) {
    server.Receive(answer);
    server.EndCycle();
    Send();
  }
  /// Ends the cycle with this joint position as the answer, and begins the next.
  void Command(std::vector<double> q) {
    Cycle(hil::Command(++client.sequence, static_cast<std::uint32_t>(UintAt(message, {1, 2})), q));
  }
  /// Runs at most 2000 cycles with answers. @returns whether this state was reached
  bool WalkTo(control::SessionState state) {
    for (int i = 0; i < 2000 && server.state() != state; ++i) Cycle();
    return server.state() == state;
  }

  FriServer server;
  TestClient client;
  Bytes message;
  rt::Nanoseconds cycles{0};
};

/// The arm's start position, by joint [rad].
inline std::vector<double> Start() { return std::vector<double>(7, 0.5); }

}  // namespace osteon::hil
