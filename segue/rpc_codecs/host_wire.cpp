// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/host_wire.hpp>

namespace segue::control::detail {

namespace {

constexpr auto kEncodeHostPart = [](const auto& item, auto builder) { encode(item, builder); };
constexpr auto kDecodeHostPart = [](const auto& part) { return decode(part); };

void encode_library(const distributed::LibraryInfo& library, wire::Library::Builder builder) {
  builder.setName(as_text(library.name));
  builder.setDigest(as_text(library.digest));
  auto components = builder.initComponents(count_of(library.components));
  for (unsigned i = 0; i < library.components.size(); ++i)
    components.set(i, as_text(library.components[i].str()));
}

distributed::LibraryInfo decode_library(wire::Library::Reader reader) {
  return {as_string(reader.getName()), as_string(reader.getDigest()),
          decode_list<model::ComponentName>(reader.getComponents(), [](capnp::Text::Reader name) {
            return model::ComponentName(as_string(name));
          })};
}

}  // namespace

void encode(const distributed::HostInfo& info, wire::HostInfo::Builder builder) {
  builder.setName(as_text(info.name.str()));
  builder.setSoftware(as_text(info.software));
  builder.setArchitecture(as_text(info.architecture));
  builder.setPid(info.pid);
  encode_list(info.libraries, builder.initLibraries(count_of(info.libraries)), encode_library);
}

distributed::HostInfo decode(wire::HostInfo::Reader reader) {
  return {model::HostName(as_string(reader.getName())), as_string(reader.getSoftware()),
          as_string(reader.getArchitecture()), reader.getPid(),
          decode_list<distributed::LibraryInfo>(reader.getLibraries(), decode_library)};
}

void encode(const distributed::LeaseInfo& lease, wire::Lease::Builder builder) {
  builder.setRobot(as_text(lease.robot));
  builder.setHolder(as_text(lease.holder));
  builder.setEpoch(lease.epoch);
  builder.setLeft(lease.left.count());
}

distributed::LeaseInfo decode(wire::Lease::Reader reader) {
  return {as_string(reader.getRobot()), as_string(reader.getHolder()), reader.getEpoch(),
          Duration(reader.getLeft())};
}

void encode(const process_server::LogPosition& position, wire::LogPosition::Builder builder) {
  builder.setFile(position.file);
  builder.setOffset(position.offset);
}

process_server::LogPosition decode(wire::LogPosition::Reader reader) {
  return {reader.getFile(), reader.getOffset()};
}

void encode(const distributed::LinkWait& link, wire::LinkWait::Builder builder) {
  builder.setTask(as_text(link.task.str()));
  builder.setCount(static_cast<std::uint32_t>(link.count));
}

distributed::LinkWait decode(wire::LinkWait::Reader reader) {
  return {model::TaskId(as_string(reader.getTask())), static_cast<int>(reader.getCount())};
}

void encode(const distributed::ModelFile& file, wire::ModelFile::Builder builder) {
  builder.setName(as_text(file.name));
  builder.setText(as_data(file.text));
}

distributed::ModelFile decode(wire::ModelFile::Reader reader) {
  return {as_string(reader.getName()), as_string(reader.getText())};
}

void encode(const distributed::HostView& view, wire::View::Builder builder) {
  encode(view.network, builder.initNetwork());
  encode_list(view.tasks, builder.initTasks(count_of(view.tasks)), kEncodeHostPart);
  encode_list(view.connections, builder.initConnections(count_of(view.connections)), kEncodeHostPart);
}

distributed::HostView decode(wire::View::Reader reader) {
  return {decode(reader.getNetwork()), decode_list<task_host::TaskReport>(reader.getTasks(), kDecodeHostPart),
          decode_list<task_host::ConnectionReport>(reader.getConnections(), kDecodeHostPart)};
}

void encode(const task_host::HostEvent& event, wire::HostEvent::Builder builder) {
  if (const auto* task = std::get_if<task_host::TaskEvent>(&event)) {
    encode(*task, builder.initTask());
  } else if (const auto* process = std::get_if<task_host::ProcessEvent>(&event)) {
    auto part = builder.initProcess();
    part.setHost(as_text(process->process.host.str()));
    part.setProcess(as_text(process->process.process.str()));
    part.setMessage(as_text(process->message));
    part.setGone(process->gone);
  }
}

task_host::HostEvent decode(wire::HostEvent::Reader reader) {
  if (reader.isTask()) return decode(reader.getTask());
  const auto part = reader.getProcess();
  return task_host::ProcessEvent{
      {model::HostName(as_string(part.getHost())), model::ProcessName(as_string(part.getProcess()))},
      as_string(part.getMessage()),
      part.getGone()};
}

}  // namespace segue::control::detail
