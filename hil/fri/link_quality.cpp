#include "hil/fri/link_quality.h"

#include <stdexcept>
#include <string>

namespace osteon::hil {

LinkQuality::LinkQuality(const QualityPolicyParams& params, int answers_per_s)
    : params_(params), window_(answers_per_s) {
  if (answers_per_s < 1 || answers_per_s > kMaxWindow)
    throw std::invalid_argument("answers per second: found " + std::to_string(answers_per_s) +
                                ", accepted 1 … 1000 (send period times receive multiplier 1 … 1000 ms)");
  if (params.fair_after_answers < 1 || params.good_after_answers < params.fair_after_answers ||
      params.excellent_after_answers < params.good_after_answers ||
      params.excellent_after_answers > answers_per_s)
    throw std::invalid_argument(
        "quality policy: accepted 1 <= fair_after_answers <= good_after_answers <= "
        "excellent_after_answers <= " +
        std::to_string(answers_per_s) + " (the answers due in a second)");
  if (params.end_after_lost_in_a_row < 1 || params.end_after_lost_per_s < 1 ||
      params.good_max_lost_per_s < 0 || !(params.good_timeout_s > 0.0))
    throw std::invalid_argument("quality policy: limits on losses and the time-out must be positive");
}

void LinkQuality::Reset() {
  history_.fill(Answer::kExcused);
  next_ = answered_ = lost_ = lost_in_a_row_ = 0;
}

void LinkQuality::Add(Answer answer) {
  Answer& slot = history_[static_cast<std::size_t>(next_)];
  answered_ += (answer == Answer::kReceived) - (slot == Answer::kReceived);
  lost_ += (answer == Answer::kLost) - (slot == Answer::kLost);
  slot = answer;
  next_ = (next_ + 1) % window_;
  if (answer == Answer::kReceived) lost_in_a_row_ = 0;
  if (answer == Answer::kLost) ++lost_in_a_row_;
}

int LinkQuality::level() const {
  if (TooManyInARow() || answered_ < params_.fair_after_answers) return 0;
  if (answered_ < params_.good_after_answers || lost_ > params_.good_max_lost_per_s) return 1;
  if (answered_ < params_.excellent_after_answers || lost_ > 0) return 2;
  return 3;
}

}  // namespace osteon::hil
