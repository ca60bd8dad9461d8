#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace osteon::simulation {

/// Number of threads to use: `asked`, or one per core if that is 0.
[[nodiscard]] inline int ThreadCount(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Calls `body(begin, end)` for chunks that together cover [0, count), on at most `threads` threads; returns
/// when all are done. Any thread may take any chunk, but the borders of the chunks do not depend on the
/// number of threads. A body that writes only to its own elements therefore gives the same result with any
/// number of threads.
/// @throws the first exception of a body; the remaining chunks are skipped.
template <typename Body>
void ParallelFor(std::size_t count, int threads, const Body& body, std::size_t chunk = 256) {
  const std::size_t chunks = (count + chunk - 1) / chunk;
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < chunks; i = next++) body(i * chunk, std::min(count, (i + 1) * chunk));
    } catch (...) {
      next = chunks;
      const std::scoped_lock lock(error_mutex);
      if (!error) error = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    const std::size_t useful = std::min(chunks, static_cast<std::size_t>(ThreadCount(threads)));
    for (std::size_t i = 1; i < useful; ++i) others.emplace_back(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace osteon::simulation
