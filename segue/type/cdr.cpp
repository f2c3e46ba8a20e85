// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/cdr.hpp>
#include <segue/type/typed_scalar.hpp>
#include <segue/type/value_path.hpp>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

namespace segue::type {
namespace {

using detail::ValuePath;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

constexpr std::size_t kHeader = 4;
constexpr std::size_t kPadding = 3;  // RTPS fills messages up to a multiple of four bytes

Error refuse(const ValuePath& path, const std::string& message) {
  return fail(ErrorCode::TypeMismatch, path.prefixed(message));
}

// The layout, or why there is none to encode by.
Result<const Type*> layout_for(const Type* type, const ValuePath& path, std::size_t depth) {
  if (depth > kDeepestNesting)
    return refuse(path,
                  "the type or value is nested deeper than " + std::to_string(kDeepestNesting) + " levels");
  const Type* layout = type == nullptr ? nullptr : detail::layout_of(*type);
  if (layout == nullptr) {
    return refuse(path, "the layout of " +
                            (type == nullptr ? std::string("a type without a name") : type->name) +
                            " is not known, so it cannot travel");
  }
  return layout;
}

// XTypes' bit_bound: enums of one, two or eight bytes keep their size; all others take four.
std::size_t bytes_of_enum(const Type& type) {
  return type.size == 1 || type.size == 2 || type.size == 8 ? type.size : 4;
}

Error no_such_number(const Type& type, const ValuePath& path) {
  return refuse(path, type.name + ": CDR has no number of " + std::to_string(type.size) + " bytes");
}

Error takes_no_bytes(const Type& type, const ValuePath& path) {
  return refuse(path, "items of " + type.name + " take no bytes, so their number could not be checked");
}

class Encoder {
 public:
  Encoder() : cdr_(buffer_, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR) { cdr_.serialize_encapsulation(); }

  Result<void> encode(const Value& value, const Type* type, const ValuePath& path, std::size_t depth) {
    const auto layout = layout_for(type, path, depth);
    if (!layout) return layout.error();
    switch ((*layout)->kind) {
      case TypeKind::Numeric:
        return number(value, **layout, path);
      case TypeKind::Enum:
        return symbol(value, **layout, path);
      case TypeKind::Compound:
        return compound(value, **layout, path, depth);
      case TypeKind::Array:
        return array(value, **layout, path, depth);
      default:
        return container(value, **layout, path, depth);
    }
  }

  std::vector<std::byte> take() {
    const auto* begin = reinterpret_cast<const std::byte*>(buffer_.getBuffer());
    return {begin, begin + cdr_.getSerializedDataLength()};
  }

 private:
  Result<void> number(const Value& value, const Type& type, const ValuePath& path) {
    if (type.category == NumericCategory::Bool) {
      const auto boolean = detail::boolean_for(value);
      if (!boolean) return refuse(path, boolean.error().message);
      put(static_cast<std::uint8_t>(*boolean ? 1 : 0));
      return {};
    }
    if (type.category == NumericCategory::Float) {
      const auto real = detail::float_for(value, type);
      if (!real) return refuse(path, real.error().message);
      return real_number(*real, type, path);
    }
    const auto bits = detail::integer_for(value, type);
    if (!bits) return refuse(path, bits.error().message);
    return integer(*bits, type.size) ? Result<void>() : no_such_number(type, path);
  }

  Result<void> real_number(double number, const Type& type, const ValuePath& path) {
    if (type.size == sizeof(float)) {
      put(static_cast<float>(number));
    } else if (type.size == sizeof(double)) {
      put(number);
    } else {
      return no_such_number(type, path);
    }
    return {};
  }

  /// FastCDR skips the gap before a number without writing it: whatever was in memory would travel.
  template <class T>
  void put(T number) {
    const std::size_t at = cdr_.getSerializedDataLength() - kHeader;
    for (std::size_t gap = Cdr::alignment(at, sizeof(T)); gap > 0; --gap)
      cdr_.serialize(std::uint8_t{0});
    cdr_.serialize(number);
  }

