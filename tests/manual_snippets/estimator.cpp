// SPDX-License-Identifier: Apache-2.0
// A component with the estimate that the page describes.
#include <segue/task/component.hpp>

#include <optional>

using namespace segue;
using namespace segue::task;
using demo::Estimate;

class Estimator final : public Component {
 private:
  // the snippet
  Estimate estimate_;
};
