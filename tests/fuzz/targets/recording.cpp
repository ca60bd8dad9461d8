#include <cstring>

#include "io/recording/recording_reader.h"
#include "io/recording/recovery.h"
#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: a recording (MCAP). Bit 0 of the input's byte 0 says whether the checksums are first set to
// "not available", so that changed data are read. The rest of the input is the file.

namespace osteon::fuzz {
namespace {

constexpr std::size_t kHead = 9;       // size of a record's opcode and length
constexpr std::size_t kChunkCrc = 24;  // offset of the CRC in a chunk, behind two times and a size
constexpr std::uint8_t kChunk = 0x06, kDataEnd = 0x0f;

// Sets all checksums to 0, which means "not available". The function follows the layout in docs/recording.md
// and is independent of the reader under test.
void ClearChecksums(std::string& bytes) {
  for (std::size_t at = 8; at + kHead <= bytes.size();) {
    const auto opcode = static_cast<std::uint8_t>(bytes[at]);
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at + 1, sizeof(length));
    if (length > bytes.size() - at - kHead) return;
    if (opcode == kChunk && length >= kChunkCrc + 4) std::memset(bytes.data() + at + kHead + kChunkCrc, 0, 4);
    if (opcode == kDataEnd && length >= 4) std::memset(bytes.data() + at + kHead, 0, 4);
    at += kHead + length;
  }
}

// Largest ratio of unpacked to packed bytes: four bytes of a zstd frame may expand to 128 KiB.
constexpr std::size_t kMaxExpansion = 32768;

void ClaimAccepted(const io::Recording& recording, std::size_t size) {
  Claim(recording.read_bytes <= size, "no more is read than there is");
  Claim(recording.ticks.size() + recording.frames.size() + recording.events.size() <= kMaxExpansion * size,
        "a message takes a byte of what the file unpacks to, and more");
  for (const control::TickRecord& tick : recording.ticks)
    Claim(tick.session_state <= 4, "a session's state exists");
}

// Claims that recovery either makes a complete recording of the readable part of a file, or refuses the file.
void ClaimRecovers(const std::filesystem::path& path, const std::filesystem::path& to, std::size_t size,
                   const tl::expected<io::Recording, std::string>& recording) {
  const auto recovery = io::RecoverRecording(path, to);
  if (!recovery) {
    Claim(recovery.error().starts_with(path.string() + ": "), "an error names the file");
    Claim(!recording || recording->ticks.empty() || !recording->complete, "a whole recording recovers");
    return;
  }
  if (recovery->was_whole) {
    Claim(recording.has_value() && recording->complete, "what is whole can be read");
    return;
  }
  const auto again = io::ReadRecording(to);
  Claim(again && again->complete, "what was recovered is whole");
  Claim(again->ticks.size() == recovery->ticks && again->frames.size() == recovery->frames &&
            again->events.size() == recovery->events,
        "and has the messages that were counted");
  Claim(recovery->messages <= kMaxExpansion * size, "a message takes a byte of what the file unpacks to");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const fuzz::FuzzFile scratch("fuzz.mcap");
  fuzz::Input in(data, size);
  const bool clear_checksums = (in.Byte() & 1u) != 0;
  std::string bytes = fuzz::Text(in.Rest());
  if (clear_checksums) fuzz::ClearChecksums(bytes);
  scratch.Write(bytes);
  const auto recording = io::ReadRecording(scratch.path());
  if (recording)
    fuzz::ClaimAccepted(*recording, bytes.size());
  else
    fuzz::ClaimNamesByte(recording.error(), scratch.path(), bytes.size());
  fuzz::ClaimRecovers(scratch.path(), scratch.Beside("recovered.mcap"), bytes.size(), recording);
  return 0;
}
