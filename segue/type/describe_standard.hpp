// SPDX-License-Identifier: Apache-2.0
//
// Descriptions of the language's and the standard library's own types; part of describe.hpp.
#pragma once

#include <segue/type/describe_own.hpp>

namespace segue::type::detail {

/// The typelib name of a described C++ type.
template <class T>
std::string name_of_type() {
  std::string text;
  Describe<T>::name(text);
  return text;
}

/// Named by size, as typelib does: int is "/int32_t", long "/int64_t", char "/int8_t".
template <class T>
requires std::is_arithmetic_v<T>
struct Describe<T> {
  static_assert(sizeof(T) <= 8, "long double has no size that machines agree on: use double");
  static void name(std::string& text) { text += number_name(category_of<T>(), sizeof(T)); }
  static void describe(Shape& shape) { describe_number(shape, category_of<T>(), sizeof(T), 0); }
};

template <>
struct Describe<std::string> {
  static void name(std::string& text) { text += "/std/string"; }
  static void describe(Shape& shape) {
    describe_container(shape, "/std/string", sizeof(std::string), described_type<char>);
  }
};

template <class T>
requires Described<T> && std::is_enum_v<T>
struct Describe<T> {
  using Number = std::underlying_type_t<T>;
  static void name(std::string& text) {
    append_type_name(text, segue_type_name(std::type_identity<T>{}, SegueGlobalScope{}));
  }
  static void describe(Shape& shape) {
    describe_enum(shape, category_of<Number>(), sizeof(T));
    const T none{};
    Visitor<T> visitor(shape, none);
    segue_visit(visitor, SegueGlobalScope{});
  }
};

template <class T>
requires Described<T> && std::is_class_v<T>
struct Describe<T> {
  static void name(std::string& text) {
    append_type_name(text, segue_type_name(std::type_identity<T>{}, SegueGlobalScope{}));
  }
  static void describe(Shape& shape) {
    describe_compound(shape, sizeof(T));
    // Only places of members are taken: no object is made, whose constructor might use types itself.
    struct alignas(T) Storage {
      std::byte bytes[sizeof(T)];
    };
    const auto storage = std::make_unique<Storage>();
    Visitor<T> visitor(shape, reinterpret_cast<const T&>(*storage));
    segue_visit(visitor, SegueGlobalScope{});
  }
};

template <class T, std::size_t N>
struct DescribeArray {
  static void name(std::string& text) {
    Describe<T>::name(text);
    text += "[" + std::to_string(N) + "]";
  }
  static void describe(Shape& shape) { describe_array(shape, N, described_type<T>); }
};
template <class T, std::size_t N>
struct Describe<std::array<T, N>> : DescribeArray<T, N> {
  static_assert(N > 0, "an array needs items");
};
template <class T, std::size_t N>
struct Describe<T[N]> : DescribeArray<T, N> {};

template <class T>
struct Describe<std::vector<T>> {
  using Vector = std::vector<T>;
  static void name(std::string& text) { text += "/std/vector<" + name_of_type<T>() + ">"; }
  static void describe(Shape& shape) {
    describe_container(shape, "/std/vector", sizeof(Vector), described_type<T>);
  }
  static std::size_t size(const DescribedType&, const void* object) {
    return static_cast<const Vector*>(object)->size();
  }
  static const void* item(const DescribedType&, const void* object, std::size_t index) {
    return static_cast<const Vector*>(object)->data() + index;
  }
  static void* resize(const DescribedType&, void* object, std::size_t size) {
    auto& vector = *static_cast<Vector*>(object);
    vector.clear();
    vector.resize(size);
    return vector.data();
  }
  static void* reuse(const DescribedType&, void* object, std::size_t size) {
    auto& vector = *static_cast<Vector*>(object);
    vector.resize(size);
    return vector.data();
  }
  static constexpr SequenceAccess kSequence{&size, &item, &resize, &reuse};
};

template <>
struct Describe<std::vector<bool>> {
  static void name(std::string& text) { text += "/std/vector</bool>"; }
  static void describe(Shape& shape) {
    describe_container(shape, "/std/vector", sizeof(std::vector<bool>), described_type<bool>);
  }
  static constexpr Conversion kConversion{&bits_to_value, &bits_from_value};
};

template <class T>
struct Describe<std::optional<T>> {
  using Optional = std::optional<T>;
  static void name(std::string& text) { text += "/std/optional<" + name_of_type<T>() + ">"; }
  static void describe(Shape& shape) {
    describe_container(shape, "/std/optional", sizeof(Optional), described_type<T>);
  }
  static std::size_t size(const DescribedType&, const void* object) {
    return static_cast<const Optional*>(object)->has_value() ? 1 : 0;
  }
  static const void* item(const DescribedType&, const void* object, std::size_t) {
    return std::addressof(**static_cast<const Optional*>(object));
  }
  static void* resize(const DescribedType&, void* object, std::size_t size) {
    auto& optional = *static_cast<Optional*>(object);
    if (size == 0) optional.reset();
    if (size > 0 && !optional) optional.emplace();
    return size > 0 ? std::addressof(*optional) : nullptr;
  }
  static constexpr SequenceAccess kSequence{&size, &item, &resize, &resize};
};

template <class Number, class Period>
struct Describe<std::chrono::duration<Number, Period>> {
  using InNanoseconds = std::ratio_divide<Period, std::nano>;
  static_assert(InNanoseconds::den == 1, "durations count whole multiples of a nanosecond");
  static void name(std::string& text) {
    append_duration_name(text, number_name(category_of<Number>(), sizeof(Number)), Period::num, Period::den);
  }
  static void describe(Shape& shape) {
    describe_number(shape, category_of<Number>(), sizeof(Number), InNanoseconds::num);
  }
};

/// "/std/chrono/time_point</std/chrono/steady_clock,/std/chrono/nanoseconds>"
template <class Clock, class Duration>
struct Describe<std::chrono::time_point<Clock, Duration>> {
  static constexpr bool kSteady = std::is_same_v<Clock, std::chrono::steady_clock>;
  static_assert(kSteady || std::is_same_v<Clock, std::chrono::system_clock>,
                "points in time are those of the steady or the system clock");
  static void name(std::string& text) {
    text += "/std/chrono/time_point</std/chrono/";
    text += kSteady ? "steady_clock," : "system_clock,";
    Describe<Duration>::name(text);
    text += ">";
  }
  static void describe(Shape& shape) { Describe<Duration>::describe(shape); }
};

}  // namespace segue::type::detail
