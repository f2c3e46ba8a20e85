// SPDX-License-Identifier: Apache-2.0
#include <segue/type/cdr_object.hpp>
#include <segue/type/eigen.hpp>
#include <support/random_types.hpp>

#ifdef SEGUE_CDR
#include <segue/type/cdr.hpp>
#endif

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <span>

namespace coded {
enum class Gait : std::uint8_t { Walk, Trot = 3, Jump = 4 };
enum class Side : std::int16_t { Left = -1, None, Right };
enum class Gear { Neutral, First };
/// As in memory, but for its end.
struct Contact {
  double force = 0;
  std::uint8_t leg = 0;
  bool firm = false;
  Gait gait = Gait::Walk;
};
/// As in memory as a whole, where it begins at a multiple of eight.
struct Stamp {
  std::int64_t seconds = 0;
  std::uint32_t fraction = 0;
  Gear gear = Gear::Neutral;
};
/// Begins with a smaller number than it contains.
struct Late {
  std::int32_t number = 0;
  std::int32_t other = 0;
  double value = 0;
};
struct Swapped {
  std::int32_t x = 0;
  std::int32_t y = 0;
};
struct Gap {
  std::uint8_t before = 0;
  std::uint32_t after = 0;
  Late late;
};
struct Step {
  std::uint8_t odd = 0;
  std::int32_t number = 0;
  std::string name;
  Stamp stamp;
  std::chrono::milliseconds duration{0};
  std::vector<Contact> contacts;
  std::vector<Late> late;
  std::vector<Stamp> stamps;
  std::optional<std::string> remark;
  std::vector<bool> firm;
  std::array<std::vector<Side>, 2> sides;
  std::vector<std::vector<std::string>> texts;
  std::array<Gap, 3> gaps;
  std::optional<Contact> last;
  Swapped swapped;
};
struct Image {
  Stamp stamp;
  std::uint32_t width = 0;
  std::vector<std::uint8_t> data;
};
struct Secretive {
  std::int32_t shown = 0;
  const char* hidden = nullptr;
  std::uint8_t small = 0;
  char gap = 0;
  std::uint16_t after = 0;
};
struct Blank {};
struct Branch {
  std::int32_t value = 0;
  std::vector<Branch> branches;
};
struct Matrices {
  std::uint8_t odd = 0;
  Eigen::VectorXd vector;
  Eigen::MatrixXf matrix;
  Eigen::Matrix<double, 3, Eigen::Dynamic> points;
  Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> image;
  Eigen::Matrix<double, 2, 3> rotation = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<float, 2, 3, Eigen::RowMajor> rows = Eigen::Matrix<float, 2, 3, Eigen::RowMajor>::Zero();
  Eigen::Vector3f axis = Eigen::Vector3f::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  std::vector<Eigen::MatrixXd> many;
};
struct Opaque {
  int value = 0;
};
struct HasOpaque {
  int number = 0;
  std::vector<Opaque> items;
};
}  // namespace coded

SEGUE_TYPE(coded::Gait, Walk, Trot, Jump)
SEGUE_TYPE(coded::Side, Left, None, Right)
SEGUE_TYPE(coded::Gear, Neutral, First)
SEGUE_TYPE(coded::Contact, force, leg, firm, gait)
SEGUE_TYPE(coded::Stamp, seconds, fraction, gear)
SEGUE_TYPE(coded::Late, number, other, value)
SEGUE_TYPE(coded::Swapped, y, x)
SEGUE_TYPE(coded::Gap, before, after, late)
SEGUE_TYPE(coded::Step, odd, number, name, stamp, duration, contacts, late, stamps, remark, firm, sides,
           texts, gaps, last, swapped)
SEGUE_TYPE(coded::Image, stamp, width, data)
SEGUE_TYPE(coded::Secretive, shown, small, after)
SEGUE_TYPE(coded::Blank)
SEGUE_TYPE(coded::Branch, value, branches)
SEGUE_TYPE(coded::Matrices, odd, vector, matrix, points, image, rotation, rows, axis, turn, many)
SEGUE_TYPE(coded::HasOpaque, number, items)

template <>
struct segue::type::detail::Describe<coded::Opaque> {
  static void name(std::string& text) { text += "/coded/Opaque"; }
  static void describe(Shape& shape) {
    shape.type.kind = TypeKind::Opaque;
    shape.type.size = sizeof(coded::Opaque);
  }
  static Value to_value(const void* object) { return static_cast<const coded::Opaque*>(object)->value; }
  static Result<void> from_value(void*, const Value&, std::string_view) { return {}; }
  static constexpr Conversion kConversion{&to_value, &from_value};
};

