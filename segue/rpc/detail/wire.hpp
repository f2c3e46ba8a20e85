// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/wire.capnp.h>
#include <segue/base/error.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Encodes and decodes values and errors. Messages are not trusted: depth and number of nodes are bounded.
/// Reading malformed messages throws kj::Exception, which the RPC system turns into an error.
namespace segue::control::detail {

/// Raised when the meaning of a message changes; additions that old programs ignore do not count.
inline constexpr std::uint32_t kProtocolVersion = 6;

/// Deeper values are refused (files are limited to 200).
inline constexpr int kMaxDepth = 256;

/// The largest message, in words of eight bytes, that a server and a client take.
inline constexpr std::uint64_t kServerMessageWords = std::uint64_t{1} << 20;   // 8 MiB
inline constexpr std::uint64_t kClientMessageWords = std::uint64_t{32} << 20;  // 256 MiB
/// A level of a Value is three levels of a message; RPC itself adds a few.
inline constexpr int kMessageNesting = 3 * kMaxDepth + 32;

/// An upper bound of the size of an encoded value.
std::uint64_t encoded_words(const type::Value& value);
/// ResourceExhausted where `value` does not fit into a message of `words` (with room for the rest).
Result<void> check_size(const type::Value& value, std::uint64_t words);

/// InvalidArgument where the value is nested too deep; the builder is then half filled.
Result<void> encode(const type::Value& value, wire::Value::Builder builder);
/// ResourceExhausted where it has more than `max_nodes` nodes, ParseError where it is nested too deep or a
/// map has a key twice.
Result<type::Value> decode(wire::Value::Reader reader, std::uint64_t max_nodes);

void encode(const Error& error, wire::Error::Builder builder);
Error decode(wire::Error::Reader reader);

/// A value that cannot be encoded is replaced by the error that describes why.
void encode(const Result<type::Value>& answer, wire::Answer::Builder builder);
Result<type::Value> decode(wire::Answer::Reader reader, std::uint64_t max_nodes);

void encode(const Result<void>& outcome, wire::Outcome::Builder builder);
Result<void> decode(wire::Outcome::Reader reader);

/// The error of encoding or decoding, where functions that walk through whole structures return no Result.
class WireError final : public std::exception {
 public:
  explicit WireError(Error error) : error_(std::move(error)) {}
  [[nodiscard]] const Error& error() const { return error_; }
  [[nodiscard]] const char* what() const noexcept override { return error_.message.c_str(); }

 private:
  Error error_;
};

/// Encode and decode values; throw WireError where encode() and decode() would return an error.
void put(const type::Value& value, wire::Value::Builder builder);
type::Value get(wire::Value::Reader reader, std::uint64_t max_nodes = kServerMessageWords);

/// An enumeration whose last enumerator is `last`; throws WireError where the number stands for none.
template <class Enum>
Enum enum_from(unsigned number, Enum last) {
  if (number > static_cast<unsigned>(last)) {
    throw WireError(fail(ErrorCode::ParseError, "a message has a word that this version does not know"));
  }
  return static_cast<Enum>(number);
}

/// Lists, item by item: `encode_item(item, builder)` and `decode_item(reader)`.
template <class Items, class Builder, class Encode>
void encode_list(const Items& items, Builder builder, Encode encode_item) {
  unsigned i = 0;
  for (const auto& item : items)
    encode_item(item, builder[i++]);
}
template <class Item, class Reader, class Decode>
std::vector<Item> decode_list(Reader reader, Decode decode_item) {
  std::vector<Item> items;
  items.reserve(reader.size());
  for (const auto item : reader)
    items.push_back(decode_item(item));
  return items;
}
/// How many items a list of a message has.
template <class Items>
unsigned count_of(const Items& items) {
  return static_cast<unsigned>(std::size(items));
}

/// Converts between C++ strings and the text of messages, without copying where possible.
capnp::Text::Reader as_text(const std::string& value);
capnp::Data::Reader as_data(std::string_view value);
std::string as_string(capnp::Text::Reader value);
std::string as_string(capnp::Data::Reader value);

}  // namespace segue::control::detail
