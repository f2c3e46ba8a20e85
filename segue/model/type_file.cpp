// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>

#include <charconv>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace segue::model::detail {

using type::Field;
using type::NumericCategory;
using type::Type;
using type::TypeKind;
using type::TypeRegistry;
using type::Value;
using type::ValueMap;

namespace {

constexpr std::array<std::string_view, 9> kKindNames = {"none",  "numeric", "enum",   "compound", "container",
                                                        "array", "pointer", "opaque", "alias"};
constexpr std::array<std::string_view, 4> kCategoryNames = {"bool", "signed", "unsigned", "float"};
constexpr std::int64_t kLargestSize = std::int64_t{1} << 40;
constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();

Value write_fields(const Type& type) {
  Value::List list;
  for (const Field& field : type.fields) {
    ValueMap entry;
    entry.append("name", field.name);
    if (field.type != nullptr) entry.append("type", field.type->name);
    entry.append("offset", static_cast<std::uint64_t>(field.offset));
    list.emplace_back(std::move(entry));
  }
  return list;
}

Value write_symbols(const Type& type) {
  ValueMap map;
  for (const type::EnumSymbol& symbol : type.symbols)
    map.append(symbol.name, symbol.value);
  return map;
}

Value write_type(const Type& type) {
  ValueMap map;
  map.append("kind", kKindNames.at(static_cast<std::size_t>(type.kind)));
  if (type.kind == TypeKind::Numeric) {
    map.append("category", kCategoryNames.at(static_cast<std::size_t>(type.category)));
    if (type.nanoseconds_per_tick != 0) map.append("nanoseconds_per_tick", type.nanoseconds_per_tick);
  }
  if (type.kind == TypeKind::Container) map.append("container", type.container_kind);
  if (type.element != nullptr) map.append("of", type.element->name);
  if (type.kind == TypeKind::Array) map.append("count", static_cast<std::uint64_t>(type.count));
  if (type.size != 0) map.append("size", static_cast<std::uint64_t>(type.size));
  if (type.kind == TypeKind::Enum) map.append("symbols", write_symbols(type));
  if (type.kind == TypeKind::Compound) map.append("fields", write_fields(type));
  return map;
}

/// Sorts types after those that they consist of, unless they are recursive.
class Collector {
 public:
  void visit(const Type& type) {
    std::vector<std::pair<const Type*, bool>> open{{&type, false}};
    while (!open.empty()) {
      const auto [current, parts_done] = open.back();
      open.pop_back();
      if (parts_done) {
        order_.push_back(current);
      } else if (seen_.insert(current).second && std::as_const(base_).find(current->name) == nullptr) {
        open.emplace_back(current, true);
        if (current->element != nullptr) open.emplace_back(current->element, false);
        for (auto field = current->fields.rbegin(); field != current->fields.rend(); ++field)
          if (field->type != nullptr) open.emplace_back(field->type, false);
      }
    }
  }
  [[nodiscard]] const std::vector<const Type*>& order() const { return order_; }

 private:
  TypeRegistry base_;
  std::unordered_set<const Type*> seen_;
  std::vector<const Type*> order_;
};

/// Creates types from definitions, which may refer to each other recursively.
class Builder {
 public:
  Builder(const TypeRegistry& known, const Source& source) : known_(known), source_(source) {}

  void define(const std::string& written, const Value& definition) {
    const auto name = type::canonical_type_name(written);
    if (!name) {
      source_.error("bad-type", "type " + quote(written) + ": " + name.error().message, definition);
      return;
    }
    if (std::as_const(local_).find(*name) != nullptr || by_name_.contains(*name)) return;
    Type& type = fresh(*name);
    links_.push_back({&type, &definition, {}, {}});
    read_attributes(type, links_.back());
  }

  /// The types read, as a registry of their own.
  TypeRegistry finish() && {
    for (const Link& link : links_)
      connect(link);
    std::vector<std::unique_ptr<Type>> types;
    for (auto& type : fresh_)
      types.push_back(std::move(type));
    if (auto added = local_.add_all(std::move(types)); !added) {
      source_.diagnostics().error("bad-type", added.error().message, {source_.file(), 0, 0});
    }
    return std::move(local_);
  }

 private:
  struct Link {
    Type* type;
    const Value* definition;
    std::string element;
    std::vector<std::string> fields;
  };

  Type& fresh(const std::string& name) {
    fresh_.push_back(std::make_unique<Type>());
    fresh_.back()->name = name;
    by_name_.emplace(name, fresh_.back().get());
    return *fresh_.back();
  }

