// SPDX-License-Identifier: Apache-2.0
#include <segue/model/reader.hpp>
#include <segue/model/rock_properties.hpp>
#include <segue/model/rock_symbol.hpp>

#include <algorithm>
#include <utility>

namespace segue::model::detail {

using type::Value;

namespace {

constexpr std::string_view kDefaultSection = "default";

/// "--- name:outdoor" begins the section "outdoor"; nothing for other lines.
std::optional<std::string> section_name(std::string_view line) {
  if (!line.starts_with("---")) return std::nullopt;
  const auto key = line.find("name:");
  if (key == std::string_view::npos) return std::nullopt;
  const auto begin = line.find_first_not_of(" \t\"'", key + 5);
  if (begin == std::string_view::npos) return std::string();
  return std::string(line.substr(begin, line.find_first_of(" \t\r\"'", begin) - begin));
}

/// The text of a section, behind as many empty lines as there are lines before it, so that errors have their
/// place in the file.
struct SectionText {
  std::string name;
  std::string text;
};

std::vector<SectionText> sections_of(std::string_view text) {
  std::vector<SectionText> sections{{std::string(kDefaultSection), {}}};
  std::size_t lines = 0;
  for (const std::string_view line : split(text, '\n')) {
    ++lines;
    if (auto name = section_name(line))
      sections.push_back({std::move(*name), std::string(lines, '\n')});
    else
      sections.back().text.append(line).push_back('\n');
  }
  return sections;
}

void read_symbols(Value& value) {
  if (value.is_map()) {
    for (auto& [key, item] : value.as_map())
      read_symbols(item);
  } else if (value.is_list()) {
    for (Value& item : value.as_list())
      read_symbols(item);
  } else if (is_symbol(value)) {
    value = symbol_text(value);
  }
}

}  // namespace

std::optional<std::vector<PropertySection>> read_property_sections(std::string_view text,
                                                                   const std::string& file,
                                                                   Diagnostics& diagnostics) {
  const Source source(file, diagnostics);
  if (text.find("<%") != std::string_view::npos) {
    source.error("is-template", "this is a template, which Segue does not evaluate; write its result",
                 Value());
    return std::nullopt;
  }
  std::vector<PropertySection> sections;
  for (const SectionText& section : sections_of(text)) {
    auto values = source.parse(section.text);
    if (!values) return std::nullopt;
    if (values->is_null()) values = type::ValueMap();
    if (!values->is_map()) {
      source.error("wrong-kind",
                   "the section " + quote(section.name) + " must be a map of properties, got " +
                       type::describe(*values),
                   *values);
      return std::nullopt;
    }
    read_symbols(*values);
    const auto same = std::ranges::find(sections, section.name, &PropertySection::name);
    if (same == sections.end())
      sections.push_back({section.name, std::move(*values)});
    else
      merge(same->values, *values);
  }
  return sections;
}

std::optional<std::filesystem::path> find_property_file(const std::filesystem::path& folder,
                                                        const ComponentName& component) {
  std::error_code failed;
  std::filesystem::path around = std::filesystem::absolute(folder, failed).lexically_normal();
  if (failed) return std::nullopt;
  while (true) {
    for (const std::string_view place : {"config/orogen", "config"}) {
      auto file = around / place / (component.str() + ".yml");
      if (std::filesystem::is_regular_file(file, failed)) return file;
    }
    if (!around.has_relative_path()) return std::nullopt;
    around = around.parent_path();
  }
}

}  // namespace segue::model::detail
