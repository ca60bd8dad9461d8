#pragma once

#include "plugin/src/session.h"

namespace osteon::plugin {

/// Locks the engine between two frames (session.h).
class Session::EngineLock {
 public:
  explicit EngineLock(Session& session) : session_(session) {
    session_.waiting_.fetch_add(1);
    session_.engine_mutex_.lock();
  }
  ~EngineLock() {
    session_.engine_mutex_.unlock();
    session_.waiting_.fetch_sub(1);
  }
  EngineLock(const EngineLock&) = delete;
  EngineLock& operator=(const EngineLock&) = delete;

 private:
  Session& session_;
};

}  // namespace osteon::plugin
