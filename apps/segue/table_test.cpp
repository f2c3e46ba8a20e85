// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "output.hpp"

namespace segue::cli {
namespace {

Table tasks_table() {
  using Align = Table::Align;
  Table table({{"TASK"}, {"COMPONENT"}, {"CYCLES", Align::Right}, {"NOTE"}});
  table.add({"laser", "demo::LaserScanner", "123456", "finds what is in front of it"});
  table.add({"drive", "demo::Drive", "7", "-"});
  return table;
}

TEST(Table, IsAsWideAsItsCellsWhereThereIsRoom) {
  const std::string whole =
      "TASK   COMPONENT           CYCLES  NOTE\n"
      "laser  demo::LaserScanner  123456  finds what is in front of it\n"
      "drive  demo::Drive              7  -\n";
  EXPECT_EQ(tasks_table().text(SIZE_MAX), whole);
  EXPECT_EQ(tasks_table().text(63), whole);
}

TEST(Table, FoldsTheWidestTextsAtBlanksAndNeverNumbers) {
  EXPECT_EQ(tasks_table().text(55),
            "TASK   COMPONENT           CYCLES  NOTE\n"
            "laser  demo::LaserScanner  123456  finds what is in\n"
            "                                   front of it\n"
            "drive  demo::Drive              7  -\n");
}

TEST(Table, FoldsNamesAfterSignsElseAnywhere) {
  Table table({{"TYPE"}});
  table.add({"robot_arm::JointTrajectory"});
  table.add({"abcdefghijklmnopq"});
  table.add({"straße straße üü"});
  EXPECT_EQ(table.text(15),
            "TYPE\n"
            "robot_arm::\nJointTrajectory\n"
            "abcdefghijklmno\npq\n"
            "straße straße\nüü\n");
}

TEST(Table, GoesOnBelowWhereColumnsWouldBeTooNarrow) {
  EXPECT_EQ(tasks_table().text(34),
            "TASK   COMPONENT           CYCLES\n"
            "laser  demo::LaserScanner  123456\n"
            "drive  demo::Drive              7\n"
            "\n"
            "TASK   NOTE\n"
            "laser  finds what is in front of\n"
            "       it\n"
            "drive  -\n");
}

TEST(Table, FoldedLinesKeepTheColourOfTheirCell) {
  Table table({{"STATE"}});
  table.add({"\x1b[31mrun time error\x1b[0m"});
  EXPECT_EQ(table.text(8), "STATE\n\x1b[31mrun time\x1b[0m\n\x1b[31merror\x1b[0m\n");
}

}  // namespace
}  // namespace segue::cli
