#include "tests/hil/can/virtual_can.h"

#include <utility>

namespace osteon::hil {
namespace {

constexpr int kMaxRounds = 8;    // largest number of rounds of replies in one step
constexpr int kMaxFrames = 256;  // largest number of frames of a node in one round, so that a node that sends
                                 // without end does not hang the test

}  // namespace

void VirtualCan::Connect(const io::CanClient& node, bool connected) {
  for (Node& n : nodes_)
    if (n.client == &node) n.connected = connected;
}

bool VirtualCan::DrawEvent(double share) {
  return share > 0.0 && static_cast<double>(random_()) < share * 4294967296.0;
}

void VirtualCan::Damage(std::vector<OnTheWire>& wire) {
  std::vector<OnTheWire> arriving;
  for (OnTheWire& item : wire) {
    if (DrawEvent(params_.loss)) continue;
    if (DrawEvent(params_.corrupt)) {
      if (random_() % 8 == 0)
        item.frame.size = static_cast<std::uint8_t>(random_() % 9);
      else
        item.frame.data[random_() % 8] = static_cast<std::uint8_t>(random_());
      for (std::size_t i = item.frame.size; i < 8; ++i) item.frame.data[i] = 0;
    }
    arriving.push_back(item);
    if (DrawEvent(params_.duplicate)) arriving.push_back(item);
  }
  for (std::size_t i = 1; i < arriving.size(); ++i)
    if (DrawEvent(params_.reorder)) std::swap(arriving[i - 1], arriving[i]);
  wire = std::move(arriving);
}

void VirtualCan::Step(rt::Nanoseconds now) {
  busy_ = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<OnTheWire> wire;
    for (const Node& node : nodes_) {
      io::CanFrame frame;
      for (int i = 0; i < kMaxFrames && node.client->Next(now, frame); ++i)
        if (node.connected) wire.push_back({frame, node.client});
    }
    if (wire.empty()) return;
    Damage(wire);
    for (const OnTheWire& item : wire) {
      busy_ += params_.frame_time;
      ++frames_;
      for (const Node& node : nodes_)
        if (node.client != item.from && node.connected)
          node.client->Accept({.frame = item.frame, .stamp = now + busy_});
    }
  }
}

}  // namespace osteon::hil
