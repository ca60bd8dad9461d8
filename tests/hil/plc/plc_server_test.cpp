#include "hil/plc/plc_server.h"

#include <array>
#include <memory>
#include <random>
#include <stdexcept>
#include <system_error>

#include <gtest/gtest.h>

#include "base/clock.h"
#include "tests/hil/plc/modbus_context.h"
#include "tests/io/net/loopback_socket.h"

// Tests the server of the simulated PLC, with the client of libmodbus and with bytes that are not Modbus.

namespace osteon::hil {
namespace {

TEST(PlcServer, LibmodbusReadsAndWritesItsRegisters) {
  PlcServer server({.port = 0});
  server.SetPanel({.mode = ModeSelector::kT2, .brake_test_due = true});
  const Context client = Connect(server);
  std::array<std::uint16_t, 14> block{};
  const rt::Nanoseconds latest = rt::MonotonicNow() + 10 * rt::kSecond;
  while (block[0] != 2 && rt::MonotonicNow() < latest)  // until a cycle of the program has read the panel
    ASSERT_EQ(modbus_read_registers(client.get(), 970, 14, block.data()), 14) << modbus_strerror(errno);
  EXPECT_EQ(block[0], 2);
  EXPECT_EQ(block[3], 1) << "brake test";
  EXPECT_EQ(block[4], 0) << "not permitted";
  EXPECT_EQ(block[7], 3) << "version";
  const std::array<std::uint16_t, 2> beat{1, 1};
  EXPECT_EQ(modbus_write_registers(client.get(), 990, 2, beat.data()), 2) << modbus_strerror(errno);
  EXPECT_EQ(modbus_write_register(client.get(), 992, 77), 1) << modbus_strerror(errno);
  EXPECT_EQ(modbus_write_register(client.get(), 993, 1), 1) << modbus_strerror(errno);
  std::array<std::uint16_t, 4> written{};
  EXPECT_EQ(modbus_read_registers(client.get(), 990, 4, written.data()), 4) << modbus_strerror(errno);
  EXPECT_EQ(written, (std::array<std::uint16_t, 4>{1, 1, 77, 1}))
      << "as written: any client can see who beats";
  EXPECT_EQ(modbus_read_registers(client.get(), 989, 1, block.data()), -1);
  EXPECT_EQ(errno, EMBXILADD);
  EXPECT_EQ(modbus_write_register(client.get(), 974, 1), -1) << "nobody permits himself to run";
  EXPECT_EQ(errno, EMBXILADD);
  EXPECT_EQ(modbus_read_registers(client.get(), 970, 15, block.data()), -1);
  EXPECT_EQ(errno, EMBXILADD);
  EXPECT_EQ(modbus_read_input_registers(client.get(), 970, 1, block.data()), -1);
  EXPECT_EQ(errno, EMBXILFUN);
  EXPECT_EQ(modbus_read_registers(client.get(), 970, 14, block.data()), 14) << "and goes on";
}

// A TCP connection that can send any bytes.
class RawClient : public io::test::LoopbackSocket {
 public:
  explicit RawClient(std::uint16_t port) : LoopbackSocket(SOCK_STREAM) { Connect(port); }

  // Number of bytes that are received next. 0: the server has closed the connection; -1: nothing was received
  // for five seconds.
  [[nodiscard]] ssize_t Receive() const {
    const auto bytes = LoopbackSocket::Receive(5000);
    return bytes ? static_cast<ssize_t>(bytes->size()) : -1;
  }
};

TEST(PlcServer, ClosesConnectionsThatSendNoModbusAndServesTheOthers) {
  PlcServer server({.port = 0});
  const Context good = Connect(server);
  std::mt19937 random(11);
  std::uint64_t closed = 0;
  for (int i = 0; i < 50; ++i) {
    const RawClient hostile(server.port());
    std::vector<std::uint8_t> noise(6 + random() % 600);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random() % 256);
    noise[2] = 0xff;  // the protocol identifier of Modbus is 0
    hostile.Send(noise);
    closed += hostile.Receive() == 0 ? 1 : 0;
    std::uint16_t version = 0;
    ASSERT_EQ(modbus_read_registers(good.get(), 977, 1, &version), 1) << modbus_strerror(errno);
    ASSERT_EQ(version, 3);
  }
  EXPECT_EQ(closed, 50u);
  EXPECT_EQ(server.counters().broken, 50u);
}

TEST(PlcServer, AcceptsARequestInPiecesAndSeveralAtOnce) {
  PlcServer server({.port = 0});
  const std::array<std::uint8_t, 12> request{0, 1, 0, 0, 0, 6, 1, 3, 0x03, 0xd1, 0, 1};
  const RawClient client(server.port());
  for (const std::uint8_t byte : request) client.Send({&byte, 1});
  EXPECT_EQ(client.Receive(), 11);
  std::vector<std::uint8_t> three;
  for (int i = 0; i < 3; ++i) three.insert(three.end(), request.begin(), request.end());
  client.Send(three);
  ssize_t received = 0;
  while (received < 33) {
    const ssize_t more = client.Receive();
    ASSERT_GT(more, 0);
    received += more;
  }
  EXPECT_EQ(received, 33);
}

TEST(PlcServer, ServesFourClientsAndRefusesTheFifth) {
  PlcServer server({.port = 0});
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 5; ++i) clients.push_back(std::make_unique<RawClient>(server.port()));
  EXPECT_EQ(clients.back()->Receive(), 0) << "closed at once";
  EXPECT_EQ(server.counters().connections, 4u);
  EXPECT_EQ(server.counters().refused, 1u);
}

TEST(PlcServer, RefusesAPortInUseAndWrongParameters) {
  const PlcServer first({.port = 0});
  EXPECT_THROW(PlcServer({.port = first.port()}), std::system_error);
  EXPECT_THROW(PlcServer({.bind_address = "localhost"}), std::invalid_argument);
  EXPECT_THROW(PlcServer({.port = 0, .cycle_ms = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
