// SPDX-License-Identifier: Apache-2.0
#include "top_page.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>

#include "../output.hpp"
#include "health_text.hpp"
#include "status_text.hpp"
#include "task_table.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

/// As many of `count` things as fit into so many lines, and how many do not.
std::string fitting(std::size_t count, std::size_t lines,
                    const std::function<std::string(std::size_t shown)>& text_of) {
  for (std::size_t shown = std::min(count, lines);; --shown) {
    std::string text = text_of(shown);
    if (shown < count) text += fmt::format("... {} more\n", count - shown);
    if (shown == 0 || line_count(text) <= lines) return text;
  }
}

/// The first lines of the text.
std::string first_lines(const std::string& text, std::size_t lines) {
  return fitting(line_count(text), lines, [&](std::size_t shown) {
    std::size_t end = 0;
    for (std::size_t line = 0; line < shown; ++line)
      end = text.find('\n', end) + 1;
    return text.substr(0, end);
  });
}

Value::List first_of(const Value::List& list, std::size_t count) {
  return {list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count)};
}

/// Those that dropped samples, the most first.
Value::List dropping_connections(const Value& status) {
  Value::List list = list_at(status, "connections");
  std::erase_if(list, [](const Value& connection) { return number_at(connection, "dropped") <= 0; });
  std::ranges::stable_sort(list, std::ranges::greater(),
                           [](const Value& connection) { return number_at(connection, "dropped"); });
  return list;
}

std::string dropping_table(const Value::List& connections) {
  constexpr auto kRight = Table::Align::Right;
  Table table({{"DROPS SAMPLES FROM"}, {"TO"}, {"WRITTEN", kRight}, {"DROPPED", kRight}});
  for (const Value& connection : connections) {
    table.add({printable_at(connection, "from"), printable_at(connection, "to"),
               fmt::format("{}", number_at(connection, "written")),
               coloured(Colour::Yellow, fmt::format("{}", number_at(connection, "dropped")))});
  }
  return table.text();
}

std::string share_cell(std::optional<double> share) {
  return share ? fmt::format("{:.1f} %", 100 * *share) : std::string("-");
}

}  // namespace

void ProcessorShares::look_at(const Value& status, TimePoint now) {
  const double elapsed_us = seconds(now - last_) * 1e6;
  std::map<std::string, Use> uses;
  for (const Value& task : list_at(status, "tasks")) {
    const std::string id = printable_at(task, "id");
    Use use{number_at(task, "cpu_us"), std::nullopt};
    const auto before = uses_.find(id);
    // It is less where a task of that name was made anew.
    if (before != uses_.end() && elapsed_us > 0 && use.cpu_us >= before->second.cpu_us)
      use.share = (use.cpu_us - before->second.cpu_us) / elapsed_us;
    uses.emplace(id, use);
  }
  uses_ = std::move(uses);
  last_ = now;
}

std::optional<double> ProcessorShares::of(const std::string& task) const {
  const auto found = uses_.find(task);
  return found == uses_.end() ? std::nullopt : found->second.share;
}

void sort_tasks(Value& status, const std::string& key, const ProcessorShares& shares) {
  Value* tasks = status.is_map() ? status.as_map().find("tasks") : nullptr;
  if (tasks == nullptr || !tasks->is_list()) return;
  const auto id_of = [](const Value& task) { return printable_at(task, "id"); };
  if (key == "name") return std::ranges::stable_sort(tasks->as_list(), {}, id_of), void();
  const std::string field = key == "missed" ? key : key + "_us";
  // Tasks whose share is not known yet come after the others, by their time.
  std::ranges::stable_sort(tasks->as_list(), std::ranges::greater(), [&](const Value& task) {
    const auto share = key == "cpu" ? shares.of(id_of(task)) : std::nullopt;
    return std::pair(share.value_or(-1), number_at(task, field));
  });
}

std::string top_heading(const Value& status) {
  const std::string controller = printable_at(status, "controller");
  return fmt::format("{}: {}, {}; up {}; {} tasks, {} connections\n",
                     coloured(Colour::Bold, printable_at(status, "robot")),
                     controller.empty() ? "the empty network" : controller, state_text(status),
                     format_seconds(number_at(status, "uptime_s")), list_at(status, "tasks").size(),
                     list_at(status, "connections").size());
}

std::string top_page(const Value& status, const ProcessorShares& shares, PageSize size) {
  const std::size_t rows = std::max<std::size_t>(size.rows, 8) - 2;  // the last two are the caller's
  const auto head =
      folded_lines(top_heading(status) + state_lines(status) + faults_text(status), size.columns);
  std::string page = first_lines(head, rows / 2);
  const auto dropping = dropping_connections(status);
  std::string drops;
  if (!dropping.empty()) {
    drops = '\n' + fitting(dropping.size(), rows / 4,
                           [&](std::size_t shown) { return dropping_table(first_of(dropping, shown)); });
  }
  const auto& tasks = list_at(status, "tasks");
  const std::size_t taken = line_count(page) + 1 + line_count(drops);
  if (!tasks.empty()) {
    page += '\n' + fitting(tasks.size(), rows - std::min(rows, taken), [&](std::size_t shown) {
              return use_table(first_of(tasks, shown), size.columns,
                               [&](const std::string& task) { return share_cell(shares.of(task)); });
            });
  }
  return page + drops;
}

}  // namespace segue::cli