  bool integer(std::uint64_t bits, std::size_t size) {
    switch (size) {
      case 1:
        put(static_cast<std::uint8_t>(bits));
        return true;
      case 2:
        put(static_cast<std::uint16_t>(bits));
        return true;
      case 4:
        put(static_cast<std::uint32_t>(bits));
        return true;
      case 8:
        put(bits);
        return true;
      default:
        return false;
    }
  }

  // A number without symbol may well come from decoding; it travels on as it is.
  Result<void> symbol(const Value& value, const Type& type, const ValuePath& path) {
    Type number_type;
    number_type.kind = TypeKind::Numeric;
    number_type.size = bytes_of_enum(type);
    if (value.is_integer()) {
      const auto bits = detail::integer_for(value, number_type);
      if (!bits) return refuse(path, bits.error().message);
      integer(*bits, number_type.size);
      return {};
    }
    const auto number = detail::symbol_for(value, type);
    if (!number) return refuse(path, number.error().message);
    integer(static_cast<std::uint64_t>(*number), number_type.size);
    return {};
  }

  Result<void> compound(const Value& value, const Type& type, const ValuePath& path, std::size_t depth) {
    if (!value.is_map())
      return refuse(path, "expected a map with the fields of " + type.name + ", got " + describe(value));
    // ROS 2 gives a message without fields one byte, since C has no empty structs.
    if (type.fields.empty()) integer(0, 1);
    std::size_t found = 0;
    for (const Field& field : type.fields) {
      const Value* item = value.find(field.name);
      if (item == nullptr)
        return refuse(path.field(field.name), "the value lacks this field of " + type.name);
      ++found;
      if (auto done = encode(*item, field.type, path.field(field.name), depth + 1); !done) return done;
    }
    if (found != value.as_map().size())
      return refuse(path, "the value has fields that " + type.name + " lacks");
    return {};
  }

  Result<void> array(const Value& value, const Type& type, const ValuePath& path, std::size_t depth) {
    const Value::List* list = type.element == nullptr ? nullptr : detail::items_for(value, *type.element);
    if (list == nullptr || list->size() != type.count) {
      return refuse(path, "expected a list of " + std::to_string(type.count) + ", got " + describe(value));
    }
    return items(*list, type, path, depth);
  }

  Result<void> container(const Value& value, const Type& type, const ValuePath& path, std::size_t depth) {
    if (type.is_string()) return text(value, path);
    if (type.is_optional()) {
      integer(value.is_null() ? 0 : 1, 4);
      return value.is_null() ? Result<void>() : encode(value, type.element, path, depth + 1);
    }
    const Value::List* list = type.element == nullptr ? nullptr : detail::items_for(value, *type.element);
    if (list == nullptr) return refuse(path, "expected a list, got " + describe(value));
    if (list->size() > std::numeric_limits<std::uint32_t>::max())
      return refuse(path, "the list is too long for CDR");
    integer(list->size(), 4);
    return items(*list, type, path, depth);
  }

  Result<void> items(const Value::List& list, const Type& type, const ValuePath& path, std::size_t depth) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::size_t before = cdr_.getSerializedDataLength();
      if (auto done = encode(list[i], type.element, path.item(i), depth + 1); !done) return done;
      if (cdr_.getSerializedDataLength() == before) return takes_no_bytes(*type.element, path);
    }
    return {};
  }

  Result<void> text(const Value& value, const ValuePath& path) {
    const auto content = detail::text_for(value);
    if (!content) return refuse(path, content.error().message);
    if (content->size() >= std::numeric_limits<std::uint32_t>::max())
      return refuse(path, "the text is too long for CDR");
    integer(content->size() + 1, 4);
    cdr_.serializeArray(content->c_str(), content->size() + 1);
    return {};
  }

