#include "io/recording/messages.h"

#include <google/protobuf/descriptor.pb.h>

#include "base/utf8.h"
#include "io/recording/message_parts.h"

namespace osteon::io {

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
  if (message.has_tool_diameter_m()) session.config.tool_diameter_m = message.tool_diameter_m();
  return {};
}

void Encode(const RecordedEvent& event, std::string& bytes) {
  Event message;
  message.set_stamp_ns(event.stamp);
  message.set_text(base::Utf8(event.text));
  message.SerializeToString(&bytes);
}

std::string Decode(std::span<const char> bytes, RecordedEvent& event) {
  Event message;
  if (!Parse(bytes, message)) return "not an osteon.Event";
  event = {.stamp = message.stamp_ns(), .text = message.text()};
  return {};
}

}  // namespace osteon::io
