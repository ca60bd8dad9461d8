#include "base/parallel.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace osteon::simulation {
namespace {

TEST(ParallelFor, VisitsEveryElementOnceForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3, 8})
    for (const std::size_t count : {0u, 1u, 255u, 256u, 257u, 10000u}) {
      std::vector<int> visits(count, 0);
      ParallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(count));
    }
}

TEST(ParallelFor, RethrowsAnExceptionOfItsBody) {
  EXPECT_THROW(ParallelFor(100000, 4,
                           [](std::size_t begin, std::size_t) {
                             if (begin > 1000) throw std::runtime_error("no");
                           }),
               std::runtime_error);
}

}  // namespace
}  // namespace osteon::simulation
