#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "io/can/udp_can_codec.h"
#include "io/engine/codec.h"
#include "tests/fuzz/corpus_folder.h"
#include "tests/io/engine/engine_samples.h"
#include "tests/io/fri/fri_oracle.h"
#include "tests/io/rsi/rsi_oracle.h"

// The program osteon_fuzz_corpus FOLDER writes the seeds of the fuzz targets (tests/fuzz/corpus) from the
// samples in the tests of io. The files of the targets define the layout of the bytes.

namespace osteon {
namespace {

constexpr std::array kFamilies{io::FriFamily::k1, io::FriFamily::k2_5, io::FriFamily::k2_7};

// Encodes one step for the targets fri_session and rsi: operation, size, datagram.
Bytes EncodedStep(unsigned op, const Bytes& datagram) {
  Bytes step{static_cast<std::uint8_t>(op), static_cast<std::uint8_t>(datagram.size()),
             static_cast<std::uint8_t>(datagram.size() >> 8)};
  Append(step, datagram);
  return step;
}

// ---- FRI

// A monitoring message with all its fields.
fri::FRIMonitoringMessage FullMonitoringWithStamp(std::uint32_t sequence, fri::SessionState state,
                                                  io::FriFamily family) {
  fri::FRIMonitoringMessage m = io::test::FullMonitoring(sequence, state, family);
  m.mutable_header()->set_reflectedsequencecounter(sequence - 1);
  auto* stamp = m.mutable_requestedtransformations(0)->mutable_timestamp();
  stamp->set_sec(5);
  stamp->set_nanosec(6);
  return m;
}

void WriteFri(const std::filesystem::path& root) {
  const Corpus decode(root, "fri_decode"), session(root, "fri_session");
  const std::array versions{std::uint8_t{4}, std::uint8_t{6},
                            std::uint8_t{7}};  // bytes that select the versions 1.15, 2.5, 2.7
  for (std::size_t f = 0; f < kFamilies.size(); ++f) {
    const std::string name = std::to_string(f);
    Bytes one{static_cast<std::uint8_t>(f == 2 ? 2 | 4 : f)};
    Append(one, io::test::Bytes(FullMonitoringWithStamp(8, fri::COMMANDING_ACTIVE, kFamilies[f])));
    decode.Write("commanding_" + name, one);
    one.resize(1);
    Append(one, io::test::Bytes(io::test::Monitoring(8, fri::MONITORING_READY, kFamilies[f])));
    decode.Write("monitoring_" + name, one);

    // a whole session from IDLE to IDLE, with commands of each kind (see Op in targets/fri_session.cpp)
    Bytes all{versions[f]};
    const struct {
      fri::SessionState state;
      unsigned op;
    } steps[]{{fri::IDLE, 0},
              {fri::MONITORING_WAIT, 0},
              {fri::MONITORING_READY, 1u << 4},
              {fri::COMMANDING_WAIT, 0},
              {fri::COMMANDING_ACTIVE, 1u << 3},
              {fri::COMMANDING_ACTIVE, 0},
              {fri::COMMANDING_ACTIVE, 1u << 3 | 1u << 0},
              {fri::COMMANDING_ACTIVE, 1u << 1},
              {fri::COMMANDING_ACTIVE, 1u << 2},
              {fri::MONITORING_READY, 1u << 6},
              {fri::COMMANDING_ACTIVE, 1u << 0},
              {fri::IDLE, 0}};
    std::uint32_t sequence = 0;
    for (const auto& step : steps) {
      auto message = FullMonitoringWithStamp(++sequence, step.state, kFamilies[f]);
      message.mutable_ipodata()->set_clientcommandmode(f == 1 ? fri::WRENCH : fri::TORQUE);
      Append(all, EncodedStep(step.op, io::test::Bytes(message)));
    }
    session.Write("session_" + name, all);
  }
}

// ---- RSI

void WriteRsi(const std::filesystem::path& root) {
  const Corpus corpus(root, "rsi");
  for (const unsigned setup :
       {0u, 8u, 9u, 10u, 12u}) {  // in all set-ups but the first, the arm may move after one message
    Bytes all{static_cast<std::uint8_t>(setup)};
    const unsigned count = setup == 0 ? 12 : 6;
    for (unsigned i = 0; i < count; ++i) {
      std::string text = io::test::kShortRobot;
      text.replace(text.find("0000012345"), 10, std::to_string(4'000'000'000u + 4 * i));
      Append(all, EncodedStep(i + 2 == count ? 4u : i + 1 == count ? 2u : i % 2, io::test::Bytes(text)));
    }
    corpus.Write("session_" + std::to_string(setup), all);
  }
  Bytes full{0};
  Append(full, EncodedStep(1, io::test::Bytes(io::test::kFullRobot)));
  Append(full,
         EncodedStep(0, io::test::Bytes(
                            "<?xml version='1.0'?><!-- c --><Rob Type='KUKA'> <IPOC> 7 </IPOC></Rob>\n")));
  corpus.Write("elements", full);
}

// ---- CAN

// Encodes one step for the target can: the index of the device's id, and the bytes of the frame.
void AppendFrame(Bytes& to, unsigned op, const Bytes& data) {
  to.push_back(static_cast<std::uint8_t>(op));
  to.push_back(static_cast<std::uint8_t>(data.size()));
  Append(to, data);
}

// The bytes, padded with zeros to the 8 bytes of a CAN frame.
Bytes PaddedToEight(Bytes bytes) {
  bytes.resize(8);
  return bytes;
}

void WriteCan(const std::filesystem::path& root) {
  const Corpus corpus(root, "can");
  constexpr unsigned kLater = 1u << 5;  // 10 ms pass before the frame

  Bytes robotous{0};
  for (int i = 0; i < 3; ++i) AppendFrame(robotous, 2 | kLater, {});  // lets time pass
  for (const Bytes& answer : {Bytes{0x08, 1}, Bytes{0x09, 0}, Bytes{0x0F, 1}, Bytes{0x10, 8}}) {
    AppendFrame(robotous, 0, PaddedToEight(answer));
    AppendFrame(robotous, 1, PaddedToEight({}));
  }
  for (int i = 0; i < 12; ++i) {
    AppendFrame(robotous, 0, {0x0B, 0, 100, 0xFF, 0x9C, 0x7F, 0xFF, 0x80});
    AppendFrame(robotous, 1, {0, 7, 0xD0, 0xF8, 0x30, static_cast<std::uint8_t>(i == 11 ? 1 : 0), 0, 0});
  }
  corpus.Write("robotous", robotous);

  Bytes ati{1};
  for (int row = 0; row < 6; ++row)
    for (int part = 0; part < 3; ++part) {
      Bytes two(8);  // two elements of the matrix: 1.0 on the diagonal
      if (row / 2 == part) two[row % 2 ? 4 : 0] = 0x3F, two[row % 2 ? 5 : 1] = 0x80;
      AppendFrame(ati, static_cast<unsigned>(2 + part), two);
    }
  AppendFrame(ati, 5, {0, 0, 0, 100, 0, 0, 0, 10});  // counts per newton and newton metre
  AppendFrame(ati, 6, {2, 3});                       // codes of the units
  for (int i = 0; i < 6; ++i) {
    AppendFrame(ati, 0, {0, 0, 0, 100, 1, 0x2C, 0x7F, 0xFE});
    AppendFrame(ati, 1, {0xFF, 0x38, 0, 10, 0xFF, 0xEC});
  }
  corpus.Write("ati", ati);
  Bytes counts(ati.begin(),
               ati.begin() + 1 + 6 * 3 * 10);  // the bytes of the matrix alone; invalid counts follow
  AppendFrame(counts, 5, {0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0});
  corpus.Write("ati_counts", counts);

  Bytes drive{2};
  for (int i = 0; i < 40; ++i)
    drive.push_back(14 | kLater);  // 40 correct answers to the drive client's requests
  AppendFrame(drive, 1, {5});      // heartbeat: operational
  for (const std::uint8_t state : Bytes{0x40, 0x21, 0x23, 0x27, 0x27, 0x27, 0x08}) {
    AppendFrame(drive, 2, {state, 0x02, 3, 0x10, 0, 0, 0});
    AppendFrame(drive, 3, {0x20, 0, 0, 0, 0x19, 0});
    AppendFrame(drive, 1, {5});
  }
  AppendFrame(drive, 4, PaddedToEight({0x10, 0x23, 1}));  // an emergency
  corpus.Write("drive", drive);

  std::array<std::uint8_t, io::kUdpCanMaxDatagram> datagram{};
  const std::size_t size = io::EncodeUdpCan(
      {.frame = {.id = 0x64, .size = 3, .data = {1, 2, 3}}, .session = 1, .sequence = 2}, datagram);
  Bytes tunnel{3};
  tunnel.insert(tunnel.end(), datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(size));
  corpus.Write("tunnel", tunnel);
}

// ---- PLC

void WritePlc(const std::filesystem::path& root) {
  const Corpus corpus(root, "plc");
  const auto blocks = [](std::initializer_list<std::array<std::uint16_t, 14>> list) {
    Bytes all;
    for (const auto& block : list) {
      all.push_back(10);  // time since the previous block [ms]
      for (const std::uint16_t value : block) {
        all.push_back(static_cast<std::uint8_t>(value));
        all.push_back(static_cast<std::uint8_t>(value >> 8));
      }
      all.push_back(5);  // time until the block is judged [ms]
    }
    return all;
  };
  corpus.Write("running", blocks({{3, 0, 0, 0, 1, 0, 0, 3, 0, 1, 1, 1, 1, 7},
                                  {3, 0, 0, 0, 1, 0, 0, 3, 0, 1, 0, 1, 1, 8}}));
  corpus.Write("stopped", blocks({{1, 0, 0, 1, 0, 0, 0, 3, 1, 2, 0, 0, 0, 7},
                                  {1, 0, 0, 1, 1, 0, 0, 3, 0, 0, 0, 0, 0, 7}}));
  corpus.Write("bad", blocks({{4, 0, 0, 0, 1, 0, 0, 3, 0, 1, 1, 1, 1, 7},
                              {3, 0, 0, 0, 1, 0, 0, 4, 9, 9, 9, 9, 9, 9}}));
}

// ---- an engine in its own process

void WriteEngine(const std::filesystem::path& root) {
  const Corpus corpus(root, "engine_message");
  const auto message = [](std::uint8_t kind, std::span<const std::uint8_t> bytes) {
    Bytes all{kind};
    all.insert(all.end(), bytes.begin(), bytes.end());
    return all;
  };
  io::EngineBytes bytes;
  io::EncodeEngine({.kind = io::EngineMessage::kFrame, .session = 7}, io::test::SampleFrame(), bytes);
  corpus.Write("frame", message(1, bytes.view()));
  io::EncodeEngine({.kind = io::EngineMessage::kCommand, .session = 7}, io::test::SampleCommand(), bytes);
  corpus.Write("command", message(3, bytes.view()));
  corpus.Write("setup", message(5, io::EncodeSetup(io::test::SampleSetup())));
}

// ---- console

void WriteConsole(const std::filesystem::path& root) {
  const Corpus corpus(root, "console_message");
  for (const char* ask : {"pause", "resume", "recover", "stop", "role", "watch", "all"})
    corpus.Write(ask, 0, std::string("{\"ask\": \"") + ask + "\"}");
  corpus.Write("drag", 0, "{\"ask\": \"drag\", \"value\": 40}");
  corpus.Write("deep", 0, std::string(500, '[') + std::string(500, ']'));
  corpus.Write("open", 1, "127.0.0.1:8470\nhttp://127.0.0.1:8470\n" + std::string(32, 'a'));
  corpus.Write("stranger", 1, "evil.example:8470\nhttp://evil.example:8470\n");
  corpus.Write("six", 1, "[::1]:8470\n\n" + std::string(32, 'a'));
  const Corpus viewers(root, "foxglove_request");
  viewers.Write(
      "subscribe",
      R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 0}, {"id": 2, "channelId": 7}]})");
  viewers.Write("unsubscribe", R"({"op": "unsubscribe", "subscriptionIds": [1, 2]})");
  viewers.Write("origin", "https://app.foxglove.dev\n");
}

}  // namespace
}  // namespace osteon

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "osteon_fuzz_corpus: one argument, the folder to write to, e.g. tests/fuzz/corpus\n");
    return 2;
  }
  osteon::WriteFri(argv[1]);
  osteon::WriteRsi(argv[1]);
  osteon::WriteCan(argv[1]);
  osteon::WritePlc(argv[1]);
  osteon::WriteEngine(argv[1]);
  osteon::WriteConsole(argv[1]);
  osteon::WriteFiles(argv[1]);
  return 0;
}
