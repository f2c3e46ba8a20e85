// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/eigen.hpp>
#include <support/random_types.hpp>

#include <cstddef>
#include <initializer_list>
#include <vector>

/// Types and objects for tests of CDR.
namespace coded {
enum class Gait : std::uint8_t { Walk, Trot = 3, Jump = 4 };
enum class Side : std::int16_t { Left = -1, None, Right };
enum class Gear { Neutral, First };
/// Has the same bytes in CDR as in memory, but for its padding at the end.
struct Contact {
  double force = 0;
  std::uint8_t leg = 0;
  bool firm = false;
  Gait gait = Gait::Walk;
};
/// Has the same bytes in CDR as in memory, as a whole, where it begins at a multiple of eight.
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
/// Packed, but copied member by member.
struct Owner {
  Owner() = default;
  Owner(const Owner&) = default;
  Owner& operator=(const Owner&) = default;
  ~Owner() {}  // NOLINT(modernize-use-equals-default): not trivial
  bool left = false;
  bool right = false;
};
struct Opaque {
  int value = 0;
};
struct HasOpaque {
  int number = 0;
  std::vector<Opaque> items;
};

SEGUE_TYPE(Gait, Walk, Trot, Jump)
SEGUE_TYPE(Side, Left, None, Right)
SEGUE_TYPE(Gear, Neutral, First)
SEGUE_TYPE(Contact, force, leg, firm, gait)
SEGUE_TYPE(Stamp, seconds, fraction, gear)
SEGUE_TYPE(Late, number, other, value)
SEGUE_TYPE(Swapped, y, x)
SEGUE_TYPE(Gap, before, after, late)
SEGUE_TYPE(Step, odd, number, name, stamp, duration, contacts, late, stamps, remark, firm, sides, texts, gaps,
           last, swapped)
SEGUE_TYPE(Image, stamp, width, data)
SEGUE_TYPE(Secretive, shown, small, after)
SEGUE_TYPE(Blank)
SEGUE_TYPE(Branch, value, branches)
SEGUE_TYPE(Matrices, odd, vector, matrix, points, image, rotation, rows, axis, turn, many)
SEGUE_TYPE(Owner, left, right)
SEGUE_TYPE(HasOpaque, number, items)

}  // namespace coded

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

using Bytes = std::vector<std::byte>;

inline Bytes message(std::initializer_list<int> numbers) {
  Bytes bytes;
  for (const int number : numbers)
    bytes.push_back(static_cast<std::byte>(number));
  return bytes;
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

inline Eigen::MatrixXd random_matrix(int rows, int columns) {
  Eigen::MatrixXd matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); ++i)
    matrix.data()[i] = *rc::gen::inRange(-999, 999);
  return matrix;
}

inline coded::Matrices random_matrices() {
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

inline coded::Branch branch(int levels) {
  coded::Branch root;
  for (int i = 0; i < levels; ++i) {
    coded::Branch above{i, {}};
    above.branches.push_back(std::move(root));
    root = std::move(above);
  }
  return root;
}

}  // namespace segue::type
