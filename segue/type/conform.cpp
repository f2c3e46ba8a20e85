// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/conform.hpp>
#include <segue/type/typed_scalar.hpp>
#include <segue/type/value_path.hpp>

#include <string>
#include <vector>

namespace segue::type {
namespace {

using detail::ValuePath;

constexpr std::size_t kReportedItems = 10;  // a list of a million wrong items needs no million messages

class Checker {
 public:
  Checker(const std::string& file, Diagnostics& diagnostics) : file_(file), diagnostics_(diagnostics) {}

  void check(const Value& value, const Type& type, const ValuePath& path) {
    const Type* layout = detail::layout_of(type);
    if (layout == nullptr) return;
    switch (layout->kind) {
      case TypeKind::Numeric:
        return check_number(value, *layout, path);
      case TypeKind::Enum:
        return report(detail::symbol_for(value, *layout), "unknown-symbol", value, path);
      case TypeKind::Compound:
        return check_compound(value, *layout, path);
      case TypeKind::Array:
        return check_array(value, *layout, path);
      default:
        return check_container(value, *layout, path);
    }
  }

 private:
  void check_number(const Value& value, const Type& type, const ValuePath& path) {
    switch (type.category) {
      case NumericCategory::Bool:
        return report(detail::boolean_for(value), "type-mismatch", value, path);
      case NumericCategory::Float:
        return report(detail::float_for(value, type), "type-mismatch", value, path);
      default:
        return report(detail::integer_for(value, type), value.is_number() ? "out-of-range" : "type-mismatch",
                      value, path);
    }
  }

  // A matrix of any size, {rows, cols, data}, may also be written as a list of rows.
  static const Type* row_of_matrix(const Type& type) {
    const auto& fields = type.fields;
    if (fields.size() != 3 || fields[0].name != "rows" || fields[1].name != "cols") return nullptr;
    return fields[2].name == "data" ? fields[2].type : nullptr;
  }

  void check_compound(const Value& value, const Type& type, const ValuePath& path) {
    if (const Type* row = row_of_matrix(type); row != nullptr && value.is_list()) {
      return check_items(value.as_list(), *row, path);
    }
    if (!value.is_map()) return mismatch("a map with the fields of " + type.name, value, path);
    for (const auto& [name, part] : value.as_map()) {
      const Field* field = find_field(type, name);
      if (field == nullptr) {
        unknown_field(name, part, type, path);
      } else if (field->type != nullptr) {
        check(part, *field->type, path.field(name));
      }
    }
  }

  void check_array(const Value& value, const Type& type, const ValuePath& path) {
    const std::string expected = "a list of " + std::to_string(type.count);
    if (type.element == nullptr) return;
    const Value::List* items = detail::items_for(value, *type.element);
    if (items == nullptr) return mismatch(expected, value, path);
    if (items->size() != type.count) {
      add("wrong-count", "expected " + expected + ", got " + std::to_string(items->size()), value, path);
    }
    check_items(*items, *type.element, path);
  }

  void check_container(const Value& value, const Type& type, const ValuePath& path) {
    if (type.is_string()) return report(detail::text_for(value), "type-mismatch", value, path);
    if (type.element == nullptr) return;
    if (type.is_optional()) {
      if (!value.is_null()) check(value, *type.element, path);
      return;
    }
    const Value::List* items = detail::items_for(value, *type.element);
    if (items == nullptr) return mismatch("a list", value, path);
    check_items(*items, *type.element, path);
  }

  void check_items(const Value::List& items, const Type& element, const ValuePath& path) {
    const std::size_t before = diagnostics_.items().size();
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (diagnostics_.items().size() - before >= kReportedItems) {
        return add("more-mismatches",
                   "the items from here on were not checked, since so many before are wrong", items[i], path);
      }
      check(items[i], element, path.item(i));
    }
  }

  static const Field* find_field(const Type& type, std::string_view name) {
    for (const Field& field : type.fields) {
      if (field.name == name) return &field;
    }
    return nullptr;
  }

  void unknown_field(const std::string& name, const Value& value, const Type& type, const ValuePath& path) {
    std::vector<std::string> names;
    for (const Field& field : type.fields)
      names.push_back(field.name);
    add("unknown-field", type.name + " has no field " + quote(name) + did_you_mean(name, names), value, path);
  }

  template <class T>
  void report(const Result<T>& result, const std::string& code, const Value& value, const ValuePath& path) {
    if (!result) add(code, result.error().message, value, path);
  }

  void mismatch(const std::string& expected, const Value& value, const ValuePath& path) {
    add("type-mismatch", "expected " + expected + ", got " + describe(value), value, path);
  }

  void add(std::string code, const std::string& message, const Value& value, const ValuePath& path) {
    const Mark mark = value.mark();
    diagnostics_.error(std::move(code), path.prefixed(message),
                       {file_, static_cast<int>(mark.line), static_cast<int>(mark.column)});
  }

  const std::string& file_;
  Diagnostics& diagnostics_;
};

}  // namespace

void check_value(const Value& value, const Type& type, std::string_view path, const std::string& file,
                 Diagnostics& diagnostics) {
  Checker(file, diagnostics).check(value, type, detail::ValuePath(path));
}

}  // namespace segue::type
