// SPDX-License-Identifier: Apache-2.0
#include <segue/base/diagnostic.hpp>

#include <gtest/gtest.h>

namespace segue {
namespace {

TEST(Error, PrintsPlaceSubjectAndCause) {
  const Error error = fail(ErrorCode::HookFailed, "cannot configure", "camera", {"a.yaml", 3, 5})
                          .because_of(fail(ErrorCode::NotFound, "no such device"));
  EXPECT_EQ(to_string(error), "a.yaml:3:5: camera: cannot configure (no such device)");
}

TEST(Error, EveryCodeHasAName) {
  EXPECT_EQ(to_string(ErrorCode::InvalidArgument), "invalid-argument");
  EXPECT_EQ(to_string(ErrorCode::Internal), "internal");
}

TEST(Diagnostics, CountsErrorsButNotWarnings) {
  Diagnostics diagnostics;
  diagnostics.warning("odd", "looks odd");
  EXPECT_FALSE(diagnostics.has_errors());
  diagnostics.error("bad", "is bad");
  EXPECT_EQ(diagnostics.error_count(), 1u);
  EXPECT_EQ(diagnostics.items().size(), 2u);
}

TEST(Diagnostics, SortPutsFindingsInTheOrderOfTheFileAndPlacelessOnesLast) {
  Diagnostics diagnostics;
  diagnostics.error("c", "no place");
  diagnostics.error("b", "second", {"f.yaml", 9, 1});
  diagnostics.error("a", "first", {"f.yaml", 2, 7});
  diagnostics.sort();
  EXPECT_EQ(diagnostics.items()[0].code, "a");
  EXPECT_EQ(diagnostics.items()[1].code, "b");
  EXPECT_EQ(diagnostics.items()[2].code, "c");
}

TEST(Diagnostics, AsOneErrorTellsHowManyMoreThereAre) {
  Diagnostics diagnostics;
  diagnostics.warning("w", "never the first error");
  diagnostics.error("a", "unknown task", {"f.yaml", 2, 7});
  diagnostics.error("b", "unknown port");
  EXPECT_EQ(to_string(diagnostics.to_error()), "f.yaml:2:7: unknown task (and 1 more)");
}

}  // namespace
}  // namespace segue
