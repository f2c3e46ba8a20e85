// SPDX-License-Identifier: Apache-2.0
#include "history_missions.hpp"

#include <segue/journal/journal_report.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "../output.hpp"
#include "../report_text.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct Happened {
  std::chrono::system_clock::time_point when;
  Value what;
};

/// "patrol/there#2"
std::string name_of(const Value& entry) {
  const std::string action = printable_at(entry, "action");
  const double iteration = number_at(entry, "iteration");
  return printable_at(entry, "mission") + (action.empty() ? "" : "/" + action) +
         (iteration == 0 ? "" : fmt::format("#{}", iteration));
}

std::string transition_line(const Value& entry) {
  const std::string who = printable_at(entry, "who");
  const std::string cause = printable_at(entry, "cause");
  const bool is_requested = cause == "request" || cause == "apply";
  return outcome_line(entry) + saving_of(entry) +
         (is_requested && !who.empty() ? "; requested by " + who : "");
}

}  // namespace

Result<Value::List> what_happened(journal::JournalReader& reader, std::size_t limit) {
  const auto missions = reader.missions(limit);
  if (!missions) return missions.error();
  const auto transitions = reader.transitions(limit);
  if (!transitions) return transitions.error();
  std::vector<Happened> all;
  for (const auto& entry : *missions)
    all.push_back({entry.time, journal::to_value(entry)});
  for (const auto& entry : *transitions) {
    all.push_back({entry.time, journal::to_value(entry)});
    all.back().what.as_map().set("kind", "transition");
  }
  std::ranges::stable_sort(all, {}, &Happened::when);
  Value::List latest;
  for (std::size_t i = all.size() - std::min(limit, all.size()); i < all.size(); ++i)
    latest.push_back(std::move(all[i].what));
  return latest;
}

std::string happened_line(const Value& entry) {
  const std::string kind = printable_at(entry, "kind");
  if (kind == "transition") return transition_line(entry);
  if (kind == "asked") return name_of(entry) + " asked for " + printable_at(entry, "controller");
  if (kind == "began") {
    const bool is_mission = entry.find("action") == nullptr;
    return name_of(entry) + " began" + (is_mission ? ", run by " + printable_at(entry, "who") : "");
  }
  const std::string error = printable_at(entry, "error");
  return fmt::format("{} ended: {} after {}{}", name_of(entry), printable_at(entry, "outcome"),
                     format_seconds(number_at(entry, "duration_s")), error.empty() ? "" : "; " + error);
}

}  // namespace segue::cli
