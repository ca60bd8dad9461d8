#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "console/server/operator_role.h"
#include "console/server/shared_live.h"
#include "console/server/surface_budget.h"
#include "console/server/surface_reader.h"
#include "console/server/surface_store.h"
#include "console/stream/live_feed.h"
#include "console/stream/live_status.h"

namespace osteon::console {

/// The data that every page's thread reads.
struct PageSources {
  const LiveFeed& feed;
  const SurfaceStore& surface;
  const OperatorRole& role;
  const std::string& hello;
  const LiveContext& context;
  const std::atomic<std::size_t>& pages;
  /// Each function makes one message, such as a playback's position. A page gets the message whenever it
  /// differs from the message of this function that the page got last.
  const std::vector<std::function<std::string()>>& notes;
  SharedLive& live;  ///< shared by all pages of the feed
};

/// Writes to one page. The functions return false if the page does not read, or has disconnected.
class PageWriter {
 public:
  virtual ~PageWriter() = default;
  virtual bool WriteText(const std::string& text) = 0;
  virtual bool WriteBinary(const std::string& bytes) = 0;
  virtual void Close() = 0;  ///< ends the connection; the page may open a new one
};

/// Sends one page all new data, in a thread of its own, until the page no longer reads.
class PageSender {
 public:
  PageSender(std::uint64_t page, const PageSources& sources, PageWriter& writer);
  ~PageSender();
  PageSender(const PageSender&) = delete;
  PageSender& operator=(const PageSender&) = delete;

  /// Sends an answer to a request of the page, before all other data. If kMaxAnswers answers are waiting, the
  /// answer is dropped.
  void Answer(std::string text);
  /// Sends hello, the windows and events that are kept, and the whole surface again.
  void Resend() { resend_.store(true); }

  static constexpr std::size_t kMaxAnswers = 16;

 private:
  void Run();
  // Each of these functions sends the data that are new since its last call. Each returns false if the page
  // does not read, or has disconnected.
  bool SendNew();
  bool SendAnswers();
  bool SendRole();
  bool SendNotes();
  bool SendSurface();

  const std::uint64_t page_;
  const PageSources sources_;
  PageWriter& writer_;

  std::atomic<bool> resend_{true};
  // used only by the thread, as are all members down to mutex_
  std::uint64_t seen_windows_{0}, seen_events_{0};
  SurfaceReader surface_;
  SurfaceBudget surface_budget_;
  std::chrono::steady_clock::time_point surface_time_{};  // time of the bone in the change that is being sent
  // the values that the page was sent last
  std::uint64_t shown_holder_{~0ull};
  std::size_t shown_pages_{0};
  std::uint64_t shown_epoch_{0};
  std::vector<std::string> shown_notes_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> answers_;  // guarded by mutex_
  bool stop_{false};                 // guarded by mutex_
  std::thread thread_;
};

}  // namespace osteon::console
