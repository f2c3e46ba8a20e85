// SPDX-License-Identifier: Apache-2.0
#include <segue/type/cdr_flat.hpp>
#include <segue/type/cdr_object.hpp>
#include <segue/type/cdr_test_support.hpp>
#include <segue/type/flat.hpp>

#ifdef SEGUE_CDR
#include <segue/type/cdr.hpp>
#endif

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstring>
#include <span>

namespace segue::type {
namespace {

constexpr std::byte kGuard{0xa5};

/// Memory of an exact size between guards, filled with what should be overwritten.
class Guarded {
 public:
  explicit Guarded(std::size_t size) : bytes_(size + 2 * kMargin, kGuard) {}
  [[nodiscard]] std::span<std::byte> inside() {
    return std::span(bytes_).subspan(kMargin, bytes_.size() - 2 * kMargin);
  }
  [[nodiscard]] Bytes copy() { return {inside().begin(), inside().end()}; }
  [[nodiscard]] bool intact() const {
    const auto is_guard = [](std::byte byte) { return byte == kGuard; };
    return std::all_of(bytes_.begin(), bytes_.begin() + kMargin, is_guard) &&
           std::all_of(bytes_.end() - kMargin, bytes_.end(), is_guard);
  }

 private:
  static constexpr std::ptrdiff_t kMargin = 64;
  Bytes bytes_;
};

template <class T>
Bytes flat_of(const T& object) {
  Bytes bytes(flat_size(type_info<T>(), &object));
  EXPECT_TRUE(write_flat(type_info<T>(), &object, bytes));
  return bytes;
}

template <class T>
Bytes cdr_of(const T& object) {
  Bytes bytes(cdr_size(type_info<T>(), &object));
  EXPECT_TRUE(write_cdr(type_info<T>(), &object, bytes));
  return bytes;
}

/// Nothing where the bytes are refused.
std::optional<Bytes> to_cdr(const TypeInfo& info, std::span<const std::byte> flat) {
  const std::size_t size = cdr_size_of_flat(info, flat);
  if (size == 0) return std::nullopt;
  Guarded cdr(size);
  const bool done = flat_to_cdr(info, flat, cdr.inside());
  EXPECT_TRUE(done) << "what has a size can be written";
  EXPECT_TRUE(cdr.intact());
  return cdr.copy();
}

std::optional<Bytes> to_flat(const TypeInfo& info, std::span<const std::byte> cdr) {
  const std::size_t size = flat_size_of_cdr(info, cdr);
  if (size == 0) return std::nullopt;
  Guarded flat(size);
  const bool done = cdr_to_flat(info, cdr, flat.inside());
  EXPECT_TRUE(flat.intact());
  if (!done) return std::nullopt;
  return flat.copy();
}

template <class T>
std::optional<Value> flat_value(std::span<const std::byte> flat) {
  T object{};
  if (!read_flat(type_info<T>(), &object, flat)) return std::nullopt;
  return value_of(object);
}

template <class T>
void check_against_codec([[maybe_unused]] const T& object, [[maybe_unused]] const Bytes& cdr) {
#ifdef SEGUE_CDR
  const auto expected = encode_cdr(value_of(object), *type_info<T>().type);
  if (!expected) RC_FAIL(to_string(expected.error()));
  RC_ASSERT(cdr == *expected);
#endif
}

/// In both directions the same as by way of an object.
template <class T>
void check(const T& object) {
  const TypeInfo& info = type_info<T>();
  const Bytes flat = flat_of(object);
  RC_ASSERT(is_flat(info, flat));
  const auto cdr = to_cdr(info, flat);
  RC_ASSERT(cdr.has_value());
  RC_ASSERT(*cdr == cdr_of(object));
  check_against_codec(object, *cdr);
  const auto again = to_flat(info, *cdr);
  RC_ASSERT(again.has_value());
  RC_ASSERT(again->size() == flat.size());
  RC_ASSERT(is_flat(info, *again));
  RC_ASSERT(flat_value<T>(*again) == value_of(object));
}

/// No part of either is taken for the whole; padding may follow CDR, and nothing may follow the flat layout.
template <class T>
void check_ends(const T& object) {
  const TypeInfo& info = type_info<T>();
  Bytes flat = flat_of(object);
  for (std::size_t cut = 0; cut < flat.size(); ++cut) {
    const Bytes part(flat.begin(), flat.begin() + static_cast<std::ptrdiff_t>(cut));
    RC_ASSERT(!is_flat(info, part));
    RC_ASSERT(!to_cdr(info, part).has_value());
  }
  Bytes cdr = cdr_of(object);
  for (std::size_t cut = 0; cut < cdr.size(); ++cut) {
    const Bytes part(cdr.begin(), cdr.begin() + static_cast<std::ptrdiff_t>(cut));
    RC_ASSERT(!to_flat(info, part).has_value());
  }
  flat.push_back({});
  RC_ASSERT(!is_flat(info, flat));
  RC_ASSERT(!to_cdr(info, flat).has_value());
  cdr.resize(cdr.size() + 3);
  RC_ASSERT(to_flat(info, cdr).has_value());
  cdr.resize(cdr.size() + 1);
  RC_ASSERT(!to_flat(info, cdr).has_value());
}

template <class... T>
void check_all() {
  (check(random_object<T>()), ...);
  (check_ends(random_object<T>()), ...);
}

/// Whatever the bytes are, the same is accepted, and means the same, as by way of an object.
template <class T>
void check_flat_input(const Bytes& flat) {
  const TypeInfo& info = type_info<T>();
  T object{};
  const bool valid = read_flat(info, &object, flat);
  RC_ASSERT(is_flat(info, flat) == valid);
  const auto cdr = to_cdr(info, flat);
  if (valid) RC_ASSERT(cdr == cdr_of(object));
}

template <class T>
void check_cdr_input(const Bytes& cdr) {
  const TypeInfo& info = type_info<T>();
  T object{};
  const bool valid = read_cdr(info, &object, cdr);
  const auto flat = to_flat(info, cdr);
  RC_ASSERT(flat.has_value() == valid);
  if (valid) RC_ASSERT(flat_value<T>(*flat) == value_of(object));
}

Bytes changed(Bytes bytes, std::size_t first) {
  const auto changes = *rc::gen::container<std::vector<std::uint8_t>>(rc::gen::arbitrary<std::uint8_t>());
  for (const std::uint8_t change : changes)
    bytes[*rc::gen::inRange<std::size_t>(first, bytes.size())] = static_cast<std::byte>(change);
  const auto bit = *rc::gen::inRange(0, 8);
  bytes[*rc::gen::inRange<std::size_t>(first, bytes.size())] ^= std::byte{1} << bit;
  return bytes;
}

template <class T>
void check_changed(const T& object) {
  check_flat_input<T>(changed(flat_of(object), 0));
  const Bytes cdr = cdr_of(object);
  check_cdr_input<T>(changed(cdr, 4));
  check_cdr_input<T>(changed(cdr, 0));
}

template <class... T>
void check_all_changed() {
  (check_changed(random_object<T>()), ...);
}

RC_GTEST_PROP(CdrFlatProperty, NumbersTextsAndContainersAreAsByWayOfObjects, ()) {
  check_all<double, bool, std::int8_t, std::uint64_t, coded::Gait, coded::Side, std::string,
            std::vector<bool>, std::vector<float>, std::vector<double>, std::vector<std::string>,
            std::optional<std::int16_t>, std::optional<std::vector<std::string>>, std::array<std::string, 3>,
            std::array<double, 2>, std::chrono::nanoseconds, std::chrono::steady_clock::time_point>();
}

RC_GTEST_PROP(CdrFlatProperty, StructsAreAsByWayOfObjects, ()) {
  check_all<coded::Contact, coded::Step, coded::Blank, coded::Image, std::vector<coded::Blank>,
            std::vector<coded::Contact>, std::vector<coded::Stamp>, std::vector<coded::Gap>,
            std::vector<coded::Step>, std::optional<coded::Step>, std::vector<std::array<coded::Contact, 2>>,
            std::vector<coded::Owner>>();
}

RC_GTEST_PROP(CdrFlatProperty, MatricesAreAsByWayOfObjects, ()) {
  check(random_matrices());
  check_ends(random_matrices());
}

RC_GTEST_PROP(CdrFlatProperty, ChangedBytesAreAcceptedWhereObjectsAcceptThem, ()) {
  check_all_changed<coded::Step, coded::Image, std::vector<coded::Gap>, std::vector<coded::Contact>,
                    std::vector<std::string>, std::vector<bool>, std::optional<coded::Contact>,
                    std::vector<coded::Blank>>();
  check_changed(random_matrices());
  check_changed(branch(*rc::gen::inRange(0, 5)));
}

RC_GTEST_PROP(CdrFlatProperty, AnyBytesAreAcceptedWhereObjectsAcceptThem,
              (const std::vector<std::uint8_t>& random)) {
  Bytes bytes;
  for (const std::uint8_t byte : random)
    bytes.push_back(static_cast<std::byte>(byte % 4));  // small counts
  check_flat_input<coded::Step>(bytes);
  check_flat_input<coded::Branch>(bytes);
  bytes.insert(bytes.begin(), {std::byte{0}, static_cast<std::byte>(random.size() % 2), {}, {}});
  check_cdr_input<coded::Step>(bytes);
  check_cdr_input<coded::Branch>(bytes);
  check_cdr_input<coded::Matrices>(bytes);
}

TEST(CdrFlat, ReadsBigEndian) {
  const auto flat =
      to_flat(type_info<std::vector<std::int16_t>>(), message({0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 1, 0}));
  ASSERT_TRUE(flat.has_value());
  EXPECT_EQ(*flat, message({2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1}));
}

TEST(CdrFlat, GapsBetweenMembersBecomeZero) {
  const auto flat = to_flat(type_info<coded::Gap>(), cdr_of(coded::Gap{1, 2, {3, 4, 0.0}}));
  ASSERT_TRUE(flat.has_value());
  EXPECT_EQ(*flat, message({1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(CdrFlat, MatricesHaveTheRowsAndColumnsThatTheirTypePermits) {
  const Eigen::MatrixXd two_rows = Eigen::MatrixXd::Ones(2, 3);
  using ThreeRows = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  EXPECT_FALSE(to_flat(type_info<ThreeRows>(), cdr_of(two_rows)).has_value());
  EXPECT_FALSE(to_cdr(type_info<ThreeRows>(), flat_of(two_rows)).has_value());
  EXPECT_FALSE(is_flat(type_info<ThreeRows>(), flat_of(two_rows)));
  EXPECT_TRUE(to_flat(type_info<Eigen::MatrixXd>(), cdr_of(two_rows)).has_value());
}

TEST(CdrFlat, AMatrixWithoutNumbersIsConvertedAtOnceWhateverItsSize) {
  const Bytes cdr = message({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  const auto flat = to_flat(type_info<Eigen::MatrixXd>(), cdr);
  ASSERT_TRUE(flat.has_value());
  EXPECT_EQ(to_cdr(type_info<Eigen::MatrixXd>(), *flat), cdr);
}

TEST(CdrFlat, BooleansAndEnumsAreChecked) {
  Bytes cdr = cdr_of(std::vector<coded::Contact>(3));
  cdr[4 + 8 + 8 + 1] = std::byte{2};
  EXPECT_FALSE(to_flat(type_info<std::vector<coded::Contact>>(), cdr).has_value());
  Bytes flat = flat_of(std::vector<coded::Contact>(3));
  flat[8 + 9] = std::byte{2};
  EXPECT_FALSE(is_flat(type_info<std::vector<coded::Contact>>(), flat));
  flat = flat_of(std::vector<coded::Side>(3));
  flat[8] = std::byte{3};
  EXPECT_FALSE(is_flat(type_info<std::vector<coded::Side>>(), flat));
}

TEST(CdrFlat, CountsBeyondTheInputAreRefused) {
  for (const int count : {3, 0x7f}) {
    const Bytes cdr = message({0, 1, 0, 0, count, 0, 0, count, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1});
    const Bytes flat = message({count, 0, 0, 0, 0, 0, 0, count, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1});
    for (const TypeInfo* info :
         {&type_info<std::vector<double>>(), &type_info<std::vector<std::string>>(),
          &type_info<std::string>(), &type_info<std::vector<bool>>(), &type_info<Eigen::MatrixXd>()}) {
      EXPECT_FALSE(to_flat(*info, cdr).has_value()) << info->name();
      EXPECT_FALSE(to_cdr(*info, flat).has_value()) << info->name();
    }
  }
}

TEST(CdrFlat, TypesThatContainThemselvesNestAHundredLevels) {
  const coded::Branch deep = branch(100);
  EXPECT_EQ(to_cdr(type_info<coded::Branch>(), flat_of(deep)), cdr_of(deep));
  EXPECT_EQ(to_flat(type_info<coded::Branch>(), cdr_of(deep)), flat_of(deep));
  Bytes cdr = message({0, 1, 0, 0});
  Bytes flat;
  for (int i = 0; i < 1000; ++i) {
    const Bytes level = message({7, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
    cdr.insert(cdr.end(), level.begin(), level.begin() + 8);
    flat.insert(flat.end(), level.begin(), level.end());
  }
  EXPECT_FALSE(to_flat(type_info<coded::Branch>(), cdr).has_value());
  EXPECT_FALSE(to_cdr(type_info<coded::Branch>(), flat).has_value());
  EXPECT_FALSE(is_flat(type_info<coded::Branch>(), flat));
}

TEST(CdrFlat, LengthsThatChangeBetweenThePassesAreNoticed) {
  const TypeInfo& info = type_info<std::vector<std::string>>();
  const Bytes before = flat_of(std::vector<std::string>{"one", "two"});
  Guarded cdr(cdr_size_of_flat(info, before));
  for (const auto& texts : {std::vector<std::string>{"one", "three"}, {"one", "t"}, {"one"}, {}}) {
    EXPECT_FALSE(flat_to_cdr(info, flat_of(texts), cdr.inside()));
    EXPECT_TRUE(cdr.intact());
  }
  EXPECT_TRUE(flat_to_cdr(info, before, cdr.inside()));
}

TEST(CdrFlat, TypesWithoutStructureAreRefused) {
  const TypeInfo& info = type_info<coded::HasOpaque>();
  const Bytes bytes = message({0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  Bytes out(100);
  EXPECT_EQ(cdr_size_of_flat(info, bytes), 0U);
  EXPECT_EQ(flat_size_of_cdr(info, bytes), 0U);
  EXPECT_FALSE(flat_to_cdr(info, bytes, out));
  EXPECT_FALSE(cdr_to_flat(info, bytes, out));
  EXPECT_FALSE(is_flat(info, bytes));
}

}  // namespace
}  // namespace segue::type
