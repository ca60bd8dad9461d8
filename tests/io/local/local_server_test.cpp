#include "io/local/local_server.h"

#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/local/local_client.h"
#include "io/local/local_socket.h"
#include "tests/io/temporary_folder.h"

// The local sockets on which running cells answer requests: who may connect, and clients that misbehave.

namespace osteon::io {
namespace {

// These tests use their own folder for sockets, because another cell may be running on this machine.
class LocalServerTest : public testing::Test {
 protected:
  void SetUp() override { ::setenv(kLocalFolderVariable, sockets().c_str(), 1); }
  void TearDown() override { ::unsetenv(kLocalFolderVariable); }
  [[nodiscard]] std::filesystem::path sockets() const { return folder_.path() / "sockets"; }

  test::TemporaryFolder folder_;
};

// The server's answer to each request.
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

TEST_F(LocalServerTest, ASocketWithoutAServerIsRemoved) {
  std::filesystem::path left;
  {
    const auto server = LocalServer::Start("run-2", Echo);
    ASSERT_TRUE(server) << server.error();
    left = (*server)->path();
    std::filesystem::create_hard_link(left, left.parent_path() / "run-3.sock");  // outlives the server
  }
  EXPECT_TRUE(std::filesystem::exists(left.parent_path() / "run-3.sock"));
  EXPECT_TRUE(FindLocalServers().empty());
  EXPECT_FALSE(std::filesystem::exists(left.parent_path() / "run-3.sock"));
}

TEST_F(LocalServerTest, AFolderThatOthersMayEnterIsRefused) {
  std::filesystem::create_directory(LocalSocketFolder());
  for (const mode_t mode : {0777, 0755, 0770, 0701}) {
    ASSERT_EQ(::chmod(LocalSocketFolder().c_str(), mode), 0);
    const auto server = LocalServer::Start("run-4", Echo);
    ASSERT_FALSE(server) << mode;
    EXPECT_NE(server.error().find("chmod 700"), std::string::npos) << server.error();
  }
}

// A folder may be open to a group (mode 0750) only if the environment variable names it. The default folder,
// under XDG_RUNTIME_DIR, belongs to one user and must not be.
TEST_F(LocalServerTest, AUsersOwnFolderMayNotBeOpenToAGroup) {
  ::unsetenv(kLocalFolderVariable);
  ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
  EXPECT_EQ(LocalSocketFolder(), folder_.path() / "osteon");
  EXPECT_EQ(LocalSocketFolders(),
            (std::vector<std::filesystem::path>{folder_.path() / "osteon", "/run/osteon"}));
  std::filesystem::create_directory(LocalSocketFolder());
  ASSERT_EQ(::chmod(LocalSocketFolder().c_str(), 0750), 0);
  EXPECT_FALSE(LocalServer::Start("run-10", Echo));
  ASSERT_EQ(::chmod(LocalSocketFolder().c_str(), 0700), 0);
  EXPECT_TRUE(LocalServer::Start("run-10", Echo));
  ::unsetenv("XDG_RUNTIME_DIR");
}

// Asks all servers from a process of that user and these groups. @returns the number of servers that
// answered; -1: the process could not ask
int AnswersFor(uid_t user, gid_t group, const std::vector<gid_t>& groups) {
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setgroups(groups.size(), groups.data()) != 0 || ::setgid(group) != 0 || ::setuid(user) != 0)
      ::_exit(255);
    int answered = 0;
    for (const auto& socket : FindLocalServers())
      answered += AskLocalServer(socket, "stop").value_or("") == "<stop>" ? 1 : 0;
    ::_exit(answered);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status) == 255 ? -1 : WEXITSTATUS(status);
}

// The folder of the installed service belongs to a group, whose members may find and end the cell.
TEST_F(LocalServerTest, OnlyRootAndTheFoldersGroupMayAsk) {
  if (::geteuid() != 0) GTEST_SKIP() << "skipped: other users' processes need root";
  constexpr uid_t kSomebody = 54321;
  constexpr gid_t kGroup = 54322, kOther = 54323;
  std::filesystem::create_directory(sockets());
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  ASSERT_EQ(::chown(sockets().c_str(), 0, kGroup), 0);
  for (const bool open : {true, false}) {
    ASSERT_EQ(::chmod(sockets().c_str(), open ? 0750 : 0700), 0);
    const auto server = LocalServer::Start("run-11", Echo);
    ASSERT_TRUE(server) << server.error();
    ASSERT_EQ(::chown((*server)->path().c_str(), 0, kGroup), 0);  // as a service of this group does
    EXPECT_EQ(AnswersFor(kSomebody, kOther, {kGroup}), open ? 1 : 0) << "a member";
    EXPECT_EQ(AnswersFor(kSomebody, kGroup, {}), open ? 1 : 0) << "whose own group it is";
    EXPECT_EQ(AnswersFor(kSomebody, kOther, {kOther}), 0) << "another user";
    EXPECT_EQ(AnswersFor(0, 0, {}), 1) << "root";
  }
}

TEST_F(LocalServerTest, AFolderThatIsALinkIsRefused) {
  std::filesystem::create_directory(folder_.path() / "elsewhere");
  std::filesystem::create_symlink(folder_.path() / "elsewhere", LocalSocketFolder());
  EXPECT_FALSE(LocalServer::Start("run-5", Echo));
}

// Each of these connections would block the server forever if the server did not limit sizes and times. The
// last request shows that none blocked it.
TEST_F(LocalServerTest, HostileConnectionsDoNotBlockTheServer) {
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

TEST_F(LocalServerTest, ManySilentConnectionsDoNotKeepOthersOut) {
  const auto server = LocalServer::Start("run-8", Echo);
  ASSERT_TRUE(server) << server.error();
  const auto address = LocalAddress((*server)->path());
  std::vector<LocalSocket> silent;
  for (int i = 0; i < 40; ++i) {
    const LocalSocket& socket = silent.emplace_back(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    ASSERT_EQ(::connect(socket.fd(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address), 0);
  }
  EXPECT_EQ(AskLocalServer((*server)->path(), "stop").value_or(""), "<stop>");
  // the server closed the oldest connection to accept a newer one, before the oldest one's time limit
  EXPECT_FALSE(ReadLine(silent.front().fd(), 100, kLocalPatience));
}

// Another client is served while the first request is still incomplete.
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

TEST(LocalAddress, APathThatIsTooLongIsRefused) {
  const auto address = LocalAddress("/" + std::string(200, 'a'));
  ASSERT_FALSE(address);
  EXPECT_NE(address.error().find("accepted at most 107"), std::string::npos) << address.error();
}

}  // namespace
}  // namespace osteon::io
