// SPDX-License-Identifier: Apache-2.0
#include <segue/type/conform.hpp>
#include <segue/type/eigen.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace demo {
struct Motion {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};
struct Samples {
  Eigen::VectorXd values;
  Eigen::MatrixXd table;
};

SEGUE_TYPE(Motion, linear, covariance, rotation)
SEGUE_TYPE(Samples, values, table)

}  // namespace demo

namespace segue::type {
namespace {

using ::testing::HasSubstr;

template <class T>
Value value_of(const T& object) {
  return type_info<T>().to_value(&object);
}

template <class T>
Result<void> assign(T& object, const Value& value) {
  return type_info<T>().from_value(&object, value, "p");
}

template <class T>
void expect_conforming(const T& object) {
  Diagnostics diagnostics;
  check_value(value_of(object), *type_info<T>().type, "p", "", diagnostics);
  EXPECT_TRUE(diagnostics.empty()) << to_string(diagnostics);
}

Eigen::Matrix2d counted() {
  Eigen::Matrix2d matrix;
  matrix << 1, 2, 3, 4;
  return matrix;
}

TEST(Eigen, TypesGoByEigensNames) {
  EXPECT_EQ(type_info<Eigen::Vector3d>().name(), "/Eigen/Vector3d");
  EXPECT_EQ(type_info<Eigen::Matrix3f>().name(), "/Eigen/Matrix3f");
  EXPECT_EQ(type_info<Eigen::VectorXd>().name(), "/Eigen/VectorXd");
  EXPECT_EQ(type_info<Eigen::MatrixXd>().name(), "/Eigen/MatrixXd");
  EXPECT_EQ(type_info<Eigen::RowVector4i>().name(), "/Eigen/RowVector4i");
  EXPECT_EQ((type_info<Eigen::Matrix<double, 6, 1>>().name()), "/Eigen/Matrix</double,6,1>");
  EXPECT_EQ((type_info<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>().name()),
            "/Eigen/Matrix</double,3,3,1>");
  EXPECT_EQ(type_info<Eigen::Quaterniond>().name(), "/Eigen/Quaterniond");
  EXPECT_EQ(type_info<Eigen::Vector3d>().type->count, 3U);
}

TEST(Eigen, FixedMatricesTravelAsBytes) {
  EXPECT_TRUE(type_info<Eigen::Vector3d>().trivially_copyable);
  EXPECT_TRUE(type_info<Eigen::Matrix4d>().trivially_copyable);
  EXPECT_TRUE(type_info<Eigen::Quaterniond>().trivially_copyable);
  EXPECT_TRUE(type_info<demo::Motion>().trivially_copyable);
  EXPECT_FALSE(type_info<Eigen::VectorXd>().trivially_copyable);
  EXPECT_FALSE(type_info<Eigen::MatrixXd>().trivially_copyable);
}

TEST(Eigen, AVectorIsAList) {
  Eigen::Vector3d vector(1, 2, 3);
  EXPECT_EQ(value_of(vector), Value::list({1, 2, 3}));
  ASSERT_TRUE(assign(vector, Value::map({{"data", Value::list({4, 5, 6})}}))) << "as Rock writes it";
  EXPECT_EQ(vector, Eigen::Vector3d(4, 5, 6));
  const auto refused = assign(vector, Value::list({1, 2}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "p: expected a list of 3, got a list of 2");
}

TEST(Eigen, AMatrixIsAListOfRowsInEitherStorageOrder) {
  const Value rows = Value::list({Value::list({1, 2}), Value::list({3, 4})});
  Eigen::Matrix2d columns_together = counted();
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> rows_together = counted();
  EXPECT_EQ(value_of(columns_together), rows);
  EXPECT_EQ(value_of(rows_together), rows);
  columns_together.setZero();
  rows_together.setZero();
  ASSERT_TRUE(assign(columns_together, rows));
  ASSERT_TRUE(assign(rows_together, rows));
  EXPECT_EQ(columns_together, counted());
  EXPECT_EQ(rows_together, counted());
  const auto refused = assign(columns_together, Value::list({Value::list({1, 2}), Value::list({3, "x"})}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "p[1][1]: expected a number, got 'x'");
  EXPECT_EQ(columns_together, counted());
  EXPECT_FALSE(assign(columns_together, Value::list({Value::list({1, 2, 3, 4})})));
}

TEST(Eigen, DynamicMatricesTakeTheirSizeFromTheValue) {
  Eigen::MatrixXd matrix;
  ASSERT_TRUE(assign(matrix, Value::list({Value::list({1, 2, 3}), Value::list({4, 5, 6})})));
  EXPECT_EQ(matrix.rows(), 2);
  EXPECT_EQ(matrix(1, 0), 4);
  const Value value = value_of(matrix);
  EXPECT_EQ(value, Value::map({{"rows", 2}, {"cols", 3}, {"data", Value::list({1, 2, 3, 4, 5, 6})}}));
  Eigen::MatrixXd copy;
  ASSERT_TRUE(assign(copy, value));
  EXPECT_EQ(copy, matrix);
  EXPECT_FALSE(assign(copy, Value::map({{"rows", 2}, {"cols", 2}, {"data", Value::list({1})}})));
  EXPECT_FALSE(assign(copy, Value::list({Value::list({1}), Value::list({1, 2})})));
  EXPECT_FALSE(assign(copy, Value::map({{"rows", -1}, {"cols", 2}, {"data", Value::list({})}})));
  EXPECT_EQ(copy, matrix);
  ASSERT_TRUE(assign(copy, Value::list({})));
  EXPECT_EQ(copy.size(), 0);
}

TEST(Eigen, DynamicVectorsTakeTheirSizeFromTheValue) {
  Eigen::VectorXd vector;
  ASSERT_TRUE(assign(vector, Value::list({1, 2})));
  EXPECT_EQ(vector, Eigen::Vector2d(1, 2));
  EXPECT_EQ(value_of(vector), Value::list({1, 2}));
}

TEST(Eigen, AQuaternionIsWXYZ) {
  Eigen::Quaterniond rotation(1, 2, 3, 4);
  EXPECT_EQ(value_of(rotation), Value::map({{"w", 1}, {"x", 2}, {"y", 3}, {"z", 4}}));
  ASSERT_TRUE(assign(rotation, Value::map({{"w", 0}, {"z", 1}})));
  EXPECT_EQ(rotation.coeffs(), Eigen::Vector4d(2, 3, 1, 0));
}

TEST(Eigen, ValuesConformToTheirTypes) {
  expect_conforming(demo::Motion{});
  demo::Samples samples;
  samples.values = Eigen::Vector2d(1, 2);
  samples.table = counted();
  expect_conforming(samples);
  demo::Samples copy;
  ASSERT_TRUE(assign(copy, value_of(samples)));
  EXPECT_EQ(copy.values, samples.values);
  EXPECT_EQ(copy.table, samples.table);
}

}  // namespace
}  // namespace segue::type
