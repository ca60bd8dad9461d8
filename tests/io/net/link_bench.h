#pragma once

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "control/ports.h"
#include "tests/base/checked_no_alloc_scope.h"

// Helpers and checks that the tests of all arms' UDP links share.

namespace osteon::io::test {

/// Deadline of a wait that must succeed.
inline rt::Nanoseconds Soon() { return rt::MonotonicNow() + 2 * rt::kSecond; }

/// A link on the loopback, at a port that the system chooses.
template <class Link>
std::unique_ptr<Link> OpenOnAnyPort() {
  auto link = Link::Open({.port = 0});
  EXPECT_TRUE(link) << link.error();
  return std::move(*link);
}

/// Expects that Open() refuses a port in use, an invalid address, and an address of another machine, and
/// names the reason. @param who  name of the protocol in the errors
template <class Link, class Params>
void ExpectAddressErrors(const std::string& who) {
  const auto expect = [](const Params& params, const std::string& text) {
    const auto link = Link::Open(params);
    ASSERT_FALSE(link);
    EXPECT_NE(link.error().find(text), std::string::npos) << link.error();
  };
  const auto first = OpenOnAnyPort<Link>();
  expect({.port = first->port()}, who + ": UDP 127.0.0.1:" + std::to_string(first->port()) + " is taken");
  expect({.bind_address = "localhost", .port = 0}, "'localhost' is not an IPv4 address");
  expect({.bind_address = "192.0.2.1", .port = 0},  // TEST-NET-1: unused
         "no network card with that address");
}

/// Receives the waiting message and answers it; expects no allocation and no lock.
inline void ExpectNoAllocation(control::ArmLink& link) {
  control::ArmState state;
  rt::CheckedNoAllocScope no_alloc;
  const control::ReceiveResult received = link.Receive(state, Soon());
  const bool sent = link.Send(control::ArmCommand{.q = state.q_ipo});
  no_alloc.End();
  EXPECT_EQ(received, control::ReceiveResult::kOk);
  EXPECT_TRUE(sent);
}

}  // namespace osteon::io::test
