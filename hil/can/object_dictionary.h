#pragma once

#include <cstdint>
#include <vector>

#include "hil/can/frame_queue.h"

namespace osteon::hil {

/// An entry of the simulated drive's object dictionary.
struct DictionaryEntry {
  int index{0}, sub{0};
  int bytes{4};                           ///< length of the value
  bool writable{false}, mappable{false};  ///< by SDO; into a PDO
  std::uint32_t value{0};
};

/// A CANopen object dictionary with its SDO server. Only expedited transfers; anything else is aborted with
/// the code of CiA 301.
class ObjectDictionary {
 public:
  explicit ObjectDictionary(std::vector<DictionaryEntry> entries) : entries_(std::move(entries)) {}

  [[nodiscard]] DictionaryEntry* Find(int index, int sub) noexcept;
  /// Returns the entry's value; 0 if there is no such entry.
  [[nodiscard]] std::uint32_t Get(int index, int sub = 0) const noexcept;
  /// The value as two's complement of the entry's length.
  [[nodiscard]] int GetSigned(int index, int sub = 0) const noexcept;
  /// Keeps the lower bytes of the value, as many as the entry has.
  void Set(int index, int sub, long value) noexcept;

  /// Called before a write takes effect: returns an abort code, or 0 to allow it.
  using Guard = std::uint32_t (*)(void* self, const DictionaryEntry& entry, std::uint32_t value);

  /// Answers one request of 8 bytes into `out`. True if an entry was written.
  bool Serve(const io::CanFrame& request, std::uint16_t answer_id, FrameQueue& out, Guard guard,
             void* self) noexcept;

 private:
  std::vector<DictionaryEntry> entries_;
};

}  // namespace osteon::hil
