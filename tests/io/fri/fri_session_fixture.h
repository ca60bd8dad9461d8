#pragma once

#include <algorithm>

#include <gtest/gtest.h>

#include "io/fri/fri_session.h"
#include "tests/io/fri/fri_oracle.h"

namespace osteon::io {

/// A session that follows any first command, and libprotobuf as the arm.
class FriSessionTest : public ::testing::Test {
 protected:
  FriAccept Take(std::uint32_t sequence, fri::SessionState state = fri::MONITORING_READY) {
    return session_.Accept(test::Bytes(test::Monitoring(sequence, state)), ++now_, state_);
  }
  // The answer of a loop that knows the present activation, as the arm reads it.
  fri::FRICommandMessage Answer(const control::JointArray& q) {
    const auto bytes = session_.Answer(control::ArmCommand{.q = q, .activation = state_.activation});
    fri::FRICommandMessage answer;
    EXPECT_TRUE(answer.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    return answer;
  }
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
