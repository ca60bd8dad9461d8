#include "studies/bench/loopback_baseline.h"

#include <unistd.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>

namespace osteon::studies {
namespace {

constexpr const char* kLoopback = "127.0.0.1";

// Opens a socket on a free port of the loopback interface.
io::BoundUdp Bind() {
  const auto bound = io::BindUdp("bare exchange", kLoopback, 0);
  if (!bound) throw std::runtime_error(bound.error());
  return *bound;
}

// Sends one datagram. @returns false if it was not sent whole
bool SendTo(const io::BoundUdp& from, const io::BoundUdp& to, std::span<const std::uint8_t> bytes) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(to.port);
  return sendto(from.socket, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                reinterpret_cast<const sockaddr*>(&address),
                sizeof address) == static_cast<ssize_t>(bytes.size());
}

// Reads one datagram that has arrived. @returns false if there is none
bool Read(const io::BoundUdp& at, std::span<std::uint8_t> room) {
  return io::ReadDatagram(at.socket, room).read == io::Datagram::Read::kTaken;
}

}  // namespace

LoopbackBaseline::LoopbackBaseline() : ours_(Bind()), theirs_(Bind()) {}

LoopbackBaseline::~LoopbackBaseline() {
  close(ours_.socket);
  close(theirs_.socket);
}

double LoopbackBaseline::Time(std::size_t message, std::size_t answer) {
  const std::span<std::uint8_t> bytes(bytes_);
  bool succeeded = SendTo(theirs_, ours_, bytes.first(std::min(message, bytes.size())));
  const rt::Nanoseconds begun = rt::MonotonicNow();
  succeeded = Read(ours_, bytes) && succeeded;
  succeeded = SendTo(ours_, theirs_, bytes.first(std::min(answer, bytes.size()))) && succeeded;
  const rt::Nanoseconds ended = rt::MonotonicNow();
  if (!Read(theirs_, bytes) || !succeeded) throw std::runtime_error("the loopback lost a datagram");
  return 1e-3 * static_cast<double>(ended - begun);
}

}  // namespace osteon::studies
