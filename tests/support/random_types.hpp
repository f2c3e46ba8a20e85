// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type.hpp>
#include <support/random_values.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

/// rapidcheck generators of data types and of values that fit them, for tests only.
namespace segue::type {

/// A complete type, which owns all its parts.
struct RandomType {
  std::vector<std::unique_ptr<Type>> parts;
  const Type* type = nullptr;
};

inline void showValue(const RandomType& random, std::ostream& stream) {
  stream << definition(*random.type);
}

namespace detail {

class TypeMaker {
 public:
  explicit TypeMaker(std::vector<std::unique_ptr<Type>>& parts) : parts_(parts) {}

  const Type* make(int levels) {
    const int kind = *rc::gen::inRange(0, levels > 0 ? 9 : 4);
    switch (kind) {
      case 0:
      case 1:
        return number();
      case 2:
        return enumeration();
      case 3:
        return text();
      case 4:
      case 5:
        return compound(levels);
      case 6:
        return holder(TypeKind::Container, levels, *rc::gen::element("/std/vector", "/std/optional"));
      case 7:
        return holder(TypeKind::Array, levels, "");
      default:
        return holder(*rc::gen::element(TypeKind::Alias, TypeKind::Opaque), levels, "");
    }
  }

 private:
  Type* add(TypeKind kind, const std::string& stem) {
    auto type = std::make_unique<Type>();
    type->kind = kind;
    type->name = "/random/" + stem + std::to_string(parts_.size());
    return parts_.emplace_back(std::move(type)).get();
  }

  const Type* number() {
    Type* type = add(TypeKind::Numeric, "Number");
    type->category = *rc::gen::element(NumericCategory::Bool, NumericCategory::Signed,
                                       NumericCategory::Unsigned, NumericCategory::Float);
    type->size = *rc::gen::element<std::size_t>(1, 2, 4, 8);
    if (type->category == NumericCategory::Bool) type->size = 1;
    if (type->category == NumericCategory::Float) type->size = std::max<std::size_t>(type->size, 4);
    return type;
  }

  const Type* enumeration() {
    Type* type = add(TypeKind::Enum, "Enum");
    type->size = *rc::gen::element<std::size_t>(1, 2, 4, 8);
    const int count = *rc::gen::inRange(1, 5);
    for (int i = 0; i < count; ++i)
      type->symbols.push_back({"SYMBOL_" + std::to_string(i), i * 31 - 40});
    return type;
  }

  const Type* text() {
    Type* type = add(TypeKind::Container, "Text");
    type->container_kind = "/std/string";
    type->element = number();
    return type;
  }

  const Type* compound(int levels) {
    Type* type = add(TypeKind::Compound, "Compound");
    const int count = *rc::gen::inRange(0, 5);
    for (int i = 0; i < count; ++i)
      type->fields.push_back(
          {"field_" + std::to_string(i), make(levels - 1), static_cast<std::size_t>(i) * 8});
    return type;
  }

  const Type* holder(TypeKind kind, int levels, const std::string& container_kind) {
    Type* type = add(kind, "Holder");
    type->container_kind = container_kind;
    type->element = make(levels - 1);
    if (kind == TypeKind::Array) type->count = *rc::gen::inRange<std::size_t>(1, 4);
    return type;
  }

  std::vector<std::unique_ptr<Type>>& parts_;
};

inline Value random_number_for(const Type& type) {
  const std::size_t unused = 64 - 8 * type.size;
  switch (type.category) {
    case NumericCategory::Bool:
      return *rc::gen::arbitrary<bool>();
    case NumericCategory::Unsigned:
      return Value(*rc::gen::arbitrary<std::uint64_t>() >> unused);
    case NumericCategory::Signed:
      return Value(*rc::gen::arbitrary<std::int64_t>() >> unused);
    default:
      break;
  }
  const double number = *random_double();
  return type.size == 4 ? static_cast<double>(static_cast<float>(number)) : number;
}

inline Value random_list_for(const Type& element, std::size_t count);

}  // namespace detail

inline rc::Gen<RandomType> random_type(int levels = 4) {
  return rc::gen::exec([levels] {
    RandomType random;
    random.type = detail::TypeMaker(random.parts).make(levels);
    return random;
  });
}

/// A value with every field. An optional within an optional is null or complete, since an empty inner one
/// looks like an empty outer one.
inline Value random_value_for(const Type& type) {
  switch (type.kind) {
    case TypeKind::Numeric:
      return detail::random_number_for(type);
    case TypeKind::Enum:
      return Value((*rc::gen::elementOf(type.symbols)).name);
    case TypeKind::Compound: {
      ValueMap map;
      for (const Field& field : type.fields)
        map.append(field.name, random_value_for(*field.type));
      return map;
    }
    case TypeKind::Array:
      return detail::random_list_for(*type.element, type.count);
    case TypeKind::Container:
      if (type.is_string()) return Value(*random_text());
      if (type.is_optional()) return *rc::gen::arbitrary<bool>() ? random_value_for(*type.element) : Value();
      return detail::random_list_for(*type.element, *rc::gen::inRange<std::size_t>(0, 5));
    default:
      return random_value_for(*type.element);
  }
}

inline Value detail::random_list_for(const Type& element, std::size_t count) {
  Value::List list;
  for (std::size_t i = 0; i < count; ++i)
    list.push_back(random_value_for(element));
  return list;
}

}  // namespace segue::type
