#pragma once

#include <cstdint>
#include <vector>

#include "hil/can/frame_queue.h"

namespace osteon::hil {

/// An entry of the simulated drive's object dictionary.
struct DictionaryEntry {
  int index{0}, sub{0};
  int bytes{4};                           ///< length of the value
  bool writable{false}, mappable{false};  ///< can be written by SDO; can be mapped to a PDO
  std::uint32_t value{0};
};

/// A CANopen object dictionary with its SDO server. The server supports only expedited transfers and aborts
/// all others with the code of CiA 301.
class ObjectDictionary {
 public:
  explicit ObjectDictionary(std::vector<DictionaryEntry> entries) : entries_(std::move(entries)) {}

  [[nodiscard]] DictionaryEntry* Find(int index, int sub) noexcept;
  /// Returns the entry's value; 0 if there is no such entry.
  [[nodiscard]] std::uint32_t Get(int index, int sub = 0) const noexcept;
  /// Returns the value as a signed number (two's complement of the entry's length).
  [[nodiscard]] int GetSigned(int index, int sub = 0) const noexcept;
  /// Sets the entry's value to the lower bytes of `value`, as many as the entry's length.
  void Set(int index, int sub, long value) noexcept;

  /// Function that is called before a write takes effect: returns an abort code, or 0 to allow the write.
  using Guard = std::uint32_t (*)(void* self, const DictionaryEntry& entry, std::uint32_t value);

  /// Answers one request of 8 bytes; queues the answer in `out`. Returns true if an entry was written.
  bool Serve(const io::CanFrame& request, std::uint16_t answer_id, FrameQueue& out, Guard guard,
             void* self) noexcept;

 private:
  std::vector<DictionaryEntry> entries_;
};

}  // namespace osteon::hil
