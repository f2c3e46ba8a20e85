// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/stand_in.hpp>

#include <segue/base/text.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace segue::task_host {

namespace {

constexpr double kFastestRate = 10000.0;
/// Long enough for any experiment, and short enough that no sum of durations overflows.
constexpr Duration kLongestHook = std::chrono::hours(1);

Error at(const type::Value& value, std::string_view path, const std::string& message) {
  return fail(ErrorCode::InvalidArgument, std::string(path) + ": " + message, {},
              {{}, static_cast<int>(value.mark().line), static_cast<int>(value.mark().column)});
}

Result<Duration> read_hook_time(const type::Value& value, std::string_view path) {
  if (!value.is_string()) {
    return at(value, path, "expected a duration such as '30ms', got " + type::describe(value));
  }
  auto duration = parse_duration(value.as_string());
  if (!duration) {
    return at(value, path, duration.error().message);
  }
  if (*duration < Duration::zero() || *duration > kLongestHook) {
    return at(value, path, "must be from 0s to 1h, got " + quote(value.as_string()));
  }
  return *duration;
}

Result<double> read_rate(const type::Value& value, std::string_view path) {
  if (!value.is_number()) {
    return at(value, path, "expected a rate in Hz, got " + type::describe(value));
  }
  const double rate = value.as_double();
  if (!std::isfinite(rate) || rate < 0 || rate > kFastestRate) {
    return at(value, path, "must be from 0 (never) to 10000 Hz, got " + type::describe(value));
  }
  return rate;
}

using Choices = std::span<const std::string_view>;

Result<std::string> read_choice(const type::Value& value, std::string_view path, Choices choices) {
  const std::vector<std::string> known(choices.begin(), choices.end());
  if (!value.is_string() || std::find(known.begin(), known.end(), value.as_string()) == known.end()) {
    return at(value, path, "expected one of " + listed(known) + ", got " + type::describe(value));
  }
  return value.as_string();
}

/// A list of choices, or a single one.
Result<std::vector<std::string>> read_choices(const type::Value& value, std::string_view path,
                                              Choices choices) {
  const type::Value::List single{value};
  std::vector<std::string> chosen;
  for (const auto& item : value.is_list() ? value.as_list() : single) {
    auto choice = read_choice(item, path, choices);
    if (!choice) {
      return std::move(choice.error());
    }
    chosen.push_back(std::move(*choice));
  }
  return chosen;
}

/// Result<To> assigned to a member, its error handed on.
template <class To, class From>
Result<void> assign(To& to, Result<From> from) {
  if (!from) {
    return std::move(from.error());
  }
  to = std::move(*from);
  return {};
}

Result<void> read_entry(StandInBehaviour& behaviour, const std::string& key, const type::Value& value,
                        const std::string& path) {
  if (key == "configure") return assign(behaviour.configure, read_hook_time(value, path));
  if (key == "start") return assign(behaviour.start, read_hook_time(value, path));
  if (key == "stop") return assign(behaviour.stop, read_hook_time(value, path));
  if (key == "cleanup") return assign(behaviour.cleanup, read_hook_time(value, path));
  if (key == "rate") return assign(behaviour.rate, read_rate(value, path));
  if (key == "fail") return assign(behaviour.fail, read_choices(value, path, kStandInFailures));
  if (key == "hang") return assign(behaviour.hang, read_choices(value, path, kStandInHangs));
  static const std::vector<std::string> kKeys = {"configure", "start", "stop", "cleanup",
                                                 "rate",      "fail",  "hang"};
  const std::string hint = did_you_mean(key, kKeys);
  return at(value, path, "no such setting" + (hint.empty() ? "; there are " + listed(kKeys) : hint));
}

}  // namespace

bool StandInBehaviour::fails(std::string_view what) const {
  return std::find(fail.begin(), fail.end(), what) != fail.end();
}

bool StandInBehaviour::hangs(std::string_view what) const {
  return std::find(hang.begin(), hang.end(), what) != hang.end();
}

Result<StandInBehaviour> read_behaviour(const type::Value& value, StandInBehaviour base,
                                        std::string_view path) {
  if (value.is_null()) {
    return base;
  }
  if (!value.is_map()) {
    return at(value, path, "expected a map such as {configure: 30ms}, got " + type::describe(value));
  }
  for (const auto& [key, entry] : value.as_map()) {
    if (auto read = read_entry(base, key, entry, std::string(path) + "." + key); !read) {
      return std::move(read.error());
    }
  }
  return base;
}

std::optional<StandInTable> StandInTable::read(const type::Value& document, const std::string& file,
                                               Diagnostics& diagnostics) {
  const type::Value* entries = document.find("stand_ins");
  if (entries == nullptr || !(entries->is_map() || entries->is_null())) {
    diagnostics.error("stand-in-file", "expected a map 'stand_ins' of components or tasks", {file, 1, 1});
    return std::nullopt;
  }
  StandInTable table;
  bool good = true;
  const type::ValueMap none;
  for (const auto& [name, entry] : entries->is_map() ? entries->as_map() : none) {
    if (auto behaviour = read_behaviour(entry, {}, "stand_ins." + name); !behaviour) {
      Error error = std::move(behaviour.error());
      error.where.file = file;
      diagnostics.error("stand-in-behaviour", error.message, error.where);
      good = false;
    }
    table.set(name, entry);
  }
  return good ? std::optional(std::move(table)) : std::nullopt;
}

std::optional<StandInTable> StandInTable::load(const std::filesystem::path& file, Diagnostics& diagnostics) {
  auto document = type::load_yaml(file);
  if (!document) {
    SourceLocation where = document.error().where;
    if (where.file.empty()) {
      where.file = file.string();
    }
    diagnostics.error("stand-in-file", document.error().message, where);
    return std::nullopt;
  }
  return read(*document, file.string(), diagnostics);
}

void StandInTable::set(std::string name, type::Value behaviour) {
  entries_.insert_or_assign(std::move(name), std::move(behaviour));
}

StandInBehaviour StandInTable::of(const model::ComponentName& component, const model::TaskId& task) const {
  StandInBehaviour behaviour;
  for (const std::string& name : {std::string("default"), component.str(), task.str()}) {
    const auto entry = entries_.find(name);
    if (entry == entries_.end()) {
      continue;
    }
    // Entries were validated when they were read; an invalid one that a program has set counts as absent.
    if (auto over = read_behaviour(entry->second, behaviour, name)) {
      behaviour = std::move(*over);
    }
  }
  return behaviour;
}

std::map<model::TaskId, std::vector<ExpectedPort>> expected_ports(const model::Network& network) {
  std::map<model::TaskId, std::vector<ExpectedPort>> ports;
  const auto note = [&](const model::PortRef& ref, model::Direction direction) {
    auto& of_task = ports[ref.task];
    const ExpectedPort port{ref.port, direction};
    if (std::find(of_task.begin(), of_task.end(), port) == of_task.end()) {
      of_task.push_back(port);
    }
  };
  for (const auto& connection : network.connections) {
    note(connection.from, model::Direction::Output);
    note(connection.to, model::Direction::Input);
  }
  return ports;
}

}  // namespace segue::task_host
