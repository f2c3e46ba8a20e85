// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/type.hpp>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "../models.hpp"
#include "../output.hpp"

namespace segue::cli {

namespace {

using type::Type;
using type::TypeKind;
using type::Value;

struct TypesOptions {
  std::string name;  ///< empty: list all
  ModelSources sources;
};

/// "messages::Pose", as in C++, for "/messages/Pose".
std::string cpp_name(const Type& type) {
  std::string name = type.name.starts_with('/') ? type.name.substr(1) : type.name;
  for (auto at = name.find('/'); at != std::string::npos; at = name.find('/', at + 2))
    name.replace(at, 1, "::");
  return name;
}

/// The types that somebody has defined: structures and enumerations, by name.
std::vector<const Type*> defined_types(const model::ComponentCatalog& catalog) {
  auto types = catalog.types().types();
  std::erase_if(types, [](const Type* type) {
    return type->kind != TypeKind::Compound && type->kind != TypeKind::Enum;
  });
  std::ranges::sort(types, {}, &Type::name);
  return types;
}

std::string parts_text(const Type& type) {
  std::vector<std::string> parts;
  for (const auto& field : type.fields)
    parts.push_back(field.name);
  for (const auto& symbol : type.symbols)
    parts.push_back(symbol.name);
  return fmt::format("{}", fmt::join(parts, ", "));
}

Value to_value(const Type& type) {
  Value::List fields;
  for (const auto& field : type.fields)
    fields.push_back(Value::map({{"name", field.name}, {"type", field.type->name}}));
  Value::List symbols;
  for (const auto& symbol : type.symbols)
    symbols.push_back(Value::map({{"name", symbol.name}, {"value", symbol.value}}));
  return Value::map({{"name", type.name},
                     {"kind", type.kind == TypeKind::Enum ? "enum" : "compound"},
                     {"fields", std::move(fields)},
                     {"symbols", std::move(symbols)}});
}

int list_types(const model::ComponentCatalog& catalog, const Context& context) {
  Value::List list;
  Table table({{"TYPE"}, {"KIND"}, {"FIELDS OR SYMBOLS"}});
  for (const Type* type : defined_types(catalog)) {
    list.push_back(to_value(*type));
    table.add({cpp_name(*type), type->kind == TypeKind::Enum ? "enum" : "struct", parts_text(*type)});
  }
  if (context.json()) {
    print_json(Value(std::move(list)));
  } else {
    print(table.text());
  }
  return kDone;
}

/// By its full name, or by the last part of it where that is of one type only.
Result<const Type*> find_type(const model::ComponentCatalog& catalog, const std::string& name) {
  if (const auto canonical = type::canonical_type_name(name)) {
    if (const Type* type = catalog.types().find(*canonical)) return type;
  }
  std::vector<const Type*> found;
  std::vector<std::string> names;
  std::vector<std::string> last_parts;
  for (const Type* type : defined_types(catalog)) {
    names.push_back(cpp_name(*type));
    if (names.back().ends_with("::" + name)) found.push_back(type);
    last_parts.push_back(names.back().substr(names.back().rfind(':') + 1));
  }
  if (found.size() == 1) return found.front();
  std::vector<std::string> several;
  for (const Type* type : found)
    several.push_back(cpp_name(*type));
  if (several.empty())
    return fail(ErrorCode::NotFound,
                "no type " + quote(name) + " is known" +
                    did_you_mean(name, name.find(':') == std::string::npos ? last_parts : names) +
                    "; `segue types` lists all types");
  return fail(ErrorCode::InvalidArgument,
              fmt::format("{} may be {}", quote(name), fmt::join(several, " or ")));
}

int show_type(const model::ComponentCatalog& catalog, const std::string& name, const Context& context) {
  const auto type = find_type(catalog, name);
  if (!type) return failed(context, type.error());
  Value::List ports;
  Table table({{"COMPONENT"}, {"PORT"}, {"DIRECTION"}});
  for (const auto* component : catalog.all()) {
    for (const auto& port : component->ports) {
      if (port.type != (*type)->name) continue;
      const std::string direction(to_string(port.direction));
      table.add({component->name.str(), port.name, direction});
      ports.push_back(
          Value::map({{"component", component->name.str()}, {"port", port.name}, {"direction", direction}}));
    }
  }
  if (context.json()) {
    Value value = to_value(**type);
    value.as_map().set("ports", std::move(ports));
    print_json(value);
    return kDone;
  }
  print(coloured(Colour::Bold, cpp_name(**type)) + '\n' + type::definition(**type) + '\n');
  if (!ports.empty()) print('\n' + table.text());
  return kDone;
}

}  // namespace

void add_types(Verb& app, Context& context) {
  const auto options = std::make_shared<TypesOptions>();
  Verb& verb =
      add_verb(app, context, "types", "the types of samples and properties, and which ports have them",
               "  segue types\n  segue types messages::Pose\n  segue types Odometry", [options, &context] {
                 Diagnostics diagnostics;
                 const auto catalog = load_catalog(options->sources, diagnostics);
                 if (diagnostics.has_errors()) return report_failure(context, diagnostics);
                 print_diagnostics(diagnostics);
                 return options->name.empty() ? list_types(catalog, context)
                                              : show_type(catalog, options->name, context);
               });
  verb.option("TYPE", options->name, "show this type; its name may be shortened to the last part");
  add_model_options(verb, options->sources);
}

}  // namespace segue::cli
