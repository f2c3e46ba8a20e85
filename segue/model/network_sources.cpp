// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network_sources.hpp>

#include <algorithm>
#include <utility>

namespace segue::model::detail {

namespace fs = std::filesystem;

namespace {

/// More is taken for a mistake: files that include each other in many ways would be read again and again.
constexpr std::size_t kMostIncludes = 1000;

/// Adds the items; one that stands for the same as another takes its place.
template <class Item, class Same>
void replace_or_add(std::vector<Item>& items, std::vector<Item> over, Same same) {
  for (Item& item : over) {
    const auto old = std::ranges::find_if(items, [&](const Item& other) { return same(item, other); });
    if (old == items.end())
      items.push_back(std::move(item));
    else
      *old = std::move(item);
  }
}

void lay_over(Network& network, Network over) {
  replace_or_add(network.tasks, std::move(over.tasks), [](auto& a, auto& b) { return a.id == b.id; });
  replace_or_add(network.deployments, std::move(over.deployments),
                 [](auto& a, auto& b) { return a.process == b.process && a.host == b.host; });
  replace_or_add(network.connections, std::move(over.connections),
                 [](auto& a, auto& b) { return a.from == b.from && a.to == b.to; });
}

}  // namespace

Network NetworkSources::complete(NetworkPart part, const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  apply_sections(part.network, folder);
  if (part.includes.empty()) return std::move(part.network);
  Network whole;
  whole.name = part.network.name;
  open_.emplace_back(fs::absolute(file).lexically_normal());
  for (const Include& include : part.includes) {
    if (auto network = included(include, folder)) lay_over(whole, std::move(*network));
  }
  open_.pop_back();
  lay_over(whole, std::move(part.network));
  return whole;
}

/// An error has the place of whatever wants the file.
std::optional<std::string> NetworkSources::read(const fs::path& file, const SourceLocation& wanted_at) {
  auto text = read_(file);
  if (!text) {
    diagnostics_.error("unreadable-file", text.error().message, wanted_at);
    return std::nullopt;
  }
  contents_ += *text;
  return std::move(*text);
}

std::optional<Network> NetworkSources::included(const Include& include, const fs::path& folder) {
  const fs::path file = folder / include.file;
  if (is_read_already(include, file)) return std::nullopt;
  const auto text = read(file, include.where);
  auto part = text ? parse_(*text, file.string(), diagnostics_) : std::nullopt;
  if (!part) return std::nullopt;
  return complete(std::move(*part), file.string());
}

bool NetworkSources::is_read_already(const Include& include, const fs::path& file) {
  if (std::ranges::find(open_, fs::absolute(file).lexically_normal()) != open_.end()) {
    diagnostics_.error("include-cycle", quote(include.file) + " includes this file, which includes it",
                       include.where);
    return true;
  }
  if (++files_ <= kMostIncludes) return false;
  if (files_ == kMostIncludes + 1)
    diagnostics_.error("too-many-files", "the network includes more than 1000 files", include.where);
  return true;
}

void NetworkSources::apply_sections(Network& network, const fs::path& folder) {
  for (Task& task : network.tasks) {
    if (task.config_names.empty()) continue;
    if (const auto file = find_property_file(folder, task.component)) apply_sections(task, *file);
  }
}

/// The task's own properties are above those of the sections.
void NetworkSources::apply_sections(Task& task, const fs::path& file) {
  const auto* sections = sections_of(file, task);
  if (sections == nullptr) return;
  type::Value values{type::ValueMap()};
  for (const std::string& name : task.config_names) {
    const auto section = std::ranges::find(*sections, name, &PropertySection::name);
    if (section != sections->end()) {
      merge(values, section->values);
      continue;
    }
    std::vector<std::string> names;
    std::ranges::transform(*sections, std::back_inserter(names), &PropertySection::name);
    diagnostics_.error("unknown-section",
                       "task " + quote(task.id.str()) + ": " + file.string() + " has no section " +
                           quote(name) + did_you_mean(name, names),
                       task.where);
  }
  merge(values, task.properties);
  task.properties = std::move(values);
  task.config_names.clear();
}

/// Null where they cannot be read, which is reported once.
const std::vector<PropertySection>* NetworkSources::sections_of(const fs::path& file, const Task& task) {
  auto known = sections_.find(file);
  if (known == sections_.end()) {
    const auto text = read(file, task.where);
    known =
        sections_
            .emplace(file, text ? read_property_sections(*text, file.string(), diagnostics_) : std::nullopt)
            .first;
  }
  return known->second ? &*known->second : nullptr;
}

}  // namespace segue::model::detail
