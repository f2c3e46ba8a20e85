// SPDX-License-Identifier: Apache-2.0
#include "plot_canvas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace segue::cli {
namespace {

TEST(Plot, JoinsTheNumbersOfAFieldOverTime) {
  const std::vector<PlotLine> lines = {{"ramp", {{0, 0}, {10, 8}}}};
  EXPECT_EQ(plot_text(lines, {.from_s = 0, .to_s = 10, .columns = 20, .rows = 4}),
            "ramp: 8\n"
            "8 |        ⢀⣀⣀⠤⠤⠒⠒⠊⠉\n"
            "0 |⣀⡠⠤⠤⠒⠒⠉⠉⠁\n"
            "  0.0 s       10.0 s\n");
}

TEST(Plot, ShowsNoNumbersOutsideOfItsTime) {
  const std::vector<PlotLine> lines = {{"jump", {{0, 1000}, {5, 1}, {10, 1}}}};
  const std::string text = plot_text(lines, {.from_s = 5, .to_s = 10, .columns = 20, .rows = 4});
  EXPECT_EQ(text.find("1000"), std::string::npos) << text;
  EXPECT_NE(text.find("1.1 |"), std::string::npos) << text;
}

TEST(Plot, InterruptsALineWhereThereIsNoNumber) {
  const std::vector<PlotLine> lines = {{"gap", {{0, 0}, {4, 0}, {5, std::nan("")}, {6, 0}, {10, 1}}}};
  const std::string text = plot_text(lines, {.from_s = 0, .to_s = 20, .columns = 20, .rows = 4});
  EXPECT_NE(text.find("⣀⣀⣀"), std::string::npos) << text;
  EXPECT_NE(text.find("⣀ "), std::string::npos) << text;
}

TEST(Plot, NamesFieldsWithoutNumbersToo) {
  const std::vector<PlotLine> lines = {{"none", {}}, {"one", {{1, 2}}}};
  const std::string text = plot_text(lines, {.from_s = 0, .to_s = 2, .columns = 20, .rows = 6});
  EXPECT_EQ(text.substr(0, text.find("2.2")), "none: -\none: 2\n");
}

}  // namespace
}  // namespace segue::cli
