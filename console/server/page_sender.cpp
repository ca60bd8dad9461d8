#include "console/server/page_sender.h"

#include <chrono>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/realtime_thread.h"
#include "console/stream/live_json.h"

namespace osteon::console {
namespace {

constexpr std::chrono::milliseconds kPagePeriod{33};  // time between messages to a page

}  // namespace

PageSender::PageSender(std::uint64_t page, const PageSources& sources, PageWriter& writer)
    : page_(page), sources_(sources), writer_(writer), thread_([this] { Run(); }) {}

PageSender::~PageSender() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PageSender::Answer(std::string text) {
  {
    const std::lock_guard lock(mutex_);
    if (answers_.size() < kMaxAnswers) answers_.push_back(std::move(text));
  }
  changed_.notify_all();
}

void PageSender::Run() {
  rt::NameThread("console page");
  rt::LowerPriority();
  while (true) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kPagePeriod, [this] { return stop_ || !answers_.empty(); });
      if (stop_) return;
    }
    if (!SendNew()) {
      writer_.Close();
      return;
    }
  }
}

bool PageSender::SendAnswers() {
  std::deque<std::string> answers;
  {
    const std::lock_guard lock(mutex_);
    answers.swap(answers_);
  }
  for (const std::string& answer : answers)
    if (!writer_.WriteText(answer)) return false;
  return true;
}

bool PageSender::SendRole() {
  const std::uint64_t holder = sources_.role.holder();
  const std::size_t pages = sources_.pages.load();
  if (holder == shown_holder_ && pages == shown_pages_) return true;
  shown_holder_ = holder;
  shown_pages_ = pages;
  return writer_.WriteText(fmt::format(R"({{"type":"role","mine":{},"taken":{},"pages":{}}})",
                                       holder == page_, holder != 0, pages));
}

bool PageSender::SendNotes() {
  shown_notes_.resize(sources_.notes.size());
  for (std::size_t i = 0; i < shown_notes_.size(); ++i) {
    std::string note = sources_.notes[i]();
    if (note == shown_notes_[i]) continue;
    if (!writer_.WriteText(note)) return false;
    shown_notes_[i] = std::move(note);
  }
  return true;
}

bool PageSender::SendSurface() {
  const SurfaceReader::Part part = surface_.Next(sources_.surface, surface_budget_.bytes());
  if (part.layout && !writer_.WriteText(*part.layout)) return false;
  if (part.bricks.empty()) return true;
  using Clock = std::chrono::steady_clock;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  const auto before = Clock::now();
  // Store the time of the bone's state that this change shows: age_ms is counted from there.
  if (part.begins && sources_.context.bone_age_s)
    surface_time_ = before - std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(sources_.context.bone_age_s().value_or(0.0)));
  if (!writer_.WriteBinary(part.bricks)) return false;
  const auto after = Clock::now();
  surface_budget_.AfterMessage(after - before);
  if (!part.ends) return true;
  if (!sources_.context.bone_age_s) return writer_.WriteText(R"({"type":"surface_whole"})");
  return writer_.WriteText(fmt::format(R"({{"type":"surface_whole","age_ms":{:.1f}}})",
                                       Milliseconds(after - surface_time_).count()));
}

bool PageSender::SendNew() {
  if (resend_.exchange(false)) {
    seen_windows_ = seen_events_ = 0;
    surface_.Restart();
    shown_holder_ = ~0ull;
    shown_notes_.clear();
    if (!writer_.WriteText(sources_.hello)) return false;
  }
  if (const std::uint64_t epoch = sources_.feed.epoch(); epoch != shown_epoch_) {
    shown_epoch_ = epoch;
    seen_windows_ = seen_events_ = 0;
    if (!writer_.WriteText(R"({"type":"restart"})")) return false;
  }
  if (!SendAnswers() || !SendRole() || !SendNotes()) return false;
  if (const auto events = sources_.feed.EventsSince(seen_events_); !events.empty())
    if (!writer_.WriteText(EventsJson(events))) return false;
  const std::uint64_t seen_before = seen_windows_;
  if (const auto windows = sources_.feed.Since(seen_windows_); !windows.empty()) {
    const SharedLive::Span span{.epoch = shown_epoch_, .from = seen_before, .to = seen_windows_};
    if (!writer_.WriteText(*sources_.live.Get(span, [&] { return LiveJson(windows, sources_.context); })))
      return false;
  }
  return SendSurface();
}

}  // namespace osteon::console
