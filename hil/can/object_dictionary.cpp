#include "hil/can/object_dictionary.h"

#include <algorithm>

namespace osteon::hil {
namespace {

// SDO abort codes (CiA 301).
constexpr std::uint32_t kNoObject = 0x06020000, kNoSub = 0x06090011, kReadOnly = 0x06010002,
                        kLength = 0x06070010, kCommand = 0x05040001;

// Queues an SDO answer: its command byte, the object, and a value or an abort code.
void Answer(FrameQueue& out, std::uint16_t id, int command, int index, int sub, std::uint32_t value) {
  out.Push(id, {command, index % 256, index / 256, sub, static_cast<int>(value % 256),
                static_cast<int>(value / 256 % 256), static_cast<int>(value / 65536 % 256),
                static_cast<int>(value / 16777216)});
}

}  // namespace

DictionaryEntry* ObjectDictionary::Find(int index, int sub) noexcept {
  for (DictionaryEntry& entry : entries_)
    if (entry.index == index && entry.sub == sub) return &entry;
  return nullptr;
}

std::uint32_t ObjectDictionary::Get(int index, int sub) const noexcept {
  for (const DictionaryEntry& entry : entries_)
    if (entry.index == index && entry.sub == sub) return entry.value;
  return 0;
}

int ObjectDictionary::GetSigned(int index, int sub) const noexcept {
  for (const DictionaryEntry& entry : entries_) {
    if (entry.index != index || entry.sub != sub) continue;
    const long whole = 1L << 8 * entry.bytes;
    const long value = entry.value;
    return static_cast<int>(value >= whole / 2 ? value - whole : value);
  }
  return 0;
}

void ObjectDictionary::Set(int index, int sub, long value) noexcept {
  DictionaryEntry* entry = Find(index, sub);
  if (entry == nullptr) return;
  const long whole = 1L << 8 * entry->bytes;
  entry->value = static_cast<std::uint32_t>((value % whole + whole) % whole);
}

bool ObjectDictionary::Serve(const io::CanFrame& request, std::uint16_t answer_id, FrameQueue& out,
                             Guard guard, void* self) noexcept {
  if (request.size != 8) return false;
  const auto& d = request.data;
  const int command = d[0], index = d[1] + 256 * d[2], sub = d[3];
  const auto abort = [&](std::uint32_t code) {
    Answer(out, answer_id, 0x80, index, sub, code);
    return false;
  };
  const bool read = command == 0x40;
  const bool write =
      command / 16 == 2 && command % 4 == 3;  // 0x23, 0x27, 0x2B, 0x2F: expedited, with its length
  if (!read && !write) return command == 0x80 ? false : abort(kCommand);

  DictionaryEntry* entry = Find(index, sub);
  if (entry == nullptr) {
    const bool known = std::any_of(entries_.begin(), entries_.end(),
                                   [index](const DictionaryEntry& e) { return e.index == index; });
    return abort(known ? kNoSub : kNoObject);
  }
  if (read) {
    // number of unused bytes of the answer's value, which its command holds in bits 2 and 3
    const int unused = 4 - entry->bytes;
    Answer(out, answer_id, 0x43 + 4 * unused, index, sub, entry->value);
    return false;
  }
  if (!entry->writable) return abort(kReadOnly);
  if (4 - command / 4 % 4 != entry->bytes) return abort(kLength);
  std::uint32_t value = 0;
  for (int i = entry->bytes; i > 0; --i) value = 256 * value + d[static_cast<std::size_t>(3 + i)];
  if (const std::uint32_t code = guard(self, *entry, value); code != 0) return abort(code);
  entry->value = value;
  Answer(out, answer_id, 0x60, index, sub, 0);
  return true;
}

}  // namespace osteon::hil