  FastBuffer buffer_;
  Cdr cdr_;
};

class Decoder {
 public:
  // Fast CDR takes a mutable buffer, but reading does not write to it.
  explicit Decoder(std::span<const std::byte> bytes)
      : size_(bytes.size()),
        buffer_(const_cast<char*>(reinterpret_cast<const char*>(bytes.data())), bytes.size()),
        cdr_(buffer_, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR) {
    cdr_.read_encapsulation();
  }

  Result<Value> decode(const Type* type, const ValuePath& path, std::size_t depth) {
    const auto layout = layout_for(type, path, depth);
    if (!layout) return layout.error();
    switch ((*layout)->kind) {
      case TypeKind::Numeric:
        return number(**layout, path);
      case TypeKind::Enum:
        return symbol(**layout, path);
      case TypeKind::Compound:
        return compound(**layout, path, depth);
      case TypeKind::Array:
        return items((*layout)->count, **layout, path, depth);
      default:
        return container(**layout, path, depth);
    }
  }

  [[nodiscard]] std::size_t left() const { return size_ - cdr_.getSerializedDataLength(); }

 private:
  template <class T>
  Result<T> read(const ValuePath& path) {
    T number{};
    const std::size_t at = cdr_.getSerializedDataLength() - kHeader;
    const std::size_t gap = Cdr::alignment(at, sizeof(T));
    if (left() < gap + sizeof(T)) return too_short(path);
    cdr_.deserialize(number);
    return number;
  }

  [[nodiscard]] Error too_short(const ValuePath& path) const {
    return refuse(path,
                  "the message ends too early: only " + std::to_string(left()) + " bytes are left here");
  }

  template <class T>
  Result<Value> read_value(const ValuePath& path) {
    const auto number = read<T>(path);
    if (!number) return number.error();
    if constexpr (std::is_floating_point_v<T>) {
      return Value(static_cast<double>(*number));
    } else if constexpr (std::is_signed_v<T>) {
      return Value(static_cast<std::int64_t>(*number));
    } else {
      return Value(static_cast<std::uint64_t>(*number));
    }
  }

  Result<Value> number(const Type& type, const ValuePath& path) {
    switch (type.category) {
      case NumericCategory::Bool:
        return boolean(path);
      case NumericCategory::Float:
        if (type.size == sizeof(float)) return read_value<float>(path);
        return type.size == sizeof(double) ? read_value<double>(path) : no_such_number(type, path);
      case NumericCategory::Unsigned:
        return unsigned_integer(type, path);
      default:
        return signed_integer(type, type.size, path);
    }
  }

  Result<Value> boolean(const ValuePath& path) {
    const auto byte = read<std::uint8_t>(path);
    if (!byte) return byte.error();
    if (*byte > 1) return refuse(path, "a boolean is 0 or 1, not " + std::to_string(*byte));
    return Value(*byte == 1);
  }

  Result<Value> unsigned_integer(const Type& type, const ValuePath& path) {
    switch (type.size) {
      case 1:
        return read_value<std::uint8_t>(path);
      case 2:
        return read_value<std::uint16_t>(path);
      case 4:
        return read_value<std::uint32_t>(path);
      case 8:
        return read_value<std::uint64_t>(path);
      default:
        return no_such_number(type, path);
    }
  }

  Result<Value> signed_integer(const Type& type, std::size_t size, const ValuePath& path) {
    switch (size) {
      case 1:
        return read_value<std::int8_t>(path);
      case 2:
        return read_value<std::int16_t>(path);
      case 4:
        return read_value<std::int32_t>(path);
      case 8:
        return read_value<std::int64_t>(path);
      default:
        return no_such_number(type, path);
    }
  }

  Result<Value> symbol(const Type& type, const ValuePath& path) {
    auto number = signed_integer(type, bytes_of_enum(type), path);
    if (!number) return number;
    const auto known = std::ranges::find(type.symbols, number->as_int(), &EnumSymbol::value);
    return known == type.symbols.end() ? *std::move(number) : Value(known->name);
  }

