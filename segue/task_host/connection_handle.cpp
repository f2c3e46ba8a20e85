// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/connection_handle.hpp>

#include <segue/base/text.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task_host/stand_in.hpp>

namespace segue::task_host::detail {

namespace {

template <class Port>
std::vector<std::string> names_of(const std::vector<Port*>& ports) {
  std::vector<std::string> names;
  for (const auto* port : ports) {
    names.push_back(port->name());
  }
  return names;
}

Error no_port(std::string_view direction, const model::PortRef& ref, const std::vector<std::string>& names,
              bool configured) {
  std::string hint = did_you_mean(ref.port, names);
  if (hint.empty()) {
    hint = names.empty() ? "; it has none" : "; there are " + listed(names);
  }
  if (!configured) {
    hint += " (dynamic ports exist once it is configured)";
  }
  return fail(ErrorCode::NotFound, "task " + quote(ref.task.str()) + " has no " + std::string(direction) +
                                       " port " + quote(ref.port) + hint);
}

}  // namespace

Result<void> add_missing_port(const ConnectionEnd& end, const model::PortRef& ref,
                              model::Direction direction) {
  return end.stand_in ? grow_port(end.component, {ref.port, direction}, end.configured) : Result<void>{};
}

Result<task::OutputPortBase*> find_output(const task::HeldPorts& ports, const ConnectionEnd& end,
                                          const model::PortRef& ref) {
  if (task::OutputPortBase* port = ports.find_output(end.component, ref.port)) {
    return port;
  }
  return no_port("output", ref, names_of(ports.outputs(end.component)), end.configured);
}

Result<task::InputPortBase*> find_input(const task::HeldPorts& ports, const ConnectionEnd& end,
                                        const model::PortRef& ref) {
  if (task::InputPortBase* port = ports.find_input(end.component, ref.port)) {
    return port;
  }
  return no_port("input", ref, names_of(ports.inputs(end.component)), end.configured);
}

Result<ConnectionHandle> connect_ports(const ConnectionEnd& from, const ConnectionEnd& to,
                                       const model::Connection& connection, task::CommitGatePtr gate) {
  if (auto grown = add_missing_port(from, connection.from, model::Direction::Output); !grown) {
    return std::move(grown.error());
  }
  if (auto grown = add_missing_port(to, connection.to, model::Direction::Input); !grown) {
    return std::move(grown.error());
  }
  const task::HeldPorts ports(from.component, to.component);
  const auto output = find_output(ports, from, connection.from);
  if (!output) {
    return output.error();
  }
  const auto input = find_input(ports, to, connection.to);
  if (!input) {
    return input.error();
  }
  const Transport wanted = connection.policy.transport;
  if (wanted != Transport::Automatic && wanted != Transport::Local) {
    return fail(ErrorCode::Unsupported,
                "link " + quote(to_string(wanted)) +
                    " cannot carry a connection inside one process; leave 'link' out");
  }
  auto made = sample_link::connect(**output, **input, connection.policy, std::move(gate));
  if (!made) {
    return std::move(made.error());
  }
  return ConnectionHandle(std::move(*made));
}

}  // namespace segue::task_host::detail
