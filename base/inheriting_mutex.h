#pragma once

#include <pthread.h>

#include <system_error>

namespace osteon::rt {

/// A mutex with priority inheritance (PTHREAD_PRIO_INHERIT): its holder runs at the priority of the most
/// urgent thread that waits for it. Use it for data that a thread of high priority shares with one of low
/// priority. With a std::mutex, the first would wait until a busy machine has time for the second.
class InheritingMutex {
 public:
  /// @throws std::system_error if the system has no mutex with priority inheritance.
  InheritingMutex() {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    int error = pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    if (error == 0) error = pthread_mutex_init(&mutex_, &attributes);
    pthread_mutexattr_destroy(&attributes);
    if (error != 0) throw std::system_error(error, std::generic_category(), "a mutex that inherits priority");
  }
  ~InheritingMutex() { pthread_mutex_destroy(&mutex_); }
  InheritingMutex(const InheritingMutex&) = delete;
  InheritingMutex& operator=(const InheritingMutex&) = delete;

  // the members of std::mutex that std::lock_guard and std::unique_lock need
  void lock() noexcept { (void)pthread_mutex_lock(&mutex_); }
  void unlock() noexcept { (void)pthread_mutex_unlock(&mutex_); }
  [[nodiscard]] bool try_lock() noexcept { return pthread_mutex_trylock(&mutex_) == 0; }

 private:
  pthread_mutex_t mutex_;
};

}  // namespace osteon::rt