  Result<Value> compound(const Type& type, const ValuePath& path, std::size_t depth) {
    ValueMap map;
    if (type.fields.empty()) {
      if (const auto filler = read<std::uint8_t>(path); !filler) return filler.error();
    }
    for (const Field& field : type.fields) {
      auto value = decode(field.type, path.field(field.name), depth + 1);
      if (!value) return value;
      map.append(field.name, *std::move(value));
    }
    return Value(std::move(map));
  }

  Result<Value> container(const Type& type, const ValuePath& path, std::size_t depth) {
    const auto length = read<std::uint32_t>(path);
    if (!length) return length.error();
    if (type.is_string()) return text(*length, path);
    if (!type.is_optional()) return items(*length, type, path, depth);
    if (*length == 0) return Value();
    if (*length > 1)
      return refuse(path, "an optional holds at most one value, not " + std::to_string(*length));
    return decode(type.element, path, depth + 1);
  }

  // Every item takes a byte at least, so what is left bounds how many there can be.
  Result<Value> items(std::size_t count, const Type& type, const ValuePath& path, std::size_t depth) {
    if (count > left()) {
      return refuse(path, std::to_string(count) + " items cannot be in the " + std::to_string(left()) +
                              " bytes that are left");
    }
    Value::List list;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t before = left();
      auto item = decode(type.element, path.item(i), depth + 1);
      if (!item) return item;
      if (left() == before) return takes_no_bytes(*type.element, path);
      list.push_back(*std::move(item));
    }
    return Value(std::move(list));
  }

  // Some writers give an empty text the length 0 instead of 1.
  Result<Value> text(std::uint32_t length, const ValuePath& path) {
    if (length > left()) return too_short(path);
    std::string content(length, '\0');
    cdr_.deserializeArray(content.data(), content.size());
    if (content.empty()) return Value(std::move(content));
    if (content.back() != '\0') return refuse(path, "a text does not end with a zero byte");
    content.pop_back();
    return Value(std::move(content));
  }

  std::size_t size_;
  FastBuffer buffer_;
  Cdr cdr_;
};

Result<void> check_header(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeader)
    return fail(ErrorCode::ParseError, "a CDR message begins with a header of 4 bytes");
  const bool plain_cdr = bytes[0] == std::byte{0} && (bytes[1] == std::byte{0} || bytes[1] == std::byte{1});
  if (!plain_cdr) {
    return fail(ErrorCode::Unsupported,
                "only plain CDR is read, not representation " +
                    std::to_string(std::to_integer<int>(bytes[0]) * 256 + std::to_integer<int>(bytes[1])));
  }
  return {};
}

Error library_failure(const std::exception& exception) {
  return fail(ErrorCode::Internal, std::string("CDR: ") + exception.what());
}

Result<Value> decode_checked(std::span<const std::byte> bytes, const Type& type) {
  Decoder decoder(bytes);
  auto value = decoder.decode(&type, ValuePath({}), 0);
  if (value && decoder.left() > kPadding) {
    return fail(ErrorCode::TypeMismatch, "the message has " + std::to_string(decoder.left()) +
                                             " bytes more than " + type.name + " takes");
  }
  return value;
}

}  // namespace

Result<std::vector<std::byte>> encode_cdr(const Value& value, const Type& type) {
  try {
    Encoder encoder;
    if (auto done = encoder.encode(value, &type, ValuePath({}), 0); !done) return done.error();
    return encoder.take();
  } catch (const std::exception& exception) {
    return library_failure(exception);
  }
}

Result<Value> decode_cdr(std::span<const std::byte> bytes, const Type& type) {
  if (auto header = check_header(bytes); !header) return header.error();
  try {
    return decode_checked(bytes, type);
  } catch (const std::exception& exception) {
    return library_failure(exception);
  }
}

}  // namespace segue::type
