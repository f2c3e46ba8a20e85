// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/deployment_wire.hpp>

#include <utility>

namespace segue::control::detail {

namespace {

using model::TaskId;

constexpr auto kEncodePart = [](const auto& item, auto builder) { encode(item, builder); };
constexpr auto kDecodePart = [](const auto& part) { return decode(part); };

void encode_endpoint(const deploy::EndpointReport& endpoint, wire::EndpointReport::Builder builder) {
  encode(endpoint.connection, builder.initConnection());
  builder.setSide(static_cast<std::uint8_t>(endpoint.side));
  builder.setPeer(endpoint.peer);
  encode(endpoint.place, builder.initPlace());
  builder.setWritten(endpoint.counters.written);
  builder.setRead(endpoint.counters.read);
  builder.setDropped(endpoint.counters.dropped);
  builder.setOverwritten(endpoint.counters.overwritten);
  builder.setCorrupt(endpoint.corrupt);
  builder.setDamage(static_cast<std::uint8_t>(endpoint.damage));
  builder.setCarries(endpoint.carries);
  encode(endpoint.latency, builder.initLatency());
}

deploy::EndpointReport decode_endpoint(wire::EndpointReport::Reader reader) {
  deploy::EndpointReport endpoint;
  endpoint.connection = decode(reader.getConnection());
  endpoint.side = enum_from(reader.getSide(), deploy::Side::Input);
  endpoint.peer = reader.getPeer();
  endpoint.place = decode(reader.getPlace());
  endpoint.counters = {reader.getWritten(), reader.getRead(), reader.getDropped(), reader.getOverwritten()};
  endpoint.corrupt = reader.getCorrupt();
  endpoint.damage = enum_from(reader.getDamage(), sample_link::Damage::Payload);
  endpoint.carries = reader.getCarries();
  endpoint.latency = decode(reader.getLatency());
  return endpoint;
}

void encode_usage(const sample_link::MemoryUsage& usage, wire::MemoryUsage::Builder builder) {
  builder.setPayloadUsed(usage.payload_used);
  builder.setPayloadTouched(usage.payload_touched);
  builder.setControlUsed(usage.control_used);
  builder.setConnections(usage.connections);
  builder.setPeers(usage.peers);
}

sample_link::MemoryUsage decode_usage(wire::MemoryUsage::Reader reader) {
  return {reader.getPayloadUsed(), reader.getPayloadTouched(), reader.getControlUsed(),
          reader.getConnections(), reader.getPeers()};
}

}  // namespace

void encode(const deploy::DeploymentInfo& info, wire::Info::Builder builder) {
  builder.setRobot(as_text(info.robot));
  encode(info.deployment, builder.initDeployment());
  builder.setPid(info.pid);
  builder.setSoftware(as_text(info.software));
  builder.setIncarnation(info.incarnation);
}

deploy::DeploymentInfo decode(wire::Info::Reader reader) {
  return {as_string(reader.getRobot()), decode(reader.getDeployment()), reader.getPid(),
          as_string(reader.getSoftware()), reader.getIncarnation()};
}

void encode(const deploy::Snapshot& snapshot, wire::Snapshot::Builder builder) {
  encode(snapshot.network, builder.initNetwork());
  encode_list(snapshot.tasks, builder.initTasks(count_of(snapshot.tasks)), kEncodePart);
  encode_list(snapshot.connections, builder.initConnections(count_of(snapshot.connections)), kEncodePart);
  encode_list(snapshot.endpoints, builder.initEndpoints(count_of(snapshot.endpoints)), encode_endpoint);
  encode_usage(snapshot.memory, builder.initMemory());
  auto hanging = builder.initHanging(count_of(snapshot.hanging));
  for (unsigned i = 0; i < snapshot.hanging.size(); ++i)
    hanging.set(i, as_text(snapshot.hanging[i].str()));
}

deploy::Snapshot decode(wire::Snapshot::Reader reader) {
  deploy::Snapshot snapshot;
  snapshot.network = decode(reader.getNetwork());
  snapshot.tasks = decode_list<task_host::TaskReport>(reader.getTasks(), kDecodePart);
  snapshot.connections = decode_list<task_host::ConnectionReport>(reader.getConnections(), kDecodePart);
  snapshot.endpoints = decode_list<deploy::EndpointReport>(reader.getEndpoints(), decode_endpoint);
  snapshot.memory = decode_usage(reader.getMemory());
  snapshot.hanging = decode_list<TaskId>(reader.getHanging(),
                                         [](capnp::Text::Reader task) { return TaskId(as_string(task)); });
  return snapshot;
}

void encode(const sample_link::OutputOrigin& origin, wire::Origin::Builder builder) {
  builder.setWriter(origin.writer);
  builder.setSampleSize(origin.sample_size);
  builder.setFlat(origin.flat);
}

sample_link::OutputOrigin decode(wire::Origin::Reader reader) {
  return {reader.getWriter(), reader.getSampleSize(), reader.getFlat()};
}

void encode(const sample_link::InputPlace& place, wire::Place::Builder builder) {
  builder.setReader(place.reader);
  builder.setOffset(place.offset);
  builder.setGeneration(place.generation);
  builder.setAnyType(place.any_type);
  builder.setType(as_text(place.type));
  builder.setHash(place.hash);
  builder.setDefinition(as_text(place.definition));
  builder.setPort(as_text(place.port));
  builder.setTopic(as_text(place.topic));
}

sample_link::InputPlace decode(wire::Place::Reader reader) {
  sample_link::InputPlace place;
  place.reader = reader.getReader();
  place.offset = reader.getOffset();
  place.generation = reader.getGeneration();
  place.any_type = reader.getAnyType();
  place.type = as_string(reader.getType());
  place.hash = reader.getHash();
  place.definition = as_string(reader.getDefinition());
  place.port = as_string(reader.getPort());
  place.topic = as_string(reader.getTopic());
  return place;
}

void encode(const Result<sample_link::OutputOrigin>& origin, wire::OriginOutcome::Builder builder) {
  if (!origin) return encode(origin.error(), builder.initError());
  encode(*origin, builder.initOrigin());
}

Result<sample_link::OutputOrigin> decode(wire::OriginOutcome::Reader reader) {
  if (reader.isError()) return decode(reader.getError());
  return decode(reader.getOrigin());
}

void encode(const Result<sample_link::InputPlace>& place, wire::PlaceOutcome::Builder builder) {
  if (!place) return encode(place.error(), builder.initError());
  encode(*place, builder.initPlace());
}

Result<sample_link::InputPlace> decode(wire::PlaceOutcome::Reader reader) {
  if (reader.isError()) return decode(reader.getError());
  return decode(reader.getPlace());
}

void encode(const deploy::OpenInput& input, wire::OpenInput::Builder builder) {
  encode(input.connection, builder.initConnection());
  encode(input.origin, builder.initOrigin());
  builder.setAtCommit(input.at_commit);
}

deploy::OpenInput decode(wire::OpenInput::Reader reader) {
  return {decode(reader.getConnection()), decode(reader.getOrigin()), reader.getAtCommit()};
}

void encode(const deploy::AttachOutput& output, wire::AttachOutput::Builder builder) {
  encode(output.connection, builder.initConnection());
  encode(output.place, builder.initPlace());
  builder.setAtCommit(output.at_commit);
}

deploy::AttachOutput decode(wire::AttachOutput::Reader reader) {
  return {decode(reader.getConnection()), decode(reader.getPlace()), reader.getAtCommit()};
}

void encode(const deploy::ArmCommit::Endpoint& endpoint, wire::EndingEndpoint::Builder builder) {
  encode(endpoint.connection, builder.initConnection());
  builder.setSide(static_cast<std::uint8_t>(endpoint.side));
  builder.setPeer(endpoint.peer);
}

deploy::ArmCommit::Endpoint decode(wire::EndingEndpoint::Reader reader) {
  return {decode(reader.getConnection()), enum_from(reader.getSide(), deploy::Side::Input), reader.getPeer()};
}

void encode(const deploy::CloseEndpoint& endpoint, wire::CloseEndpoint::Builder builder) {
  encode(endpoint.connection, builder.initConnection());
  builder.setSide(static_cast<std::uint8_t>(endpoint.side));
  builder.setPeerClosed(endpoint.peer_closed);
  builder.setPeer(endpoint.peer);
}

deploy::CloseEndpoint decode(wire::CloseEndpoint::Reader reader) {
  return {decode(reader.getConnection()), enum_from(reader.getSide(), deploy::Side::Input),
          reader.getPeerClosed(), reader.getPeer()};
}

void encode(const process_server::ExitReason& reason, wire::ExitReason::Builder builder) {
  builder.setStatus(reason.status);
  builder.setSignal(reason.signal);
  builder.setCoreDumped(reason.core_dumped);
  builder.setKnown(reason.known);
  builder.setRequested(reason.requested);
  builder.setKilled(reason.killed);
}

process_server::ExitReason decode(wire::ExitReason::Reader reader) {
  return {reader.getStatus(), reader.getSignal(),    reader.getCoreDumped(),
          reader.getKnown(),  reader.getRequested(), reader.getKilled()};
}

void encode(const process_server::ProcessInfo& process, wire::ProcessInfo::Builder builder) {
  builder.setRobot(as_text(process.robot));
  builder.setHost(as_text(process.key.host.str()));
  builder.setProcess(as_text(process.key.process.str()));
  builder.setPid(process.pid);
  builder.setSocket(as_text(process.socket.native()));
  builder.setLog(as_text(process.log.native()));
  builder.setAdopted(process.adopted);
  if (process.exit) encode(*process.exit, builder.initExit());
}

process_server::ProcessInfo decode(wire::ProcessInfo::Reader reader) {
  process_server::ProcessInfo process;
  process.robot = as_string(reader.getRobot());
  process.key.host = model::HostName(as_string(reader.getHost()));
  process.key.process = model::ProcessName(as_string(reader.getProcess()));
  process.pid = reader.getPid();
  process.socket = as_string(reader.getSocket());
  process.log = as_string(reader.getLog());
  process.adopted = reader.getAdopted();
  if (reader.hasExit()) process.exit = decode(reader.getExit());
  return process;
}

}  // namespace segue::control::detail
