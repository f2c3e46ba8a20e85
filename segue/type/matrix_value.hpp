// SPDX-License-Identifier: Apache-2.0
//
// The parts of eigen.hpp that do not depend on Eigen. Not for users.
#pragma once

#include <segue/type/described_type.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue::type::detail {

/// Appends "/Eigen/Vector3d" where Eigen has a short name, else "/Eigen/Matrix</double,6,1>", with a final
/// "1" for row-major storage. -1 stands for a variable size.
void append_matrix_name(std::string& text, std::string_view number, int rows, int columns, bool row_major);

/// {rows, cols, data}, the data row by row.
void describe_dynamic_matrix(Shape& shape, std::size_t size, DescribedType& index, DescribedType& data);

/// The layout of a matrix: its size, and the distances between rows and columns in bytes.
struct MatrixView {
  DescribedType* number = nullptr;
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::size_t row_step = 0;
  std::size_t column_step = 0;
};

/// A list of rows.
Value rows_to_value(const MatrixView& view, const void* numbers);
Result<void> rows_from_value(const MatrixView& view, void* numbers, const Value& value,
                             std::string_view path);

/// {rows, cols, data}
Value dynamic_to_value(const MatrixView& view, const void* numbers);

/// The numbers of a matrix value, row by row.
struct MatrixValue {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<const Value*> numbers;
};
/// Reads {rows, cols, data} or a list of rows of equal length.
Result<MatrixValue> dynamic_from_value(const Value& value, std::string_view path);
/// Assigns the numbers; sizes must agree.
Result<void> assign_numbers(const MatrixView& view, void* numbers, const MatrixValue& values,
                            std::string_view path);

}  // namespace segue::type::detail
