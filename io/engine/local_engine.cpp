#include "io/engine/local_engine.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "io/net/udp_socket.h"

namespace osteon::io {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> kMagic{'O', 'S', 'T', 'S', 'H', 'A', 'R', 'E'};
// Prefix of the names of all runs' folders.
constexpr const char* kPrefix = "osteon_engine_";
// Intervals at which shared memory is polled: for a command (one arrives each millisecond), for a frame, and
// for the engine's state at the end of the run.
constexpr rt::Nanoseconds kCommandPoll = 50'000, kFramePoll = 100'000, kStatePoll = 5 * rt::kMillisecond;
// Interval between two checks whether the run's process still exists.
constexpr rt::Nanoseconds kRunCheck = 100 * rt::kMillisecond;

// Returns the system's folder for shared memory, or the folder for temporary files if the system has none.
fs::path SharedFolder() {
  std::error_code error;
  return fs::is_directory("/dev/shm", error) ? fs::path("/dev/shm") : fs::temp_directory_path();
}

// Removes the folders of runs that have ended. Such a folder is recognised because no process holds the lock
// on its segment.
void RemoveStale(const fs::path& parent) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, error)) {
    if (!entry.path().filename().string().starts_with(kPrefix)) continue;
    struct stat folder {};
    if (lstat(entry.path().c_str(), &folder) != 0 || folder.st_uid != geteuid() || !S_ISDIR(folder.st_mode))
      continue;
    const int file = open((entry.path() / "segment").c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) continue;
    struct stat segment {};  // an empty segment belongs to a run that is just being created
    if (fstat(file, &segment) == 0 && segment.st_size > 0 && flock(file, LOCK_EX | LOCK_NB) == 0)
      fs::remove_all(entry.path(), error);
    close(file);
  }
}

// Maps the segment into this process; returns null on failure.
SharedEngine* Map(int file) {
  void* at = mmap(nullptr, sizeof(SharedEngine), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file, 0);
  return at == MAP_FAILED ? nullptr : static_cast<SharedEngine*>(at);
}

// Copies a text into shared memory, truncated to the available size and terminated by a zero.
template <std::size_t kSize>
void WriteSharedText(const std::string& text, std::array<char, kSize>& to) {
  to.fill('\0');
  std::copy_n(text.begin(), std::min(text.size(), kSize - 1), to.begin());
}

// Copies a text out of shared memory. Control characters are replaced by blanks, because the text will be
// printed.
template <std::size_t kSize>
std::string ReadSharedText(const std::array<char, kSize>& from) {
  const auto end = std::find(from.begin(), from.end(), '\0');
  std::string text(from.begin(), end);
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

tl::expected<std::vector<std::uint8_t>, std::string> ReadFile(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(stream), {});
  if (!stream.is_open() || stream.bad()) return tl::make_unexpected(path.string() + ": cannot read");
  return bytes;
}

// Writes a file. Returns the error text; empty on success.
std::string WriteFile(const fs::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  return stream ? "" : path.string() + ": cannot write: is there room in shared memory?";
}

}  // namespace

