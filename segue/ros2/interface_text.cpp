// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/interface_text.hpp>

#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>
#include <segue/ros2/derived_messages.hpp>
#include <segue/ros2/interface_names.hpp>
#include <segue/ros2/literal.hpp>

#include <algorithm>
#include <charconv>
#include <utility>

namespace segue::ros2 {

namespace {

constexpr std::string_view kUpperBound = "<=";

/// Digits only, and more than 0.
std::optional<std::uint64_t> positive(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size() || number == 0) return std::nullopt;
  return number;
}

/// Reads one section of an interface file: the fields and constants of one message.
class SectionReader {
 public:
  SectionReader(const InterfaceName& interface, std::string file, Diagnostics& diagnostics)
      : interface_(interface), file_(std::move(file)), diagnostics_(diagnostics) {}

  /// `number` counts from 1.
  void read(std::string_view line, int number, MessageDefinition& message) {
    where_ = {file_, number, 1};
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) return;
    const auto type_end = line.find_first_of(" \t");
    const std::string_view rest = type_end == std::string_view::npos ? "" : trimmed(line.substr(type_end));
    if (rest.empty()) return error("bad-field", quote(line) + " is not a valid field: expected TYPE NAME");
    const auto type = read_type(line.substr(0, type_end));
    if (!type) return;
    const auto equals = rest.find('=');
    if (equals == std::string_view::npos) {
      read_field(*type, rest, message);
    } else {
      read_constant(*type, trimmed(rest.substr(0, equals)), trimmed(rest.substr(equals + 1)), message);
    }
  }

 private:
  void error(std::string code, std::string text) {
    diagnostics_.error(std::move(code), std::move(text), where_);
  }

  std::optional<FieldType> bad_type(std::string_view text, const std::string& why) {
    error("bad-type", quote(text) + " is not a valid type: " + why);
    return std::nullopt;
  }

  std::optional<FieldType> read_type(std::string_view text) {
    FieldType type;
    std::string_view item = text;
    if (text.ends_with(']')) {
      const auto bracket = text.rfind('[');
      if (bracket == std::string_view::npos) return bad_type(text, "it lacks a '['");
      item = text.substr(0, bracket);
      std::string_view count = text.substr(bracket + 1, text.size() - bracket - 2);
      type.multiplicity = Multiplicity::Sequence;
      if (!count.empty()) {
        const bool is_bound = count.starts_with(kUpperBound);
        if (is_bound) count.remove_prefix(kUpperBound.size());
        const auto capacity = positive(count);
        if (!capacity) return bad_type(text, "the size of an array is a number above 0, or '<=' with one");
        type.multiplicity = is_bound ? Multiplicity::BoundedSequence : Multiplicity::Array;
        type.capacity = *capacity;
      }
    }
    return read_item(text, item, std::move(type));
  }

  std::optional<FieldType> read_item(std::string_view text, std::string_view item, FieldType type) {
    const auto bound = item.find(kUpperBound);
    const std::string_view name = item.substr(0, bound);
    if (const auto primitive = primitive_named(name)) {
      type.primitive = *primitive;
      if (bound == std::string_view::npos) return type;
      const bool is_wide = type.primitive == Primitive::WString;
      if (!is_wide && type.primitive != Primitive::String)
        return bad_type(text, "only strings and arrays have an upper bound");
      const auto capacity = positive(item.substr(bound + kUpperBound.size()));
      if (!capacity) return bad_type(text, "the upper bound of a string is a number above 0");
      type.primitive = is_wide ? Primitive::BoundedWString : Primitive::BoundedString;
      type.string_capacity = *capacity;
      return type;
    }
    if (item == "time" || item == "duration")
      return bad_type(
          text, "in ROS 2 it is builtin_interfaces/" + std::string(item == "time" ? "Time" : "Duration"));
    const auto parts = split(item, '/');
    const bool has_package = parts.size() == 2;
    if (parts.size() > 2 || (has_package && !is_package_name(parts[0])) || !is_message_name(parts.back()))
      return bad_type(text,
                      "expected a basic type, a message such as Point, or package and message such as "
                      "geometry_msgs/Point");
    type.nested =
        (has_package ? std::string(parts[0]) : interface_.package) + "/msg/" + std::string(parts.back());
    return type;
  }

  void read_field(FieldType type, std::string_view rest, MessageDefinition& message) {
    const auto name_end = rest.find_first_of(" \t");
    const std::string name(rest.substr(0, name_end));
    const std::string_view text = name_end == std::string_view::npos ? "" : trimmed(rest.substr(name_end));
    if (!is_package_name(name))
      return error("bad-name", quote(name) +
                                   " is not a valid name of a field: lower-case letters, digits and single "
                                   "underscores, a letter first");
    if (std::ranges::find(message.fields, name, &FieldDefinition::name) != message.fields.end())
      return error("duplicate-field", "field " + quote(name) + " is there twice");
    FieldDefinition field{name, std::move(type), std::nullopt};
    if (!text.empty()) {
      auto value = parse_default(text, field.type);
      if (!value) return error("bad-value", "field " + quote(name) + ": " + value.error().message);
      field.default_value = std::move(*value);
    }
    message.fields.push_back(std::move(field));
  }

  void read_constant(const FieldType& type, std::string_view name, std::string_view text,
                     MessageDefinition& message) {
    const bool is_basic = type.primitive != Primitive::Nested && type.multiplicity == Multiplicity::Single &&
                          type.string_capacity == 0;
    if (!is_basic)
      return error("bad-type", "constant " + quote(name) + ": a constant has a basic type, without a bound");
    if (!is_constant_name(name))
      return error("bad-name", quote(name) +
                                   " is not a valid name of a constant: capital letters, digits and single "
                                   "underscores, a letter first");
    if (std::ranges::find(message.constants, name, &ConstantDefinition::name) != message.constants.end())
      return error("duplicate-constant", "constant " + quote(name) + " is there twice");
    auto value = parse_default(text, type);
    if (!value) return error("bad-value", "constant " + quote(name) + ": " + value.error().message);
    message.constants.push_back({std::string(name), type.primitive, std::move(*value)});
  }

  const InterfaceName& interface_;
  const std::string file_;
  Diagnostics& diagnostics_;
  SourceLocation where_;
};

/// How many sections a file of that kind has: message; request and response; goal, result and feedback.
std::size_t section_count(std::string_view kind) {
  return kind == "msg" ? 1 : kind == "srv" ? 2 : 3;
}

}  // namespace

std::vector<MessageDefinition> read_interface(const InterfaceName& name, std::string_view text,
                                              const std::string& file, Diagnostics& diagnostics) {
  Diagnostics found;
  SectionReader reader(name, file, found);
  std::vector<MessageDefinition> sections(1);
  int number = 0;
  for (const std::string_view line : split(text, '\n')) {
    ++number;
    if (name.kind != "msg" && trimmed(line) == "---") {
      sections.emplace_back();
    } else {
      reader.read(line, number, sections.back());
    }
  }
  if (sections.size() != section_count(name.kind)) {
    found.error("bad-sections",
                name.kind == "srv"
                    ? "a service has two parts, request and response, with a line '---' between"
                    : "an action has three parts, goal, result and feedback, with lines '---' between",
                {file, number, 1});
  }
  diagnostics.append(found);
  if (found.has_errors()) return {};
  return messages_of(name, std::move(sections));
}

}  // namespace segue::ros2
