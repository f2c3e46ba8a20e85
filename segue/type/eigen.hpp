// SPDX-License-Identifier: Apache-2.0
//
// Descriptions of Eigen's dense matrices, vectors and quaternions, so that ports, properties and described
// structs may hold them. Named as C++ names them: "/Eigen/Vector3d", "/Eigen/Matrix</double,6,1>".
//
// Values: a vector is a list, a matrix a list of rows whatever its storage order; Rock's {data: [...]} is
// read, too. MatrixXd is {rows, cols, data} with the data row by row, and is read from a list of rows as
// well. A quaternion is {w, x, y, z}; it is not normalised.
#pragma once

#include <segue/type/describe.hpp>
#include <segue/type/matrix_value.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace segue::type::detail {

template <class Matrix>
MatrixView view_of(const Matrix& matrix) {
  using Number = typename Matrix::Scalar;
  const auto inner = sizeof(Number);
  const auto outer = sizeof(Number) * static_cast<std::size_t>(matrix.outerStride());
  return {&described_type<Number>, static_cast<std::size_t>(matrix.rows()),
          static_cast<std::size_t>(matrix.cols()), Matrix::IsRowMajor ? outer : inner,
          Matrix::IsRowMajor ? inner : outer};
}

template <class Number, int Rows, int Columns, int Options, int MaxRows, int MaxColumns>
struct Describe<Eigen::Matrix<Number, Rows, Columns, Options, MaxRows, MaxColumns>> {
  using Matrix = Eigen::Matrix<Number, Rows, Columns, Options, MaxRows, MaxColumns>;
  static_assert(std::is_arithmetic_v<Number>, "matrices of numbers");
  static_assert(MaxRows == Rows && MaxColumns == Columns, "matrices of bounded size are not supported");
  static constexpr bool kVector = Matrix::IsVectorAtCompileTime != 0;
  static constexpr bool kFixed = Rows != Eigen::Dynamic && Columns != Eigen::Dynamic;

  static void name(std::string& text) {
    append_matrix_name(text, name_of_type<Number>(), Rows, Columns, Matrix::IsRowMajor && !kVector);
  }

  static void describe(Shape& shape) {
    if constexpr (kFixed && kVector) {
      describe_array(shape, static_cast<std::size_t>(Rows * Columns), described_type<Number>);
    } else if constexpr (kFixed) {
      using Row = std::array<Number, static_cast<std::size_t>(Columns)>;
      describe_array(shape, static_cast<std::size_t>(Rows), described_type<Row>);
    } else if constexpr (kVector) {
      describe_container(shape, "/std/vector", sizeof(Matrix), described_type<Number>);
    } else {
      describe_dynamic_matrix(shape, sizeof(Matrix), described_type<std::int64_t>,
                              described_type<std::vector<Number>>);
    }
  }

  static std::size_t size(const DescribedType&, const void* object) {
    return static_cast<std::size_t>(static_cast<const Matrix*>(object)->size());
  }
  static const void* item(const DescribedType&, const void* object, std::size_t index) {
    return static_cast<const Matrix*>(object)->data() + index;
  }
  static void* resize(const DescribedType&, void* object, std::size_t size) {
    auto& vector = *static_cast<Matrix*>(object);
    if constexpr (kVector && !kFixed) vector.setZero(static_cast<Eigen::Index>(size));
    return vector.data();
  }

  static void* reuse(const DescribedType&, void* object, std::size_t size) {
    auto& vector = *static_cast<Matrix*>(object);
    if constexpr (kVector && !kFixed) vector.resize(static_cast<Eigen::Index>(size));
    return vector.data();
  }

  static std::array<std::size_t, 2> grid_size(const void* object) {
    const auto& matrix = *static_cast<const Matrix*>(object);
    return {static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols())};
  }
  static const void* numbers(const void* object) { return static_cast<const Matrix*>(object)->data(); }
  static bool resize_grid(void* object, const std::array<std::size_t, 2>& size, void*& numbers) {
    if (!fits_grid(size)) return false;
    auto& matrix = *static_cast<Matrix*>(object);
    matrix.resize(static_cast<Eigen::Index>(size[0]), static_cast<Eigen::Index>(size[1]));
    numbers = matrix.data();
    return true;
  }

  /// Whether a size is the one fixed at compile time, if it is.
  static constexpr bool fits(int fixed, std::size_t size) {
    return fixed == Eigen::Dynamic || static_cast<std::size_t>(fixed) == size;
  }

  static bool fits_grid(const std::array<std::size_t, 2>& size) {
    return fits(Rows, size[0]) && fits(Columns, size[1]);
  }

  static Value to_value(const void* object) {
    const auto& matrix = *static_cast<const Matrix*>(object);
    return kFixed ? rows_to_value(view_of(matrix), matrix.data())
                  : dynamic_to_value(view_of(matrix), matrix.data());
  }
  static Result<void> from_value(void* object, const Value& value, std::string_view path) {
    auto& matrix = *static_cast<Matrix*>(object);
    if constexpr (kFixed) {
      return rows_from_value(view_of(matrix), matrix.data(), value, path);
    } else {
      const Result<MatrixValue> values = dynamic_from_value(value, path);
      if (!values) return values.error();
      if (!fits(Rows, values->rows) || !fits(Columns, values->columns))
        return unexpected_value(path, "as many rows and columns as " + name_of_type<Matrix>() + " has",
                                value);
      matrix.resize(static_cast<Eigen::Index>(values->rows), static_cast<Eigen::Index>(values->columns));
      return assign_numbers(view_of(matrix), matrix.data(), *values, path);
    }
  }

  static constexpr SequenceAccess kSequence =
      kVector ? SequenceAccess{&size, &item, &resize, &reuse} : SequenceAccess{};
  static constexpr Conversion kConversion = kVector ? Conversion{} : Conversion{&to_value, &from_value};
  static constexpr MatrixAccess grid() {
    if constexpr (kVector) return {};
    if constexpr (kFixed)
      return {&described_type<Number>, Matrix::IsRowMajor, nullptr, nullptr, nullptr, nullptr};
    return {&described_type<Number>, Matrix::IsRowMajor, &grid_size, &numbers, &resize_grid, &fits_grid};
  }
  static constexpr MatrixAccess kGrid = grid();
};

template <class Number, int Options>
struct Describe<Eigen::Quaternion<Number, Options>> {
  static void name(std::string& text) {
    text += std::is_same_v<Number, double> ? "/Eigen/Quaterniond" : "/Eigen/Quaternionf";
  }
  static void describe(Shape& shape) {
    static_assert(std::is_floating_point_v<Number>);
    describe_compound(shape, sizeof(Eigen::Quaternion<Number, Options>));
    // Eigen keeps the real part last.
    add_field(shape, "w", 3 * sizeof(Number), described_type<Number>);
    add_field(shape, "x", 0, described_type<Number>);
    add_field(shape, "y", sizeof(Number), described_type<Number>);
    add_field(shape, "z", 2 * sizeof(Number), described_type<Number>);
  }
};

}  // namespace segue::type::detail