namespace segue::type {
namespace {

using Bytes = std::vector<std::byte>;

Bytes message(std::initializer_list<int> numbers) {
  Bytes bytes;
  for (const int number : numbers)
    bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

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

template <class T>
Value value_of(const T& object) {
  return type_info<T>().to_value(&object);
}

template <class T>
T random_object() {
  T object;
  const auto done = type_info<T>().from_value(&object, random_value_for(*type_info<T>().type), "random");
  if (!done) RC_FAIL(to_string(done.error()));
  return object;
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

Eigen::MatrixXd random_matrix(int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    matrix.data()[i] = *rc::gen::inRange(-999, 999);
  return matrix;
}

coded::Matrices random_matrices() {
  const auto size = [] { return *rc::gen::inRange(0, 5); };
  coded::Matrices matrices;
  matrices.vector = random_matrix(size(), 1);
  matrices.matrix = random_matrix(size(), size()).cast<float>();
  matrices.points = random_matrix(3, size());
  matrices.image = random_matrix(size(), size()).cast<std::int16_t>();
  matrices.rotation = random_matrix(2, 3);
  matrices.rows = random_matrix(2, 3).cast<float>();
  matrices.axis = random_matrix(3, 1).cast<float>();
  matrices.turn.coeffs() = random_matrix(4, 1);
  for (int i = size(); i > 0; --i)
    matrices.many.push_back(random_matrix(size(), size()));
  return matrices;
}

coded::Branch branch(int levels) {
  coded::Branch root;
  for (int i = 0; i < levels; ++i) {
    coded::Branch above{i, {}};
    above.branches.push_back(std::move(root));
    root = std::move(above);
  }
  return root;
}

RC_GTEST_PROP(CdrObjectProperty, numbers_texts_and_containers_are_encoded_as_their_values, ()) {
  check_all<double, bool, std::int8_t, std::uint64_t, coded::Gait, coded::Side, std::string,
            std::vector<bool>, std::vector<float>, std::vector<double>, std::vector<std::string>,
            std::optional<std::int16_t>, std::optional<std::vector<std::string>>, std::array<std::string, 3>,
            std::array<double, 2>, std::chrono::nanoseconds, std::chrono::steady_clock::time_point>();
}

RC_GTEST_PROP(CdrObjectProperty, structs_are_encoded_as_their_values, ()) {
  check_all<coded::Contact, coded::Step, coded::Blank, coded::Image, std::vector<coded::Blank>,
            std::vector<coded::Contact>, std::vector<coded::Stamp>, std::vector<coded::Gap>,
            std::vector<coded::Step>, std::optional<coded::Step>,
            std::vector<std::array<coded::Contact, 2>>>();
}

RC_GTEST_PROP(CdrObjectProperty, matrices_are_encoded_as_their_values, ()) {
  check(random_matrices(), random_matrices());
}

RC_GTEST_PROP(CdrObjectProperty, changed_bytes_leave_something_valid, (std::vector<std::uint8_t> changes)) {
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

TEST(CdrObject, writes_numbers_at_multiples_of_their_size_and_zeros_between) {
  const coded::Gap gap{1, 2, {3, 4, 0.0}};
  EXPECT_EQ(written(gap), message({0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0,
                                   // the number at 16 is there already
                                   0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(CdrObject, writes_texts_with_their_length_and_a_final_zero) {
  EXPECT_EQ(written(std::string("go")), message({0, 1, 0, 0, 3, 0, 0, 0, 'g', 'o', 0}));
  EXPECT_EQ(written(std::string()), message({0, 1, 0, 0, 1, 0, 0, 0, 0}));
}

TEST(CdrObject, writes_a_struct_without_members_as_one_byte) {
  EXPECT_EQ(written(coded::Blank{}), message({0, 1, 0, 0, 0}));
}

TEST(CdrObject, an_image_is_its_header_and_its_bytes) {
  coded::Image image;
  image.data.assign(1000, 7);
  const Bytes bytes = written(image);
  EXPECT_EQ(bytes.size(), 4U + 16 + 4 + 4 + 1000);
  EXPECT_TRUE(
      std::ranges::all_of(std::span(bytes).subspan(28), [](auto byte) { return byte == std::byte{7}; }));
}

TEST(CdrObject, reads_big_endian) {
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

TEST(CdrObject, refuses_other_representations) {
  std::int32_t number = 0;
  EXPECT_TRUE(read(number, message({0, 1, 0, 0, 5, 0, 0, 0})));
  EXPECT_FALSE(read(number, message({0, 3, 0, 0, 5, 0, 0, 0}))) << "a parameter list";
  EXPECT_FALSE(read(number, message({0, 7, 0, 0, 5, 0, 0, 0}))) << "XCDR2";
  EXPECT_FALSE(read(number, message({1, 1, 0, 0, 5, 0, 0, 0})));
  EXPECT_FALSE(read(number, message({0, 1, 0})));
  EXPECT_FALSE(read(number, {}));
}

TEST(CdrObject, members_that_are_not_named_are_left_alone) {
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

TEST(CdrObject, counts_beyond_the_input_are_refused_before_anything_grows) {
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

TEST(CdrObject, matrices_have_as_many_numbers_as_they_say) {
  const Eigen::MatrixXd two_rows = Eigen::MatrixXd::Ones(2, 3);
  Bytes bytes = written(two_rows);
  Eigen::Matrix<double, 3, Eigen::Dynamic> three_rows;
  EXPECT_FALSE(read(three_rows, bytes));
  Eigen::MatrixXd matrix;
  EXPECT_TRUE(read(matrix, bytes));
  bytes[4] = std::byte{3};
  EXPECT_FALSE(read(matrix, bytes));
}

TEST(CdrObject, booleans_enums_and_optionals_are_checked) {
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

TEST(CdrObject, types_that_contain_themselves_nest_a_hundred_levels) {
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

TEST(CdrObject, an_object_that_holds_as_much_keeps_its_memory) {
  coded::Image image;
  image.data.assign(1000, 7);
  const Bytes bytes = written(image);
  coded::Image object;
  ASSERT_TRUE(read(object, bytes));
  const auto* data = object.data.data();
  ASSERT_TRUE(read(object, bytes));
  EXPECT_EQ(object.data.data(), data);
}

TEST(CdrObject, types_without_structure_cannot_be_encoded) {
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
