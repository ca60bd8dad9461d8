#pragma once

#include <algorithm>

#include <gtest/gtest.h>

#include "io/fri/fri_session.h"
#include "tests/io/fri/fri_oracle.h"

namespace osteon::io {

/// A session whose first command may be any distance from the arm's pose; libprotobuf plays the arm.
class FriSessionTest : public ::testing::Test {
 protected:
  // Gives the session a message of the arm with this sequence number and state.
  FriAccept AcceptMessage(std::uint32_t sequence, fri::SessionState state = fri::MONITORING_READY) {
    return session_.Accept(test::Bytes(test::Monitoring(sequence, state)), ++now_, state_);
  }
  // The session's answer, as the arm reads it, when the loop commands q and names the present activation.
  fri::FRICommandMessage Answer(const control::JointArray& q) {
    const auto bytes = session_.Answer(control::ArmCommand{.q = q, .activation = state_.activation});
    fri::FRICommandMessage answer;
    EXPECT_TRUE(answer.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    return answer;
  }
  // The joint position in an answer.
  static control::JointArray Position(const fri::FRICommandMessage& answer) {
    control::JointArray q{};
    EXPECT_EQ(answer.commanddata().jointposition().value_size(), 7);
    std::copy(answer.commanddata().jointposition().value().begin(),
              answer.commanddata().jointposition().value().end(), q.begin());
    return q;
  }

  FriSession session_{{.entry_step_rad = 10.0}};
  control::ArmState state_;
  rt::Nanoseconds now_{1000};
};

}  // namespace osteon::io
