// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>

namespace segue::model {
namespace {

using type::Value;

FileKind kind_of_name(const std::string& name) {
  if (name.ends_with(".tlb")) return FileKind::Typelib;
  if (name.find(".cnd") != std::string::npos) return FileKind::Cnd;
  return FileKind::Unknown;
}

FileKind kind_of_networks(const Value& root, const std::string& name) {
  return detail::is_cnd(root, name) ? FileKind::Cnd : FileKind::Network;
}

FileKind kind_of_map(const Value& root, const std::string& name) {
  auto has = [&](std::string_view key) { return root.find(key) != nullptr; };
  if (has("robot")) return FileKind::Robot;
  if (has("mission")) return FileKind::Mission;
  if (has("plan_mapping")) return FileKind::PlanMapping;
  if (has("stand_ins")) return FileKind::StandIns;
  if (has("transition") || (has("actions") && has("from") && has("to"))) return FileKind::Transition;
  if (has("components") || has("component") || detail::is_rock_interface(root)) return FileKind::Components;
  if (has("network") || has("tasks") || has("connections") || has("deployments")) {
    return kind_of_networks(root, name);
  }
  if (detail::is_rock_export(root)) return FileKind::Components;
  const Value* types = root.find("types");
  if (types != nullptr && types->is_map()) return FileKind::Components;
  return kind_of_name(name);
}

/// For text that does not parse: the first significant top-level key decides, so that the right reader
/// reports the errors.
FileKind kind_of_broken(std::string_view text, const std::string& name) {
  constexpr std::pair<std::string_view, FileKind> kKeys[] = {
      {"network:", FileKind::Network},         {"robot:", FileKind::Robot},
      {"mission:", FileKind::Mission},         {"transition:", FileKind::Transition},
      {"components:", FileKind::Components},   {"component:", FileKind::Components},
      {"tasks:", FileKind::Network},           {"connections:", FileKind::Network},
      {"deployments:", FileKind::Network},     {"stand_ins:", FileKind::StandIns},
      {"plan_mapping:", FileKind::PlanMapping}};
  if (kind_of_name(name) != FileKind::Unknown) return kind_of_name(name);
  for (std::size_t start = 0; start < text.size();) {
    const std::string_view line = text.substr(start, text.find('\n', start) - start);
    for (const auto& [key, kind] : kKeys) {
      if (line.starts_with(key)) return kind;
    }
    start += line.size() + 1;
  }
  return FileKind::Unknown;
}

/// Plans that begin otherwise: "0: (move a b)", "STEP 0: move(a,b)", "SequentialPlan:", and the output of FF.
bool is_plan(std::string_view text) {
  if (text.find("found legal plan as follows") != std::string_view::npos) return true;
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  text.remove_prefix(first);
  for (const std::string_view title : {"SequentialPlan:", "TimeTriggeredPlan:"}) {
    if (text.starts_with(title)) return true;
  }
  if (text.starts_with("STEP ") || text.starts_with("step ")) text.remove_prefix(5);
  const auto end = text.find_first_not_of("0123456789. ");
  return end != std::string_view::npos && end > 0 && text[end] == ':';
}

/// The first character of PDDL is a parenthesis, after comments.
bool is_pddl(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  while (true) {
    const auto first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return false;
    if (text[first] != ';') return text[first] == '(';
    const auto end = text.find('\n', first);
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end);
  }
}

}  // namespace

FileKind kind_of_file(const std::filesystem::path& file, std::string_view text) {
  const std::string name = file.filename().string();
  if (name.ends_with(".orogen")) return FileKind::Components;
  const auto first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first == std::string_view::npos) return kind_of_name(name);
  if (text[first] == '<') {
    return text.find("<typelib") == std::string_view::npos ? FileKind::Unknown : FileKind::Typelib;
  }
  if (is_pddl(text)) return FileKind::Pddl;
  const auto root = type::parse_yaml(text, name);
  if (!root) {
    const FileKind kind = kind_of_broken(text, name);
    return kind == FileKind::Unknown && is_plan(text) ? FileKind::Pddl : kind;
  }
  const FileKind kind = root->is_map() ? kind_of_map(*root, name) : kind_of_name(name);
  const bool network = kind == FileKind::Unknown && text[first] == '{' && root->find("nodes") != nullptr;
  if (network) return FileKind::TaskNetwork;
  return kind == FileKind::Unknown && is_plan(text) ? FileKind::Pddl : kind;
}

}  // namespace segue::model
