#include <map>

#include <gtest/gtest.h>

#include "io/fri/codec.h"
#include "tests/io/fri/fri_expected.h"
#include "tests/io/fri/fri_oracle.h"
#include "tests/io/fri/fri_wire_tree.h"

// The codec and libprotobuf read the same messages, which were changed at random. Both must accept or refuse
// the same messages, for the same reason, and must read the same values. fri_expected.h implements the
// codec's rules a second time. fri_wide_oracle.h lists the cases in which libprotobuf accepts more than the
// codec.

namespace osteon::io {
namespace {

constexpr unsigned kSeed = 20240901;
constexpr std::array kFamilies{FriFamily::k1, FriFamily::k2_5, FriFamily::k2_7};

// A message with every field that its version has. Repeated fields have two elements.
fri::FRIMonitoringMessage FullMessage(std::uint32_t sequence, fri::SessionState state, FriFamily family) {
  fri::FRIMonitoringMessage m = test::Monitoring(sequence, state, family);
  for (const char* name : {"Drill.On", "Pump.Flow"}) {
    auto* io = m.mutable_monitordata()->add_readiorequest();
    io->set_name(name);
    io->set_type(fri::DIGITAL);
    io->set_direction(fri::OUTPUT);
    io->set_digitalvalue(sequence);
    io->set_analogvalue(0.5);
    auto* frame = m.add_requestedtransformations();
    if (family == FriFamily::k1) {
      frame->set_name(name);
      for (const double x : {0., -1., 0., 1., 0., 0., -1., 2., 1., 0., 0., 3.}) frame->add_element(x);
    } else {
      test::PutPose(frame);
    }
    frame->mutable_timestamp()->set_sec(sequence);
    frame->mutable_timestamp()->set_nanosec(7);
  }
  m.mutable_endofmessagedata()->set_messagelength(400);
  m.mutable_endofmessagedata()->mutable_messagechecksum()->set_crc32(-1);
  return m;
}

// Whether the bytes may contain a tag of more than 32 bits or a varint of more than 64 bits. libprotobuf
// truncates such numbers.
bool MayHaveCutNumber(std::span<const std::uint8_t> bytes) {
  int high = 0;
  for (const std::uint8_t byte : bytes) {
    if ((high >= 4 && byte > 0x0f) || (high >= 9 && byte > 1)) return true;
    high = byte >= 0x80 ? high + 1 : 0;
  }
  return false;
}

class FriDifferential : public testing::Test {
 protected:
  // Decodes a message with the codec and with libprotobuf. Expects equal errors and equal values.
  // @param inside  the message without the frame of 2.7 @returns the codec's error
  CodecError Compare(FriFamily family, const std::vector<std::uint8_t>& inside) {
    const auto datagram = family == FriFamily::k2_7 ? test::Framed(inside) : inside;
    const test::Expected expected(family, inside, oracle_);
    MonitoringMessage m;
    const CodecError error = DecodeMonitoring(family, datagram, m);
    if (datagram.size() > kFriMaxDatagram) {
      EXPECT_EQ(error, CodecError::kTooLong);
      return error;
    }
    // The codec has refused a number that libprotobuf has truncated. Compare the results for the message as
    // libprotobuf writes it.
    if (error == CodecError::kMalformed && error != expected.error() && MayHaveCutNumber(inside)) {
      ++cut_numbers_;
      return DecodeAsRewritten(family, expected);
    }
    EXPECT_EQ(error, expected.error()) << Describe(error) << "; expected: " << Describe(expected.error());
    if (error == CodecError::kNone && expected.error() == CodecError::kNone) {
      EXPECT_EQ(expected.Difference(m), "");
    }
    return error;
  }

  // Decodes the message as libprotobuf writes it again, with the truncated number. Expects the error that
  // follows from the rules.
  CodecError DecodeAsRewritten(FriFamily family, const test::Expected& expected) {
    const auto rewritten = expected.Rewritten();
    MonitoringMessage m;
    const auto datagram = family == FriFamily::k2_7 ? test::Framed(rewritten) : rewritten;
    EXPECT_EQ(DecodeMonitoring(family, datagram, m), expected.error());
    return CodecError::kMalformed;
  }

