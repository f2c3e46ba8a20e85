// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "../connection.hpp"
#include "../report_text.hpp"

namespace segue::cli {

namespace {

struct CancelOptions {
  std::uint64_t request = 0;  ///< 0: the newest
  Duration timeout = std::chrono::seconds(60);
};

/// Its outcome is "cancelled", which is what was asked for, unless something else came first.
int cancel_request(control::RobotService& robot, const CancelOptions& options, const Context& context) {
  const auto answer = robot.cancel(options.request, sender("cancel"), deadline_in(options.timeout));
  if (!answer) return failed(context, answer.error());
  show_outcome(*answer, context);
  const type::Value* undo = answer->find("undo");
  const type::Value* restored = undo == nullptr ? nullptr : undo->find("restored");
  const bool is_restored = restored == nullptr || *restored == type::Value(true);
  return printable_at(*answer, "outcome") == "cancelled" && is_restored ? kDone : kFailed;
}

}  // namespace

void add_cancel(Verb& app, Context& context) {
  const auto options = std::make_shared<CancelOptions>();
  Verb& verb = add_verb(app, context, "cancel", "cancel a request in progress",
                        "  segue cancel\n\n"
                        "Before its point of commit a transition is undone, as where an action fails: the "
                        "robot runs again what "
                        "it\n"
                        "ran before. Afterwards it is refused, because the transition completes. Actions in "
                        "progress end first.",
                        [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return cancel_request(robot, *options, context);
                          });
                        });
  verb.option("--request N", options->request,
              "only this request, by its number in `segue status --format json`; else the newest");
  verb.option("--timeout DURATION", options->timeout, "how long to wait until it is undone (default 60s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli
