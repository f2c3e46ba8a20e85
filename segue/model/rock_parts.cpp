// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/port_pattern.hpp>
#include <segue/model/rock_symbol.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>

namespace segue::model::detail {

using type::Value;

namespace {

/// Adds missing brackets to names such as "/std/vector</controldev/AxisPort".
std::string balanced(const std::string& written) {
  const auto open = std::ranges::count(written, '<');
  const auto close = std::ranges::count(written, '>');
  return open > close ? written + std::string(static_cast<std::size_t>(open - close), '>') : written;
}

/// Reads "? /base/Pose" as "/base/Pose".
std::string without_guess_mark(const std::string& written) {
  const auto start = written.find_first_not_of("? ");
  return start == std::string::npos ? std::string{} : written.substr(start);
}

}  // namespace

std::string rock_type_name(const std::string& written, ComponentModel& model, const Value& at,
                           const Source& source) {
  const bool guess = written.starts_with('?');
  const std::string wanted = guess ? without_guess_mark(written) : written;
  if (guess) {
    model.incomplete = true;
    source.warning("guessed-type",
                   "component " + quote(model.name.str()) + ": the type " + quote(wanted) + " is a guess",
                   at);
  }
  if (wanted.empty() || wanted == "/nil" || wanted == "void") return {};
  if (auto name = type::canonical_type_name(wanted)) return *name == "/nil" ? std::string{} : *name;
  // Samples are always passed as read-only pointers here, so the port has the type pointed to.
  constexpr std::string_view kReadOnly = "ro_ptr ";
  const std::string repaired =
      balanced(wanted.starts_with(kReadOnly) ? wanted.substr(kReadOnly.size()) : wanted);
  const auto name = type::canonical_type_name(repaired);
  source.warning("unreadable-type",
                 "component " + quote(model.name.str()) + ": the type name " + quote(wanted) +
                     " is read as " + (name ? quote(*name) : std::string("unknown, which fits every type")),
                 at);
  return name.value_or("");
}

Value rock_default(const Value& written, const PropertyModel& property, const Source& source) {
  static const type::TypeRegistry numbers;
  if (is_symbol(written)) return symbol_text(written);
  const type::Type* type = property.type.empty() ? nullptr : numbers.find(property.type);
  if (type == nullptr || type->kind != type::TypeKind::Numeric) return written;
  const bool boolean = type->category == type::NumericCategory::Bool;
  if (boolean && written.is_integer()) return Value(!(written == Value(0)));
  if (boolean ? written.is_bool() : written.is_number()) return written;
  source.warning("unreadable-default",
                 "property " + quote(property.name) + ": the default " + type::describe(written) +
                     " is not a value of " + quote(property.type) + " and ignored",
                 written);
  return {};
}

PortModel rock_family(const std::string& searched, Direction direction, std::string type) {
  PortModel port;
  port.name = whole_match_pattern(searched);
  port.direction = direction;
  port.type = std::move(type);
  port.dynamic = true;
  port.pattern = true;
  return port;
}

}  // namespace segue::model::detail
