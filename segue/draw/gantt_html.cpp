// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/draw/gantt_page.hpp>
#include <segue/type/json.hpp>

#include <initializer_list>
#include <utility>

namespace segue::draw {

using type::Value;

namespace {

double in_seconds(TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
double in_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

template <class Number>
std::uint64_t number(Number value) {
  return static_cast<std::uint64_t>(value);
}

Value wait_value(const task_network::Wait& wait) {
  const bool somebody = index(wait.node) != task_network::kNone;
  return Value::List{number(wait.kind), somebody ? Value(number(wait.node)) : Value(std::int64_t{-1}),
                     wait.subject, in_seconds(wait.from), in_seconds(wait.until)};
}

Value node_value(const Gantt::Node& node) {
  Value::List waits;
  for (const task_network::Wait& wait : node.waits)
    waits.push_back(wait_value(wait));
  Value::List resources;
  for (const std::uint32_t resource : node.resources)
    resources.emplace_back(number(resource));
  return Value::List{node.name,     number(node.kind), number(node.status), node.outcome,
                     node.critical, node.speculative,  std::move(waits),    std::move(resources)};
}

/// In the format that gantt_page_draw.js reads.
Value run_value(const Gantt& gantt) {
  Value::List nodes;
  for (const Gantt::Node& node : gantt.nodes)
    nodes.push_back(node_value(node));
  Value::List bars;
  for (const Gantt::Bar& bar : gantt.bars)
    bars.push_back(Value::List{number(bar.node), in_seconds(bar.from), in_seconds(bar.until), bar.wasted});
  Value::List resources;
  for (const Gantt::Resource& resource : gantt.resources)
    resources.emplace_back(resource.name);
  return Value::map({{"name", gantt.name},
                     {"outcome", gantt.outcome},
                     {"makespan", in_seconds(gantt.makespan)},
                     {"sequential", in_seconds(gantt.summary.sequential)},
                     {"critical_path", in_seconds(gantt.summary.critical_path)},
                     {"shortest", in_seconds(gantt.summary.shortest)},
                     {"wasted", gantt.statistics.wasted},
                     {"repeated", gantt.statistics.repeated},
                     {"nodes", std::move(nodes)},
                     {"bars", std::move(bars)},
                     {"resources", std::move(resources)}});
}

/// Escapes "<" in JSON, since "</script>" and "<!--" would end or hide the script in a page.
std::string script_safe(const std::string& json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  }
  return safe;
}

/// Replaces markers, each of which occurs once, in their order; inserted text is not searched for further
/// ones.
std::string filled(std::string_view page,
                   std::initializer_list<std::pair<std::string_view, std::string>> parts) {
  std::string text;
  for (const auto& [marker, part] : parts) {
    const auto at = page.find(marker);
    text.append(page.substr(0, at)).append(part);
    page.remove_prefix(at + marker.size());
  }
  return text.append(page);
}

}  // namespace

std::string to_html(const Gantt& gantt) {
  const std::string json = type::to_json(run_value(gantt), -1);
  return filled(detail::kGanttPage, {{"@title@", escape_markup(gantt.name)},
                                     {"@run@", script_safe(json)},
                                     {"@script@", std::string(detail::kGanttScript)}});
}

}  // namespace segue::draw
