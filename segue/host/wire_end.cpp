// SPDX-License-Identifier: Apache-2.0
#include <segue/host/wire_end.hpp>

#include <segue/base/text.hpp>
#include <segue/host/stand_in.hpp>

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

}  // namespace

Result<void> grow(const WireEnd& end, const model::PortRef& ref, model::Direction direction) {
  return end.stand_in ? grow_port(end.component, {ref.port, direction}, end.configured) : Result<void>{};
}

Result<task::OutputPortBase*> find_output(const task::HeldPorts& ports, const WireEnd& end,
                                          const model::PortRef& ref) {
  if (task::OutputPortBase* port = ports.find_output(end.component, ref.port)) {
    return port;
  }
  return no_port("output", ref, names_of(ports.outputs(end.component)), end.configured);
}

Result<task::InputPortBase*> find_input(const task::HeldPorts& ports, const WireEnd& end,
                                        const model::PortRef& ref) {
  if (task::InputPortBase* port = ports.find_input(end.component, ref.port)) {
    return port;
  }
  return no_port("input", ref, names_of(ports.inputs(end.component)), end.configured);
}

}  // namespace segue::host::detail
