#include "session/procedure/session_writer.h"

#include <utility>

#include "base/realtime_thread.h"
#include "simulation/files/carved_file.h"

namespace osteon::session {

SessionWriter::SessionWriter(std::filesystem::path folder, const simulation::Bone& bone, bool with_thread)
    : folder_(std::move(folder)), bone_(bone) {
  if (with_thread) thread_ = std::thread([this] { Loop(); });
}

SessionWriter::~SessionWriter() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SessionWriter::WriteState(std::string name, std::shared_ptr<const simulation::CarvedState> state) {
  Push({.name = std::move(name), .state = std::move(state), .session = {}});
}

void SessionWriter::WriteSession(SessionFile session) {
  Push({.name = {}, .state = nullptr, .session = std::move(session)});
}

void SessionWriter::RunAfter(std::function<void()> work) {
  if (thread_.joinable()) Push({.name = {}, .state = nullptr, .session = {}, .work = std::move(work)});
}

std::string SessionWriter::Flush() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.empty() && !busy_; });
  return error_;
}

void SessionWriter::Push(Job job) {
  if (!thread_.joinable()) return Write(job);
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

// Does one job. After an error nothing more is written: a session must not name a state that is missing.
void SessionWriter::Write(const Job& job) {
  if (job.work) return job.work();
  {
    const std::lock_guard lock(mutex_);
    if (!error_.empty()) return;
  }
  std::string wrong;
  if (job.name.empty()) {
    if (const auto written = session::WriteSession(folder_, job.session); !written) wrong = written.error();
  } else if (const auto written = simulation::WriteCarvedState(folder_ / job.name, *job.state, bone_);
             !written) {
    wrong = written.error().Text();
  }
  const std::lock_guard lock(mutex_);
  error_ = std::move(wrong);
}

void SessionWriter::Loop() {
  rt::NameThread("session");
  rt::LowerPriority();
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
    if (jobs_.empty()) return;  // end only after all jobs are done
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    Write(job);
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

}  // namespace osteon::session
