// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_file_parts.hpp>

#include <utility>

/// Actions that pools of processes carry out, in mission files.
namespace segue::mission::detail {

using type::Value;
using type::ValueMap;

namespace {

void read_operation(PoolCall& call, Fields& fields, const Source& source) {
  const Value* map = fields.require("call", "name the operation, as in {plan: {from: \"{start}\"}}");
  if (map == nullptr) return;
  if (!map->is_map() || map->as_map().size() != 1) {
    source.error("bad-call",
                 fields.what() +
                     ": 'call' must be one operation with its arguments, as in {plan: {from: "
                     "\"{start}\"}}",
                 *map);
    return;
  }
  const auto& [operation, arguments] = *map->as_map().begin();
  call.operation = operation;
  call.arguments = arguments.is_null() ? Value(ValueMap{}) : arguments;
  call.where = source.at(arguments);
  if (!call.arguments.is_map()) {
    source.error("bad-call",
                 fields.what() + ": the arguments of " + quote(operation) + " must be a map, got " +
                     type::describe(arguments),
                 arguments);
  }
}

}  // namespace

PoolCall read_pool_call(Fields& fields, const Source& source) {
  PoolCall call;
  call.pool = fields.name("pool");
  read_operation(call, fields, source);
  call.outcome_from = fields.text("outcome_from");
  call.timeout = fields.duration("timeout").value_or(call.timeout);
  if (call.timeout <= Duration::zero()) {
    source.error("bad-duration", fields.what() + ": 'timeout' must be positive", *fields.find("timeout"));
  }
  if (const Value* outputs = fields.find("outputs", Value::Kind::Map)) {
    for (const auto& [output, field] : outputs->as_map()) {
      const auto name = model::detail::scalar_text(field);
      if (!name || name->empty()) {
        source.error("bad-field",
                     fields.what() + ": output " + quote(output) +
                         " needs the name of a field of the answer, or 'value' for the answer itself",
                     field);
      }
      call.outputs.push_back({output, name.value_or(""), source.at(field)});
    }
  }
  return call;
}

Value write_pool_call(const PoolCall& call) {
  ValueMap map;
  map.append("pool", call.pool);
  map.append("call", Value::map({{call.operation, call.arguments}}));
  if (!call.outcome_from.empty()) map.append("outcome_from", call.outcome_from);
  ValueMap outputs;
  for (const ResultField& one : call.outputs)
    outputs.append(one.output, one.field);
  if (!outputs.empty()) map.append("outputs", std::move(outputs));
  if (call.timeout != PoolCall{}.timeout) map.append("timeout", format_duration(call.timeout));
  return map;
}

}  // namespace segue::mission::detail
