// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc/detail/wire.hpp>

#include <algorithm>
#include <limits>
#include <memory>
#include <unordered_set>
#include <utility>
#include <vector>

namespace segue::control::detail {

namespace {

using type::Value;
using type::ValueMap;

constexpr int kMaxCauses = 32;
constexpr std::uint64_t kWordBytes = 8;
constexpr std::uint64_t kValueWords = 5;  ///< a Value of the schema, and the tag of a list
constexpr std::uint64_t kEntryWords = 2;

Result<void> encode_at(const Value& value, wire::Value::Builder builder, int depth);

/// Whether all items are plain numbers of one kind, which travel packed.
bool all_of_kind(const Value::List& list, Value::Kind kind) {
  return !list.empty() && std::all_of(list.begin(), list.end(), [kind](const Value& item) {
    return item.kind() == kind && item.source_text().empty();
  });
}

Result<void> encode_list(const Value::List& list, wire::Value::Builder builder, int depth) {
  const auto size = static_cast<unsigned>(list.size());
  if (all_of_kind(list, Value::Kind::Int)) {
    auto items = builder.initIntegers(size);
    for (unsigned i = 0; i < size; ++i)
      items.set(i, list[i].as_int());
    return {};
  }
  if (all_of_kind(list, Value::Kind::Float)) {
    auto items = builder.initNumbers(size);
    for (unsigned i = 0; i < size; ++i)
      items.set(i, list[i].as_double());
    return {};
  }
  auto items = builder.initList(size);
  for (unsigned i = 0; i < size; ++i) {
    if (auto done = encode_at(list[i], items[i], depth + 1); !done) return done;
  }
  return {};
}

Result<void> encode_map(const ValueMap& map, wire::Value::Builder builder, int depth) {
  auto entries = builder.initMap(static_cast<unsigned>(map.size()));
  unsigned i = 0;
  for (const auto& [key, value] : map) {
    auto entry = entries[i++];
    entry.setKey(as_data(key));
    if (auto done = encode_at(value, entry.initValue(), depth + 1); !done) return done;
  }
  return {};
}

Result<void> encode_at(const Value& value, wire::Value::Builder builder, int depth) {
  if (depth > kMaxDepth) {
    return fail(ErrorCode::InvalidArgument,
                "a value nested deeper than " + std::to_string(kMaxDepth) + " levels cannot be sent");
  }
  if (const auto source = value.source_text(); !source.empty())
    builder.setSource(as_text(std::string(source)));
  switch (value.kind()) {
    case Value::Kind::Null:
      builder.setNothing();
      return {};
    case Value::Kind::Bool:
      builder.setBoolean(value.as_bool());
      return {};
    case Value::Kind::Int:
      builder.setInteger(value.as_int());
      return {};
    case Value::Kind::UInt:
      builder.setUnsigned(value.as_uint());
      return {};
    case Value::Kind::Float:
      builder.setNumber(value.as_double());
      return {};
    case Value::Kind::String:
      builder.setText(as_data(value.as_string()));
      return {};
    case Value::Kind::List:
      return encode_list(value.as_list(), builder, depth);
    case Value::Kind::Map:
      return encode_map(value.as_map(), builder, depth);
  }
  return fail(ErrorCode::Internal, "a value of a kind that is not known");
}

/// Reads one value under limits.
class Decoder {
 public:
  explicit Decoder(std::uint64_t max_nodes) : left_(max_nodes) {}

  Result<Value> decode_at(wire::Value::Reader reader, int depth) {
    if (depth > kMaxDepth) return fail(ErrorCode::ParseError, "a value is nested too deep");
    if (auto taken = take(1); !taken) return taken.error();
    auto value = content(reader, depth);
    if (value && reader.hasSource()) value->set_source_text(as_string(reader.getSource()));
    return value;
  }

 private:
  Result<void> take(std::uint64_t nodes) {
    if (nodes > left_) return fail(ErrorCode::ResourceExhausted, "a value has too many parts");
    left_ -= nodes;
    return {};
  }

  Result<Value> content(wire::Value::Reader reader, int depth) {
    switch (reader.which()) {
      case wire::Value::NOTHING:
        return Value();
      case wire::Value::BOOLEAN:
        return Value(reader.getBoolean());
      case wire::Value::INTEGER:
        return Value(std::int64_t{reader.getInteger()});
      case wire::Value::UNSIGNED:
        return Value(std::uint64_t{reader.getUnsigned()});
      case wire::Value::NUMBER:
        return Value(reader.getNumber());
      case wire::Value::TEXT:
        return Value(as_string(reader.getText()));
      case wire::Value::LIST:
        return list(reader.getList(), depth);
      case wire::Value::INTEGERS:
        return packed<std::int64_t>(reader.getIntegers());
      case wire::Value::NUMBERS:
        return packed<double>(reader.getNumbers());
      case wire::Value::MAP:
        return map(reader.getMap(), depth);
    }
    return fail(ErrorCode::ParseError, "a value of a kind that this version does not know");
  }

  Result<Value> list(capnp::List<wire::Value>::Reader items, int depth) {
    Value::List list;
    for (const auto item : items) {
      auto value = decode_at(item, depth + 1);
      if (!value) return value;
      list.push_back(std::move(*value));
    }
    return Value(std::move(list));
  }