tl::expected<std::unique_ptr<LocalEngineClient>, std::string> LocalEngineClient::Create(
    std::span<const std::uint8_t> setup) {
  const fs::path parent = SharedFolder();
  RemoveStale(parent);
  std::string folder = fmt::format("{}/{}XXXXXX", parent.string(), kPrefix);
  if (mkdtemp(folder.data()) == nullptr)
    return tl::make_unexpected(folder + ": cannot make a folder: " + SystemReason(errno));
  const auto refuse = [&folder](const std::string& why, int file = -1) {
    if (file >= 0) close(file);
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    return tl::make_unexpected(why);
  };
  const std::string segment = folder + "/segment";
  const int file = open(segment.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return refuse(segment + ": cannot make: " + SystemReason(errno));
  if (flock(file, LOCK_EX | LOCK_NB) != 0 || posix_fallocate(file, 0, sizeof(SharedEngine)) != 0)
    return refuse(segment + ": cannot make: is there room in shared memory?", file);
  SharedEngine* shared = Map(file);
  if (shared == nullptr) return refuse(segment + ": cannot map: " + SystemReason(errno), file);
  std::unique_ptr<LocalEngineClient> client(new LocalEngineClient(folder, file, shared));
  if (std::string wrong = WriteFile(client->folder_ / "setup", setup); !wrong.empty())
    return tl::make_unexpected(std::move(wrong));
  return client;
}

// A new file contains zeros, so those members of SharedEngine that are not written here are zero initially.
LocalEngineClient::LocalEngineClient(std::filesystem::path folder, int file, SharedEngine* shared)
    : folder_(std::move(folder)),
      file_(file),
      shared_(shared),
      commands_(shared->commands),
      models_(shared->models),
      session_(0) {
  if (getrandom(&session_, sizeof session_, 0) != sizeof session_)
    session_ = static_cast<std::uint64_t>(rt::MonotonicNow());
  shared_->session = session_;
  shared_->version = kEngineVersion;
  shared_->commands.middle.store(1);
  shared_->models.middle.store(1);
  shared_->run.store(SharedState::kRunning);
  shared_->magic = kMagic;
}

LocalEngineClient::~LocalEngineClient() {
  shared_->run.store(SharedState::kEnded, std::memory_order_release);
  munmap(shared_, sizeof(SharedEngine));
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  close(file_);
}

void LocalEngineClient::ReadNames() {
  engine_ = ReadSharedText(shared_->engine_name);
  device_ = ReadSharedText(shared_->device);
}

std::string LocalEngineClient::ReadError() const { return ReadSharedText(shared_->error); }

const simulation::ContactModel& LocalEngineClient::Load() OSTEON_RT {
  if (!models_.Load(model_bytes_)) return newest_.model;
  EngineHeader header;
  EngineFrame frame;
  if (DecodeEngine(model_bytes_.view(), header, frame) != EngineError::kNone || header.session != session_ ||
      frame.model.frame < newest_.model.frame)
    rejected_.fetch_add(1, std::memory_order_relaxed);
  else
    newest_ = frame;
  return newest_.model;
}

void LocalEngineClient::Store(const simulation::ToolCommand& command) OSTEON_RT {
  if (command.stamp > 0) StoreCommand({.command = command});
}

void LocalEngineClient::Send(const EngineCommand& command) { StoreCommand(command); }

void LocalEngineClient::StoreCommand(const EngineCommand& command) OSTEON_RT {
  EncodeEngine({.kind = EngineMessage::kCommand, .session = session_, .sequence = ++sent_}, command,
               command_bytes_);
  commands_.Store(command_bytes_);
}

bool LocalEngineClient::AwaitFrame(EngineFrame& frame, rt::Nanoseconds deadline) {
  for (;;) {
    while (shared_->frames.Pop(frame_bytes_)) {
      EngineHeader header;
      if (DecodeEngine(frame_bytes_.view(), header, frame) != EngineError::kNone ||
          header.session != session_ || header.sequence < next_frame_) {
        rejected_.fetch_add(1, std::memory_order_relaxed);
        continue;
      }
      counters_.lost += header.sequence - next_frame_;
      next_frame_ = header.sequence + 1;
      ++counters_.frames;
      return true;
    }
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (now >= deadline) return false;
    rt::SleepUntil(std::min(deadline, now + kFramePoll));
  }
}

tl::expected<std::vector<std::uint8_t>, std::string> LocalEngineClient::FetchCarved(
    rt::Nanoseconds deadline) {
  shared_->run.store(SharedState::kEnding, std::memory_order_release);
  while (state() != SharedState::kEnded) {
    if (state() == SharedState::kFailed) return tl::make_unexpected(ReadError());
    if (rt::MonotonicNow() >= deadline)
      return tl::make_unexpected(std::string("the engine's process does not answer"));
    rt::SleepUntil(rt::MonotonicNow() + kStatePoll);
  }
  return ReadFile(folder_ / "carved");
}

EngineCounters LocalEngineClient::counters() const {
  EngineCounters counters = counters_;
  counters.rejected = rejected_.load(std::memory_order_relaxed);
  return counters;
}

tl::expected<std::unique_ptr<LocalEngineServer>, std::string> LocalEngineServer::Open(
    const fs::path& folder) {
  struct stat status {};
  if (lstat(folder.c_str(), &status) != 0)
    return tl::make_unexpected(folder.string() + ": " + SystemReason(errno));
  if (!S_ISDIR(status.st_mode) || status.st_uid != geteuid() || (status.st_mode & 077) != 0)
    return tl::make_unexpected(folder.string() +
                               ": found a folder of another user, or one that others may enter; accepted the "
                               "folder that a run has made for its engine");
  const fs::path segment = folder / "segment";
  const int file = open(segment.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (file < 0) return tl::make_unexpected(segment.string() + ": " + SystemReason(errno));
  const auto refuse = [&](const std::string& why) {
    close(file);
    return tl::make_unexpected(segment.string() + ": " + why);
  };
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode) ||
      status.st_size != static_cast<off_t>(sizeof(SharedEngine)))
    return refuse("found another size than this version's, accepted a run of the same version");
  SharedEngine* shared = Map(file);
  if (shared == nullptr) return refuse("cannot map: " + SystemReason(errno));
  std::unique_ptr<LocalEngineServer> server(new LocalEngineServer(folder, file, shared));
  if (shared->magic != kMagic || shared->version != kEngineVersion)
    return tl::make_unexpected(segment.string() +
                               ": found another version's segment, accepted a run of the same version");
  if (server->IsRunGone())
    return tl::make_unexpected(segment.string() + ": found the segment of a run that has ended");
  return server;
}

