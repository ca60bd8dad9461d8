#include "session/process/output.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <exception>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/realtime_thread.h"
#include "session/process/exit_code.h"

namespace osteon::session {
namespace {

constexpr std::chrono::milliseconds kReaderInterval{100};  // time between two checks of the readers
constexpr std::size_t kMaxWaiting = 64u << 10;             // bytes that may wait; beyond it stderr is dropped
constexpr int kExitClosed = 128 + SIGPIPE;                 // exit code if nobody reads stdout any more

// One of the process's two outputs.
struct Output {
  int descriptor;
  std::atomic<int> error{0};  // errno of the first write that failed

  // Writes the whole text, waiting if necessary. After an error the rest of the text is dropped.
  void Write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = write(descriptor, text.data(), text.size());
      if (written >= 0) {
        text.remove_prefix(static_cast<std::size_t>(written));
      } else if (errno == EAGAIN || errno == EWOULDBLOCK) {  // non-blocking: wait and write the rest
        pollfd wait{.fd = descriptor, .events = POLLOUT, .revents = 0};
        poll(&wait, 1, -1);
      } else if (errno != EINTR) {
        int none = 0;
        error.compare_exchange_strong(none, errno);
        return;
      }
    }
  }

  // Whether nobody reads the output any more: the other end of its pipe, or its terminal, is closed.
  [[nodiscard]] bool IsClosed() const {
    pollfd look{.fd = descriptor, .events = 0, .revents = 0};
    return poll(&look, 1, 0) == 1 && (look.revents & (POLLERR | POLLHUP)) != 0;
  }
};

Output g_out{.descriptor = STDOUT_FILENO}, g_err{.descriptor = STDERR_FILENO};

}  // namespace

// Texts on their way to the two outputs, and the thread that writes them.
class OutputQueue {
 public:
  explicit OutputQueue(bool watch_stderr)
      : watch_stderr_(watch_stderr), thread_([this] {
          rt::NameThread("output");
          Run();
        }) {}
  ~OutputQueue() {
    {
      const std::lock_guard lock(mutex_);
      end_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }
  OutputQueue(const OutputQueue&) = delete;
  OutputQueue& operator=(const OutputQueue&) = delete;

  void Push(Output& output, std::string_view text) {
    {
      const std::lock_guard lock(mutex_);
      if (&output == &g_err && waiting_ > kMaxWaiting) {
        dropped_ += text.size();
        return;
      }
      waiting_ += text.size();
      if (parts_.empty() || parts_.back().output != &output)
        parts_.push_back({.output = &output, .text = {}});
      parts_.back().text += text;
    }
    changed_.notify_one();
  }

 private:
  // A text for one of the outputs.
  struct Part {
    Output* output;
    std::string text;
  };

  void Run() {
    std::unique_lock lock(mutex_);
    while (!end_ || !parts_.empty()) {
      changed_.wait_for(lock, kReaderInterval, [this] { return end_ || !parts_.empty(); });
      std::vector<Part> parts;
      parts.swap(parts_);
      if (dropped_ > 0 && !parts.empty())
        parts.push_back(
            {.output = &g_err,
             .text = fmt::format("\n({} bytes of output were dropped: nobody read them)\n", dropped_)});
      if (!parts.empty()) dropped_ = 0;
      lock.unlock();
      std::size_t written = 0;
      for (const Part& part : parts) {
        part.output->Write(part.text);
        written += part.text.size();
      }
      if (g_out.IsClosed() || (watch_stderr_ && g_err.IsClosed())) base::RequestInterrupt(SIGPIPE);
      lock.lock();
      waiting_ -= std::min(waiting_, written);  // only `written` includes the note about dropped text
    }
  }

  const bool watch_stderr_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Part> parts_;
  std::size_t waiting_{0}, dropped_{0};  // bytes: not yet written; dropped from stderr
  bool end_{false};
  std::thread thread_;  // declared last: it uses the other members
};

namespace {

std::atomic<OutputQueue*> g_queue{nullptr};

// The write function for the stdio streams: it always accepts all of the text.
ssize_t WriteToQueue(void* output, const char* text, std::size_t size) {
  const int kept = errno;
  try {
    if (OutputQueue* queue = g_queue.load())
      queue->Push(*static_cast<Output*>(output), {text, size});
    else
      static_cast<Output*>(output)->Write({text, size});
  } catch (const std::exception&) {  // no memory for the text
  }
  errno = kept;
  return static_cast<ssize_t>(size);
}

// Makes a stdio stream that writes to an output. @param mode  of setvbuf
std::FILE* Stream(Output& output, int mode) {
  std::FILE* stream =
      fopencookie(&output, "w", {.read = nullptr, .write = WriteToQueue, .seek = nullptr, .close = nullptr});
  if (stream) setvbuf(stream, nullptr, mode, BUFSIZ);
  return stream;
}

}  // namespace

void InstallOutput() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor)
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(
          open("/dev/null", descriptor == STDIN_FILENO ? O_RDONLY : O_WRONLY));  // gets the closed number
  if (std::FILE* out = Stream(g_out, isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF)) stdout = out;
  if (std::FILE* err = Stream(g_err, _IONBF)) stderr = err;
}

int OutputExitCode(int code) {
  std::fflush(stdout);
  const int error = g_out.error.load();
  if (error == 0) return code;
  if (error == EPIPE) return code == 0 ? kExitClosed : code;
  fmt::print(stderr, "osteon: stdout: what was printed can't be written: {}\n",
             std::generic_category().message(error));
  return code == 0 ? kFailed : code;
}

OutputThread::OutputThread(const OutputThreadParams& params)
    : queue_(std::make_unique<OutputQueue>(params.watch_stderr)) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // so that a file-size limit makes the write fail, as a full disk does
  g_queue.store(queue_.get());
}

OutputThread::~OutputThread() {
  std::fflush(stdout);
  g_queue.store(nullptr);
}

}  // namespace osteon::session