  test::WideOracle oracle_;
  test::TreeMutator random_{kSeed};
  int cut_numbers_{0};
};

TEST_F(FriDifferential, UnchangedMessagesAreReadAlike) {
  for (const FriFamily family : kFamilies)
    EXPECT_EQ(Compare(family, test::Bytes(FullMessage(8, fri::COMMANDING_ACTIVE, family))),
              CodecError::kNone);
}

TEST_F(FriDifferential, ChangedFieldsAreReadAlike) {
  SCOPED_TRACE(kSeed);
  std::map<CodecError, int> verdicts;
  for (int i = 0; i < 20'000 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const FriFamily family = kFamilies[random_.Below(3)];
    const auto state = static_cast<fri::SessionState>(random_.Below(5));
    const FriFamily arm = random_.Below(20) == 0 ? kFamilies[random_.Below(3)] : family;
    auto tree = test::ReadTree(test::Bytes(FullMessage(static_cast<std::uint32_t>(i), state, arm)));
    ASSERT_TRUE(tree);
    for (std::size_t changes = 1 + random_.Below(4); changes > 0; --changes) random_.Change(*tree);
    ++verdicts[Compare(family, test::WriteTree(*tree))];
  }
  EXPECT_LT(cut_numbers_, 100);
  // each error must have occurred, and success as well
  for (const CodecError error :
       {CodecError::kNone, CodecError::kMalformed, CodecError::kWrongId, CodecError::kMissingField,
        CodecError::kWrongCount, CodecError::kNotFinite, CodecError::kOutOfRange, CodecError::kOtherVersion})
    EXPECT_GT(verdicts[error], 20) << Describe(error);
}

TEST_F(FriDifferential, ChangedBytesAreReadAlike) {
  SCOPED_TRACE(kSeed);
  int accepted = 0;
  for (int i = 0; i < 20'000 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const FriFamily family = kFamilies[random_.Below(3)];
    const auto state = static_cast<fri::SessionState>(random_.Below(5));
    auto bytes = test::Bytes(FullMessage(static_cast<std::uint32_t>(i), state, family));
    for (std::size_t changes = 1 + random_.Below(2); changes > 0; --changes) {
      auto& byte = bytes[random_.Below(bytes.size())];
      byte = random_.Below(2) ? static_cast<std::uint8_t>(byte ^ 1u << random_.Below(8))
                              : static_cast<std::uint8_t>(random_.Below(256));
    }
    if (random_.Below(8) == 0) bytes.resize(random_.Below(bytes.size()));
    accepted += Compare(family, bytes) == CodecError::kNone;
  }
  EXPECT_LT(cut_numbers_, 100);
  EXPECT_GT(accepted, 5'000) << "most doubles, names and stamps may change";
}

// Each case is one rule of protobuf's wire format. Real arms do not send these bytes.
TEST_F(FriDifferential, CodecFollowsEachRuleOfTheWireFormat) {
  using Bytes = std::vector<std::uint8_t>;
  const Bytes whole = test::Bytes(test::Monitoring(300, fri::MONITORING_READY));
  // the error for a valid message with these bytes appended
  const auto with = [&](const Bytes& more) {
    Bytes bytes = whole;
    bytes.insert(bytes.end(), more.begin(), more.end());
    return Compare(FriFamily::k1, bytes);
  };
  constexpr CodecError kNone = CodecError::kNone, kMalformed = CodecError::kMalformed;
  const auto sequence_of = [](const Bytes& bytes) {
    MonitoringMessage m;
    EXPECT_EQ(DecodeMonitoring(FriFamily::k1, bytes, m), CodecError::kNone);
    return m.sequence;
  };

  // if a field occurs twice, its last value counts; if a nested message occurs twice, both are merged
  Bytes again = whole;
  again.insert(again.end(), {0x0a, 0x02, 0x10, 0x05});
  EXPECT_EQ(sequence_of(again), 5u);
  EXPECT_EQ(with({0x0a, 0x02, 0x10, 0x05}), kNone);
  EXPECT_EQ(with({0x22, 0x02, 0x18, 0x0a}), kNone) << "a period alone, of a connection that is whole";
  EXPECT_EQ(Compare(FriFamily::k1, {0x0a, 0x04, 0x08, 0x01, 0x10, 0x02, 0x0a, 0x02, 0x18, 0x03}),
            CodecError::kWrongId)
      << "a header in two parts is one";
  EXPECT_EQ(Compare(FriFamily::k1, {0x0a, 0x04, 0x08, 0x01, 0x10, 0x02}), kMalformed) << "and in one is none";

  // unknown fields of every type must be skipped; groups must be refused
  EXPECT_EQ(with({0x80, 0x01, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}), kNone);
  EXPECT_EQ(with({0x81, 0x01, 1, 2, 3, 4, 5, 6, 7, 8}), kNone);
  EXPECT_EQ(with({0x82, 0x01, 0x02, 1, 2}), kNone);
  EXPECT_EQ(with({0x85, 0x01, 1, 2, 3, 4}), kNone);
  EXPECT_EQ(with({0x83, 0x01, 0x84, 0x01}), kMalformed) << "a group";
  EXPECT_EQ(with({0x84, 0x01}), kMalformed) << "its end";
  EXPECT_EQ(with({0x86, 0x01}), kMalformed) << "no wire type";

  // refused are: field 0, a varint of eleven bytes, a varint of 65 bits, and a tag and a length of six bytes
  EXPECT_EQ(with({0x00, 0x00}), kMalformed);
  EXPECT_EQ(with({0x02, 0x00}), kMalformed);
  EXPECT_EQ(with({0x80, 0x01, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x00}), kMalformed);
  EXPECT_EQ(with({0x80, 0x01, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x02}), kMalformed);
  EXPECT_EQ(with({0x80, 0x81, 0x80, 0x80, 0x80, 0x00, 0x00}), kMalformed);
  EXPECT_EQ(with({0x82, 0x01, 0x80, 0x80, 0x80, 0x80, 0x80, 0x00}), kMalformed);

  // the message ends within a field, in each possible way
  for (const Bytes& cut :
       {Bytes{0x80}, Bytes{0x80, 0x01}, Bytes{0x80, 0x01, 0x80}, Bytes{0x81, 0x01, 1, 2, 3, 4, 5, 6, 7},
        Bytes{0x82, 0x01}, Bytes{0x82, 0x01, 0x02, 1}, Bytes{0x85, 0x01, 1, 2, 3},
        Bytes{0x82, 0x01, 0xff, 0xff, 0xff, 0xff, 0x0f}})
    EXPECT_EQ(with(cut), kMalformed);

  // refused are: known fields of a wrong type, and numbers of more than 32 bits
  EXPECT_EQ(with({0x0d, 1, 2, 3, 4}), kMalformed) << "a header of four bytes";
  EXPECT_EQ(with({0x0a, 0x05, 0x15, 1, 2, 3, 4}), kMalformed) << "a counter of four bytes";
  EXPECT_EQ(with({0x0a, 0x06, 0x10, 0xff, 0xff, 0xff, 0xff, 0x0f}), kNone) << "the largest counter";
  EXPECT_EQ(with({0x0a, 0x06, 0x10, 0x80, 0x80, 0x80, 0x80, 0x10}), kMalformed) << "and one more";
  EXPECT_EQ(with({0x12, 0x06, 0x08, 0x87, 0x80, 0x80, 0x80, 0x10}), kNone) << "7 joints, by the low 32 bits";
  const Bytes minus_one{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01};
  Bytes safety{0x12, 0x0b, 0x10};
  safety.insert(safety.end(), minus_one.begin(), minus_one.end());
  EXPECT_EQ(with(safety), CodecError::kOutOfRange) << "a negative enum";
  EXPECT_EQ(with({0x12, 0x06, 0x10, 0x80, 0x80, 0x80, 0x80, 0x10}), kMalformed) << "an enum beyond 32 bits";

  // the drive states are packed, missing, or one too many
  EXPECT_EQ(with({0x12, 0x02, 0x2a, 0x00}), kNone);
  EXPECT_EQ(with({0x12, 0x02, 0x28, 0x02}), kMalformed) << "an eighth";
  EXPECT_EQ(with({0x12, 0x03, 0x2a, 0x01, 0x02}), kMalformed) << "an eighth, packed";
  EXPECT_EQ(with({0x12, 0x03, 0x2a, 0x01, 0x80}), kMalformed) << "cut within";
}

}  // namespace
}  // namespace osteon::io
