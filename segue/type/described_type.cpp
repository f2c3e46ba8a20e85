// SPDX-License-Identifier: Apache-2.0
//
// Conversion between values and objects, driven by the shape of the object's type.
#include <segue/base/text.hpp>
#include <segue/type/described_type.hpp>
#include <segue/type/typed_scalar.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <new>
#include <utility>

namespace segue::type::detail {
namespace {

const std::byte* at(const void* object, std::size_t offset) {
  return static_cast<const std::byte*>(object) + offset;
}

std::byte* at(void* object, std::size_t offset) {
  return static_cast<std::byte*>(object) + offset;
}

template <class Number>
Number load(const void* object) {
  Number number{};
  std::memcpy(&number, object, sizeof number);
  return number;
}

std::int64_t load_signed(const void* object, std::size_t size) {
  switch (size) {
    case 1:
      return load<std::int8_t>(object);
    case 2:
      return load<std::int16_t>(object);
    case 4:
      return load<std::int32_t>(object);
    default:
      return load<std::int64_t>(object);
  }
}

std::uint64_t load_unsigned(const void* object, std::size_t size) {
  switch (size) {
    case 1:
      return load<std::uint8_t>(object);
    case 2:
      return load<std::uint16_t>(object);
    case 4:
      return load<std::uint32_t>(object);
    default:
      return load<std::uint64_t>(object);
  }
}

/// The low bytes of `bits`, in the machine's order.
void store_bits(void* object, std::size_t size, std::uint64_t bits) {
  const auto store = [&](auto number) { std::memcpy(object, &number, sizeof number); };
  if (size == 1) return store(static_cast<std::uint8_t>(bits));
  if (size == 2) return store(static_cast<std::uint16_t>(bits));
  if (size == 4) return store(static_cast<std::uint32_t>(bits));
  store(bits);
}

Value number_to_value(const Type& type, const void* object) {
  switch (type.category) {
    case NumericCategory::Bool:
      return load<std::uint8_t>(object) != 0;
    case NumericCategory::Signed:
      return load_signed(object, type.size);
    case NumericCategory::Unsigned:
      return load_unsigned(object, type.size);
    case NumericCategory::Float:
      break;
  }
  return type.size == sizeof(float) ? static_cast<double>(load<float>(object)) : load<double>(object);
}

std::int64_t enum_number(const Type& type, const void* object) {
  return type.category == NumericCategory::Signed
             ? load_signed(object, type.size)
             : static_cast<std::int64_t>(load_unsigned(object, type.size));
}

/// The symbol, or the number where it has none.
Value enum_to_value(const Type& type, const void* object) {
  const std::int64_t number = enum_number(type, object);
  const auto symbol = std::ranges::find(type.symbols, number, &EnumSymbol::value);
  if (symbol == type.symbols.end()) return number;
  return symbol->name;
}

Value compound_to_value(const Shape& shape, const void* object) {
  ValueMap map;
  for (const DescribedField& field : shape.fields)
    map.append(field.name, to_value(*field.type, at(object, field.offset)));
  return map;
}

Value array_to_value(const Shape& shape, const void* object) {
  Value::List list;
  list.reserve(shape.type.count);
  for (std::size_t i = 0; i < shape.type.count; ++i)
    list.push_back(to_value(*shape.element, at(object, i * shape.element->info.size)));
  return list;
}

Value container_to_value(const DescribedType& described, const void* object) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string()) return *static_cast<const std::string*>(object);
  const std::size_t size = described.sequence.size(described, object);
  if (shape.type.is_optional())
    return size == 0 ? Value() : to_value(*shape.element, described.sequence.item(described, object, 0));
  Value::List list;
  list.reserve(size);
  for (std::size_t i = 0; i < size; ++i)
    list.push_back(to_value(*shape.element, described.sequence.item(described, object, i)));
  return list;
}

