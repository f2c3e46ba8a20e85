// SPDX-License-Identifier: Apache-2.0
//
// Descriptions of a program's own types, without those of the standard library; part of describe.hpp.
#pragma once

#include <segue/type/described_type.hpp>

#include <array>
#include <chrono>
#include <concepts>
#include <memory>
#include <optional>
#include <ratio>
#include <string>
#include <type_traits>
#include <vector>

/// For the associated namespaces of calls only: SEGUE_TYPE is found at global scope, too.
struct SegueGlobalScope {};

/// Names the members of a struct or the symbols of an enum, so that it can travel through ports and be a
/// property: `SEGUE_TYPE(Pose, x, y, theta)`, once, after the definition, in the type's namespace, or with
/// the full name at global scope. Up to 64 names. Members of base classes may be named too; members not named
/// do not take part. The type needs a default constructor and copies. Its name elsewhere is typelib's:
/// "/demo/Pose".
#define SEGUE_TYPE(type_, ...)                                                            \
  inline ::segue::type::detail::WrittenName segue_type_name(::std::type_identity<type_>,  \
                                                            ::SegueGlobalScope) {         \
    return {__PRETTY_FUNCTION__, #type_};                                                 \
  }                                                                                       \
  template <::std::same_as<type_> Described_>                                             \
  void segue_visit([[maybe_unused]] ::segue::type::detail::Visitor<Described_>& visitor_, \
                   ::SegueGlobalScope) {                                                  \
    if constexpr (std::is_enum_v<Described_>) {                                           \
      SEGUE_DETAIL_EACH(SEGUE_DETAIL_SYMBOL, __VA_ARGS__)                                 \
    } else {                                                                              \
      SEGUE_DETAIL_EACH(SEGUE_DETAIL_MEMBER, __VA_ARGS__)                                 \
    }                                                                                     \
  }                                                                                       \
  [[maybe_unused]] static const bool SEGUE_DETAIL_NAME(segue_announced_, __COUNTER__) =   \
      ::segue::type::detail::announce(::segue::type::detail::described_type<type_>);
#define SEGUE_DETAIL_SYMBOL(name_) visitor_.symbol(#name_, Described_::name_);
#define SEGUE_DETAIL_MEMBER(name_) visitor_.member(#name_, &Described_::name_);

/// Scans its arguments again, often enough for 64 repetitions of SEGUE_DETAIL_STEP.
#define SEGUE_DETAIL_SCAN(...) \
  SEGUE_DETAIL_SCAN_4(SEGUE_DETAIL_SCAN_4(SEGUE_DETAIL_SCAN_4(SEGUE_DETAIL_SCAN_4(__VA_ARGS__))))
#define SEGUE_DETAIL_SCAN_4(...) \
  SEGUE_DETAIL_SCAN_3(SEGUE_DETAIL_SCAN_3(SEGUE_DETAIL_SCAN_3(SEGUE_DETAIL_SCAN_3(__VA_ARGS__))))
#define SEGUE_DETAIL_SCAN_3(...) \
  SEGUE_DETAIL_SCAN_2(SEGUE_DETAIL_SCAN_2(SEGUE_DETAIL_SCAN_2(SEGUE_DETAIL_SCAN_2(__VA_ARGS__))))
#define SEGUE_DETAIL_SCAN_2(...) __VA_ARGS__

#define SEGUE_DETAIL_PARENTHESES ()

#define SEGUE_DETAIL_NAME(name, number) SEGUE_DETAIL_JOIN(name, number)
#define SEGUE_DETAIL_JOIN(name, number) name##number

/// use(a) use(b) use(c) for (a, b, c).
#define SEGUE_DETAIL_EACH(use, ...) __VA_OPT__(SEGUE_DETAIL_SCAN(SEGUE_DETAIL_STEP(use, __VA_ARGS__)))
#define SEGUE_DETAIL_STEP(use, first, ...) \
  use(first) __VA_OPT__(SEGUE_DETAIL_STEP_AGAIN SEGUE_DETAIL_PARENTHESES(use, __VA_ARGS__))
#define SEGUE_DETAIL_STEP_AGAIN() SEGUE_DETAIL_STEP

namespace segue::type {

namespace detail {

template <class T>
concept Described = requires {
  segue_type_name(std::type_identity<T>{}, SegueGlobalScope{});
};

/// The description of a C++ type: name(text), describe(shape) and, where needed, kSequence, kConversion and
/// kGrid. Specialised below and in eigen.hpp.
template <class T>
struct Describe {
  static_assert(Described<T>,
                "no description of this type: describe it with SEGUE_TYPE(Name, its, members) in its "
                "namespace before it is used by a port or property; pointers, references and maps cannot be "
                "described");
};

template <class T>
void construct(const TypeInfo&, void* memory) {
  ::new (memory) T();
}

template <class T>
void destroy(const TypeInfo&, void* object) noexcept {
  std::destroy_at(static_cast<T*>(object));
}

template <class T>
void copy(const TypeInfo& self, void* to, const void* from) {
  if constexpr (std::is_array_v<T>) {
    for (std::size_t i = 0; i < std::extent_v<T>; ++i)
      copy<std::remove_extent_t<T>>(self, *static_cast<T*>(to) + i, *static_cast<const T*>(from) + i);
  } else {
    *static_cast<T*>(to) = *static_cast<const T*>(from);
  }
}

template <class T>
constexpr DescribedType make_described() {
  using Element = std::remove_all_extents_t<T>;
  static_assert(std::is_default_constructible_v<Element> && std::is_copy_assignable_v<Element>,
                "types of ports and properties need a default constructor and must be copyable: types that "
                "can only be moved, and types with const members, are not supported");
  DescribedType described{};
  described.info.size = sizeof(T);
  described.info.alignment = alignof(T);
  // Preliminary, narrowed by complete(). Not is_trivially_copyable, which does not hold for Eigen's fixed
  // matrices.
  described.info.trivially_copyable = std::is_trivially_destructible_v<T>;
  described.info.functions = {&construct<T>, &destroy<T>, &copy<T>, &object_to_value, &object_from_value};
  described.name = &Describe<T>::name;
  described.describe = &Describe<T>::describe;
  if constexpr (requires { Describe<T>::kSequence; }) described.sequence = Describe<T>::kSequence;
  if constexpr (requires { Describe<T>::kConversion; }) described.conversion = Describe<T>::kConversion;
  if constexpr (requires { Describe<T>::kGrid; }) described.grid = Describe<T>::kGrid;
  return described;
}

template <class T>
inline constinit DescribedType described_type = make_described<T>();

/// Receives the names listed in SEGUE_TYPE.
template <class T>
class Visitor {
 public:
  Visitor(Shape& shape, const T& prototype) : shape_(shape), prototype_(prototype) {}

  template <class Class, class Member>
  void member(std::string_view name, Member Class::*pointer) {
    static_assert(std::is_object_v<Member>, "functions cannot be members of a description");
    const auto* member = reinterpret_cast<const std::byte*>(std::addressof(prototype_.*pointer));
    const auto* object = reinterpret_cast<const std::byte*>(std::addressof(prototype_));
    add_field(shape_, name, static_cast<std::size_t>(member - object), described_type<Member>);
  }

  void symbol(std::string_view name, T value) { add_symbol(shape_, name, static_cast<std::int64_t>(value)); }

 private:
  Shape& shape_;
  const T& prototype_;
};

template <class T>
constexpr NumericCategory category_of() {
  if (std::is_same_v<T, bool>) return NumericCategory::Bool;
  if (std::is_floating_point_v<T>) return NumericCategory::Float;
  return std::is_signed_v<T> || std::is_same_v<T, char> ? NumericCategory::Signed : NumericCategory::Unsigned;
}

}  // namespace detail

template <class T>
const TypeInfo& type_info() {
  static_assert(std::is_same_v<T, std::remove_cvref_t<T>>, "ask for the type without const and reference");
  static const TypeInfo& info = detail::complete(detail::described_type<T>);
  return info;
}

}  // namespace segue::type
