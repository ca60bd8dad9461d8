#include "tests/app/command.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace osteon::app {
namespace {

// This process's environment, with these entries added or replaced.
std::vector<std::string> Environment(const std::vector<std::string>& added) {
  std::vector<std::string> all = added;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string name = std::string(*entry).substr(0, std::string(*entry).find('=') + 1);
    const bool replaced = std::any_of(added.begin(), added.end(),
                                      [&](const std::string& text) { return text.starts_with(name); });
    if (!replaced) all.emplace_back(*entry);
  }
  return all;
}

// Null-terminated list for posix_spawn. The pointers refer to the texts, which must outlive the list.
std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

Command::Command(const std::filesystem::path& folder, std::vector<std::string> arguments,
                 const std::vector<std::string>& environment, const CommandStreams& streams)
    : out_(folder / ".stdout"), err_(folder / ".stderr") {
  arguments.insert(arguments.begin(), OSTEON_BINARY);
  std::vector<std::string> settings = environment;
  settings.push_back("OSTEON_ROOT=" OSTEON_SOURCE_DIR);
  std::vector<std::string> all = Environment(settings);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  const auto redirect = [&actions](int descriptor, int to, const std::filesystem::path& file) {
    if (to == CommandStreams::kFile)
      posix_spawn_file_actions_addopen(&actions, descriptor, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                       0600);
    else if (to == CommandStreams::kClosed)
      posix_spawn_file_actions_addclose(&actions, descriptor);
    else
      posix_spawn_file_actions_adddup2(&actions, to, descriptor);
  };
  redirect(STDOUT_FILENO, streams.out, out_);
  redirect(STDERR_FILENO, streams.err, err_);
  // the child gets the default reaction to these signals, as from a shell, even if this process ignores them
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  for (const int signal_number : {SIGHUP, SIGPIPE}) sigaddset(&defaults, signal_number);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const int error = posix_spawn(&pid_, OSTEON_BINARY, &actions, &attributes, Pointers(arguments).data(),
                                Pointers(all).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error(std::string(OSTEON_BINARY) + ": " + std::strerror(error));
}

Command::~Command() {
  if (Ended()) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, &status_, 0);
}

void Command::Send(int signal_number) const { kill(pid_, signal_number); }

std::string Command::Out() const { return io::test::ReadAll(out_); }
std::string Command::Err() const { return io::test::ReadAll(err_); }

bool Command::Ended() {
  if (!ended_) ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return ended_;
}

bool Command::WaitUntil(const std::function<bool()>& condition, std::chrono::seconds limit) {
  const auto give_up = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (Ended() || std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

CommandResult Command::Wait(std::chrono::seconds limit) {
  if (!WaitUntil([this] { return Ended(); }, limit)) {
    kill(pid_, SIGKILL);
    waitpid(pid_, &status_, 0);
    ended_ = true;
  }
  return {.exit_code = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_),
          .out = Out(),
          .err = Err()};
}

CommandResult RunCommand(const std::filesystem::path& folder, std::vector<std::string> arguments,
                         const std::vector<std::string>& environment) {
  return Command(folder, std::move(arguments), environment).Wait();
}

nlohmann::json ReadJson(const std::filesystem::path& file) {
  nlohmann::json json = nlohmann::json::parse(io::test::ReadAll(file), nullptr, false);
  EXPECT_TRUE(json.is_object()) << file;
  return json;
}

io::Recording ReadComplete(const std::filesystem::path& file) {
  auto recording = io::ReadRecording(file);
  if (!recording) {
    ADD_FAILURE() << recording.error();
    return {};
  }
  EXPECT_TRUE(recording->complete) << file;
  EXPECT_FALSE(recording->ticks.empty());
  EXPECT_FALSE(recording->frames.empty());
  return std::move(*recording);
}

}  // namespace osteon::app
