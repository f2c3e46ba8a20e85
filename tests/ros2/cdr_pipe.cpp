// SPDX-License-Identifier: Apache-2.0
//
// Segue's side of cdr_judge.mjs: writes and reads messages of ROS 2 as CDR, a line of JSON in, a line of JSON
// out.
//   cdr_pipe [FOLDER...]   folders with interface packages, besides those that are built in
// In:  {"type": "std_msgs/msg/Float32", "value": {"data": "..."}, "messages": ["00010000...", ...]}
// Out: {"written": "00010000...", "read": [{"value": {"data": "..."}, "relayed": "00010000...", "bounds":
// ""}, ...]}
//      "written" is the value as CDR; of each message "read" has its value, what becomes of it on its way
//      through shared memory to another host, and which bound it does not keep. {"error": "..."} where
//      something is refused.
// Numbers are decimal texts and floating point numbers those of the bits of a double, since JSON has neither
// NaN nor -0, and JavaScript reads no integers of 64 bits.
#include <segue/ros2/message_bounds.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/json.hpp>
#include <segue/type/made_type.hpp>

#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using namespace segue;
using type::NumericCategory;
using type::Type;
using type::TypeInfo;
using type::TypeKind;
using type::Value;
using Bytes = std::vector<std::byte>;

template <class Number>
Number number_from(const std::string& text, int base = 10) {
  Number number{};
  std::from_chars(text.data(), text.data() + text.size(), number, base);
  return number;
}

Bytes bytes_of(const std::string& hex) {
  Bytes bytes(hex.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = std::byte{number_from<std::uint8_t>(hex.substr(2 * i, 2), 16)};
  return bytes;
}

std::string hex_of(const Bytes& bytes) {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const std::byte byte : bytes) {
    hex += kDigits[std::to_integer<std::size_t>(byte) / 16];
    hex += kDigits[std::to_integer<std::size_t>(byte) % 16];
  }
  return hex;
}

Value number_of(const std::string& text, const Type& type) {
  if (type.category == NumericCategory::Bool) return text == "true";
  if (type.category == NumericCategory::Float) return std::bit_cast<double>(number_from<std::uint64_t>(text));
  if (type.category == NumericCategory::Unsigned) return number_from<std::uint64_t>(text);
  return number_from<std::int64_t>(text);
}

Value text_of(const Value& number, const Type& type) {
  if (type.category == NumericCategory::Bool) return number.as_bool() ? "true" : "false";
  if (type.category == NumericCategory::Float)
    return std::to_string(std::bit_cast<std::uint64_t>(number.as_double()));
  if (type.category == NumericCategory::Unsigned) return std::to_string(number.as_uint());
  return std::to_string(number.as_int());
}

/// The value with each number replaced by what `convert` makes of it. Requires a value of the type.
template <class Convert>
Value converted(const Value& value, const Type& type, const Convert& convert) {
  if (type.kind == TypeKind::Numeric) return convert(value, type);
  if (type.is_string()) return value;
  if (type.kind == TypeKind::Compound) {
    type::ValueMap members;
    for (const type::Field& field : type.fields)
      members.set(field.name, converted(*value.find(field.name), *field.type, convert));
    return members;
  }
  Value::List items;
  for (const Value& item : value.as_list())
    items.push_back(converted(item, *type.element, convert));
  return items;
}

Value from_texts(const Value& texts, const Type& type) {
  return converted(texts, type,
                   [](const Value& text, const Type& its) { return number_of(text.as_string(), its); });
}

Value to_texts(const Value& value, const Type& type) {
  return converted(value, type, text_of);
}

using Object = std::unique_ptr<std::byte[], std::function<void(std::byte*)>>;

Object make_object(const TypeInfo& info) {
  Object object(new std::byte[info.size], [&info](std::byte* memory) {
    info.destroy(memory);
    delete[] memory;
  });
  info.construct(object.get());
  return object;
}

Result<std::string> written(const TypeInfo& info, const Value& value) {
  const Object object = make_object(info);
  if (auto done = info.from_value(object.get(), value, "value"); !done) return done.error();
  Bytes bytes(type::cdr_size(info, object.get()));
  if (!type::write_cdr(info, object.get(), bytes))
    return fail(ErrorCode::Internal, "write_cdr() refused the value");
  return hex_of(bytes);
}

Result<std::string> relayed(const TypeInfo& info, const Bytes& message) {
  Bytes flat(type::flat_size_of_cdr(info, message));
  if (!type::cdr_to_flat(info, message, flat))
    return fail(ErrorCode::Internal, "cdr_to_flat() refused the message");
  Bytes bytes(type::cdr_size_of_flat(info, flat));
  if (!type::flat_to_cdr(info, flat, bytes))
    return fail(ErrorCode::Internal, "flat_to_cdr() refused the message");
  return hex_of(bytes);
}

Result<Value> read(const TypeInfo& info, const ros2::MessageBounds& bounds, const Bytes& message) {
  const Object object = make_object(info);
  if (!type::read_cdr(info, object.get(), message))
    return fail(ErrorCode::Internal, "read_cdr() refused the message");
  auto again = relayed(info, message);
  if (!again) return again.error();
  return Value::map({{"value", to_texts(info.to_value(object.get()), *info.type)},
                     {"relayed", *std::move(again)},
                     {"bounds", bounds.broken_by(message)}});
}

class Pipe {
 public:
  explicit Pipe(std::vector<std::filesystem::path> folders) : library_(std::move(folders)) {}

  Result<Value> answer(const std::string& line) {
    const auto request = type::parse_json(line);
    if (!request) return request.error();
    const std::string& name = request->find("type")->as_string();
    const auto type = ros2::message_type(library_, name, registry_);
    if (!type) return type.error();
    const auto bounds = ros2::MessageBounds::of(library_, name);
    if (!bounds) return bounds.error();
    const auto info = type::make_type_info(**type);
    if (!info) return info.error();
    auto own = written(**info, from_texts(*request->find("value"), **type));
    if (!own) return own.error();
    Value::List values;
    for (const Value& message : request->find("messages")->as_list()) {
      auto value = read(**info, *bounds, bytes_of(message.as_string()));
      if (!value) return value.error();
      values.push_back(*std::move(value));
    }
    return Value::map({{"written", *std::move(own)}, {"read", std::move(values)}});
  }

 private:
  ros2::InterfaceLibrary library_;
  type::TypeRegistry registry_;
};

}  // namespace

int main(int argc, char** argv) {
  Pipe pipe(std::vector<std::filesystem::path>(argv + 1, argv + argc));
  for (std::string line; std::getline(std::cin, line);) {
    const auto answer = pipe.answer(line);
    std::cout << type::to_json(answer ? *answer : Value::map({{"error", to_string(answer.error())}}), -1)
              << '\n';
  }
  return 0;
}
