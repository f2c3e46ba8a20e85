// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/gantt.hpp>
#include <segue/type/json.hpp>

namespace segue::draw {

using type::Value;
using type::ValueMap;

namespace {

double in_seconds(TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

Value trace_event(const Gantt& gantt, const Gantt::Bar& bar, int process, std::size_t row) {
  const double from = in_seconds(bar.from);
  return Value::map({{"name", gantt.nodes[bar.node].name},
                     {"ph", "X"},
                     {"ts", from * 1e6},
                     {"dur", (in_seconds(bar.until) - from) * 1e6},
                     {"pid", process},
                     {"tid", static_cast<std::uint64_t>(row)}});
}

Value trace_name(const char* what, const std::string& name, int process, std::size_t row) {
  return Value::map({{"name", what},
                     {"ph", "M"},
                     {"pid", process},
                     {"tid", static_cast<std::uint64_t>(row)},
                     {"args", Value::map({{"name", name}})}});
}

}  // namespace

std::string to_trace(const Gantt& gantt) {
  Value::List events;
  events.push_back(trace_name("process_name", "nodes", 1, 0));
  events.push_back(trace_name("process_name", "resources", 2, 0));
  for (const Gantt::Bar& bar : gantt.bars) {
    Value event = trace_event(gantt, bar, 1, bar.lane);
    ValueMap details;
    details.set("wasted", bar.wasted);
    for (const task_network::Wait& wait : gantt.nodes[bar.node].waits)
      details.set(std::string(to_string(wait.kind)), wait.subject);
    event.as_map().set("args", std::move(details));
    events.push_back(std::move(event));
  }
  for (std::size_t i = 0; i < gantt.resources.size(); ++i) {
    events.push_back(trace_name("thread_name", gantt.resources[i].name, 2, i));
    for (const std::uint32_t bar : gantt.resources[i].bars)
      events.push_back(trace_event(gantt, gantt.bars[bar], 2, i));
  }
  return type::to_json(Value::map({{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}), -1) +
         "\n";
}

}  // namespace segue::draw