  void read_attributes(Type& type, Link& link) {
    Fields fields(*link.definition, "type " + quote(type.name), source_);
    fields.require("kind");
    if (auto kind = fields.choice("kind", kKindNames, "bad-type")) type.kind = static_cast<TypeKind>(*kind);
    type.size = static_cast<std::size_t>(fields.integer("size", 0, kLargestSize, "bad-type").value_or(0));
    if (type.kind == TypeKind::Numeric) {
      if (auto category = fields.choice("category", kCategoryNames, "bad-type")) {
        type.category = static_cast<NumericCategory>(*category);
      }
      type.nanoseconds_per_tick = fields.integer("nanoseconds_per_tick", 0, kAny, "bad-type").value_or(0);
    }
    if (type.kind == TypeKind::Container) type.container_kind = fields.text("container");
    link.element = fields.text("of");
    if (type.kind == TypeKind::Array) {
      type.count = static_cast<std::size_t>(fields.integer("count", 0, kLargestSize, "bad-type").value_or(0));
    }
    if (type.kind == TypeKind::Enum) read_symbols(type, fields);
    if (type.kind == TypeKind::Compound) read_fields(type, link, fields);
    fields.finish();
  }

  void read_symbols(Type& type, Fields& fields) {
    const Value* symbols = fields.find("symbols", Value::Kind::Map);
    if (symbols == nullptr) return;
    for (const auto& [name, value] : symbols->as_map()) {
      if (value.kind() == Value::Kind::Int) {
        type.symbols.push_back({name, value.as_int()});
      } else {
        source_.error("bad-type", fields.what() + ": symbol " + quote(name) + " needs a whole number", value);
      }
    }
  }

  void read_fields(Type& type, Link& link, Fields& fields) {
    const Value* list = fields.find("fields", Value::Kind::List);
    if (list == nullptr) return;
    for (const Value& item : list->as_list()) {
      Fields field(item, "a field of " + fields.what(), source_);
      field.require("name");
      const auto offset = field.integer("offset", 0, kLargestSize, "bad-type").value_or(0);
      type.fields.push_back({field.text("name"), nullptr, static_cast<std::size_t>(offset)});
      link.fields.push_back(field.text("type"));
      field.finish();
    }
  }

  void connect(const Link& link) {
    link.type->element = resolve(link.element, link);
    for (std::size_t i = 0; i < link.fields.size(); ++i)
      link.type->fields[i].type = resolve(link.fields[i], link);
  }

  const Type* resolve(const std::string& written, const Link& link) {
    if (written.empty()) return nullptr;
    const auto name = type::canonical_type_name(written);
    if (const Type* found = name ? lookup(*name) : nullptr) return found;
    source_.error(
        "unknown-type",
        "type " + quote(link.type->name) + " consists of " + quote(written) + ", which is not known",
        *link.definition);
    return nullptr;
  }

  const Type* lookup(const std::string& name) {
    if (auto found = by_name_.find(name); found != by_name_.end()) return found->second;
    if (const Type* type = std::as_const(local_).find(name)) return type;
    if (const Type* type = known_.find(name)) {
      auto copy = local_.copy(*type);
      return copy ? *copy : nullptr;
    }
    return composite(name);
  }

  /// "/T[n]" and "/std/vector</T>" of types that are being defined.
  const Type* composite(const std::string& name) {
    constexpr std::string_view kVector = "/std/vector<";
    if (name.starts_with(kVector) && name.ends_with('>')) {
      const Type* element = lookup(name.substr(kVector.size(), name.size() - kVector.size() - 1));
      if (element == nullptr) return nullptr;
      Type& type = fresh(name);
      type.kind = TypeKind::Container;
      type.container_kind = "/std/vector";
      type.element = element;
      return &type;
    }
    const auto open = name.rfind('[');
    if (open == std::string::npos || !name.ends_with(']')) return nullptr;
    const Type* element = lookup(name.substr(0, open));
    std::size_t count = 0;
    const auto [end, status] = std::from_chars(name.data() + open + 1, name.data() + name.size() - 1, count);
    const bool sane = status == std::errc{} && count <= std::size_t{kLargestSize};
    if (element == nullptr || !sane || element->size > (std::size_t{1} << 20)) return nullptr;
    Type& type = fresh(name);
    type.kind = TypeKind::Array;
    type.element = element;
    type.count = count;
    type.size = element->size * count;
    return &type;
  }

  const TypeRegistry& known_;
  const Source& source_;
  TypeRegistry local_;
  std::vector<std::unique_ptr<Type>> fresh_;
  std::unordered_map<std::string, Type*> by_name_;
  std::vector<Link> links_;
};

}  // namespace

Value write_types(const std::vector<const Type*>& types) {
  Collector collector;
  for (const Type* type : types)
    collector.visit(*type);
  ValueMap map;
  for (const Type* type : collector.order())
    map.append(type->name, write_type(*type));
  return map;
}

void read_types(const Value& definitions, TypeRegistry& registry, const Source& source) {
  if (!definitions.is_map()) {
    source.error("wrong-kind", "'types' must be a map, got " + type::describe(definitions), definitions);
    return;
  }
  const std::size_t errors_before = source.diagnostics().error_count();
  Builder builder(registry, source);
  for (const auto& [name, definition] : definitions.as_map())
    builder.define(name, definition);
  const TypeRegistry read = std::move(builder).finish();
  if (source.diagnostics().error_count() > errors_before) return;
  if (auto merged = registry.merge(read); !merged) {
    source.error("type-conflict", merged.error().message, definitions);
  }
}

}  // namespace segue::model::detail