LocalEngineServer::LocalEngineServer(std::filesystem::path folder, int file, SharedEngine* shared)
    : folder_(std::move(folder)),
      file_(file),
      shared_(shared),
      commands_(shared->commands),
      models_(shared->models),
      session_(shared->session) {}

LocalEngineServer::~LocalEngineServer() {
  std::error_code ignored;
  // A run that was killed could not remove its folder.
  if (IsRunGone()) fs::remove_all(folder_, ignored);
  munmap(shared_, sizeof(SharedEngine));
  close(file_);
}

bool LocalEngineServer::IsRunGone() const {
  if (shared_->run.load(std::memory_order_acquire) == SharedState::kEnded) return true;
  // the run's process holds the lock, so it still exists
  if (flock(file_, LOCK_SH | LOCK_NB) != 0) return false;
  flock(file_, LOCK_UN);
  return true;
}

tl::expected<std::vector<std::uint8_t>, std::string> LocalEngineServer::ReadSetup() const {
  return ReadFile(folder_ / "setup");
}

void LocalEngineServer::SetRunning(const std::string& engine, const std::string& device) {
  WriteSharedText(engine, shared_->engine_name);
  WriteSharedText(device, shared_->device);
  shared_->engine.store(SharedState::kRunning, std::memory_order_release);
}

void LocalEngineServer::SetFailed(const std::string& why) {
  WriteSharedText(why, shared_->error);
  shared_->engine.store(SharedState::kFailed, std::memory_order_release);
}

EngineEvent LocalEngineServer::Await(EngineCommand& command, rt::Nanoseconds deadline) {
  for (;;) {
    if (commands_.Load(command_bytes_)) {
      EngineHeader header;
      if (DecodeEngine(command_bytes_.view(), header, command) == EngineError::kNone &&
          header.session == session_)
        return EngineEvent::kCommand;
    }
    const SharedState run = shared_->run.load(std::memory_order_acquire);
    if (run == SharedState::kEnding) return EngineEvent::kEnd;
    const rt::Nanoseconds now = rt::MonotonicNow();
    if (now - run_checked_at_ >= kRunCheck) {
      run_checked_at_ = now;
      if (IsRunGone()) return EngineEvent::kGone;
    }
    if (now >= deadline) return EngineEvent::kNothing;
    rt::SleepUntil(std::min(deadline, now + kCommandPoll));
  }
}

void LocalEngineServer::Publish(const EngineFrame& frame) {
  EncodeEngine({.kind = EngineMessage::kFrame, .session = session_, .sequence = ++made_}, frame,
               frame_bytes_);
  models_.Store(frame_bytes_);
  // If the ring is full, the frame is dropped. The run notices this by the gap in the sequence numbers.
  static_cast<void>(shared_->frames.Push(frame_bytes_));
}

void LocalEngineServer::PutCarved(std::vector<std::uint8_t> bytes) {
  if (std::string wrong = WriteFile(folder_ / "carved", bytes); !wrong.empty()) return SetFailed(wrong);
  shared_->engine.store(SharedState::kEnded, std::memory_order_release);
}

}  // namespace osteon::io
