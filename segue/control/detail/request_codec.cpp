// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/request_codec.hpp>

#include <segue/control/detail/services.hpp>
#include <segue/rpc/detail/wire.hpp>
#include <segue/type/value_at.hpp>

#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

/// A list of {"task", "property", "value"}.
Value listed(const std::vector<PropertySetting>& properties) {
  Value::List list;
  for (const PropertySetting& one : properties)
    list.push_back(Value::map({{"task", one.task.str()}, {"property", one.property}, {"value", one.value}}));
  return list;
}

/// Null is none.
Result<std::vector<PropertySetting>> properties_from(const Value& list) {
  std::vector<PropertySetting> properties;
  if (list.is_null()) return properties;
  if (!list.is_list()) return fail(ErrorCode::InvalidArgument, "the properties of a request must be a list");
  for (const Value& one : list.as_list()) {
    const Value* value = one.find("value");
    PropertySetting property{model::TaskId(text_at(one, "task")), text_at(one, "property"),
                             value == nullptr ? Value() : *value};
    if (property.task.empty() || property.property.empty() || value == nullptr)
      return fail(ErrorCode::InvalidArgument, "a property of a request needs 'task', 'property' and 'value'");
    properties.push_back(std::move(property));
  }
  return properties;
}

}  // namespace

std::string who_asks(std::string said, const Peer& peer) {
  if (peer.local) return said;
  return to_string(peer) + (said.empty() ? "" : ": " + said);
}

Result<void> encode(const RequestOptions& options, wire::RequestOptions::Builder builder) {
  const Value properties = listed(options.properties);
  if (auto fits = check_size(properties, kServerMessageWords); !fits) return fits;
  builder.setOrder(as_text(std::string(to_string(options.order))));
  builder.setActionTimeout(options.action_deadline.count());
  builder.setForce(options.force);
  builder.setWho(as_text(options.who));
  builder.setLease(options.lease);
  builder.setTakeOver(options.take_over);
  return encode(properties, builder.initProperties());
}

Result<RequestOptions> decode(wire::RequestOptions::Reader reader, const Peer& peer) {
  const auto order = model::order_named(as_string(reader.getOrder()));
  if (!order) return order.error();
  const auto list = decode(reader.getProperties(), kServerMessageWords);
  if (!list) return list.error();
  auto properties = properties_from(*list);
  if (!properties) return properties.error();
  return RequestOptions{.order = *order,
                        .action_deadline = Duration(reader.getActionTimeout()),
                        .force = reader.getForce(),
                        .who = who_asks(as_string(reader.getWho()), peer),
                        .properties = std::move(*properties),
                        .lease = reader.getLease(),
                        .take_over = reader.getTakeOver()};
}

void encode(const Sender& sender, wire::Sender::Builder builder) {
  builder.setWho(as_text(sender.who));
  builder.setLease(sender.lease);
  builder.setBesideMission(sender.beside_mission);
}

Sender decode(wire::Sender::Reader reader, const Peer& peer) {
  return {who_asks(as_string(reader.getWho()), peer), reader.getLease(), reader.getBesideMission()};
}

}  // namespace segue::control::detail
