// SPDX-License-Identifier: Apache-2.0
#include <segue/host/wire.hpp>

#include <segue/base/text.hpp>
#include <segue/link/local.hpp>

namespace segue::host::detail {

Result<Wire> lay_wire(const WireEnd& from, const WireEnd& to, const model::Connection& connection) {
  if (auto grown = grow(from, connection.from, model::Direction::Output); !grown) {
    return std::move(grown.error());
  }
  if (auto grown = grow(to, connection.to, model::Direction::Input); !grown) {
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
  auto made = link::connect(**output, **input, connection.policy);
  if (!made) {
    return std::move(made.error());
  }
  return Wire(std::move(*made));
}

}  // namespace segue::host::detail
