// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/interface_library.hpp>

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/interface_text.hpp>
#include <segue/ros2/standard_interfaces.hpp>

#include <algorithm>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

namespace segue::ros2 {

namespace {

namespace fs = std::filesystem;

/// "SetBool" of "SetBool_Request", "Fibonacci" of "Fibonacci_SendGoal_Response".
std::string whole_of(const InterfaceName& name) {
  return name.kind == "msg" ? name.name : name.name.substr(0, name.name.find('_'));
}

/// Where a folder may have the packages.
std::vector<fs::path> package_folders(const fs::path& folder) {
  return {folder, folder / "share"};
}

std::optional<fs::path> file_of(const std::vector<fs::path>& folders, const InterfaceName& name) {
  const std::string file = whole_of(name) + "." + name.kind;
  for (const fs::path& folder : folders) {
    for (const fs::path& packages : package_folders(folder)) {
      fs::path path = packages / name.package / name.kind / file;
      std::error_code ignored;
      if (fs::is_regular_file(path, ignored)) return path;
    }
  }
  return std::nullopt;
}

void list_package(const fs::path& package, std::set<std::string>& names) {
  for (const char* kind : {"msg", "srv", "action"}) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(package / kind, ignored)) {
      if (entry.path().extension() == std::string(".") + kind)
        names.insert(package.filename().string() + "/" + kind + "/" + entry.path().stem().string());
    }
  }
}

}  // namespace

InterfaceLibrary::InterfaceLibrary(std::vector<fs::path> folders) : folders_(std::move(folders)) {}

Result<const MessageDefinition*> InterfaceLibrary::find(std::string_view name) {
  const auto parsed = parse_interface_name(name);
  if (!parsed) return parsed.error();
  const std::string whole = to_string(*parsed);
  if (!messages_.contains(whole)) {
    if (auto loaded = load(*parsed); !loaded) return loaded.error();
  }
  const auto found = messages_.find(whole);
  return found == messages_.end() ? Result<const MessageDefinition*>(no_such(whole)) : &found->second;
}

Result<void> InterfaceLibrary::load(const InterfaceName& name) {
  const InterfaceName whole{name.package, name.kind, whole_of(name)};
  if (const auto path = file_of(folders_, name)) {
    const auto text = read_file(*path);
    return text ? read(whole, *text, path->string()) : text.error();
  }
  const auto found = standard_interfaces().find(to_string(whole));
  return found == standard_interfaces().end() ? no_such(to_string(name))
                                              : read(whole, found->second, found->first);
}

Result<void> InterfaceLibrary::add(const InterfaceName& name, std::string_view text) {
  return read(name, text, to_string(name));
}

Result<void> InterfaceLibrary::read(const InterfaceName& name, std::string_view text,
                                    const std::string& file) {
  Diagnostics diagnostics;
  auto messages = read_interface(name, text, file, diagnostics);
  if (diagnostics.has_errors()) return diagnostics.to_error(ErrorCode::ParseError);
  for (MessageDefinition& message : messages) {
    std::string key = message.name;
    messages_.insert_or_assign(std::move(key), std::move(message));
  }
  return {};
}

Result<void> InterfaceLibrary::add_parts(const MessageDefinition& message, Parts& parts) {
  parts.around.push_back(message.name);
  if (parts.around.size() > type::kDeepestNesting)
    return fail(ErrorCode::InvalidArgument, message.name + " lies too deep in other messages");
  for (const FieldDefinition& field : message.fields) {
    const std::string& name = field.type.nested;
    if (field.type.primitive != Primitive::Nested || parts.found.contains(name)) continue;
    const auto at_field = [&](ErrorCode code, const std::string& what) {
      return fail(code, "field " + quote(field.name) + " of " + message.name + " " + what);
    };
    if (std::ranges::find(parts.around, name) != parts.around.end())
      return at_field(ErrorCode::InvalidArgument, "makes " + name + " contain itself");
    const auto part = find(name);
    if (!part) return at_field(part.error().code, "cannot be used").because_of(part.error());
    if (auto added = add_parts(**part, parts); !added) return added;
    parts.found.emplace(name, *part);
  }
  parts.around.pop_back();
  return {};
}

Result<std::vector<const MessageDefinition*>> InterfaceLibrary::with_parts(std::string_view name) {
  const auto top = find(name);
  if (!top) return top.error();
  Parts parts;
  if (auto added = add_parts(**top, parts); !added) return added.error();
  std::vector<const MessageDefinition*> all{*top};
  for (const auto& [its_name, part] : parts.found)
    all.push_back(part);
  return all;
}

std::vector<std::string> InterfaceLibrary::names() const {
  std::set<std::string> all;
  for (const auto& [name, text] : standard_interfaces())
    all.insert(name);
  for (const fs::path& folder : folders_) {
    for (const fs::path& packages : package_folders(folder)) {
      std::error_code ignored;
      for (const auto& package : fs::directory_iterator(packages, ignored))
        list_package(package.path(), all);
    }
  }
  return {all.begin(), all.end()};
}

Error InterfaceLibrary::no_such(std::string_view name) const {
  return fail(ErrorCode::NotFound,
              "no interface " + quote(name) + did_you_mean(name, names()) +
                  (folders_.empty() ? "" : ", neither built in nor in the folders named"));
}

std::vector<std::string> standard_packages() {
  std::set<std::string> packages;
  for (const auto& [name, text] : standard_interfaces())
    packages.insert(name.substr(0, name.find('/')));
  return {packages.begin(), packages.end()};
}

}  // namespace segue::ros2
