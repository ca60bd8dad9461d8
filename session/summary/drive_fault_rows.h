#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "control/tick_record.h"

namespace osteon::session {

/// Faults of the reamer's drive that were latched in one tick, or their reset.
struct DriveFaultRow {
  double time_s{0.0};               ///< since the run's first tick
  std::uint8_t latched{0};          ///< newly latched io::DriveFault bits; 0: the drive was reset
  std::uint8_t nmt_state{0};        ///< NMT state (CiA 301)
  std::uint16_t emergency_code{0};  ///< code of the last EMCY message (CiA 301); 0: none
  std::uint16_t error_code{0};      ///< object 603F of CiA 402; 0: none
  std::string text;                 ///< the row in words, with the meaning of the codes
};

/// Collects the rows from the ticks: one whenever a further fault is latched, and one when the faults are
/// cleared.
class DriveFaultRows {
 public:
  void Add(const control::TickRecord& tick);
  [[nodiscard]] const std::vector<DriveFaultRow>& rows() const { return rows_; }

 private:
  std::vector<DriveFaultRow> rows_;
  std::optional<rt::Nanoseconds> start_;  // the first tick's stamp
  std::uint8_t before_{0};                // io::DriveFault bits of the tick before
};

}  // namespace osteon::session
