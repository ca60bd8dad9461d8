#include "report/duration_counts.h"

namespace osteon::report {

void DurationCounts::Add(rt::Nanoseconds duration) {
  ++count_;
  const auto page = static_cast<std::size_t>(duration) / kPage;
  if (duration < 0 || page >= kMaxPages) {
    ++others_[duration];
    return;
  }
  if (page >= pages_.size()) pages_.resize(page + 1);
  if (!pages_[page]) pages_[page] = std::make_unique<Page>();
  ++(*pages_[page])[static_cast<std::size_t>(duration) % kPage];
}

rt::Nanoseconds DurationCounts::At(std::uint64_t rank) const {
  rt::Nanoseconds found = 0;
  std::uint64_t before = 0;
  ForEach([&](rt::Nanoseconds duration, std::uint64_t times) {
    if (rank >= before && rank < before + times) found = duration;
    before += times;
  });
  return found;
}

}  // namespace osteon::report
