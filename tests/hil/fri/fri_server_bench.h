#pragma once

#include <gtest/gtest.h>

#include "hil/fri/fri_server.h"
#include "tests/hil/test_client.h"

namespace osteon::hil {

/// An arm that is exactly at its command, and a client that answers when asked to.
struct Session {
  explicit Session(const FriServerParams& params = {},
                   const kinematics::JointVector& q_start = kinematics::JointVector::Constant(0.5))
      : server(params, kinematics::Iiwa14().limits, q_start) {
    server.Open();
    Send();
  }

  void Send() {
    const auto bytes = server.BeginCycle({.q = server.q_commanded()}, ++cycles * rt::kMillisecond);
    message.assign(bytes.begin(), bytes.end());
  }
  void Cycle(bool answer = true, bool had_its_time = true) {
    if (answer) server.Receive(client.Answer(message));
    server.EndCycle(had_its_time);
    Send();
  }
  void Cycle(const Bytes& answer) {
    server.Receive(answer);
    server.EndCycle();
    Send();
  }
  // Sends this joint position as the answer to the present message.
  void Command(std::vector<double> q) {
    Cycle(hil::Command(++client.sequence, static_cast<std::uint32_t>(UintAt(message, {1, 2})), q));
  }
  bool WalkTo(control::SessionState state) {
    for (int i = 0; i < 2000 && server.state() != state; ++i) Cycle();
    return server.state() == state;
  }

  FriServer server;
  TestClient client;
  Bytes message;
  rt::Nanoseconds cycles{0};
};

inline std::vector<double> Start() { return std::vector<double>(7, 0.5); }

}  // namespace osteon::hil
