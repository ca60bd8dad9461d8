#include "io/recording/messages.h"

#include <google/protobuf/descriptor.pb.h>

#include "base/utf8.h"
#include "io/recording/message_parts.h"

namespace osteon::io {
namespace {

// FillPacking converts a PackingRecord to a message; PackingOf converts it back.

void FillPacking(const PackingRecord& packing, Packing& message) {
  message.set_kind(packing.kind);
  message.set_spacing_m(packing.spacing_m);
  message.set_radius_m(packing.radius_m);
  message.set_surface_gap_m(packing.surface_gap_m);
  message.set_children(packing.children);
  message.set_zone_depth_m(packing.zone_depth_m);
  message.set_corner_m(packing.corner_m);
  message.set_error_m(packing.error_m);
  message.set_rate_hz(packing.rate_hz);
  message.set_timed(packing.timed);
  message.set_expected_error_m(packing.expected_error_m);
  message.set_promised_error_m(packing.promised_error_m);
  message.set_expected_frame_us(packing.expected_frame_us);
  message.set_seen_frame_us(packing.seen_frame_us);
  for (const PackingRecord::Unmet& unmet : packing.unmet) {
    Packing::Unmet* added = message.add_unmet();
    added->set_what(base::Utf8(unmet.what));
    added->set_asked(unmet.asked);
    added->set_predicted(unmet.predicted);
  }
  message.set_balls(packing.balls);
  message.set_balls_checksum(base::Utf8(packing.balls_checksum));
}

PackingRecord PackingOf(const Packing& message) {
  PackingRecord packing{.kind = message.kind(),
                        .spacing_m = message.spacing_m(),
                        .radius_m = message.radius_m(),
                        .surface_gap_m = message.surface_gap_m(),
                        .children = message.children(),
                        .zone_depth_m = message.zone_depth_m(),
                        .corner_m = message.corner_m(),
                        .error_m = message.error_m(),
                        .rate_hz = message.rate_hz(),
                        .timed = message.timed(),
                        .expected_error_m = message.expected_error_m(),
                        .promised_error_m = message.promised_error_m(),
                        .expected_frame_us = message.expected_frame_us(),
                        .seen_frame_us = message.seen_frame_us(),
                        .unmet = {},
                        .balls = message.balls(),
                        .balls_checksum = message.balls_checksum()};
  for (const Packing::Unmet& unmet : message.unmet())
    packing.unmet.push_back({.what = unmet.what(), .asked = unmet.asked(), .predicted = unmet.predicted()});
  return packing;
}

}  // namespace

std::string RecordingDescriptorSet() {
  google::protobuf::FileDescriptorSet set;
  Tick::descriptor()->file()->CopyTo(set.add_file());
  return set.SerializeAsString();
}

void Encode(const SessionInfo& session, std::string& bytes) {
  Session message;
  message.set_stamp_ns(session.stamp);
  message.set_version(base::Utf8(session.version));
  message.set_engine(base::Utf8(session.engine));
  message.set_device(base::Utf8(session.device));
  message.set_scene(base::Utf8(session.scene));
  message.set_tool(base::Utf8(session.tool));
  message.set_force_limit_n(session.force_limit_N);
  for (const std::string& limit : session.limits) message.add_limits(base::Utf8(limit));
  message.set_config_text(base::Utf8(session.config_text));
  for (const ConfigFile& file : session.config.files) {
    osteon::ConfigFile* added = message.add_config_files();
    added->set_name(base::Utf8(file.name));
    added->set_content(file.content);
  }
  message.set_cell_file(base::Utf8(session.config.cell_file));
  message.set_tool_file(base::Utf8(session.config.tool_file));
  message.set_gains_file(base::Utf8(session.config.gains_file));
  message.set_identified_file(base::Utf8(session.config.identified_file));
  if (session.config.tool_diameter_m) message.set_tool_diameter_m(*session.config.tool_diameter_m);
  message.set_config_folder(base::Utf8(session.config.folder));
  message.set_utc_ns(session.utc);
  message.set_build(base::Utf8(session.build));
  message.set_machine(base::Utf8(session.machine));
  if (session.packing) FillPacking(*session.packing, *message.mutable_packing());
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, SessionInfo& session) {
  Session message;
  if (!Parse(bytes, message)) return "not an osteon.Session";
  session = {.stamp = message.stamp_ns(),
             .version = message.version(),
             .engine = message.engine(),
             .device = message.device(),
             .scene = message.scene(),
             .tool = message.tool(),
             .force_limit_N = message.force_limit_n(),
             .limits = {message.limits().begin(), message.limits().end()},
             .config_text = message.config_text(),
             .config = {.files = {},
                        .cell_file = message.cell_file(),
                        .tool_file = message.tool_file(),
                        .gains_file = message.gains_file(),
                        .identified_file = message.identified_file(),
                        .folder = message.config_folder()},
             .utc = message.utc_ns(),
             .build = message.build(),
             .machine = message.machine()};
  for (const osteon::ConfigFile& file : message.config_files())
    session.config.files.push_back({.name = file.name(), .content = file.content()});
  if (message.has_packing()) session.packing = PackingOf(message.packing());
  if (message.has_tool_diameter_m()) session.config.tool_diameter_m = message.tool_diameter_m();
  return {};
}

void Encode(const RecordedEvent& event, std::string& bytes) {
  Event message;
  message.set_stamp_ns(event.stamp);
  message.set_text(base::Utf8(event.text));
  if (event.packing) {
    FillPacking(*event.packing, *message.mutable_packing());
    message.set_after_frame(event.after_frame);
  }
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, RecordedEvent& event) {
  Event message;
  if (!Parse(bytes, message)) return "not an osteon.Event";
  event = {.stamp = message.stamp_ns(), .text = message.text(), .after_frame = message.after_frame()};
  if (message.has_packing()) event.packing = PackingOf(message.packing());
  return {};
}

}  // namespace osteon::io
