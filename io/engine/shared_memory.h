#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/marker.h"
#include "io/engine/codec.h"

// The memory that a run and its engine share. Neither side relies on valid content: each side copies a
// message before it decodes the message, and bounds every index that the other side can write.

namespace osteon::io {

static_assert(std::atomic<std::uint8_t>::is_always_lock_free &&
              std::atomic<std::uint32_t>::is_always_lock_free &&
              std::atomic<std::uint64_t>::is_always_lock_free);

/// One message in shared memory.
struct alignas(64) SharedMessage {
  std::uint32_t size;
  std::array<std::uint8_t, kEngineMaxMessage> bytes;
};

/// The shared part of a triple buffer that passes the newest message without waiting (rt::LatestValue does
/// the same within a process). Each side owns one buffer and stores that buffer's index in its own process.
/// The atomic byte `middle` holds the index of the third buffer.
///
/// Writer: one SlotWriter; reader: one SlotReader. Memory order: both exchange with acquire and release.
struct SharedSlot {
  static constexpr std::uint8_t kIndex = 3;  ///< mask of the index in `middle`
  static constexpr std::uint8_t kFresh = 4;  ///< bit in `middle`: the reader does not have this message yet
  std::array<SharedMessage, 3> messages;
  alignas(64) std::atomic<std::uint8_t> middle;  ///< initially 1
};

/// The writer of a SharedSlot.
class SlotWriter {
 public:
  explicit SlotWriter(SharedSlot& slot) : slot_(slot) {}
  void Store(const EngineBytes& message) OSTEON_RT {
    SharedMessage& back = slot_.messages[back_];
    back.size = static_cast<std::uint32_t>(message.size);
    std::memcpy(back.bytes.data(), message.bytes.data(), message.size);
    const std::uint8_t old = slot_.middle.exchange(static_cast<std::uint8_t>(back_ | SharedSlot::kFresh),
                                                   std::memory_order_acq_rel) &
                             SharedSlot::kIndex;
    if (old < slot_.messages.size()) back_ = old;
  }

 private:
  SharedSlot& slot_;
  std::uint8_t back_{0};
};

/// The reader of a SharedSlot.
class SlotReader {
 public:
  explicit SlotReader(SharedSlot& slot) : slot_(slot) {}
  /// Copies the newest message. Returns false if there is no new message.
  bool Load(EngineBytes& message) OSTEON_RT {
    if ((slot_.middle.load(std::memory_order_relaxed) & SharedSlot::kFresh) == 0) return false;
    const std::uint8_t old = slot_.middle.exchange(front_, std::memory_order_acq_rel) & SharedSlot::kIndex;
    if (old >= slot_.messages.size()) return false;
    front_ = old;
    Copy(slot_.messages[front_], message);
    return true;
  }

  /// Copies a message; if its size is invalid, the result is empty.
  static void Copy(const SharedMessage& from, EngineBytes& to) OSTEON_RT {
    const std::uint32_t size = from.size;
    to.size = size <= to.bytes.size() ? size : 0;
    std::memcpy(to.bytes.data(), from.bytes.data(), to.size);
  }

 private:
  SharedSlot& slot_;
  std::uint8_t front_{2};
};

/// A ring that passes all frames in order from one writer to one reader. A full ring refuses further frames.
/// Memory order: the writer releases `written`, the reader releases `read`.
struct SharedRing {
  static constexpr std::size_t kMessages = 1024;  // 1 s at 1000 frames/s
  std::array<SharedMessage, kMessages> messages;
  alignas(64) std::atomic<std::uint64_t> written;
  alignas(64) std::atomic<std::uint64_t> read;

  /// False if the ring is full.
  bool Push(const EngineBytes& message) OSTEON_RT {
    const std::uint64_t at = written.load(std::memory_order_relaxed);
    if (at - read.load(std::memory_order_acquire) >= kMessages) return false;
    SharedMessage& to = messages[at % kMessages];
    to.size = static_cast<std::uint32_t>(message.size);
    std::memcpy(to.bytes.data(), message.bytes.data(), message.size);
    written.store(at + 1, std::memory_order_release);
    return true;
  }
  /// False if the ring is empty.
  bool Pop(EngineBytes& message) OSTEON_RT {
    const std::uint64_t at = read.load(std::memory_order_relaxed);
    if (at == written.load(std::memory_order_acquire)) return false;
    SlotReader::Copy(messages[at % kMessages], message);
    read.store(at + 1, std::memory_order_release);
    return true;
  }
};

/// Progress of one side, the run or the engine.
enum class SharedState : std::uint32_t { kStarting, kRunning, kEnding, kEnded, kFailed };

/// The whole segment.
struct SharedEngine {
  std::array<char, 8> magic;  ///< "OSTSHARE", written last
  std::uint32_t version;      ///< kEngineVersion
  std::uint64_t session;
  alignas(64) std::atomic<SharedState> run, engine;
  SharedSlot commands, models;  ///< newest command, and newest frame
  SharedRing frames;            ///< every frame
  std::array<char, 64> engine_name;
  std::array<char, 256> device;
  std::array<char, 512> error;  ///< why the engine failed
};

}  // namespace osteon::io
