// SPDX-License-Identifier: Apache-2.0
#include <segue/type/cdr_object.hpp>
#include <segue/type/cdr_test_support.hpp>

#ifdef SEGUE_CDR
#include <segue/type/cdr.hpp>
#endif

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>
#include <span>

namespace segue::type {
namespace {

template <class T>
Bytes written(const T& object) {
  // Whatever is not written would show.
  Bytes bytes(cdr_size(type_info<T>(), &object), std::byte{0xa5});
  const auto used = write_cdr(type_info<T>(), &object, bytes);
  EXPECT_EQ(used.value_or(0), bytes.size());
  return bytes;
}

template <class T>
bool read(T& object, std::span<const std::byte> bytes) {
  return read_cdr(type_info<T>(), &object, bytes);
}

/// The bytes are those of the codec for values, in both directions.
template <class T>
void agree([[maybe_unused]] const T& object, [[maybe_unused]] const Bytes& bytes) {
#ifdef SEGUE_CDR
  const auto expected = encode_cdr(value_of(object), *type_info<T>().type);
  if (!expected) RC_FAIL(to_string(expected.error()));
  RC_ASSERT(bytes == *expected);
  const auto value = decode_cdr(bytes, *type_info<T>().type);
  if (!value) RC_FAIL(to_string(value.error()));
  T again{};
  RC_ASSERT(type_info<T>().from_value(&again, *value, "").has_value());
  RC_ASSERT(value_of(again) == value_of(object));
#endif
}

/// No part of a message is read as a whole, and no more than padding may follow.
template <class T>
void cut_short(Bytes bytes, const T& object, T used) {
  Bytes fewer(bytes.size());
  RC_ASSERT(!write_cdr(type_info<T>(), &object, std::span(fewer).first(bytes.size() - 1)).has_value());
  const auto cut = *rc::gen::inRange<std::size_t>(0, bytes.size());
  RC_ASSERT(!read(used, std::span(bytes).first(cut)));
  static_cast<void>(value_of(used));
  bytes.resize(bytes.size() + 3);
  RC_ASSERT(read(used, bytes));
  bytes.resize(bytes.size() + 1);
  RC_ASSERT(!read(used, bytes));
}

template <class T>
void check(const T& object, T used) {
  const Bytes bytes = written(object);
  agree(object, bytes);
  T fresh{};
  RC_ASSERT(read(fresh, bytes));
  RC_ASSERT(value_of(fresh) == value_of(object));
  cut_short(bytes, object, used);
  RC_ASSERT(read(used, bytes));
  RC_ASSERT(value_of(used) == value_of(object));
  RC_ASSERT(written(used) == bytes);
}

template <class... T>
void check_all() {
  (check(random_object<T>(), random_object<T>()), ...);
}

RC_GTEST_PROP(CdrObjectProperty, NumbersTextsAndContainersAreEncodedAsTheirValues, ()) {
  check_all<double, bool, std::int8_t, std::uint64_t, coded::Gait, coded::Side, std::string,
            std::vector<bool>, std::vector<float>, std::vector<double>, std::vector<std::string>,
            std::optional<std::int16_t>, std::optional<std::vector<std::string>>, std::array<std::string, 3>,
            std::array<double, 2>, std::chrono::nanoseconds, std::chrono::steady_clock::time_point>();
}

RC_GTEST_PROP(CdrObjectProperty, StructsAreEncodedAsTheirValues, ()) {
  check_all<coded::Contact, coded::Step, coded::Blank, coded::Image, std::vector<coded::Blank>,
            std::vector<coded::Contact>, std::vector<coded::Stamp>, std::vector<coded::Gap>,
            std::vector<coded::Step>, std::optional<coded::Step>, std::vector<std::array<coded::Contact, 2>>,
            std::vector<coded::Owner>>();
}

RC_GTEST_PROP(CdrObjectProperty, MatricesAreEncodedAsTheirValues, ()) {
  check(random_matrices(), random_matrices());
}

RC_GTEST_PROP(CdrObjectProperty, ChangedBytesLeaveSomethingValid, (std::vector<std::uint8_t> changes)) {
  Bytes bytes = written(random_object<coded::Step>());
  for (const std::uint8_t change : changes)
    bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = static_cast<std::byte>(change);
  auto object = random_object<coded::Step>();
  static_cast<void>(read(object, bytes));
  const Bytes again = written(object);
  coded::Step copy;
  RC_ASSERT(read(copy, again));
  RC_ASSERT(value_of(copy) == value_of(object));
}

TEST(CdrObject, WritesNumbersAtMultiplesOfTheirSizeAndZerosBetween) {
  const coded::Gap gap{1, 2, {3, 4, 0.0}};
  EXPECT_EQ(written(gap), message({0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0,
                                   // the number at 16 is there already
                                   0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(CdrObject, WritesTextsWithTheirLengthAndAFinalZero) {
  EXPECT_EQ(written(std::string("go")), message({0, 1, 0, 0, 3, 0, 0, 0, 'g', 'o', 0}));
  EXPECT_EQ(written(std::string()), message({0, 1, 0, 0, 1, 0, 0, 0, 0}));
}

TEST(CdrObject, WritesAStructWithoutMembersAsOneByte) {
  EXPECT_EQ(written(coded::Blank{}), message({0, 1, 0, 0, 0}));
}

TEST(CdrObject, AnImageIsItsHeaderAndItsBytes) {
  coded::Image image;
  image.data.assign(1000, 7);
  const Bytes bytes = written(image);
  EXPECT_EQ(bytes.size(), 4U + 16 + 4 + 4 + 1000);
  EXPECT_TRUE(
      std::ranges::all_of(std::span(bytes).subspan(28), [](auto byte) { return byte == std::byte{7}; }));
}

TEST(CdrObject, ReadsBigEndian) {
  coded::Late late;
  ASSERT_TRUE(read(late, message({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0})));
  EXPECT_EQ(late.number, 1);
  EXPECT_EQ(late.other, 512);
  EXPECT_EQ(late.value, 1.0);
  std::vector<std::int16_t> numbers;
  ASSERT_TRUE(read(numbers, message({0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 1, 0})));
  EXPECT_EQ(numbers, (std::vector<std::int16_t>{1, 256}));
  std::vector<bool> bits;
  ASSERT_TRUE(read(bits, message({0, 0, 0, 0, 0, 0, 0, 2, 1, 0})));
  EXPECT_EQ(bits, (std::vector<bool>{true, false}));
}

TEST(CdrObject, RefusesOtherRepresentations) {
  std::int32_t number = 0;
  EXPECT_TRUE(read(number, message({0, 1, 0, 0, 5, 0, 0, 0})));
  EXPECT_FALSE(read(number, message({0, 3, 0, 0, 5, 0, 0, 0}))) << "a parameter list";
  EXPECT_FALSE(read(number, message({0, 7, 0, 0, 5, 0, 0, 0}))) << "XCDR2";
  EXPECT_FALSE(read(number, message({1, 1, 0, 0, 5, 0, 0, 0})));
  EXPECT_FALSE(read(number, message({0, 1, 0})));
  EXPECT_FALSE(read(number, {}));
}

TEST(CdrObject, MembersThatAreNotNamedAreLeftAlone) {
  const char* text = "mine";
  coded::Secretive object{1, text, 2, 'g', 3};
  const coded::Secretive other{10, nullptr, 20, 'x', 30};
  ASSERT_TRUE(read(object, written(other)));
  EXPECT_EQ(object.shown, 10);
  EXPECT_EQ(object.small, 20);
  EXPECT_EQ(object.after, 30);
  EXPECT_EQ(object.hidden, text);
  EXPECT_EQ(object.gap, 'g');
}

TEST(CdrObject, CountsBeyondTheInputAreRefusedBeforeAnythingGrows) {
  for (const int count : {3, 0x7f}) {
    const Bytes bytes = message({0, 1, 0, 0, count, 0, 0, count, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1});
    std::vector<double> numbers;
    EXPECT_FALSE(read(numbers, bytes));
    std::vector<std::string> texts;
    EXPECT_FALSE(read(texts, bytes));
    std::vector<bool> bits;
    EXPECT_FALSE(read(bits, bytes));
    std::string text;
    EXPECT_FALSE(read(text, bytes));
    Eigen::MatrixXd matrix;
    EXPECT_FALSE(read(matrix, bytes));
    EXPECT_EQ(numbers.capacity() + texts.capacity() + bits.capacity(), 0U);
    EXPECT_EQ(matrix.size(), 0);
  }
}

TEST(CdrObject, MatricesHaveAsManyNumbersAsTheySay) {
  const Eigen::MatrixXd two_rows = Eigen::MatrixXd::Ones(2, 3);
  Bytes bytes = written(two_rows);
  Eigen::Matrix<double, 3, Eigen::Dynamic> three_rows;
  EXPECT_FALSE(read(three_rows, bytes));
  Eigen::MatrixXd matrix;
  EXPECT_TRUE(read(matrix, bytes));
  bytes[4] = std::byte{3};
  EXPECT_FALSE(read(matrix, bytes));
}

TEST(CdrObject, AMatrixWithoutNumbersIsReadAtOnceWhateverItsSize) {
  Eigen::MatrixXd matrix;
  const Bytes rows = message({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_TRUE(read(matrix, rows));
  EXPECT_EQ(matrix.rows(), std::int64_t{1} << 60);
  EXPECT_EQ(written(matrix), rows);
  EXPECT_EQ(value_of(matrix).find("data")->as_list().size(), 0U);
}

TEST(CdrObject, BooleansEnumsAndOptionalsAreChecked) {
  bool boolean = false;
  EXPECT_FALSE(read(boolean, message({0, 1, 0, 0, 2})));
  std::vector<coded::Contact> contacts;
  Bytes bytes = written(std::vector<coded::Contact>(3));
  bytes[4 + 8 + 8 + 1] = std::byte{2};
  EXPECT_FALSE(read(contacts, bytes));
  coded::Gait gait{};
  EXPECT_TRUE(read(gait, message({0, 1, 0, 0, 7}))) << "the bits of its symbols";
  EXPECT_FALSE(read(gait, message({0, 1, 0, 0, 8})));
  EXPECT_FALSE(read(gait, message({0, 0, 0, 0, 8})));
  std::optional<std::uint8_t> optional;
  EXPECT_TRUE(read(optional, message({0, 1, 0, 0, 1, 0, 0, 0, 9})));
  EXPECT_FALSE(read(optional, message({0, 1, 0, 0, 2, 0, 0, 0, 9, 9})));
  std::string text;
  EXPECT_FALSE(read(text, message({0, 1, 0, 0, 2, 0, 0, 0, 'g', 'o'})));
}

TEST(CdrObject, BooleansOfClassesWithADestructorAreChecked) {
  std::vector<coded::Owner> owners;
  EXPECT_TRUE(read(owners, message({0, 1, 0, 0, 1, 0, 0, 0, 1, 1})));
  EXPECT_FALSE(read(owners, message({0, 1, 0, 0, 1, 0, 0, 0, 1, 2})));
}

TEST(CdrObject, TypesThatContainThemselvesNestAHundredLevels) {
  const coded::Branch deep = branch(100);
  coded::Branch copy;
  ASSERT_TRUE(read(copy, written(deep)));
  EXPECT_EQ(value_of(copy), value_of(deep));
  const coded::Branch deeper = branch(101);
  EXPECT_EQ(cdr_size(type_info<coded::Branch>(), &deeper), 0U);
  Bytes endless = message({0, 1, 0, 0});
  for (int i = 0; i < 1000; ++i) {
    const Bytes level = message({7, 0, 0, 0, 1, 0, 0, 0});
    endless.insert(endless.end(), level.begin(), level.end());
  }
  EXPECT_FALSE(read(copy, endless));
}

TEST(CdrObject, AnObjectThatHoldsAsMuchKeepsItsMemory) {
  coded::Image image;
  image.data.assign(1000, 7);
  const Bytes bytes = written(image);
  coded::Image object;
  ASSERT_TRUE(read(object, bytes));
  const auto* data = object.data.data();
  ASSERT_TRUE(read(object, bytes));
  EXPECT_EQ(object.data.data(), data);
}

TEST(CdrObject, TypesWithoutStructureCannotBeEncoded) {
  EXPECT_FALSE(can_encode_cdr(type_info<coded::HasOpaque>()));
  coded::HasOpaque object;
  Bytes bytes(100);
  EXPECT_EQ(cdr_size(type_info<coded::HasOpaque>(), &object), 0U);
  EXPECT_FALSE(write_cdr(type_info<coded::HasOpaque>(), &object, bytes));
  EXPECT_FALSE(read_cdr(type_info<coded::HasOpaque>(), &object, bytes));
  EXPECT_TRUE(can_encode_cdr(type_info<coded::Matrices>()));
}

}  // namespace
}  // namespace segue::type