std::string joined(std::string_view path, std::string_view name) {
  std::string text(path);
  if (!text.empty()) text += '.';
  return text += name;
}

/// Adds path and place to an error of the scalar rules, which have neither.
template <class T>
Error placed(Result<T>& refused, const Value& value, std::string_view path) {
  return at_value(path, std::move(refused.error().message), value);
}

Result<void> assign_number(const Type& type, void* object, const Value& value, std::string_view path) {
  if (type.category == NumericCategory::Bool) {
    Result<bool> boolean = boolean_for(value);
    if (!boolean) return placed(boolean, value, path);
    store_bits(object, 1, *boolean ? 1 : 0);
    return {};
  }
  if (type.category != NumericCategory::Float) {
    Result<std::uint64_t> integer = integer_for(value, type);
    if (!integer) return placed(integer, value, path);
    store_bits(object, type.size, *integer);
    return {};
  }
  Result<double> number = float_for(value, type);
  if (!number) return placed(number, value, path);
  const bool narrow = type.size == sizeof(float);
  store_bits(object, type.size,
             narrow ? std::bit_cast<std::uint32_t>(static_cast<float>(*number))
                    : std::bit_cast<std::uint64_t>(*number));
  return {};
}

Result<void> assign_enum(const Type& type, void* object, const Value& value, std::string_view path) {
  Result<std::int64_t> number = symbol_for(value, type);
  if (!number) return placed(number, value, path);
  store_bits(object, type.size, static_cast<std::uint64_t>(*number));
  return {};
}

Result<void> assign_string(void* object, const Value& value, std::string_view path) {
  Result<std::string> text = text_for(value);
  if (!text) return placed(text, value, path);
  *static_cast<std::string*>(object) = std::move(*text);
  return {};
}

Result<void> assign_items(const DescribedType& element, std::byte* items, const Value::List& list,
                          std::string_view path) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = std::string(path) + "[" + std::to_string(i) + "]";
    if (auto done = assign(element, items + i * element.info.size, list[i], place); !done) return done;
  }
  return {};
}

Result<void> assign_array(const Shape& shape, void* object, const Value& value, std::string_view path) {
  const Value::List* items = items_for(value, *shape.type.element);
  if (items == nullptr || items->size() != shape.type.count)
    return unexpected_value(path, "a list of " + std::to_string(shape.type.count), value);
  return assign_items(*shape.element, at(object, 0), *items, path);
}

Result<void> assign_container(const DescribedType& described, void* object, const Value& value,
                              std::string_view path) {
  const Shape& shape = *described.shape;
  if (shape.type.is_string()) return assign_string(object, value, path);
  if (shape.type.is_optional()) {
    void* item = described.sequence.resize(described, object, value.is_null() ? 0 : 1);
    return item == nullptr ? Result<void>{} : assign(*shape.element, item, value, path);
  }
  const Value::List* list = items_for(value, *shape.type.element);
  if (list == nullptr) return unexpected_value(path, "a list", value);
  void* items = described.sequence.resize(described, object, list->size());
  return assign_items(*shape.element, static_cast<std::byte*>(items), *list, path);
}

Error unknown_member(const Shape& shape, const std::string& name, const Value& value, std::string_view path) {
  std::vector<std::string> names;
  for (const DescribedField& field : shape.fields)
    names.push_back(field.name);
  return at_value(path, shape.type.name + " has no member " + quote(name) + did_you_mean(name, names), value);
}

Result<void> assign_compound(const Shape& shape, void* object, const Value& value, std::string_view path) {
  if (!value.is_map()) return unexpected_value(path, "a map", value);
  for (const auto& [name, item] : value.as_map()) {
    const auto field = std::ranges::find(shape.fields, name, &DescribedField::name);
    if (field == shape.fields.end()) return unknown_member(shape, name, item, path);
    if (auto done = assign(*field->type, at(object, field->offset), item, joined(path, name)); !done)
      return done;
  }
  return {};
}