  template <class Number, class Reader>
  Result<Value> packed(const Reader& items) {
    if (auto taken = take(items.size()); !taken) return taken.error();
    Value::List list;
    list.reserve(items.size());
    for (const auto item : items)
      list.emplace_back(Number{item});
    return Value(std::move(list));
  }

  Result<Value> map(capnp::List<wire::Value::Entry>::Reader entries, int depth) {
    ValueMap map;
    std::unordered_set<std::string> keys;
    for (const auto entry : entries) {
      auto value = decode_at(entry.getValue(), depth + 1);
      if (!value) return value;
      std::string key = as_string(entry.getKey());
      if (!keys.insert(key).second) return fail(ErrorCode::ParseError, "a map has a key twice");
      map.append(std::move(key), std::move(*value));
    }
    return Value(std::move(map));
  }

  std::uint64_t left_;
};

ErrorCode code_from(std::string_view name) {
  for (int i = 0; i <= static_cast<int>(ErrorCode::Internal); ++i) {
    if (to_string(static_cast<ErrorCode>(i)) == name) return static_cast<ErrorCode>(i);
  }
  return ErrorCode::Internal;
}

void encode_error(const Error& error, wire::Error::Builder builder, int causes) {
  builder.setCode(as_text(std::string(to_string(error.code))));
  builder.setMessage(as_data(error.message));
  builder.setFile(as_data(error.where.file));
  builder.setLine(error.where.line);
  builder.setColumn(error.where.column);
  builder.setSubject(as_data(error.subject));
  if (error.cause && causes > 0) encode_error(*error.cause, builder.initCause(), causes - 1);
}

Error decode_error(wire::Error::Reader reader, int causes) {
  Error error;
  error.code = code_from(as_string(reader.getCode()));
  error.message = as_string(reader.getMessage());
  error.where = {as_string(reader.getFile()), reader.getLine(), reader.getColumn()};
  error.subject = as_string(reader.getSubject());
  if (reader.hasCause() && causes > 0) {
    error.cause = std::make_shared<const Error>(decode_error(reader.getCause(), causes - 1));
  }
  return error;
}

}  // namespace

capnp::Text::Reader as_text(const std::string& value) {
  return {value.c_str(), value.size()};
}

capnp::Data::Reader as_data(std::string_view value) {
  return {reinterpret_cast<const kj::byte*>(value.data()), value.size()};
}

std::string as_string(capnp::Text::Reader value) {
  return {value.begin(), value.size()};
}

std::string as_string(capnp::Data::Reader value) {
  return {reinterpret_cast<const char*>(value.begin()), value.size()};
}

std::uint64_t encoded_words(const Value& value) {
  std::uint64_t words = kValueWords + value.source_text().size() / kWordBytes + 1;
  if (value.is_string()) words += value.as_string().size() / kWordBytes + 1;
  if (value.is_list()) {
    for (const Value& item : value.as_list())
      words += encoded_words(item);
  }
  if (value.is_map()) {
    for (const auto& [key, item] : value.as_map()) {
      words += kEntryWords + key.size() / kWordBytes + 1 + encoded_words(item);
    }
  }
  return words;
}

Result<void> check_size(const Value& value, std::uint64_t words) {
  // Half, since the reader of a message counts some parts twice.
  const std::uint64_t needed = encoded_words(value);
  if (needed <= words / 2) return {};
  return fail(ErrorCode::ResourceExhausted, "a value of " + std::to_string(needed * kWordBytes >> 20) +
                                                " MiB is too large to be sent; at most " +
                                                std::to_string(words * kWordBytes / 2 >> 20) + " MiB are");
}

Result<void> encode(const Value& value, wire::Value::Builder builder) {
  return encode_at(value, builder, 0);
}

Result<Value> decode(wire::Value::Reader reader, std::uint64_t max_nodes) {
  return Decoder(max_nodes).decode_at(reader, 0);
}

void encode(const Error& error, wire::Error::Builder builder) {
  encode_error(error, builder, kMaxCauses);
}

Error decode(wire::Error::Reader reader) {
  return decode_error(reader, kMaxCauses);
}

void encode(const Result<Value>& answer, wire::Answer::Builder builder) {
  if (!answer) return encode(answer.error(), builder.initError());
  if (const auto fits = check_size(*answer, kClientMessageWords); !fits) {
    return encode(fits.error(), builder.initError());
  }
  if (const auto done = encode(*answer, builder.initValue()); !done)
    encode(done.error(), builder.initError());
}

Result<Value> decode(wire::Answer::Reader reader, std::uint64_t max_nodes) {
  if (reader.isError()) return decode(reader.getError());
  return decode(reader.getValue(), max_nodes);
}

void encode(const Result<void>& outcome, wire::Outcome::Builder builder) {
  if (outcome) return builder.setDone();
  encode(outcome.error(), builder.initError());
}

Result<void> decode(wire::Outcome::Reader reader) {
  if (reader.isError()) return decode(reader.getError());
  return {};
}

void put(const Value& value, wire::Value::Builder builder) {
  if (const auto done = encode(value, builder); !done) throw WireError(done.error());
}

Value get(wire::Value::Reader reader, std::uint64_t max_nodes) {
  auto value = decode(reader, max_nodes);
  if (!value) throw WireError(value.error());
  return std::move(*value);
}

}  // namespace segue::control::detail
