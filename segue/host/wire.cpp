// SPDX-License-Identifier: Apache-2.0
#include <segue/host/wire.hpp>

#include <segue/base/text.hpp>
#include <segue/host/stand_in.hpp>
#include <segue/link/local.hpp>
#include <segue/task/held_ports.hpp>

namespace segue::host::detail {

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

Result<void> grow(const WireEnd& end, const std::string& port, model::Direction direction) {
  return end.stand_in ? grow_port(end.component, {port, direction}, end.configured) : Result<void>{};
}

}  // namespace

Result<Wire> lay_wire(const WireEnd& from, const WireEnd& to, const model::Connection& connection) {
  if (auto grown = grow(from, connection.from.port, model::Direction::Output); !grown) {
    return std::move(grown.error());
  }
  if (auto grown = grow(to, connection.to.port, model::Direction::Input); !grown) {
    return std::move(grown.error());
  }
  const task::HeldPorts ports(from.component, to.component);
  task::OutputPortBase* output = ports.find_output(from.component, connection.from.port);
  if (output == nullptr) {
    return no_port("output", connection.from, names_of(ports.outputs(from.component)), from.configured);
  }
  task::InputPortBase* input = ports.find_input(to.component, connection.to.port);
  if (input == nullptr) {
    return no_port("input", connection.to, names_of(ports.inputs(to.component)), to.configured);
  }
  const Transport wanted = connection.policy.transport;
  if (wanted != Transport::Automatic && wanted != Transport::Local) {
    return fail(ErrorCode::Unsupported,
                "link " + quote(to_string(wanted)) +
                    " cannot carry a connection inside one process; leave 'link' out");
  }
  auto made = link::connect(*output, *input, connection.policy);
  if (!made) {
    return std::move(made.error());
  }
  return Wire(std::move(*made));
}

}  // namespace segue::host::detail
