// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/matrix_value.hpp>
#include <segue/type/typed_scalar.hpp>

#include <array>
#include <utility>

namespace segue::type::detail {
namespace {

constexpr std::uint64_t kMostRows = 1U << 30;

std::size_t offset(const MatrixView& view, std::size_t row, std::size_t column) {
  return row * view.row_step + column * view.column_step;
}

Value number_at(const MatrixView& view, const void* numbers, std::size_t row, std::size_t column) {
  return to_value(*view.number, static_cast<const std::byte*>(numbers) + offset(view, row, column));
}

/// The letter of Eigen's short names; none for numbers that have no short names.
std::string_view letter_of(std::string_view number) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kLetters = {
      {{"/double", "d"}, {"/float", "f"}, {"/int32_t", "i"}}};
  for (const auto& [name, letter] : kLetters) {
    if (name == number) return letter;
  }
  return {};
}

/// "3" or "X", and "" for sizes without a short name.
std::string short_size(int size) {
  if (size == -1) return "X";
  return size >= 2 && size <= 4 ? std::to_string(size) : std::string();
}

std::string short_name(int rows, int columns) {
  if (columns == 1 && !short_size(rows).empty()) return "Vector" + short_size(rows);
  if (rows == 1 && !short_size(columns).empty()) return "RowVector" + short_size(columns);
  if (rows == columns && !short_size(rows).empty()) return "Matrix" + short_size(rows);
  return {};
}

/// The items of a row; all rows must have the same number of them.
Result<void> append_row(const Value& row, std::size_t index, MatrixValue& matrix, std::string_view path) {
  const std::string place = std::string(path) + "[" + std::to_string(index) + "]";
  if (!row.is_list()) return unexpected_value(place, "a list of numbers", row);
  if (index > 0 && row.as_list().size() != matrix.columns)
    return unexpected_value(place, "a list of " + std::to_string(matrix.columns), row);
  matrix.columns = row.as_list().size();
  for (const Value& number : row.as_list())
    matrix.numbers.push_back(&number);
  return {};
}

Result<MatrixValue> from_rows(const Value& rows, std::string_view path) {
  MatrixValue matrix;
  for (const Value& row : rows.as_list()) {
    if (auto done = append_row(row, matrix.rows, matrix, path); !done) return done.error();
    ++matrix.rows;
  }
  return matrix;
}

Result<MatrixValue> from_data(const Value& rows, const Value& columns, const Value& data,
                              std::string_view path) {
  for (const Value* size : {&rows, &columns}) {
    if (size->kind() != Value::Kind::Int || size->as_int() < 0 || size->as_uint() > kMostRows)
      return unexpected_value(path, "rows and cols to be numbers from 0 to 2^30", *size);
  }
  if (!data.is_list()) return unexpected_value(path, "data to be a list", data);
  MatrixValue matrix{rows.as_uint(), columns.as_uint(), {}};
  if (matrix.rows * matrix.columns != data.as_list().size())
    return unexpected_value(path, "rows times cols numbers in data", data);
  for (const Value& number : data.as_list())
    matrix.numbers.push_back(&number);
  return matrix;
}

}  // namespace

void append_matrix_name(std::string& text, std::string_view number, int rows, int columns, bool row_major) {
  const std::string name = short_name(rows, columns);
  const std::string_view letter = letter_of(number);
  text += "/Eigen/";
  if (!name.empty() && !letter.empty() && !row_major) {
    text.append(name).append(letter);
    return;
  }
  text.append("Matrix<").append(number);
  text += "," + std::to_string(rows) + "," + std::to_string(columns) + (row_major ? ",1>" : ">");
}

void describe_dynamic_matrix(Shape& shape, std::size_t size, DescribedType& index, DescribedType& data) {
  describe_compound(shape, size);
  // Parts of the value, not members of the C++ object: the offsets have no meaning.
  shape.type.fields = {{"rows", part(index), 0}, {"cols", part(index), 0}, {"data", part(data), 0}};
}

Value rows_to_value(const MatrixView& view, const void* numbers) {
  Value::List rows(view.rows);
  for (std::size_t row = 0; row < view.rows; ++row) {
    Value::List items;
    for (std::size_t column = 0; column < view.columns; ++column)
      items.push_back(number_at(view, numbers, row, column));
    rows[row] = std::move(items);
  }
  return rows;
}

Value dynamic_to_value(const MatrixView& view, const void* numbers) {
  Value::List data;
  // Without columns there may be any number of rows.
  for (std::size_t row = 0; view.columns > 0 && row < view.rows; ++row) {
    for (std::size_t column = 0; column < view.columns; ++column)
      data.push_back(number_at(view, numbers, row, column));
  }
  return Value::map(
      {{"rows", std::uint64_t{view.rows}}, {"cols", std::uint64_t{view.columns}}, {"data", std::move(data)}});
}

Result<MatrixValue> dynamic_from_value(const Value& value, std::string_view path) {
  if (value.is_list()) return from_rows(value, path);
  const Value* rows = value.find("rows");
  const Value* columns = value.find("cols");
  const Value* data = value.find("data");
  if (rows == nullptr || columns == nullptr || data == nullptr)
    return unexpected_value(path, "a list of rows, or a map of rows, cols and data", value);
  return from_data(*rows, *columns, *data, path);
}

Result<void> assign_numbers(const MatrixView& view, void* numbers, const MatrixValue& values,
                            std::string_view path) {
  for (std::size_t i = 0; i < values.numbers.size(); ++i) {
    const std::size_t row = i / view.columns;
    const std::size_t column = i % view.columns;
    auto* number = static_cast<std::byte*>(numbers) + offset(view, row, column);
    const std::string place =
        std::string(path) + "[" + std::to_string(row) + "][" + std::to_string(column) + "]";
    if (auto done = assign(*view.number, number, *values.numbers[i], place); !done) return done;
  }
  return {};
}

Result<void> rows_from_value(const MatrixView& view, void* numbers, const Value& value,
                             std::string_view path) {
  const std::string expected =
      "a list of " + std::to_string(view.rows) + " rows of " + std::to_string(view.columns) + " numbers";
  if (!value.is_list()) return unexpected_value(path, expected, value);
  const Result<MatrixValue> rows = from_rows(value, path);
  if (!rows) return rows.error();
  if (rows->rows != view.rows || rows->columns != view.columns)
    return unexpected_value(path, expected, value);
  return assign_numbers(view, numbers, *rows, path);
}

}  // namespace segue::type::detail