/// A copy of an object to try a conversion on.
class Scratch {
 public:
  Scratch(const TypeInfo& info, const void* original)
      : info_(info), memory_(::operator new(info.size, std::align_val_t(info.alignment))) {
    try {
      info.construct(memory_);
      constructed_ = true;
      info.copy(memory_, original);
    } catch (...) {
      release();
      throw;
    }
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { release(); }

  [[nodiscard]] void* object() const { return memory_; }

 private:
  void release() noexcept {
    if (constructed_) info_.destroy(memory_);
    ::operator delete(memory_, std::align_val_t(info_.alignment));
  }

  const TypeInfo& info_;
  void* memory_;
  bool constructed_ = false;
};

}  // namespace

Error at_value(std::string_view path, std::string message, const Value& value) {
  if (!path.empty()) message = std::string(path) + ": " + message;
  const Mark mark = value.mark();
  return fail(ErrorCode::TypeMismatch, std::move(message), {},
              {{}, static_cast<int>(mark.line), static_cast<int>(mark.column)});
}

Error unexpected_value(std::string_view path, std::string_view expected, const Value& value) {
  return at_value(path, "expected " + std::string(expected) + ", got " + describe(value), value);
}

Value to_value(const DescribedType& described, const void* object) {
  if (described.conversion.to_value != nullptr) return described.conversion.to_value(object);
  const Shape& shape = *described.shape;
  switch (shape.type.kind) {
    case TypeKind::Numeric:
      return number_to_value(shape.type, object);
    case TypeKind::Enum:
      return enum_to_value(shape.type, object);
    case TypeKind::Compound:
      return compound_to_value(shape, object);
    case TypeKind::Array:
      return array_to_value(shape, object);
    default:
      return container_to_value(described, object);
  }
}

Result<void> assign(const DescribedType& described, void* object, const Value& value, std::string_view path) {
  if (described.conversion.from_value != nullptr) return described.conversion.from_value(object, value, path);
  const Shape& shape = *described.shape;
  switch (shape.type.kind) {
    case TypeKind::Numeric:
      return assign_number(shape.type, object, value, path);
    case TypeKind::Enum:
      return assign_enum(shape.type, object, value, path);
    case TypeKind::Compound:
      return assign_compound(shape, object, value, path);
    case TypeKind::Array:
      return assign_array(shape, object, value, path);
    default:
      return assign_container(described, object, value, path);
  }
}

Result<void> from_value(const DescribedType& described, void* object, const Value& value,
                        std::string_view path) {
  const TypeKind kind = described.shape->type.kind;
  if (kind == TypeKind::Numeric || kind == TypeKind::Enum) return assign(described, object, value, path);
  const Scratch scratch(described.info, object);
  if (auto done = assign(described, scratch.object(), value, path); !done) return done;
  described.info.copy(object, scratch.object());
  return {};
}

Value object_to_value(const TypeInfo& self, const void* object) {
  return to_value(*self.described, object);
}

Result<void> object_from_value(const TypeInfo& self, void* object, const Value& value,
                               std::string_view path) {
  return from_value(*self.described, object, value, path);
}

Value bits_to_value(const void* object) {
  Value::List list;
  for (const bool bit : *static_cast<const std::vector<bool>*>(object))
    list.emplace_back(bit);
  return list;
}

Result<void> bits_from_value(void* object, const Value& value, std::string_view path) {
  if (!value.is_list()) return unexpected_value(path, "a list", value);
  std::vector<bool> bits;
  for (const Value& item : value.as_list()) {
    if (!item.is_bool())
      return unexpected_value(std::string(path) + "[" + std::to_string(bits.size()) + "]", "true or false",
                              item);
    bits.push_back(item.as_bool());
  }
  *static_cast<std::vector<bool>*>(object) = std::move(bits);
  return {};
}

}  // namespace segue::type::detail
