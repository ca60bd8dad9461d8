#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "io/engine/codec.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/engine/engine_samples.h"

// Tests the codec of the messages between controller and simulation engine: commands, frames, and the set-up.

namespace osteon::io {
namespace {

using testing::HasSubstr;

// Encodes a message with the session 77 and the sequence number 5.
template <class Message>
EngineBytes Encoded(const Message& message, EngineMessage kind) {
  EngineBytes bytes;
  EncodeEngine({.kind = kind, .session = 77, .sequence = 5}, message, bytes);
  return bytes;
}
EngineBytes EncodedFrame(const EngineFrame& frame) { return Encoded(frame, EngineMessage::kFrame); }
EngineBytes EncodedCommand(const EngineCommand& command) { return Encoded(command, EngineMessage::kCommand); }

// Encodes each message, decodes it, and encodes the result again. Each field has a different value. So equal
// bytes prove that every field was encoded and decoded.
TEST(EngineCodec, FrameAndCommandAreDecodedBitForBit) {
  EngineHeader header;
  EngineFrame frame;
  const EngineBytes sent = EncodedFrame(test::SampleFrame());
  ASSERT_EQ(DecodeEngine(sent.view(), header, frame), EngineError::kNone);
  EXPECT_EQ(header.session, 77u);
  EXPECT_EQ(header.sequence, 5u);
  EXPECT_EQ(frame.model.contacts[1].stiffness_N_per_m,
            test::SampleFrame().model.contacts[1].stiffness_N_per_m);
  EXPECT_EQ(frame.model.balls_not_split, 7u);
  EXPECT_EQ(frame.duration_ns, 230'000);
  const EngineBytes again = EncodedFrame(frame);
  ASSERT_EQ(again.size, sent.size);
  EXPECT_EQ(std::memcmp(again.bytes.data(), sent.bytes.data(), sent.size), 0);

  EngineCommand command;
  const EngineBytes asked = EncodedCommand(test::SampleCommand());
  ASSERT_EQ(DecodeEngine(asked.view(), header, command), EngineError::kNone);
  EXPECT_EQ(command.command.stamp, 123'456'789);
  EXPECT_EQ(command.dt_s, 0.002);
  const EngineBytes asked_again = EncodedCommand(command);
  ASSERT_EQ(asked_again.size, asked.size);
  EXPECT_EQ(std::memcmp(asked_again.bytes.data(), asked.bytes.data(), asked.size), 0);
}

TEST(EngineCodec, TheLongestFrameFitsADatagram) {
  EngineFrame frame = test::SampleFrame();
  frame.model.contact_count = simulation::kMaxContacts;
  for (simulation::Contact& c : frame.model.contacts) c = frame.model.contacts[0];
  const EngineBytes bytes = EncodedFrame(frame);
  EXPECT_GT(bytes.size, 1000u);
  EXPECT_LE(bytes.size, kEngineMaxMessage);
}

TEST(EngineCodec, EachDamagedByteIsRefusedAndChangesNoOutput) {
  const EngineBytes sent = EncodedFrame(test::SampleFrame());
  for (std::size_t i = 0; i < sent.size; ++i) {
    EngineBytes bytes = sent;
    bytes.bytes[i] ^= 0x10;
    EngineHeader header;
    EngineFrame frame;
    ASSERT_NE(DecodeEngine(bytes.view(), header, frame), EngineError::kNone) << "byte " << i;
    ASSERT_EQ(frame.model.frame, 0u);
  }
}

TEST(EngineCodec, EachShorterOrLongerMessageIsRefused) {
  EngineBytes bytes = EncodedFrame(test::SampleFrame());
  EngineHeader header;
  EngineFrame frame;
  for (std::size_t size = 0; size < bytes.size; ++size)
    ASSERT_NE(DecodeEngine({bytes.bytes.data(), size}, header, frame), EngineError::kNone) << size;
  bytes.bytes[bytes.size++] = 0;
  EXPECT_EQ(DecodeEngine(bytes.view(), header, frame), EngineError::kWrongSize);
}

// Messages with a correct checksum, in which one value is not finite, too large, or outside its range. They
// must be refused.
TEST(EngineCodec, ValuesOutOfRangeAreRefused) {
  using Change = void (*)(EngineFrame&);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  static double bad;
  for (const double value : {nan, std::numeric_limits<double>::infinity(), 1e12}) {
    bad = value;
    for (const Change change : {Change{[](EngineFrame& f) { f.model.F_T_W.f.y = bad; }},
                                Change{[](EngineFrame& f) { f.model.contacts[1].gap_m = bad; }},
                                Change{[](EngineFrame& f) { f.model.X_WP.p.x = bad; }},
                                Change{[](EngineFrame& f) { f.model.X_WP.R[4] = bad; }}}) {
      EngineFrame frame = test::SampleFrame();
      change(frame);
      EngineHeader header;
      EXPECT_EQ(DecodeEngine(EncodedFrame(frame).view(), header, frame), EngineError::kOutOfRange) << value;
    }
  }
  for (const Change change : {Change{[](EngineFrame& f) { f.model.contact_count = -1; }},
                              Change{[](EngineFrame& f) { f.model.contact_count = 9; }},
                              Change{[](EngineFrame& f) { f.model.status = simulation::EngineStatus{4}; }},
                              Change{[](EngineFrame& f) { f.model.contacts[0].material = 8; }},
                              Change{[](EngineFrame& f) { f.model.contacts[0].stiffness_N_per_m = -1.0; }},
                              Change{[](EngineFrame& f) { f.model.pose_stamp = -1; }},
                              Change{[](EngineFrame& f) { f.model.X_WP.R[0] = -f.model.X_WP.R[0]; }}}) {
    EngineFrame frame = test::SampleFrame();
    change(frame);
    EngineHeader header;
    EXPECT_EQ(DecodeEngine(EncodedFrame(frame).view(), header, frame), EngineError::kOutOfRange);
  }
  EngineCommand command = test::SampleCommand();
  command.command.stamp = 0;
  EngineHeader header;
  EXPECT_EQ(DecodeEngine(EncodedCommand(command).view(), header, command), EngineError::kOutOfRange);
}

TEST(EngineCodec, OtherKindsAndVersionsAreRefused) {
  EngineHeader header;
  EngineFrame frame;
  EXPECT_EQ(DecodeEngine(EncodedCommand(test::SampleCommand()).view(), header, frame),
            EngineError::kWrongKind);
  EngineBytes other = EncodedFrame(test::SampleFrame());
  ++other.bytes[4];
  EXPECT_EQ(DecodeEngine(other.view(), header, frame), EngineError::kOtherVersion);
  EXPECT_THAT(Describe(EngineError::kOtherVersion), HasSubstr("another version"));
}

TEST(EngineCodec, DoesNotAllocate) {
  EngineFrame frame = test::SampleFrame();
  EngineBytes bytes;
  EngineHeader header;
  rt::CheckedNoAllocScope no_alloc;
  EncodeEngine({.kind = EngineMessage::kFrame}, frame, bytes);
  const EngineError error = DecodeEngine(bytes.view(), header, frame);
  no_alloc.End();
  EXPECT_EQ(error, EngineError::kNone);
}

TEST(EngineSetup, IsDecodedBitForBit) {
  const EngineSetup sent = test::SampleSetup();
  const std::vector<std::uint8_t> bytes = EncodeSetup(sent);
  const auto got = DecodeSetup(bytes);
  ASSERT_TRUE(got) << got.error();
  EXPECT_EQ(got->bone.balls.size(), sent.bone.balls.size());
  EXPECT_EQ(got->bone.points[3].p_m.x, sent.bone.points[3].p_m.x);
  EXPECT_EQ(got->tool.balls[0].radius_m, sent.tool.balls[0].radius_m);
  EXPECT_EQ(got->tool.balls[0].edges, 2);
  EXPECT_EQ(got->bone.materials[0].edge_force_N_per_m, 21e3);
  EXPECT_EQ(got->bone.materials[0].measured_chip_m, 48e-6);
  EXPECT_TRUE(got->cutting.edge_force);
  EXPECT_EQ(EncodeSetup(*got), bytes);
}

TEST(EngineSetup, DamagedAndTruncatedSetUpsAreRefused) {
  const std::vector<std::uint8_t> bytes = EncodeSetup(test::SampleSetup());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::uint8_t> bad = bytes;
    bad[i] ^= 0x20;
    ASSERT_FALSE(DecodeSetup(bad)) << "byte " << i;
    ASSERT_FALSE(DecodeSetup(std::span(bytes).first(i))) << "cut at " << i;
  }
}

TEST(EngineSetup, WrongValuesAreRefusedAndNamed) {
  EngineSetup setup = test::SampleSetup();
  setup.bone.points[2].material = 1;
  EXPECT_THAT(DecodeSetup(EncodeSetup(setup)).error(),
              HasSubstr("mass point's material: found 1, accepted 0 … 0"));
  setup = test::SampleSetup();
  setup.bone.balls[0].radius_m = std::nan("");
  EXPECT_THAT(DecodeSetup(EncodeSetup(setup)).error(), HasSubstr("ball's radius: found nan"));
  setup = test::SampleSetup();
  setup.tool.balls.clear();
  EXPECT_THAT(DecodeSetup(EncodeSetup(setup)).error(), HasSubstr("tool's balls: found 0"));
  setup = test::SampleSetup();
  setup.X_WG.R[0] = 0.5;
  EXPECT_THAT(DecodeSetup(EncodeSetup(setup)).error(), HasSubstr("no rotation"));
  setup = test::SampleSetup();
  setup.bone.materials[0].density_kg_per_m3 = 0.0;
  EXPECT_THAT(DecodeSetup(EncodeSetup(setup)).error(), HasSubstr("density"));
}

}  // namespace
}  // namespace osteon::io
