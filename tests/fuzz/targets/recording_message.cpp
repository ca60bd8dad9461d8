#include "io/recording/messages.h"
#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: one message of a recording. The input's byte 0 selects the kind of message; the rest is the
// message.

namespace osteon::fuzz {
namespace {

// Claims that an accepted message can be encoded, and decodes to the same message.
template <typename Record>
void ClaimRoundTrip(const std::string& bytes) {
  Record record;
  const std::string wrong = io::Decode(bytes, record);
  if (!wrong.empty()) return;
  std::string first, second;
  io::Encode(record, first);
  Record again;
  Claim(io::Decode(first, again).empty(), "what was read can be written, and read");
  io::Encode(again, second);
  Claim(first == second, "and is then the same");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  fuzz::Input in(data, size);
  const unsigned kind = in.Byte() & 3u;
  const std::string bytes = fuzz::Text(in.Rest());
  switch (kind) {
    case 0:
      fuzz::ClaimRoundTrip<io::SessionInfo>(bytes);
      break;
    case 1:
      fuzz::ClaimRoundTrip<control::TickRecord>(bytes);
      break;
    case 2:
      fuzz::ClaimRoundTrip<simulation::FrameRecord>(bytes);
      break;
    default:
      fuzz::ClaimRoundTrip<io::RecordedEvent>(bytes);
  }
  return 0;
}
