// SPDX-License-Identifier: Apache-2.0
#include <segue/type/cdr.hpp>
#include <segue/type/conform.hpp>
#include <support/random_types.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <initializer_list>
#include <string>
#include <vector>

namespace segue::type {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> numbers) {
  Bytes result;
  for (const int number : numbers)
    result.push_back(static_cast<std::byte>(number));
  return result;
}

Type numeric(NumericCategory category, std::size_t size) {
  Type type;
  type.kind = TypeKind::Numeric;
  type.name = "/number";
  type.category = category;
  type.size = size;
  return type;
}

Type made_of(TypeKind kind, const Type& element, std::string container_kind = {}, std::size_t count = 0) {
  Type type;
  type.kind = kind;
  type.name = "/holder";
  type.element = &element;
  type.container_kind = std::move(container_kind);
  type.count = count;
  return type;
}

struct Types {
  Type byte = numeric(NumericCategory::Unsigned, 1);
  Type boolean = numeric(NumericCategory::Bool, 1);
  Type int32 = numeric(NumericCategory::Signed, 4);
  Type real = numeric(NumericCategory::Float, 8);
  Type text = made_of(TypeKind::Container, byte, "/std/string");
  Type list = made_of(TypeKind::Container, int32, "/std/vector");
  Type pair = made_of(TypeKind::Array, int32, {}, 2);
  Type maybe = made_of(TypeKind::Container, real, "/std/optional");
  Type mode;
  Type header;
  Type empty;

  Types() {
    mode.kind = TypeKind::Enum;
    mode.name = "/demo/Mode";
    mode.size = 4;
    mode.symbols = {{"IDLE", 0}, {"DRIVE", 1}};
    // Like ROS 2's std_msgs/Header.
    header.kind = TypeKind::Compound;
    header.name = "/std_msgs/Header";
    header.fields = {{"sec", &int32, 0}, {"nanosec", &int32, 4}, {"frame_id", &text, 8}};
    empty.kind = TypeKind::Compound;
    empty.name = "/std_msgs/Empty";
  }
};

class CdrCodec : public ::testing::Test {
 protected:
  static void expect_bytes(const Value& value, const Type& type, const Bytes& expected) {
    const auto encoded = encode_cdr(value, type);
    ASSERT_TRUE(encoded) << to_string(encoded.error());
    EXPECT_EQ(*encoded, expected);
    const auto decoded = decode_cdr(expected, type);
    ASSERT_TRUE(decoded) << to_string(decoded.error());
    EXPECT_EQ(*decoded, value);
  }

  static std::string encoding_refused(const Value& value, const Type& type) {
    const auto encoded = encode_cdr(value, type);
    return encoded ? "it was accepted" : to_string(encoded.error());
  }

  static std::string decoding_refused(const Bytes& input, const Type& type) {
    const auto decoded = decode_cdr(input, type);
    return decoded ? "it was accepted as " + describe(*decoded) : to_string(decoded.error());
  }

  Types types_;
};

TEST_F(CdrCodec, WritesARosHeaderAsRosDoes) {
  expect_bytes(Value::map({{"sec", 1}, {"nanosec", 2}, {"frame_id", "map"}}), types_.header,
               bytes({0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 'm', 'a', 'p', 0}));
}

TEST_F(CdrCodec, AlignsNumbersFromBehindTheHeader) {
  Type type;
  type.kind = TypeKind::Compound;
  type.fields = {
      {"a", &types_.byte, 0}, {"b", &types_.real, 8}, {"c", &types_.boolean, 16}, {"d", &types_.int32, 20}};
  expect_bytes(Value::map({{"a", 7}, {"b", 1.0}, {"c", true}, {"d", -2}}), type,
               bytes({0, 1, 0, 0, 7,    0,    0, 0, 0, 0, 0,    0,    0,    0,
                      0, 0, 0, 0, 0xF0, 0x3F, 1, 0, 0, 0, 0xFE, 0xFF, 0xFF, 0xFF}));
}

TEST_F(CdrCodec, SequencesHaveALengthArraysHaveNone) {
  expect_bytes(Value::list({5, 6}), types_.list, bytes({0, 1, 0, 0, 2, 0, 0, 0, 5, 0, 0, 0, 6, 0, 0, 0}));
  expect_bytes(Value::list({5, 6}), types_.pair, bytes({0, 1, 0, 0, 5, 0, 0, 0, 6, 0, 0, 0}));
  expect_bytes(Value(), types_.maybe, bytes({0, 1, 0, 0, 0, 0, 0, 0}));
}

TEST_F(CdrCodec, EnumsTakeTheSizeOfTheirType) {
  expect_bytes("DRIVE", types_.mode, bytes({0, 1, 0, 0, 1, 0, 0, 0}));
  types_.mode.size = 1;
  expect_bytes("DRIVE", types_.mode, bytes({0, 1, 0, 0, 1}));
  expect_bytes(9, types_.mode, bytes({0, 1, 0, 0, 9}));  // a number without symbol passes through
}

TEST_F(CdrCodec, ACompoundWithoutFieldsIsOneByte) {
  expect_bytes(ValueMap(), types_.empty, bytes({0, 1, 0, 0, 0}));
}

TEST_F(CdrCodec, ReadsBigEndianAndPadding) {
  EXPECT_EQ(decode_cdr(bytes({0, 0, 0, 0, 0, 0, 1, 2}), types_.int32).value_or(Value()), Value(258));
  EXPECT_EQ(decode_cdr(bytes({0, 1, 0, 3, 1, 0, 0, 0}), types_.boolean).value_or(Value()), Value(true));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 1, 0, 0, 0, 0}), types_.boolean),
              HasSubstr("4 bytes more"));
}

