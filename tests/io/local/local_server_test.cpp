#include "io/local/local_server.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/local/local_client.h"
#include "io/local/local_socket.h"
#include "tests/io/temporary_folder.h"

namespace osteon::io {
namespace {

// Sockets of this test alone: another cell may run on this machine.
class LocalServerTest : public testing::Test {
 protected:
  void SetUp() override { ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
  void TearDown() override { ::unsetenv("XDG_RUNTIME_DIR"); }

  test::TemporaryFolder folder_;
};

std::string Echo(const std::string& request) { return "<" + request + ">"; }

TEST_F(LocalServerTest, AnswersARequestAndIsFoundUntilItEnds) {
  EXPECT_TRUE(FindLocalServers().empty());
  {
    const auto server = LocalServer::Start("run-1", Echo);
    ASSERT_TRUE(server) << server.error();
    const auto found = FindLocalServers();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0], (*server)->path());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(AskLocalServer(found[0], "pause").value_or(""), "<pause>");
  }
  EXPECT_TRUE(FindLocalServers().empty());
}

TEST_F(LocalServerTest, ASocketThatNobodyAnswersIsRemoved) {
  std::filesystem::path left;
  {
    const auto server = LocalServer::Start("run-2", Echo);
    ASSERT_TRUE(server) << server.error();
    left = (*server)->path();
    std::filesystem::create_hard_link(left, left.parent_path() / "run-3.sock");  // survives the server
  }
  EXPECT_TRUE(std::filesystem::exists(left.parent_path() / "run-3.sock"));
  EXPECT_TRUE(FindLocalServers().empty());
  EXPECT_FALSE(std::filesystem::exists(left.parent_path() / "run-3.sock"));
}

TEST_F(LocalServerTest, AFolderThatOthersMayEnterIsRefused) {
  std::filesystem::create_directory(LocalSocketFolder());
  ASSERT_EQ(::chmod(LocalSocketFolder().c_str(), 0777), 0);
  const auto server = LocalServer::Start("run-4", Echo);
  ASSERT_FALSE(server);
  EXPECT_NE(server.error().find("chmod 700"), std::string::npos) << server.error();
}

TEST_F(LocalServerTest, AFolderThatIsALinkIsRefused) {
  std::filesystem::create_directory(folder_.path() / "elsewhere");
  std::filesystem::create_symlink(folder_.path() / "elsewhere", LocalSocketFolder());
  EXPECT_FALSE(LocalServer::Start("run-5", Echo));
}

// Each of these would hold the server for good if sizes and times had no bound; the last request shows that
// none did.
TEST_F(LocalServerTest, HostileConnectionsHoldNobodyUp) {
  const auto server = LocalServer::Start("run-6", Echo);
  ASSERT_TRUE(server) << server.error();
  const auto address = LocalAddress((*server)->path());
  ASSERT_TRUE(address);
  const auto connect = [&] {
    LocalSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address), 0);
    return socket;
  };
  { const LocalSocket closes_at_once = connect(); }
  const LocalSocket sends_too_much = connect();
  (void)WriteAll(sends_too_much.fd(), std::string(3 * kMaxLocalRequest, 'x'));
  const LocalSocket zeros = connect();
  EXPECT_TRUE(WriteAll(zeros.fd(), std::string("\0\0\n", 3)));
  EXPECT_EQ(ReadLine(zeros.fd(), 100, 3 * kLocalPatience).value_or(""), std::string("<\0\0>", 4));
  EXPECT_FALSE(ReadLine(sends_too_much.fd(), 100, kLocalPatience));
  EXPECT_EQ(AskLocalServer((*server)->path(), "status").value_or(""), "<status>");
}

TEST_F(LocalServerTest, ASilentConnectionIsClosedAndTheNextIsServed) {
  const auto server = LocalServer::Start("run-7", Echo);
  ASSERT_TRUE(server) << server.error();
  const auto address = LocalAddress((*server)->path());
  const LocalSocket silent(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::connect(silent.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address), 0);
  EXPECT_EQ(AskLocalServer((*server)->path(), "status").value_or(""), "<status>");
}

TEST_F(LocalServerTest, ManySilentConnectionsKeepNobodyOut) {
  const auto server = LocalServer::Start("run-8", Echo);
  ASSERT_TRUE(server) << server.error();
  const auto address = LocalAddress((*server)->path());
  std::vector<LocalSocket> silent;
  for (int i = 0; i < 40; ++i) {
    const LocalSocket& socket = silent.emplace_back(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ASSERT_EQ(::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address), 0);
  }
  EXPECT_EQ(AskLocalServer((*server)->path(), "stop").value_or(""), "<stop>");
  // the oldest gave way, within their patience and not after it
  EXPECT_FALSE(ReadLine(silent.front().fd(), 100, kLocalPatience));
}

// A request may come in pieces.
TEST_F(LocalServerTest, ARequestInPiecesIsOneRequest) {
  const auto server = LocalServer::Start("run-9", Echo);
  ASSERT_TRUE(server) << server.error();
  const auto address = LocalAddress((*server)->path());
  const LocalSocket socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address), 0);
  ASSERT_TRUE(WriteAll(socket.fd(), "sta"));
  EXPECT_EQ(AskLocalServer((*server)->path(), "pause").value_or(""), "<pause>");
  ASSERT_TRUE(WriteAll(socket.fd(), "tus\n"));
  EXPECT_EQ(ReadLine(socket.fd(), 100, 3 * kLocalPatience).value_or(""), "<status>");
}

TEST(LocalAddress, APathThatTheSystemDoesNotTakeIsRefused) {
  const auto address = LocalAddress("/" + std::string(200, 'a'));
  ASSERT_FALSE(address);
  EXPECT_NE(address.error().find("accepted at most 107"), std::string::npos) << address.error();
}

}  // namespace
}  // namespace osteon::io
