#pragma once

#include <array>
#include <cstdint>

namespace osteon::hil {

/// Parameters of the simulated arm's connection quality. KUKA does not publish how losses determine the
/// quality, nor how many losses end commanding. This policy is an assumption that tests can vary. For
/// comparison: iiQKA tolerates 5 lost answers in a row and 25 a second; Franka stops after 20 missed ones.
///
/// The quality follows from the answers due in the last second:
///
///     POOR       fewer than fair_after_answers, or end_after_lost_in_a_row lost in a row just now
///     FAIR       at least fair_after_answers answered
///     GOOD       at least good_after_answers answered and at most good_max_lost_per_s lost
///     EXCELLENT  at least excellent_after_answers answered and none lost
struct QualityPolicyParams {
  int fair_after_answers{10};
  int good_after_answers{50};
  int excellent_after_answers{90};
  int good_max_lost_per_s{10};
  int end_after_lost_in_a_row{5};  ///< number of consecutive lost answers that ends the commanding states
  int end_after_lost_per_s{25};    ///< number of lost answers within a second that ends the commanding states
  double good_timeout_s{10.0};  ///< a session that has not been GOOD within this time after opening is closed
};

/// The outcome of one due answer.
enum class Answer : std::uint8_t {
  kExcused,  ///< no answer came, and the arm itself was late
  kReceived,
  kLost,
};

/// Counts the answers of the last second and derives the connection quality from them.
class LinkQuality {
 public:
  static constexpr int kMaxWindow = 1000;

  /// @param answers_per_s answers due in one second, 1 … kMaxWindow.
  /// @throws std::invalid_argument if a level of the policy cannot be reached.
  LinkQuality(const QualityPolicyParams& params, int answers_per_s);

  void Reset();
  void Add(Answer answer);

  [[nodiscard]] int level() const;  ///< 0 poor, 1 fair, 2 good, 3 excellent
  [[nodiscard]] int lost_in_a_row() const { return lost_in_a_row_; }
  [[nodiscard]] int lost_per_s() const { return lost_; }
  [[nodiscard]] bool TooManyInARow() const { return lost_in_a_row_ >= params_.end_after_lost_in_a_row; }
  [[nodiscard]] bool TooManyPerSecond() const { return lost_ >= params_.end_after_lost_per_s; }

 private:
  QualityPolicyParams params_;
  int window_;                                // number of answers due in a second
  std::array<Answer, kMaxWindow> history_{};  // a ring of the last window_ answers
  int next_{0};
  int answered_{0}, lost_{0}, lost_in_a_row_{0};
};

}  // namespace osteon::hil