TEST_F(CdrCodec, RefusesOtherRepresentations) {
  EXPECT_THAT(decoding_refused(bytes({0, 3, 0, 0, 1}), types_.boolean), HasSubstr("representation 3"));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0}), types_.boolean), HasSubstr("header of 4 bytes"));
}

TEST_F(CdrCodec, LengthsAreCheckedBeforeTheyAreBelieved) {
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 255, 255, 255, 255, 1}), types_.list),
              HasSubstr("4294967295 items cannot be in the 1 bytes"));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 255, 255, 255, 255, 1}), types_.text),
              HasSubstr("ends too early"));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 2, 0, 0, 0}), types_.maybe), HasSubstr("at most one"));
}

TEST_F(CdrCodec, RefusesWhatNoWriterWrites) {
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 7}), types_.boolean), HasSubstr("0 or 1, not 7"));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 1, 0, 0, 0, 'x'}), types_.text), HasSubstr("zero byte"));
}

TEST_F(CdrCodec, ValuesMustFitAndBeWhole) {
  EXPECT_THAT(encoding_refused(Value::map({{"sec", 1}}), types_.header),
              HasSubstr("nanosec: the value lacks"));
  EXPECT_THAT(encoding_refused(Value::map({{"sec", 1}, {"nanosec", "x"}, {"frame_id", ""}}), types_.header),
              HasSubstr("nanosec: expected a number, got 'x'"));
  EXPECT_THAT(encoding_refused(Value::map({{"sec", 1}, {"nanosec", 1}, {"frame_id", ""}, {"more", 1}}),
                               types_.header),
              HasSubstr("has fields that /std_msgs/Header lacks"));
  EXPECT_THAT(encoding_refused(Value::list({1, "x"}), types_.list), HasSubstr("[1]: expected a number"));
  EXPECT_THAT(encoding_refused(Value::list({1}), types_.pair), HasSubstr("expected a list of 2"));
  EXPECT_THAT(encoding_refused("GO", types_.mode), HasSubstr("IDLE and DRIVE"));
}

TEST_F(CdrCodec, TypesMustBeComplete) {
  Type opaque;
  opaque.kind = TypeKind::Opaque;
  opaque.name = "/base/Opaque";
  EXPECT_THAT(encoding_refused(1, opaque), HasSubstr("the layout of /base/Opaque is not known"));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 1}), made_of(TypeKind::Pointer, types_.byte)),
              HasSubstr("layout"));
  EXPECT_THAT(encoding_refused(1.0, numeric(NumericCategory::Float, 16)), HasSubstr("no number of 16 bytes"));
}

TEST_F(CdrCodec, ItemsWithoutBytesAreRefused) {
  const Type none = made_of(TypeKind::Array, types_.int32, {}, 0);
  const Type many = made_of(TypeKind::Container, none, "/std/vector");
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0}), many),
              HasSubstr("take no bytes"));
  EXPECT_THAT(encoding_refused(Value::list({Value(Value::List{})}), many), HasSubstr("take no bytes"));
}

TEST_F(CdrCodec, TypesThatContainThemselvesEnd) {
  Type endless;
  endless.kind = TypeKind::Compound;
  endless.name = "/demo/Endless";
  endless.fields = {{"a", &endless, 0}, {"b", &endless, 0}};
  EXPECT_THAT(decoding_refused(Bytes(1000, std::byte{1}), endless), HasSubstr("representation"));
  EXPECT_THAT(decoding_refused(bytes({0, 1, 0, 0, 1, 1}), endless), HasSubstr("deeper than 200"));
}

RC_GTEST_PROP(CdrProperties, WhatIsEncodedDecodesEqual, ()) {
  const RandomType random = *random_type();
  const Value value = random_value_for(*random.type);
  const auto encoded = encode_cdr(value, *random.type);
  RC_ASSERT(encoded.has_value());
  const auto decoded = decode_cdr(*encoded, *random.type);
  RC_ASSERT(decoded.has_value());
  RC_ASSERT(*decoded == value);
}

RC_GTEST_PROP(CdrProperties, WhatFitsATypePassesItsCheck, ()) {
  const RandomType random = *random_type();
  Diagnostics diagnostics;
  check_value(random_value_for(*random.type), *random.type, "value", {}, diagnostics);
  RC_ASSERT(diagnostics.empty());
}

RC_GTEST_PROP(CdrProperties, CutMessagesAreRefused, ()) {
  const RandomType random = *random_type();
  const auto encoded = encode_cdr(random_value_for(*random.type), *random.type);
  RC_PRE(encoded.has_value() && encoded->size() > 4);
  const auto length = *rc::gen::inRange<std::size_t>(0, encoded->size());
  RC_ASSERT(!decode_cdr(std::span(*encoded).first(length), *random.type));
}

RC_GTEST_PROP(CdrProperties, DamagedMessagesNeverCrash, ()) {
  const RandomType random = *random_type();
  auto encoded = encode_cdr(random_value_for(*random.type), *random.type);
  RC_ASSERT(encoded.has_value());
  const auto at = *rc::gen::inRange<std::size_t>(0, encoded->size());
  (*encoded)[at] = static_cast<std::byte>(*rc::gen::arbitrary<std::uint8_t>());
  const auto decoded = decode_cdr(*encoded, *random.type);
  // Whatever was read is a value of the type, so it can be written again.
  if (decoded) RC_ASSERT(encode_cdr(*decoded, *random.type).has_value());
}

}  // namespace
}  // namespace segue::type
