// SPDX-License-Identifier: Apache-2.0
#include <segue/type/copy_bytes.hpp>
#include <segue/type/eigen.hpp>
#include <segue/type/flat.hpp>
#include <support/counted_new.hpp>
#include <support/random_types.hpp>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

using namespace std::chrono_literals;

namespace demo {
enum class Gait : std::uint8_t { Walk, Trot = 3, Jump = 4 };
enum class Side : std::int16_t { Left = -1, None, Right };
enum class Gear { Neutral, First };
enum class Large : std::uint64_t { Low, High = 0x8000'0000'0000'0000 };
struct Contact {
  double force = 0;
  std::uint8_t leg = 0;
  bool firm = false;
  Gait gait = Gait::Walk;
};
struct Step {
  std::int32_t number = 0;
  std::int32_t phase = 0;
  std::string name;
  double length = 0;
  std::chrono::milliseconds duration{0};
  std::vector<Contact> contacts;
  std::optional<std::string> remark;
  std::vector<bool> firm;
  std::array<std::vector<Side>, 2> sides;
  std::vector<std::vector<std::string>> texts;
  std::optional<Contact> last;
  Large large = Large::Low;
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
  Eigen::VectorXd vector;
  Eigen::MatrixXf matrix;
  Eigen::Matrix<double, 3, Eigen::Dynamic> points;
  Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> image;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  std::vector<Eigen::MatrixXd> many;
};
/// Described, but by nothing that flat.hpp knows.
struct Opaque {
  int value = 0;
};
struct HasOpaque {
  int number = 0;
  std::vector<Opaque> items;
};
struct TreeOfOpaque {
  std::vector<TreeOfOpaque> branches;
  std::optional<Opaque> leaf;
};

SEGUE_TYPE(Gait, Walk, Trot, Jump)
SEGUE_TYPE(Side, Left, None, Right)
SEGUE_TYPE(Gear, Neutral, First)
SEGUE_TYPE(Large, Low, High)
SEGUE_TYPE(Contact, force, leg, firm, gait)
SEGUE_TYPE(Step, number, phase, name, length, duration, contacts, remark, firm, sides, texts, last, large)
SEGUE_TYPE(Secretive, shown, small, after)
SEGUE_TYPE(Blank)
SEGUE_TYPE(Branch, value, branches)
SEGUE_TYPE(Matrices, vector, matrix, points, image, rotation, many)
SEGUE_TYPE(HasOpaque, number, items)
SEGUE_TYPE(TreeOfOpaque, branches, leaf)

}  // namespace demo

template <>
struct segue::type::detail::Describe<demo::Opaque> {
  static void name(std::string& text) { text += "/demo/Opaque"; }
  static void describe(Shape& shape) {
    shape.type.kind = TypeKind::Opaque;
    shape.type.size = sizeof(demo::Opaque);
  }
  static Value to_value(const void* object) { return static_cast<const demo::Opaque*>(object)->value; }
  static Result<void> from_value(void*, const Value&, std::string_view) { return {}; }
  static constexpr Conversion kConversion{&to_value, &from_value};
};

namespace segue::type {
namespace {

using Bytes = std::vector<std::byte>;

template <class T>
Bytes written(const T& object) {
  Bytes bytes(flat_size(type_info<T>(), &object));
  const auto used = write_flat(type_info<T>(), &object, bytes);
  EXPECT_EQ(used.value_or(0), bytes.size());
  return bytes;
}

template <class T>
bool read(T& object, std::span<const std::byte> bytes) {
  return read_flat(type_info<T>(), &object, bytes);
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

/// Into a fresh object and into one that held something else.
template <class T>
void round_trip(const T& object, T used) {
  const Bytes bytes = written(object);
  T fresh{};
  RC_ASSERT(read(fresh, bytes));
  RC_ASSERT(value_of(fresh) == value_of(object));
  RC_ASSERT(read(used, bytes));
  RC_ASSERT(value_of(used) == value_of(object));
  RC_ASSERT(written(used) == bytes);
}

/// No part of what was written is read as a whole, whatever was there before, nor more than was written.
template <class T>
void cut_short(const T& object, T used) {
  Bytes bytes = written(object);
  Bytes fewer(bytes.size());
  RC_ASSERT(!write_flat(type_info<T>(), &object, std::span(fewer).first(bytes.size() - 1)).has_value());
  const auto cut = *rc::gen::inRange<std::size_t>(0, bytes.size());
  RC_ASSERT(!read(used, std::span(bytes).first(cut)));
  static_cast<void>(value_of(used));
  bytes.push_back(std::byte{0});
  RC_ASSERT(!read(used, bytes));
}

template <class T>
void check_random() {
  const T object = random_object<T>();
  round_trip(object, random_object<T>());
  cut_short(object, random_object<T>());
}

template <class... T>
void check_all() {
  (check_random<T>(), ...);
}

Eigen::MatrixXd random_matrix(int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    matrix.data()[i] = *rc::gen::inRange(-999, 999);
  return matrix;
}

demo::Matrices random_matrices() {
  const auto size = [] { return *rc::gen::inRange(0, 5); };
  demo::Matrices matrices;
  matrices.vector = random_matrix(size(), 1);
  matrices.matrix = random_matrix(size(), size()).cast<float>();
  matrices.points = random_matrix(3, size());
  matrices.image = random_matrix(size(), size()).cast<std::int16_t>();
  matrices.rotation = random_matrix(3, 3);
  for (int i = size(); i > 0; --i)
    matrices.many.push_back(random_matrix(size(), size()));
  return matrices;
}

demo::Branch branch(int levels) {
  demo::Branch root;
  for (int i = 0; i < levels; ++i) {
    demo::Branch above{i, {}};
    above.branches.push_back(std::move(root));
    root = std::move(above);
  }
  return root;
}

RC_GTEST_PROP(FlatProperty, NumbersTextsAndContainersSurvive, ()) {
  check_all<double, bool, std::int8_t, demo::Gait, demo::Side, demo::Large, std::string, std::vector<bool>,
            std::vector<float>, std::vector<std::string>, std::optional<std::int16_t>,
            std::optional<std::vector<std::string>>, std::array<std::string, 3>, std::array<double, 2>,
            std::chrono::nanoseconds, std::chrono::steady_clock::time_point>();
}

RC_GTEST_PROP(FlatProperty, StructsSurvive, ()) {
  check_all<demo::Contact, demo::Step, demo::Blank, std::vector<demo::Blank>, std::vector<demo::Contact>,
            std::vector<demo::Step>, std::optional<demo::Step>, std::vector<std::array<demo::Contact, 2>>>();
}

RC_GTEST_PROP(FlatProperty, MatricesSurvive, ()) {
  const demo::Matrices matrices = random_matrices();
  round_trip(matrices, random_matrices());
  cut_short(matrices, random_matrices());
}

RC_GTEST_PROP(FlatProperty, ChangedBytesLeaveSomethingValid, (std::vector<std::uint8_t> changes)) {
  Bytes bytes = written(random_object<demo::Step>());
  for (const std::uint8_t change : changes)
    bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = static_cast<std::byte>(change);
  auto object = random_object<demo::Step>();
  static_cast<void>(read(object, bytes));
  const Bytes again = written(object);
  demo::Step copy;
  RC_ASSERT(read(copy, again));
  RC_ASSERT(value_of(copy) == value_of(object));
}

TEST(Flat, LaysOutRunsCountsAndItems) {
  demo::Step step;
  step.number = 1;
  step.phase = 2;
  step.name = "go";
  const Bytes bytes = written(step);
  std::array<std::int32_t, 2> run{};
  std::memcpy(run.data(), bytes.data(), sizeof run);
  EXPECT_EQ(run, (std::array<std::int32_t, 2>{1, 2}));
  EXPECT_EQ(bytes[8], std::byte{2}) << "the count of characters";
  EXPECT_EQ(bytes[16], std::byte{'g'});
  // run, name, length and duration, contacts, remark, firm, two sides, texts, last, large
  EXPECT_EQ(bytes.size(), 8U + 10 + 16 + 8 + 1 + 8 + 16 + 8 + 1 + 8);
}

TEST(Flat, WhatTravelsAsBytesIsItsBytes) {
  const std::array<double, 3> axis{1, 2, 3};
  const Bytes bytes = written(axis);
  EXPECT_EQ(bytes.size(), sizeof axis);
  EXPECT_EQ(std::memcmp(bytes.data(), axis.data(), sizeof axis), 0);
}

TEST(Flat, MembersThatAreNotNamedAreLeftAlone) {
  const char* text = "mine";
  demo::Secretive object{1, text, 2, 'g', 3};
  const demo::Secretive other{10, nullptr, 20, 'x', 30};
  ASSERT_TRUE(read(object, written(other)));
  EXPECT_EQ(object.shown, 10);
  EXPECT_EQ(object.small, 20);
  EXPECT_EQ(object.after, 30);
  EXPECT_EQ(object.hidden, text);
  EXPECT_EQ(object.gap, 'g');
}

TEST(Flat, AnObjectShrinksAndGrowsToWhatIsRead) {
  const demo::Step small;
  demo::Step large;
  large.name = std::string(100, 'x');
  large.contacts.resize(50);
  large.texts = {{"a", "b"}, {}};
  large.remark = "seen";
  const Value large_value = value_of(large);
  const Bytes large_bytes = written(large);
  ASSERT_TRUE(read(large, written(small)));
  EXPECT_EQ(value_of(large), value_of(small));
  ASSERT_TRUE(read(large, large_bytes));
  EXPECT_EQ(value_of(large), large_value);
}

#ifdef SEGUE_COUNTS_NEW
TEST(Flat, AnObjectThatHoldsAsMuchAllocatesNothing) {
  demo::Step step;
  step.name = std::string(100, 'x');
  step.contacts.resize(50);
  step.firm.resize(70);
  step.texts = {{std::string(50, 'a'), std::string(60, 'b')}, {std::string(70, 'c')}};
  step.remark = std::string(80, 'd');
  Bytes bytes(flat_size(type_info<demo::Step>(), &step));
  demo::Step object;
  using testing::allocations;
  const std::size_t at_first = allocations;
  ASSERT_TRUE(write_flat(type_info<demo::Step>(), &step, bytes));
  EXPECT_EQ(allocations, at_first) << "writing";
  ASSERT_TRUE(read(object, bytes));
  EXPECT_GT(allocations, at_first);
  const std::size_t before = allocations;
  ASSERT_TRUE(read(object, bytes));
  EXPECT_EQ(allocations, before) << "reading";
}
#endif

TEST(Flat, MatricesOfTheSameSizeKeepTheirMemory) {
  demo::Matrices matrices;
  matrices.matrix = Eigen::MatrixXf::Ones(4, 5);
  matrices.vector = Eigen::VectorXd::Ones(7);
  const Bytes bytes = written(matrices);
  demo::Matrices object;
  ASSERT_TRUE(read(object, bytes));
  const float* numbers = object.matrix.data();
  const double* others = object.vector.data();
  ASSERT_TRUE(read(object, bytes));
  EXPECT_EQ(object.matrix.data(), numbers);
  EXPECT_EQ(object.vector.data(), others);
}

template <class T>
bool reads_after(T object, std::size_t offset, std::uint64_t count) {
  Bytes bytes = written(object);
  std::memcpy(bytes.data() + offset, &count, sizeof count);
  return read(object, bytes);
}

TEST(Flat, CountsBeyondTheInputAreRefusedBeforeAnythingGrows) {
  constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();
  for (const std::uint64_t count :
       {kHuge, kHuge / 2, kHuge / 8 + 1, std::uint64_t{1} << 40, std::uint64_t{9}}) {
    EXPECT_FALSE(reads_after(std::vector<double>(2), 0, count)) << count;
    EXPECT_FALSE(reads_after(std::vector<bool>(2), 0, count)) << count;
    EXPECT_FALSE(reads_after(std::string("ab"), 0, count)) << count;
    EXPECT_FALSE(reads_after(std::vector<demo::Blank>(2), 0, count)) << count;
    EXPECT_FALSE(reads_after(Eigen::MatrixXd(2, 2), 0, count)) << count;
    EXPECT_FALSE(reads_after(Eigen::MatrixXd(2, 2), 8, count)) << count;
    EXPECT_FALSE(reads_after(Eigen::MatrixXd(0, 0), 0, kHuge)) << "fewer than none";
  }
}

TEST(Flat, AMatrixOfAnotherFixedSizeIsRefused) {
  const Eigen::MatrixXd two_rows = Eigen::MatrixXd::Ones(2, 3);
  Eigen::Matrix<double, 3, Eigen::Dynamic> three_rows;
  EXPECT_FALSE(read(three_rows, written(two_rows)));
  EXPECT_TRUE(read(three_rows, written(Eigen::MatrixXd(two_rows.transpose()))));
}

TEST(Flat, BooleansAreFalseOrTrue) {
  demo::Contact contact;
  Bytes bytes = written(std::vector<demo::Contact>(3));
  bytes[8 + 2 * sizeof contact + offsetof(demo::Contact, firm)] = std::byte{2};
  std::vector<demo::Contact> contacts;
  EXPECT_FALSE(read(contacts, bytes));
  for (const demo::Contact& each : contacts)
    EXPECT_LE(std::bit_cast<std::uint8_t>(each.firm), 1);
  Bytes bits = written(std::vector<bool>{true, false});
  bits.back() = std::byte{2};
  std::vector<bool> object;
  EXPECT_FALSE(read(object, bits));
  Bytes optional = written(std::optional<double>(1));
  optional.front() = std::byte{2};
  std::optional<double> number;
  EXPECT_FALSE(read(number, optional));
  optional.resize(1 + 2 * sizeof(double));
  EXPECT_FALSE(read(number, optional)) << "two of them";
}

template <class Enum>
bool reads_number(std::int64_t number) {
  Bytes bytes(sizeof(Enum));
  std::memcpy(bytes.data(), &number, bytes.size());
  Enum object{};
  const bool done = read(object, bytes);
  EXPECT_EQ(static_cast<std::int64_t>(object) == number, done);
  return done;
}

TEST(Flat, EnumsAreWhatTheBitsOfTheirSymbolsExpress) {
  for (int number = 0; number < 8; ++number)
    EXPECT_TRUE(reads_number<demo::Gait>(number)) << number;
  for (const int number : {8, 16, 255})
    EXPECT_FALSE(reads_number<demo::Gait>(number)) << number;
  EXPECT_TRUE(reads_number<demo::Side>(-1));
  EXPECT_TRUE(reads_number<demo::Side>(1));
  EXPECT_FALSE(reads_number<demo::Side>(2));
  EXPECT_FALSE(reads_number<demo::Side>(-3));
  EXPECT_FALSE(reads_number<demo::Gear>(-1)) << "no symbol is negative";
  EXPECT_TRUE(reads_number<demo::Large>(-1)) << "all 64 bits";
}

TEST(Flat, TypesThatContainThemselvesNestAHundredLevels) {
  const demo::Branch deep = branch(100);
  demo::Branch copy;
  ASSERT_TRUE(read(copy, written(deep)));
  EXPECT_EQ(value_of(copy), value_of(deep));
  const demo::Branch deeper = branch(101);
  EXPECT_EQ(flat_size(type_info<demo::Branch>(), &deeper), 0U);
  Bytes bytes(100'000);
  EXPECT_FALSE(write_flat(type_info<demo::Branch>(), &deeper, bytes));
}

TEST(Flat, InputThatNestsWithoutEndIsRefused) {
  const struct {
    std::int32_t value;
    std::uint64_t count;
  } __attribute__((packed)) level{1, 1};
  Bytes bytes;
  for (int i = 0; i < 1'000'000; ++i) {
    const auto* begin = reinterpret_cast<const std::byte*>(&level);
    bytes.insert(bytes.end(), begin, begin + sizeof level);
  }
  demo::Branch object;
  EXPECT_FALSE(read(object, bytes));
}

TEST(Flat, SaysWhichTypesItCanFlatten) {
  EXPECT_TRUE(can_flatten(type_info<demo::Step>()));
  EXPECT_TRUE(can_flatten(type_info<demo::Branch>()));
  EXPECT_TRUE(can_flatten(type_info<demo::Matrices>()));
  EXPECT_FALSE(can_flatten(type_info<demo::Opaque>()));
  EXPECT_FALSE(can_flatten(type_info<demo::HasOpaque>()));
  EXPECT_FALSE(can_flatten(type_info<demo::TreeOfOpaque>()));
  EXPECT_FALSE(can_flatten(type_info<std::vector<demo::TreeOfOpaque>>()));
  EXPECT_FALSE(can_flatten(TypeInfo{}));
}

TEST(Flat, RefusesTypesThatItCannotFlatten) {
  demo::HasOpaque object;
  Bytes bytes(100);
  EXPECT_EQ(flat_size(type_info<demo::HasOpaque>(), &object), 0U);
  EXPECT_FALSE(write_flat(type_info<demo::HasOpaque>(), &object, bytes));
  EXPECT_FALSE(read(object, bytes));
}

TEST(CopyBytes, CopiesExactlyThoseBytesWhereverTheyAre) {
  std::vector<unsigned char> source(3 * 4096);
  for (std::size_t i = 0; i < source.size(); ++i)
    source[i] = static_cast<unsigned char>(i * 31 + i / 256);
  for (const std::size_t size : {0UL, 1UL, 2047UL, 4095UL, 4096UL, 4097UL, 6151UL, 8192UL}) {
    for (std::size_t behind = 0; behind < 20; ++behind) {
      std::vector<unsigned char> target(source.size() + 4096 + 64, 0xaa);
      const auto difference = (reinterpret_cast<std::uintptr_t>(target.data()) -
                               reinterpret_cast<std::uintptr_t>(source.data())) %
                              4096;
      const std::size_t begin = (4096 - difference + behind) % 4096;
      std::vector<unsigned char> expected = target;
      std::copy_n(source.begin(), size, expected.begin() + static_cast<std::ptrdiff_t>(begin));
      detail::copy_bytes(target.data() + begin, source.data(), size);
      EXPECT_EQ(target, expected) << size << " bytes, " << behind << " behind";
    }
  }
}

}  // namespace
}  // namespace segue::type
